// CSV in layers: from bytes to lines and cells (csv_text), from cells to numbers (csv_cells), and here from
// the first rows to the format, and from rows to columns.
#include <rlslab/input/csv.hpp>

#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/csv_cells.hpp>
#include <rlslab/input/csv_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace rlslab {

using namespace csv;

namespace {

std::string listed(std::vector<std::string> const& names) {
    constexpr std::size_t shown = 8;
    std::string list;
    for (std::size_t i = 0; i < std::min(shown, names.size()); ++i)
        list += (i == 0 ? "" : ", ") + in_quotes(names[i], 24);
    return names.size() > shown ? fmt::format("{}, ... ({} in all)", list, names.size()) : list;
}

/// The separator that a line "sep=;" names, as spreadsheet programs write and read it; 0: the line is something else.
char named_separator(std::string_view line) {
    if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
    bool const is_one =
        line.size() == 5 && (line.starts_with("sep=") || line.starts_with("SEP=") || line.starts_with("Sep="));
    return is_one ? line[4] : '\0';
}

/// The cells of the line, if all that are requested are among them.
std::optional<std::vector<std::string>> names_in(std::string_view line, char separator,
                                                 std::vector<std::string> const& requested) {
    Row row;
    if (row.split(line, separator) != Row::Result::whole) return std::nullopt;
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < row.size(); ++i) cells.emplace_back(row[i]);
    for (auto const& name : requested)
        if (std::ranges::find(cells, name) == cells.end()) return std::nullopt;
    return cells;
}

/// The row as one possible separator divides it.
struct Split {
    std::size_t cells = 0;               ///< 0: its quotes do not fit
    bool values = false, words = false;  ///< all cells are values; some are text
    Split(std::string_view text, char separator) {
        Row row;
        if (row.split(text, separator) != Row::Result::whole) return;
        cells = row.size();
        values = true;
        for (std::size_t i = 0; i < cells; ++i) {
            Kind const kind = reading_of(row[i]).kind;
            values &= is_value(kind);
            words |= kind == Kind::text;
        }
    }
};

/// "|---|:---|", under the names of a table in Markdown.
bool is_rule(Row const& row) {
    bool dashes = false;
    for (std::size_t i = 0; i < row.size(); ++i) {
        bool const here = row[i].size() > 2 && row[i].find_first_not_of("-:") == std::string_view::npos;
        if (!here && !row[i].empty()) return false;
        dashes |= here;
    }
    return dashes;
}

}  // namespace

struct CsvFile::State {
    Lines lines;
    CsvFormat format;  // as far as it is known
    char given;        // separator; 0: none
    long most;         // numbers that may be stored
    Row row = {};
    bool header = false, finished = false;
    std::string above = {}, unsplit = {};  // the last comment above the first row; why that row cannot be split
    long above_line = 0;
    std::vector<std::string> names = {};
    long first = 0;                      // line of the first row, header or not
    long line = 0;                       // line on which the row begins
    std::string whole = {}, below = {};  // a row of several lines; the row below the first, if it was looked at
    std::optional<long> below_line = {};
    std::vector<long> blank_lines =
        {};  // in a file of one column, since the last row: values that are missing if another row follows
    Marks marks = Marks(format.decimal);

    std::string told(long at, std::string const& message) const {
        return fmt::format("{}:{}: {}", lines.name(), at, message);
    }
    [[noreturn]] void fail(long at, std::string const& message) const { throw InputError(told(at, message)); }
    [[noreturn]] void fail(long at, std::size_t column, std::string const& message) const {
        std::string const name = header ? fmt::format(" ({})", printable(names[column])) : "";
        fail(at, fmt::format("column {}{}: {}", column + 1, name, message));
    }
    std::optional<std::string_view> next_text();
    bool look_below();
    char separator_of(std::string const& text);
    std::string split(std::string_view text);
    void split_row(std::string_view text) {
        if (std::string const why = split(text); !why.empty()) throw InputError(why);
    }
    bool first_row();
    bool next_row();
    void use_numbers_as_names(std::vector<std::string> const& requested);
    bool names_above(std::vector<std::string> const& requested);
    bool names_below(std::vector<std::string> const& requested);
    Reading reading(std::string_view cell) const { return reading_of(cell, format.missing); }
    void pass(std::optional<Marks::Fault> const& fault) const {
        if (fault) fail(fault->at.line, fault->at.column, fault->message);
    }
    double number_in(std::size_t column);
    std::optional<std::size_t> column_of_times(std::vector<std::size_t> const& requested) const;
};

