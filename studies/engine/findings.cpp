// The numbers that claims measure, and the two tests of them.
#include "studies/engine/findings.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab {
namespace {

double fitted(std::vector<double> const& x, std::vector<double> const& y) {
    double const n = double(x.size());
    if (x.size() < 2) return std::nan("");
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
    for (size_t i = 0; i < x.size(); ++i) xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
    return xy / xx;
}

Number over(std::string column, double (*of)(std::vector<double>)) {
    return [=](Table const& table) { return of(table.numbers(column)); };
}

/// Fitted to the rows for which both scales give a finite number.
Number fit(std::string x, double (*of_x)(double), std::string y, double (*of_y)(double)) {
    return [=](Table const& table) {
        std::vector<double> const all_x = table.numbers(x), all_y = table.numbers(y);
        std::vector<double> kept_x, kept_y;
        for (size_t i = 0; i < all_x.size(); ++i) {
            double const at = of_x(all_x[i]), value = of_y(all_y[i]);
            if (!std::isfinite(at) || !std::isfinite(value)) continue;
            kept_x.push_back(at);
            kept_y.push_back(value);
        }
        return fitted(kept_x, kept_y);
    };
}
bool has_nan(std::vector<double> const& v) {
    return std::ranges::any_of(v, [](double x) { return x != x; });
}
double as_it_is(double x) { return x; }
double log_10(double x) { return correctly::log10(x); }
double log_e(double x) { return correctly::log(x); }

}  // namespace

Number slope(std::string x, std::string y) { return fit(std::move(x), &log_10, std::move(y), &log_10); }
Number rate(std::string x, std::string y) { return fit(std::move(x), &as_it_is, std::move(y), &log_e); }
Number linear_slope(std::string x, std::string y) { return fit(std::move(x), &as_it_is, std::move(y), &as_it_is); }

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    // NaN is worse than any number.
    std::ranges::sort(values, [](double a, double b) { return b != b ? a == a : a < b; });
    size_t const middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : values[middle - 1] / 2 + values[middle] / 2;
}

Number median(std::string column) { return over(column, &median); }
Number least(std::string column) {
    return over(column, [](std::vector<double> v) { return v.empty() || has_nan(v) ? std::nan("") : *std::ranges::min_element(v); });
}
Number greatest(std::string column) {
    return over(column, [](std::vector<double> v) { return v.empty() || has_nan(v) ? std::nan("") : *std::ranges::max_element(v); });
}
Number root_mean_square(std::string column) {
    return over(column, [](std::vector<double> v) {
        double sum = 0;
        for (double const x : v) sum += x * x / double(v.size());
        return std::sqrt(sum);
    });
}

Finding within(Table const& table, std::vector<std::string> const& by, Number const& number, double from, double to) {
    auto const groups = table.groups(by);
    if (groups.empty()) return {false, "nothing was measured"};
    std::pair<double, std::string> smallest{std::nan(""), ""}, largest = smallest;
    bool holds = true;
    for (auto const& [name, rows] : groups) {
        double const x = number(rows);
        if (x != x) return {false, fmt::format("not a number{}", name.empty() ? "" : " (" + name + ")")};
        holds = holds && from <= x && x <= to;
        if (!(x >= smallest.first)) smallest = {x, name};
        if (!(x <= largest.first)) largest = {x, name};
    }
    auto const said = [](std::pair<double, std::string> const& x) {
        return fmt::format("{:.4g}{}", x.first, x.second.empty() ? "" : " (" + x.second + ")");
    };
    return {holds, groups.size() == 1 ? said(smallest) : said(smallest) + " ... " + said(largest)};
}

Finding everywhere(Table const& table, std::string const& column, Cell const& value) {
    size_t const at = table.index(column), rows = table.rows().size();
    size_t const good = size_t(std::ranges::count_if(table.rows(), [&](auto const& row) { return row[at] == value; }));
    return {rows > 0 && good == rows, fmt::format("{} of {} are \"{}\"", good, rows, as_text(value))};
}

}  // namespace rlslab
