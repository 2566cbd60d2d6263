// From bytes to lines, and from lines to cells. Internal to the reader of CSV files.
#pragma once

#include <rlslab/input/bytes.hpp>

#include <optional>
#include <vector>

namespace rlslab::csv {

constexpr std::size_t longest_line = 1 << 20;  // a longer one is no row of numbers

/// "text", shortened and printable.
std::string in_quotes(std::string_view text, std::size_t limit = 40);
/// Without blanks around it.
std::string_view trimmed(std::string_view text);

/// The lines of a text, which end with LF, CRLF or (if the first one does) CR. next() throws InputError for bytes that
/// are no table of text, which it names, and for a line that is too long.
class Lines {
    std::string name_;
    ByteSource source_;
    std::vector<char> chunk_;
    std::string_view rest_;  // of the chunk, or of begin_
    std::string begin_;      // the chunks up to the first end of a line
    std::string line_;       // one that crosses chunks
    long number_ = 0;
    char end_ = 0;  // 0: not known yet

    void find_end();
    bool refill();
    std::string_view checked_line(std::string_view line);

public:
    Lines(ByteSource source, std::string name) : name_(std::move(name)), source_(std::move(source)), chunk_(1 << 16) {}
    Lines(Lines const&) = delete;  // rest_ points into chunk_ or begin_
    Lines& operator=(Lines const&) = delete;
    std::string const& name() const { return name_; }
    long number() const { return number_; }  // of the line last returned

    /// The next line without its end, valid until the next call; nullopt at the end of the data.
    std::optional<std::string_view> next();
};

/// The state of a row after a character. start: at the start of a cell; bare: in a cell without quotes; quoted: inside
/// quotes; quote: after a quote mark that closes them or is the first of two; closed: after the closing quote and
/// blanks; broken: text behind the closing quote.
enum class At { start, bare, quoted, quote, closed, broken };
/// The state after the next character c; separates: c is a separator. A quote mark opens at the start of a cell; one
/// within is doubled.
At after(At at, char c, bool separates);

/// Follows the quotes over the lines of one row.
class Quotes {
    std::string_view separators_;  // all that are possible
    At at_ = At::start;
    std::string seen_;  // separators outside quotes, each once

public:
    /// separator 0: not known yet.
    explicit Quotes(char separator);
    void follow(std::string_view line);
    bool open() const { return at_ == At::quoted; }
    bool saw(char separator) const { return seen_.find(separator) != seen_.npos; }
};

/// A row split into its cells, quotes resolved; its storage is reused from row to row. The separator ' ' stands for
/// runs of blanks and tabs, which may also begin and end the row.
class Row {
    std::string text_;  // of all cells, without separators
    std::vector<std::size_t> ends_;
    At at_ = At::start;

    std::size_t begin(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }
    void end_cell() {
        ends_.push_back(text_.size());
        at_ = At::start;
    }

public:
    enum class Result { whole, open, broken };  // open: inside quotes; broken: text behind a closing quote
    std::size_t size() const { return ends_.size(); }
    /// The next cell from i on that contains c exactly once; size(): there is none.
    std::size_t with_one(char c, std::size_t i) const;
    std::string_view operator[](std::size_t i) const {
        return trimmed(std::string_view(text_).substr(begin(i), ends_[i] - begin(i)));
    }
    Result split(std::string_view row, char separator);
};

inline constexpr std::string_view separators = ",;\t| ";
/// The length of the mark with which a line above the first row begins that is a comment; 0: it is none.
std::size_t comment_mark(std::string_view line);
inline constexpr int lines_with_names = 100;  // at the beginning of a file, in which its names are looked for
/// Those of the words that are cells of one of these lines, however they are separated.
std::vector<std::string> cells_among(std::vector<std::string> const& words, ByteSource bytes, std::string name);

}  // namespace rlslab::csv