/// The lines of the next row; sets `line`.
std::optional<std::string_view> CsvFile::State::next_text() {
    std::optional<std::string_view> text;
    bool const searching = first == 0;
    for (;;) {
        text = lines.next();
        if (!text) return std::nullopt;
        if (char const named = searching && lines.number() == 1 ? named_separator(*text) : '\0') {
            if (separators.find(named) == separators.npos)
                fail(1, "expected sep= with a comma, semicolon, tab, bar or blank, found " + in_quotes(*text));
            if (format.separator == 0) given = format.separator = named;
            continue;
        }
        bool const blank = text->find_first_not_of(format.separator == ' ' ? " \t" : " ") == text->npos;
        if (blank && !searching && names.size() == 1 && long(blank_lines.size()) < most)
            blank_lines.push_back(lines.number());
        if (blank) continue;
        if (!searching || comment_mark(*text) == 0) break;
        above = *text;
        above_line = lines.number();
    }
    line = lines.number();
    if (text->find('"') == text->npos) return text;
    Quotes quotes(format.separator);
    quotes.follow(*text);
    if (!quotes.open()) return text;
    whole.clear();
    while (quotes.open()) {
        whole += *text;
        whole += '\n';
        text = whole.size() <= longest_line ? lines.next() : std::nullopt;
        if (!text) return whole;
        quotes.follow(*text);
    }
    return whole += *text;
}

/// Reads the row below into `below`; false: there is none.
bool CsvFile::State::look_below() {
    if (below_line) return true;
    long const here = line;
    auto const next = next_text();
    if (!next) return false;
    below = *next;
    below_line = std::exchange(line, here);
    return true;
}

/// The separator, from the first row and, if that has only blanks between words, from the row below.
char CsvFile::State::separator_of(std::string const& text) {
    Quotes quotes(0);
    quotes.follow(text);
    for (char const sure : {'\t', ';'})
        if (quotes.saw(sure)) return sure;
    if (quotes.saw('|')) {
        Split const by_bars(text, '|');
        first = line;  // from here on, '#' begins a row
        bool const more = look_below();
        auto const fits = [&](Split const& here, char separator) {
            return here.cells > 1 && (!more || Split(below, separator).cells == here.cells);
        };
        Split const by_commas(text, ',');
        if (fits(by_bars, '|') && (!fits(by_commas, ',') || (by_bars.values && !by_commas.values))) return '|';
    }
    char const one_column = format.decimal == ',' ? ';' : ',';
    Split const by_blanks(text, ' ');
    if (quotes.saw(',')) {
        Split const by_commas(text, ',');
        if (by_blanks.cells > 1 && by_blanks.values && !by_commas.values) return ' ';  // 1,5 2,5
        return by_commas.words ? ',' : one_column;
    }
    if (by_blanks.cells < 2) return one_column;
    if (by_blanks.values) return ' ';
    first = line;  // from here on, '#' begins a row
    if (!look_below()) return one_column;
    std::size_t const cells = Split(below, ' ').cells;
    if (cells == by_blanks.cells) return ' ';
    if (cells > 1)
        unsplit = told(
            first,
            fmt::format(
                "expected as many names as cells below, found {} words over {} in line {} (quote a name that holds "
                "blanks, or give the separator: --separator)",
                by_blanks.cells, cells, *below_line));
    return one_column;
}

/// Splits the row; what is wrong with it, or nothing.
std::string CsvFile::State::split(std::string_view text) {
    switch (row.split(text, format.separator)) {
        case Row::Result::open: return told(line, fmt::format("column {}: expected a closing quote", row.size() + 1));
        case Row::Result::broken:
            return told(line, fmt::format("column {}: expected a separator behind the closing quote", row.size() + 1));
        default: return "";
    }
}

bool CsvFile::State::first_row() {
    auto const text = next_text();
    if (!text) return false;
    std::string const copy(*text);
    if (format.separator == 0) format.separator = separator_of(copy);
    first = line;
    std::string const why = split(copy);
    if (unsplit.empty()) unsplit = why;
    return true;
}

bool CsvFile::State::next_row() {
    if (below_line) {
        line = *std::exchange(below_line, std::nullopt);
        split_row(below);
        return true;
    }
    auto const text = next_text();
    if (text) split_row(*text);
    return text.has_value();
}

/// A first row of text and numbers over a row of text and numbers in the same columns has no names where columns are
/// requested by number.
void CsvFile::State::use_numbers_as_names(std::vector<std::string> const& requested) {
    std::vector<std::string> numbers;
    for (std::size_t i = 0; i < names.size(); ++i) numbers.push_back(std::to_string(i + 1));
    auto const number_of = [&](std::string const& name) { return std::ranges::find(numbers, name) - numbers.begin(); };
    std::ptrdiff_t const none = std::ssize(numbers);
    if (std::ranges::any_of(requested, [&](auto const& name) { return number_of(name) == none; }) || !look_below())
        return;
    Row under;
    if (under.split(below, format.separator) != Row::Result::whole || under.size() != names.size()) return;
    bool number = false, text = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
        Kind const here = reading(names[i]).kind, there = reading(under[i]).kind;
        if (here == Kind::text && is_value(there) && there != Kind::missing) return;  // a name over a number
        number |= is_value(here) && here != Kind::missing;
        text |= here == Kind::text && there == Kind::text;
    }
    if (!number || !text) return;
    for (auto const& name : requested)
        if (auto const found = std::ranges::find(names, name); found != names.end())
            fail(first, fmt::format("expected a row of names: {0} may be column {0}, or column {1} with {0} in this "
                                    "row, which is like the row below",
                                    in_quotes(name), found - names.begin() + 1));
    header = false;
    names = std::move(numbers);
}

