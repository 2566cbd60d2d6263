// CSV in three layers: lines out of bytes, cells out of lines, numbers out of cells.
#include <rlslab/model/csv.hpp>
#include <rlslab/model/suggestion.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

namespace rlslab {
namespace {

constexpr std::size_t longest_line = 1 << 20;        // no row of numbers comes near; what does is not a CSV file

std::string quoted(std::string_view text, std::size_t limit = 40) {
    return fmt::format("\"{}\"", printable(text, limit));
}

std::string_view trimmed(std::string_view text) {
    auto const first = text.find_first_not_of(' ');
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

char lower(char c) { return 'A' <= c && c <= 'Z' ? char(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view b) { return std::ranges::equal(a, b, {}, lower, lower); }

// ---- lines ----------------------------------------------------------------------------------------------------------

class Lines {
    struct Close {
        void operator()(std::FILE* file) const {
            if (file != stdin) std::fclose(file);
        }
    };
    std::string name_;
    std::unique_ptr<std::FILE, Close> file_;
    std::array<char, 1 << 16> chunk_{};
    std::string_view rest_;                          // of the chunk
    std::string line_;                               // one that crosses chunks
    long number_ = 0;

    bool refill() {
        errno = 0;
        std::size_t const got = std::fread(chunk_.data(), 1, chunk_.size(), file_.get());
        rest_ = {chunk_.data(), got};
        if (got > 0 || !std::ferror(file_.get())) return got > 0;
        if (errno == EISDIR) throw InputError(name_ + ": expected a file, found a directory");
        throw InputError(fmt::format("{}: cannot be read: {}", name_, std::generic_category().message(errno)));
    }

    std::string_view checked_line(std::string_view line) {
        if (number_ == 1) {
            if (line.starts_with("\xff\xfe") || line.starts_with("\xfe\xff"))
                throw InputError(name_ + ": expected UTF-8 text, found UTF-16");
            if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
        }
        if (line.find('\0') != line.npos)
            throw InputError(fmt::format("{}:{}: expected text, found a zero byte (a binary file?)", name_, number_));
        if (line.ends_with('\r')) line.remove_suffix(1);
        return line;
    }

public:
    explicit Lines(std::string const& path)
        : name_(path == "-" ? "standard input" : printable(path, 200)),
          file_(path == "-" ? stdin : std::fopen(path.c_str(), "rb")) {
        if (!file_)
            throw InputError(fmt::format("{}: cannot be opened: {}", name_, std::generic_category().message(errno)));
    }
    Lines(Lines const&) = delete;                    // rest_ points into chunk_
    Lines& operator=(Lines const&) = delete;
    std::string const& name() const { return name_; }
    long number() const { return number_; }          // of the line last returned

    /// The next line without its end, valid until the next call; nullopt at the end of the data.
    std::optional<std::string_view> next() {
        line_.clear();
        if (rest_.empty() && !refill()) return std::nullopt;
        ++number_;
        for (;;) {
            auto const end = rest_.find('\n');
            auto const part = rest_.substr(0, end);
            if (line_.size() + part.size() > longest_line)
                throw InputError(fmt::format("{}:{}: expected a line of at most 1 MiB", name_, number_));
            rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
            if (end != part.npos && line_.empty()) return checked_line(part);
            line_ += part;
            if (end != part.npos || !refill()) return checked_line(line_);
        }
    }
};

// ---- cells ----------------------------------------------------------------------------------------------------------

/// Follows quotes over the lines of one row, as Row does: one opens at the start of a cell, one within stands doubled.
class Quotes {
    std::string_view separators_;                    // all that come into question
    bool open_ = false, start_ = true, closed_ = false, tab_ = false, semicolon_ = false;

public:
    explicit Quotes(char separator) : separators_(separator == ',' ? "," : separator == ';' ? ";" : "\t") {}
    Quotes() : separators_(",;\t") {}
    void take(std::string_view line) {
        for (char const c : line) {
            bool const quote = c == '"', was_open = open_;
            if (quote) open_ = !was_open && (start_ || closed_);
            closed_ = quote && was_open;
            if (open_ || quote) {
                start_ = false;
                continue;
            }
            tab_ |= c == '\t';
            semicolon_ |= c == ';';
            start_ = separators_.find(c) != separators_.npos || (start_ && c == ' ');
        }
    }
    bool open() const { return open_; }
    char separator() const { return tab_ ? '\t' : semicolon_ ? ';' : ','; }        // seen outside quotes
};

/// A row split into its cells, quotes resolved; its storage is reused from row to row.
class Row {
    enum class At { start, bare, quoted, quote, closed };
    std::string text_;                               // of all cells, without separators
    std::vector<std::size_t> ends_;
    At at_ = At::start;

    std::size_t begin(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }
    void end_cell() {
        ends_.push_back(text_.size());
        at_ = At::start;
    }

public:
    enum class Taken { whole, open, broken };        // open: inside quotes; broken: text behind a closing quote
    std::size_t size() const { return ends_.size(); }
    std::string_view operator[](std::size_t i) const {
        return trimmed(std::string_view(text_).substr(begin(i), ends_[i] - begin(i)));
    }
    Taken take(std::string_view row, char separator) {
        text_.clear();
        ends_.clear();
        at_ = At::start;
        for (char const c : row) {
            bool const inside = at_ == At::quoted;
            if (c == separator && !inside) {
                end_cell();
            } else if (inside) {
                if (c == '"') at_ = At::quote;
                else text_ += c;
            } else if (at_ == At::quote && c == '"') {
                text_ += '"';
                at_ = At::quoted;
            } else if (at_ == At::quote || at_ == At::closed) {
                if (c != ' ') return Taken::broken;
                at_ = At::closed;
            } else if (at_ == At::start && c == '"') {
                text_.resize(begin(ends_.size()));       // spaces before the quote
                at_ = At::quoted;
            } else {
                text_ += c;
                if (c != ' ') at_ = At::bare;
            }
        }
        if (at_ == At::quoted) return Taken::open;
        end_cell();
        return Taken::whole;
    }
};

// ---- numbers --------------------------------------------------------------------------------------------------------

enum class Kind { number, missing, infinite, out_of_range, decimal_comma, text };

struct Reading {
    Kind kind;
    double value = std::numeric_limits<double>::quiet_NaN();
};

Reading reading_of(std::string_view cell) {
    if (cell.empty() || cell == "." || cell == "?" || same_word(cell, "na") || same_word(cell, "n/a") ||
        same_word(cell, "#n/a") || same_word(cell, "null"))
        return {Kind::missing};
    bool const plus = cell[0] == '+';
    std::string_view const magnitude = cell.substr(plus || cell[0] == '-' ? 1 : 0);
    if (same_word(magnitude, "nan")) return {Kind::missing};
    if (same_word(magnitude, "inf") || same_word(magnitude, "infinity")) return {Kind::infinite};
    // from_chars takes a minus but no plus; what it makes of letters ("nan(1)") is no number here.
    if (magnitude.empty() || (magnitude[0] != '.' && (magnitude[0] < '0' || magnitude[0] > '9'))) return {Kind::text};
    double value = 0;
    char const* const end = cell.data() + cell.size();
    auto const [stop, error] = std::from_chars(cell.data() + plus, end, value);
    if (stop == end) {
        bool const held = error == std::errc() && std::abs(value) <= largest_value;
        return held ? Reading{Kind::number, value} : Reading{Kind::out_of_range};
    }
    if (auto const comma = cell.find(','); comma != cell.npos) {
        std::string pointed(cell);
        pointed[comma] = '.';
        auto const kind = reading_of(pointed).kind;
        if (kind == Kind::number || kind == Kind::decimal_comma) return {Kind::decimal_comma};
    }
    return {Kind::text};
}

std::string complaint(Kind kind, std::string_view cell) {
    switch (kind) {
        case Kind::infinite: return "expected a finite number, found " + quoted(cell);
        case Kind::out_of_range:
            return "expected 0 or a size from 2^-1074 to 2^500 (squares must stay finite), found " + quoted(cell);
        case Kind::decimal_comma:
            return "expected a number, found " + quoted(cell) + " (decimal commas are not supported: use a point)";
        default: return "expected a number, found " + quoted(cell);
    }
}

// ---- names ----------------------------------------------------------------------------------------------------------

std::string listed(std::vector<std::string> const& names) {
    constexpr std::size_t shown = 8;
    std::string list;
    for (std::size_t i = 0; i < std::min(shown, names.size()); ++i)
        list += (i == 0 ? "" : ", ") + quoted(names[i], 24);
    return names.size() > shown ? fmt::format("{}, ... ({} in all)", list, names.size()) : list;
}

}  // namespace

// ---- the file -------------------------------------------------------------------------------------------------------

struct CsvFile::State {
    Lines lines;
    Row row;
    char separator = ',';
    bool header = false, finished = false;
    std::vector<std::string> names;
    long first = 0;                                  // line of the first row, header or not
    long line = 0;                                   // line on which the row begins

    [[noreturn]] void fail(long at, std::string const& message) const {
        throw InputError(fmt::format("{}:{}: {}", lines.name(), at, message));
    }
    bool next_row();
    std::size_t column_of(std::string const& asked) const;
    double number_in(std::size_t column) const;
};

bool CsvFile::State::next_row() {
    std::optional<std::string_view> text;
    do {
        text = lines.next();
        if (!text) return false;
    } while (text->find_first_not_of(' ') == text->npos || (first == 0 && text->starts_with('#')));
    line = lines.number();
    Quotes quotes = first == 0 ? Quotes() : Quotes(separator);
    if (first == 0 || text->find('"') != text->npos) quotes.take(*text);
    std::string whole;
    while (quotes.open()) {
        whole += *text;
        whole += '\n';
        text = whole.size() <= longest_line ? lines.next() : std::nullopt;
        if (!text) break;
        quotes.take(*text);
        if (!quotes.open()) text = whole += *text;
    }
    if (first == 0) {
        first = line;
        separator = quotes.separator();
    }
    auto const taken = row.take(text ? *text : whole, separator);
    if (taken == Row::Taken::open) fail(line, fmt::format("column {}: expected a closing quote", row.size() + 1));
    if (taken == Row::Taken::broken)
        fail(line, fmt::format("column {}: expected a separator behind the closing quote", row.size() + 1));
    return true;
}

std::size_t CsvFile::State::column_of(std::string const& asked) const {
    if (asked.empty()) throw InputError(lines.name() + ": expected the name of a column, found \"\"");
    auto const found = std::ranges::find(names, asked);
    if (found == names.end())
        throw InputError(fmt::format("{}: no column {}{}; {} {}", lines.name(), quoted(asked),
                                     header ? did_you_mean(asked, {names.begin(), names.end()}) : "",
                                     header ? "the columns are" : "without a header they are", listed(names)));
    auto const again = std::find(found + 1, names.end(), asked);
    if (again != names.end())
        fail(first, fmt::format("expected different names, found {} over columns {} and {}", quoted(asked),
                                found - names.begin() + 1, again - names.begin() + 1));
    return std::size_t(found - names.begin());
}

double CsvFile::State::number_in(std::size_t column) const {
    auto const [kind, value] = reading_of(row[column]);
    if (kind == Kind::number || kind == Kind::missing) return value;
    std::string const name = header ? fmt::format(" ({})", printable(names[column])) : "";
    fail(line, fmt::format("column {}{}: {}", column + 1, name, complaint(kind, row[column])));
}

CsvFile::CsvFile(std::string const& path) : state_(new State{.lines = Lines(path), .row = {}, .names = {}}) {
    State& s = *state_;
    if (!s.next_row())
        throw InputError(fmt::format("{}: expected rows of numbers, found {}", s.lines.name(),
                                     s.lines.number() == 0 ? "an empty file" : "only comments and blank lines"));
    for (std::size_t i = 0; i < s.row.size(); ++i) s.header |= reading_of(s.row[i]).kind == Kind::text;
    for (std::size_t i = 0; i < s.row.size(); ++i)
        s.names.push_back(s.header ? std::string(s.row[i]) : std::to_string(i + 1));
}

CsvFile::CsvFile(CsvFile&&) noexcept = default;
CsvFile& CsvFile::operator=(CsvFile&&) noexcept = default;
CsvFile::~CsvFile() = default;

std::string const& CsvFile::file() const { return state_->lines.name(); }
bool CsvFile::has_header() const { return state_->header; }
std::vector<std::string> const& CsvFile::names() const { return state_->names; }

Columns CsvFile::read(std::vector<std::string> const& asked) {
    State& s = *state_;
    expects(!asked.empty(), "the name of a column at least");
    expects(!s.finished, "a file that was not read before");
    s.finished = true;
    std::vector<std::size_t> columns;
    for (auto const& name : asked) columns.push_back(s.column_of(name));
    Columns data{.file = s.lines.name(), .header = s.header, .names = asked};
    data.values.resize(asked.size());
    for (bool more = !s.header || s.next_row(); more; more = s.next_row()) {
        if (s.row.size() != s.names.size())
            s.fail(s.line, fmt::format("expected {} columns as in line {}, found {}", s.names.size(), s.first,
                                       s.row.size()));
        for (std::size_t i = 0; i < columns.size(); ++i) data.values[i].push_back(s.number_in(columns[i]));
        data.lines.push_back(s.line);
    }
    if (data.lines.empty())
        throw InputError(fmt::format("{}: expected rows below the header, found none (the columns are {})", data.file,
                                     listed(s.names)));
    return data;
}

Columns read_columns(std::string const& path, std::vector<std::string> const& asked) {
    return CsvFile(path).read(asked);
}

std::vector<double> const& Columns::operator[](std::string const& name) const {
    auto const found = std::ranges::find(names, name);
    expects(found != names.end(), "a column that was read");
    return values[std::size_t(found - names.begin())];
}

}  // namespace rlslab
