// Reads the table cell by cell; no cell can make it fail in another way than by a message.
#include "docs/site/live/table.hpp"

#include <cmath>
#include <cstdlib>

namespace rlslab::live {
namespace {

using Cells = std::vector<std::string>;

/// Takes one row's text off the front: up to a line end outside quotes.
std::string_view next_line(std::string_view& text, long& line) {
    bool quoted = false;
    size_t at = 0;
    long ends = 0;
    for (; at < text.size(); ++at) {
        if (text[at] == '"') quoted = !quoted;
        bool const end = text[at] == '\n' || (text[at] == '\r' && (at + 1 == text.size() || text[at + 1] != '\n'));
        if (end && !quoted) break;
        ends += end;
    }
    std::string_view out = text.substr(0, at);
    text.remove_prefix(std::min(text.size(), at + 1));
    line += ends + 1;
    while (out.ends_with('\r')) out.remove_suffix(1);
    return out;
}
std::string trimmed(std::string cell) {
    auto const first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    return first == cell.npos ? "" : cell.substr(first, last - first + 1);
}
Cells cells_of(std::string_view row, char separator) {
    Cells out(1);
    bool quoted = false;
    if (separator == ' ') row.remove_prefix(std::min(row.size(), row.find_first_not_of(' ')));
    for (size_t i = 0; i < row.size(); ++i) {
        char const c = row[i];
        if (c == '"' && quoted && i + 1 < row.size() && row[i + 1] == '"') out.back() += '"', ++i;
        else if (c == '"') quoted = !quoted;
        else if (c == separator && !quoted) {
            while (separator == ' ' && i + 1 < row.size() && row[i + 1] == ' ') ++i;
            if (separator != ' ' || i + 1 < row.size()) out.emplace_back();
        } else out.back() += c;
    }
    for (std::string& cell : out) cell = trimmed(cell);
    return out;
}
char separator_of(std::string_view row) {
    for (char const separator : {'\t', ';', ','})
        if (cells_of(row, separator).size() > 1) return separator;
    return ' ';
}
bool is_missing(std::string const& cell) {
    std::string lower;
    for (char const c : cell) lower += 'A' <= c && c <= 'Z' ? char(c - 'A' + 'a') : c;
    for (char const* word : {"", "na", "n/a", "#n/a", "nan", "null", ".", "?"})
        if (lower == word) return true;
    return false;
}
/// Whether the cell is a number, which is left in x.
bool number(std::string cell, char separator, double& x) {
    if (size_t const comma = cell.find(','); separator != ',' && comma != cell.npos) cell[comma] = '.';
    if (cell.empty() || cell.find_first_not_of("0123456789+-.eE") != cell.npos) return false;
    char* end = nullptr;
    x = std::strtod(cell.c_str(), &end);
    return end == cell.c_str() + cell.size() && std::abs(x) <= 0x1p500;
}
std::string in_words(long n, char const* what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

/// The power of two next to the root mean square; 1 for zeros.
double scale_of(double squares, long rows) {
    double const rms = std::sqrt(squares / double(rows));
    if (!(rms > 0) || !std::isfinite(rms)) return 1;
    int exponent;
    double const fraction = std::frexp(rms, &exponent);
    return std::ldexp(1.0, fraction < 0.70710678118654752 ? exponent - 1 : exponent);
}

}  // namespace

Table read_table(std::string_view text) {
    Table table;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    char separator = 0;
    for (long line = 1; !text.empty() && table.rows() < most_rows;) {
        long const at = line;
        std::string_view const row = next_line(text, line);
        if (row.find_first_not_of(" \t") == row.npos || row.starts_with('#')) continue;
        bool const first = separator == 0;
        if (first) separator = separator_of(row);
        Cells const cells = cells_of(row, separator);
        double x = 0;
        if (first) {
            bool header = false;
            for (std::string const& cell : cells) header = header || !(is_missing(cell) || number(cell, separator, x));
            for (size_t j = 0; j < cells.size(); ++j)
                table.columns.push_back({header && !cells[j].empty() ? cells[j] : std::to_string(j + 1), {}, 0, 0});
            if (header) continue;
        }
        if (cells.size() != table.columns.size()) {
            table.error = "line " + std::to_string(at) + ": expected " + in_words(long(table.columns.size()), "cell") +
                          ", found " + std::to_string(cells.size());
            return table;
        }
        for (size_t j = 0; j < cells.size(); ++j) {
            Table::Column& column = table.columns[j];
            bool const missing = is_missing(cells[j]), good = !missing && number(cells[j], separator, x);
            column.missing += missing;
            if (!missing && !good && column.not_a_number == 0) column.not_a_number = at;
            column.numbers.push_back(good ? x : std::numeric_limits<double>::quiet_NaN());
        }
    }
    if (table.columns.empty()) table.error = "expected a table of numbers, found no row";
    else if (table.rows() == 0) table.error = "expected rows of numbers below the names, found none";
    return table;
}

Rows rows_of(Table const& table, Model const& model) {
    Rows out;
    struct Term {
        size_t column;
        int lag;
    };
    std::vector<Term> terms;
    auto const add = [&](size_t column, int lag, bool lagged) {
        terms.push_back({column, lag});
        std::string const& name = table.columns[column].name;
        out.names.push_back(!lagged ? name : lag == 0 ? name + "[k]" : name + "[k-" + std::to_string(lag) + "]");
    };
    auto const usable = [&](size_t column) {
        if (column >= table.columns.size()) out.error = "expected a column of the table";
        else if (table.columns[column].not_a_number > 0)
            out.error = "line " + std::to_string(table.columns[column].not_a_number) + ", column " +
                        table.columns[column].name + ": expected a number";
        return out.error.empty();
    };
    if (!usable(model.output)) return out;
    for (int lag = 1; lag <= model.past; ++lag) add(model.output, lag, true);
    for (size_t const input : model.inputs) {
        if (!usable(input)) return out;
        for (int lag = 0; lag <= model.delays; ++lag) add(input, lag, model.delays > 0);
    }
    if (model.constant) out.names.push_back("1");
    int const d = out.d(), longest = std::max(model.past, model.delays);
    if (d < 1 || d > most_parameters) {
        out.error = "expected 1 to " + std::to_string(most_parameters) + " parameters, found " + std::to_string(d);
        return out;
    }
    for (long k = longest; k < table.rows(); ++k) {
        std::vector<double> row;
        for (Term const& t : terms) row.push_back(table.columns[t.column].numbers[size_t(k - t.lag)]);
        if (model.constant) row.push_back(1);
        double const y = table.columns[model.output].numbers[size_t(k)];
        bool whole = y == y;
        for (double const x : row) whole = whole && x == x;
        if (!whole) {
            ++out.skipped;
            continue;
        }
        out.psi.insert(out.psi.end(), row.begin(), row.end());
        out.y.push_back(y);
    }
    if (out.rows() < d) {
        out.error =
            "expected at least " + in_words(d, "row") + " without a missing value, found " + std::to_string(out.rows());
        return out;
    }
    auto const scaled = [&](double* first, long stride) {
        double squares = 0;
        for (long k = 0; k < out.rows(); ++k) squares += first[k * stride] * first[k * stride];
        double const scale = scale_of(squares, out.rows());
        for (long k = 0; k < out.rows(); ++k) first[k * stride] /= scale;
        return scale;
    };
    for (int i = 0; i < d; ++i) out.scales.push_back(scaled(out.psi.data() + i, d));
    out.y_scale = scaled(out.y.data(), 1);
    return out;
}

}  // namespace rlslab::live