/// The comment above the first row has the names: "# u y" over "1 2".
bool CsvFile::State::names_above(std::vector<std::string> const& requested) {
    std::string_view const text = above;
    for (std::size_t const mark : {std::size_t(0), comment_mark(text)})
        for (char const separator : separators)
            if (auto cells = names_in(text.substr(mark), separator, requested); cells && cells->size() == row.size()) {
                names = *std::move(cells);
                return header = true;
            }
    return false;
}

/// A row below has them, over one of equally many cells: lines of another kind stand above the table.
bool CsvFile::State::names_below(std::vector<std::string> const& requested) {
    for (auto const& name : requested)
        if (reading(name).kind != Kind::text) return false;
    std::string_view const possible = given == 0 ? separators : std::string_view(&given, 1);
    for (int k = 0; k < lines_with_names && look_below(); ++k) {
        std::string const here = std::exchange(below, {});
        line = *std::exchange(below_line, std::nullopt);
        bool const more = look_below();
        for (char const separator : possible) {
            auto cells = names_in(here, separator, requested);
            if (!cells || (more && Split(below, separator).cells != cells->size())) continue;
            names = *std::move(cells);
            format.separator = separator;
            first = line;
            blank_lines.clear();
            unsplit.clear();
            return header = true;
        }
    }
    return false;
}

double CsvFile::State::number_in(std::size_t column) {
    auto const [kind, value] = reading(row[column]);
    if (!is_value(kind))
        fail(line, column,
             complaint(kind, row[column]) + (kind == Kind::text && header && line == first + 1
                                                 ? fmt::format("; if line {} has units or types, delete it", line)
                                                 : ""));
    if (std::string const word = kind == Kind::comma || kind == Kind::comma_or_group ? torn(format.missing, value) : "";
        !word.empty())
        fail(line, column,
             fmt::format("{} is no missing value: a comma in --missing parts words; write --missing {}",
                         in_quotes(row[column]), word));
    pass(marks.number(kind, line, column, row[column]));
    return value;
}

/// One that may be it.
std::optional<std::size_t> CsvFile::State::column_of_times(std::vector<std::size_t> const& requested) const {
    auto const called = std::ranges::find_if(names, named_as_time);
    std::size_t const place = header && called != names.end() ? std::size_t(called - names.begin()) : 0;
    return std::ranges::count(requested, place) > 0 ? std::nullopt : std::optional(place);
}

CsvFile::CsvFile(std::string const& path, CsvFormat format)
    : CsvFile(bytes_of_file(path), name_of_file(path), format) {}

CsvFile::CsvFile(ByteSource bytes, std::string file, CsvFormat format, long most)
    : state_(new State{.lines = Lines(std::move(bytes), std::move(file)),
                       .format = format,
                       .given = format.separator,
                       .most = most}) {
    expects(format.separator == 0 || separators.find(format.separator) != separators.npos,
            "a separator , ; | tab or blank");
    expects(format.decimal == 0 || format.decimal == '.' || format.decimal == ',', "a decimal point or comma");
    State& s = *state_;
    if (!s.first_row())
        throw InputError(fmt::format("{}: expected rows of numbers, found {}", s.lines.name(),
                                     s.lines.number() == 0 ? "an empty file" : "only comments and blank lines"));
    for (std::size_t i = 0; i < s.row.size(); ++i) s.header |= s.reading(s.row[i]).kind == Kind::text;
    for (std::size_t i = 0; i < s.row.size(); ++i)
        s.names.push_back(s.header ? std::string(s.row[i]) : std::to_string(i + 1));
}

CsvFile::CsvFile(CsvFile&&) noexcept = default;
CsvFile& CsvFile::operator=(CsvFile&&) noexcept = default;
CsvFile::~CsvFile() = default;

std::string const& CsvFile::file() const { return state_->lines.name(); }
bool CsvFile::has_header() const { return state_->header; }
std::vector<std::string> const& CsvFile::names() const { return state_->names; }

