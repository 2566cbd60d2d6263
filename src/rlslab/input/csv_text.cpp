// One pass over each line. Only cells, and lines that cross chunks, are copied.
#include <rlslab/input/csv_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace rlslab::csv {
namespace {

// ---- files that are no table of text, by the first bytes that formats prescribe -------------------------------------

struct FileKind {
    std::string_view begins, what;
};

constexpr std::string_view utf_16 = "UTF-16: save it as UTF-8 (iconv -f UTF-16LE -t UTF-8, or UTF-16BE)";
constexpr std::string_view utf_32 = "UTF-32: save it as UTF-8 (iconv -f UTF-32LE -t UTF-8, or UTF-32BE)";
constexpr FileKind of_bytes[] = {{std::string_view("\xff\xfe\0\0", 4), utf_32},
                                 {std::string_view("\0\0\xfe\xff", 4), utf_32},
                                 {"\xff\xfe", utf_16},
                                 {"\xfe\xff", utf_16},
                                 {"\x1f\x8b", "gzip's compressed data: unpack them first"},
                                 {"BZh91AY", "bzip2's compressed data: unpack them first"},
                                 {"\xfd"
                                  "7zXZ",
                                  "xz's compressed data: unpack them first"},
                                 {"\x28\xb5\x2f\xfd", "zstd's compressed data: unpack them first"},
                                 {"7z\xbc\xaf", "a 7-Zip archive: unpack it first"},
                                 {"PK\x03\x04", "a zip archive or a workbook: save the sheet as CSV"},
                                 {"\xd0\xcf\x11\xe0", "a workbook: save the sheet as CSV"},
                                 {"\x89PNG", "a PNG image"},
                                 {"\xff\xd8\xff", "a JPEG image"},
                                 {"GIF89a", "a GIF image"},
                                 {"%PDF-", "a PDF document"},
                                 {"{\\rtf", "an RTF document: save the table as CSV"},
                                 {"\x89HDF", "an HDF5 file: save the columns as CSV"},
                                 {"\x93NUMPY", "an array of NumPy: write it with numpy.savetxt"},
                                 {"PAR1\x15", "a Parquet file: save the columns as CSV"},
                                 {"SQLite format 3", "a database of SQLite: save the table as CSV"},
                                 {"\x7f"
                                  "ELF",
                                  "a program"}};
constexpr std::string_view of_markup[] = {"<!doctype html", "<html", "<head", "<body", "<table"};

/// Whether one of every two bytes is zero: letters and digits in UTF-16, which begins without a mark.
bool in_pairs(std::string_view begin) {
    begin = begin.substr(0, std::min<std::size_t>(begin.size(), 16));
    bool zero[2] = {begin.size() > 1, begin.size() > 1};
    for (std::size_t i = 0; i < begin.size(); ++i) zero[i % 2] &= begin[i] == '\0';
    return zero[0] != zero[1];
}

/// "a PNG image" with what to do about it, for a text that begins so; "" for anything else.
std::string_view not_a_table(std::string_view begin) {
    for (auto const& [begins, what] : of_bytes)
        if (begin.starts_with(begins)) return what;
    if (in_pairs(begin)) return begin.substr(1, 2) == std::string_view("\0\0", 2) ? utf_32 : utf_16;
    if (begin.starts_with("\xef\xbb\xbf")) begin.remove_prefix(3);
    begin.remove_prefix(std::min(begin.find_first_not_of(" \t"), begin.size()));
    auto const same = [](char a, char b) { return ('A' <= a && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
    for (auto const& tag : of_markup)
        if (std::ranges::equal(begin.substr(0, tag.size()), tag, same))
            return "a web page (HTML): save the table in it as CSV";
    if (std::ranges::equal(begin.substr(0, 5), std::string_view("<?xml"), same))
        return "an XML file: save the table in it as CSV";
    return "";
}

}  // namespace

std::string in_quotes(std::string_view text, std::size_t limit) {
    return fmt::format("\"{}\"", printable(text, limit));
}

std::string_view trimmed(std::string_view text) {
    auto const first = text.find_first_not_of(' ');
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// ---- lines ----------------------------------------------------------------------------------------------------------

bool Lines::refill() {
    std::size_t const got = source_(chunk_);
    rest_ = {chunk_.data(), got};
    return got > 0;
}

/// Ends of lines in quotes are not looked at: they are part of a cell.
void Lines::find_end() {
    bool quoted = false;
    std::size_t at = 0, behind = 0;
    while (end_ == 0 && begin_.size() <= longest_line && refill()) {
        begin_ += rest_;
        for (; end_ == 0 && at < begin_.size(); ++at) {
            if (begin_[at] == '"') quoted = !quoted;
            if (begin_[at] == '\n') end_ = '\n';
            if (begin_[at] != '\r' || quoted) continue;
            behind = begin_.find_first_not_of('\r', at);
            if (behind == begin_.npos) break;  // in the next chunk
            end_ = begin_[behind] == '\n' ? '\n' : '\r';
        }
    }
    if (end_ == 0) end_ = behind == begin_.npos ? '\r' : '\n';
    rest_ = begin_;
}

std::string_view Lines::checked_line(std::string_view line) {
    if (number_ == 1) {
        if (auto const what = not_a_table(line); !what.empty())
            throw InputError(fmt::format("{}: expected rows of numbers as UTF-8 text, found {}", name_, what));
        if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    }
    if (line.find('\0') != line.npos)
        throw InputError(fmt::format("{}:{}: expected text, found a zero byte (a binary file?)", name_, number_));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::optional<std::string_view> Lines::next() {
    line_.clear();
    if (end_ == 0) find_end();
    if (rest_.empty() && !refill()) return std::nullopt;
    ++number_;
    for (;;) {
        auto const end = rest_.find(end_);
        auto const part = rest_.substr(0, end);
        if (line_.size() + part.size() > longest_line)
            throw InputError(fmt::format("{}:{}: expected a line of at most 1 MiB", name_, number_));
        rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
        if (end != part.npos && line_.empty()) return checked_line(part);
        line_ += part;
        if (end != part.npos || !refill()) return checked_line(line_);
    }
}

// ---- cells ----------------------------------------------------------------------------------------------------------

namespace {

std::string_view separators_of(char separator) {
    if (separator == 0) return separators.substr(0, 4);
    if (separator == ' ') return " \t";
    return separators.substr(separators.find(separator), 1);
}

}  // namespace

Quotes::Quotes(char separator) : separators_(separators_of(separator)) {}

At after(At at, char c, bool separates) {
    if (at == At::quoted) return c == '"' ? At::quote : At::quoted;
    if (separates) return At::start;
    switch (at) {
        case At::start: return c == '"' ? At::quoted : c == ' ' ? At::start : At::bare;
        case At::quote: return c == '"' ? At::quoted : c == ' ' ? At::closed : At::broken;
        case At::closed: return c == ' ' ? At::closed : At::broken;
        default: return at;
    }
}

void Quotes::follow(std::string_view line) {
    for (char const c : line) {
        bool const separates = !open() && separators_.find(c) != separators_.npos;
        if (separates && !saw(c)) seen_ += c;
        at_ = after(at_, c, separates);
    }
}

Row::Result Row::split(std::string_view row, char separator) {
    text_.clear();
    ends_.clear();
    at_ = At::start;
    bool const blanks = separator == ' ';
    for (char const c : row) {
        bool const separates = at_ != At::quoted && (c == separator || (blanks && c == '\t'));
        if (separates) {
            if (!blanks || at_ != At::start) end_cell();
            continue;
        }
        At const before = std::exchange(at_, after(at_, c, false));
        if (at_ == At::broken) return Result::broken;
        if (before == At::start && at_ == At::quoted) text_.resize(begin(ends_.size()));  // spaces before the quote
        else if (at_ != At::quote && at_ != At::closed) text_ += c;
    }
    if (at_ == At::quoted) return Result::open;
    if (!blanks || at_ != At::start || ends_.empty()) end_cell();
    return Result::whole;
}

std::size_t comment_mark(std::string_view line) {
    if (line.starts_with("//")) return 2;
    return line.starts_with('#') || line.starts_with('%') || line.starts_with('!');
}

std::vector<std::string> cells_among(std::vector<std::string> const& words, ByteSource bytes, std::string name) {
    Lines lines(std::move(bytes), std::move(name));
    std::vector<std::string> out;
    Row row;
    for (int k = 0; k < lines_with_names; ++k) {
        auto const line = lines.next();
        if (!line) break;
        for (std::size_t const mark : {std::size_t(0), comment_mark(*line)})
            for (char const separator : separators)
                if (row.split(line->substr(mark), separator) == Row::Result::whole)
                    for (std::size_t i = 0; i < row.size(); ++i)
                        if (std::ranges::find(words, row[i]) != words.end() &&
                            std::ranges::find(out, row[i]) == out.end())
                            out.emplace_back(row[i]);
    }
    return out;
}

std::size_t Row::with_one(char c, std::size_t i) const {
    for (std::size_t at = i < size() ? text_.find(c, begin(i)) : text_.npos; at != text_.npos;
         at = text_.find(c, ends_[i])) {
        while (ends_[i] <= at) ++i;
        auto const again = text_.find(c, at + 1);
        if (again == text_.npos || again >= ends_[i]) return i;
    }
    return size();
}

}  // namespace rlslab::csv
