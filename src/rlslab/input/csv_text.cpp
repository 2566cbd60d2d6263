// One pass over each line. Only cells, and lines that cross chunks, are copied.
#include <rlslab/input/csv_text.hpp>

#include <rlslab/input/file_kind.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace rlslab::csv {

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