Columns CsvFile::read(std::vector<std::string> const& requested, std::string const& time) {
    State& s = *state_;
    expects(!requested.empty(), "the name of a column at least");
    expects(!s.finished, "a file that was not read before");
    s.finished = true;
    std::vector<std::string> all = requested;
    if (!time.empty()) all.push_back(time);
    if (s.header) s.use_numbers_as_names(all);
    bool const there = s.unsplit.empty() && std::ranges::all_of(all, [&](auto const& name) {
                           return std::ranges::find(s.names, name) != s.names.end();
                       });
    bool const above = !there && s.unsplit.empty() && s.names_above(all);
    if (!there && !above && !s.names_below(all) && !s.unsplit.empty()) throw InputError(s.unsplit);
    std::vector<std::size_t> columns;
    std::string const names_at = fmt::format("{}:{}", s.lines.name(), above ? s.above_line : s.first);
    for (auto const& name : requested)
        columns.push_back(column_called(name, s.names, s.header, s.lines.name(), names_at));
    std::optional<std::size_t> times = time.empty() ? s.column_of_times(columns) : std::nullopt;
    if (!time.empty()) times = column_called(time, s.names, s.header, s.lines.name(), names_at);
    Columns data{.file = s.lines.name(), .header = s.header, .names = requested};
    data.values.resize(requested.size());
    TimeCells clock;
    auto const without_times = [&](bool told) {
        if (told && named_as_time(s.names[*times])) data.time = s.names[*times], data.unread_time = clock.unread;
        times.reset(), data.times.clear();
    };
    long const most_rows = s.most / long(requested.size() + 1);  // one more for the line on which each row begins
    for (bool more = !s.header || above || s.next_row(); more; more = s.next_row()) {
        if (s.row.size() != s.names.size()) {
            bool const halves = s.format.separator == ',' && s.row.size() == 2 * s.names.size();
            s.fail(s.line,
                   fmt::format("expected {} columns as in line {}, found {}{}", s.names.size(), s.first, s.row.size(),
                               halves ? " (decimal commas? they need another separator, or quotes)" : ""));
        }
        if (data.lines.empty() && s.header && is_rule(s.row)) continue;
        for (long const blank : std::exchange(s.blank_lines, {})) {
            if (data.lines.empty()) continue;
            for (auto& column : data.values) column.push_back(std::numeric_limits<double>::quiet_NaN());
            if (times) data.times.push_back(std::numeric_limits<double>::quiet_NaN());
            data.lines.push_back(blank);
        }
        if (data.rows() >= most_rows) s.fail(s.line, fmt::format("expected at most {} rows", most_rows));
        for (std::size_t i = 0; i < columns.size(); ++i) data.values[i].push_back(s.number_in(columns[i]));
        if (times) {
            std::string_view const cell = s.row[*times];
            Reading const reading = s.reading(cell);
            auto const at = clock.read(reading, cell, s.line, *times);
            if (at) data.times.push_back(*at);
            if (at && !time.empty()) s.pass(s.marks.number(reading.kind, s.line, *times, cell));
            if (!at && !time.empty()) s.fail(s.line, *times, clock.expected);
            if (!at) without_times(cell[0] >= '0' && cell[0] <= '9');
        }
        s.marks.row(s.row, s.line);
        data.lines.push_back(s.line);
    }
    if (data.lines.empty())
        throw InputError(fmt::format("{}: expected rows below the header, found none (the columns are {})", data.file,
                                     listed(s.names)));
    s.pass(s.marks.end(s.format.separator));
    if (times && time.empty() && clock.in_doubt(s.marks, s.format.separator)) without_times(true);
    if (times) data.time = s.names[*times];
    if (clock.numbers()) stamps_to_seconds(data);
    return data;
}

Columns read_columns(std::string const& path, std::vector<std::string> const& requested, CsvFormat format) {
    return CsvFile(path, format).read(requested);
}

std::size_t column_called(std::string const& requested, std::vector<std::string> const& names, bool header,
                          std::string const& file, std::string const& at) {
    if (requested.empty()) throw InputError(file + ": expected the name of a column, found \"\"");
    auto const found = std::ranges::find(names, requested);
    if (found == names.end())
        throw InputError(fmt::format("{}: no column {}{}; {} {}", file, in_quotes(requested),
                                     header ? did_you_mean(requested, {names.begin(), names.end()}) : "",
                                     header ? "the columns are" : "without a header they are", listed(names)));
    auto const again = std::find(found + 1, names.end(), requested);
    if (again != names.end())
        throw InputError(fmt::format("{}: expected different names, found {} over columns {} and {}", at,
                                     in_quotes(requested), found - names.begin() + 1, again - names.begin() + 1));
    return std::size_t(found - names.begin());
}

std::vector<double> const& Columns::operator[](std::string const& name) const {
    auto const found = std::ranges::find(names, name);
    expects(found != names.end(), "a column that was read");
    return values[std::size_t(found - names.begin())];
}

}  // namespace rlslab
