// What claims measure, and the verdicts on it.
#include "studies/engine/findings.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

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

Number of_column(std::string column, double (*of)(std::vector<double>), Estimate estimate) {
    return {[=](Table const& table) { return of(table.numbers(column)); }, estimate};
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

Number mean(std::string column) {
    return of_column(
        std::move(column),
        [](std::vector<double> v) {
            double sum = 0;
            for (double const x : v) sum += x / double(v.size());
            return v.empty() ? std::nan("") : sum;
        },
        Estimate::mean);
}
Number median(std::string column) { return of_column(std::move(column), &median, Estimate::middle); }
Number least(std::string column) {
    return of_column(
        std::move(column), [](std::vector<double> v) { return v.empty() || has_nan(v) ? std::nan("") : *std::ranges::min_element(v); },
        Estimate::every);
}
Number greatest(std::string column) {
    return of_column(
        std::move(column), [](std::vector<double> v) { return v.empty() || has_nan(v) ? std::nan("") : *std::ranges::max_element(v); },
        Estimate::every);
}
Number ratio_of_errors(std::string variant, std::string other) {
    auto const mean_log = [](Table const& table, std::string const& of) {
        std::vector<double> const errors = table.where("variant", of).numbers("error");
        double sum = 0;
        for (double const e : errors) sum += correctly::log10(e) / double(errors.size());
        return errors.empty() ? std::nan("") : sum;
    };
    return {[=](Table const& table) { return correctly::pow(10, mean_log(table, variant) - mean_log(table, other)); }, Estimate::geometric};
}
Number root_mean_square(std::string column) {
    return of_column(
        std::move(column),
        [](std::vector<double> v) {
            double sum = 0;
            for (double const x : v) sum += x * x / double(v.size());
            return std::sqrt(sum);
        },
        Estimate::quadratic);
}

Number Number::as(Estimate estimate) const {
    Number out = *this;
    out.estimate_ = estimate;
    return out;
}
Number Number::over(std::string replicate) const {
    Number out = *this;
    out.replicate_ = std::move(replicate);
    return out;
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Interval hull(Interval const& a, Interval const& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }

/// On the scale on which the mean is taken, and back.
Interval through(std::vector<double> x, double risk, double (*to)(double), double (*back)(double)) {
    for (double& v : x) v = to(v);
    Interval const of_mean =
        x.size() < many_seeds ? student_interval(x, risk) : hull(student_interval(x, risk), bootstrap_interval(x, risk));
    return {back(of_mean.low), back(of_mean.high)};
}

double power_of_10(double x) { return std::isfinite(x) ? correctly::pow(10, x) : x < 0 ? 0 : x; }
double squared(double x) { return x * x; }
double root(double x) { return x > 0 ? std::sqrt(x) : 0; }

Interval estimated(std::vector<double> const& x, Estimate estimate, double risk) {
    if (x.size() < fewest_seeds) return {-infinity, infinity};
    bool const positive = std::ranges::all_of(x, [](double v) { return v > 0; });
    switch (estimate) {
        case Estimate::middle:
            if (x.size() >= many_seeds) return median_interval(x, risk);
            if (positive) return through(x, risk, &log_10, &power_of_10);
            return through(x, risk, &as_it_is, &as_it_is);
        case Estimate::geometric: return positive ? through(x, risk, &log_10, &power_of_10) : Interval{-infinity, infinity};
        case Estimate::quadratic: return through(x, risk, &squared, &root);
        default: return through(x, risk, &as_it_is, &as_it_is);
    }
}

/// The seeds' numbers in one, on the scale on which their interval is; NaN only where each of them is.
double in_one(std::vector<double> x, Estimate estimate) {
    std::erase_if(x, [](double v) { return v != v; });
    if (x.empty()) return std::nan("");
    if (estimate == Estimate::middle || estimate == Estimate::every) return median(x);
    bool const logarithmic = estimate == Estimate::geometric, square = estimate == Estimate::quadratic;
    double sum = 0;
    for (double const v : x) sum += (logarithmic ? log_10(v) : square ? v * v : v) / double(x.size());
    return logarithmic ? power_of_10(sum) : square ? root(sum) : sum;
}

/// What a group gives: its number, the interval printed, and the verdict.
struct Part {
    double point;
    Interval shown;
    Verdict verdict;
    size_t seeds;  ///< 0: none matters
};

/// `number` is asked of each seed's rows; of all rows only where no seed matters.
Part part(Table const& rows, Number const& number, Interval const& band, size_t groups) {
    if (number.estimate() == Estimate::fixed || !rows.has(number.replicate())) {
        double const point = number(rows);
        Interval const itself{point, point};
        return {point, itself, itself.inside(band) ? Verdict::holds : Verdict::fails, 0};
    }
    std::vector<double> x;
    for (auto const& [seed, own] : rows.groups({number.replicate()})) x.push_back(number(own));
    double const point = in_one(x, number.estimate());
    if (point != point) return {point, {point, point}, Verdict::fails, x.size()};
    if (number.estimate() == Estimate::every) {
        bool const all = std::ranges::all_of(x, [&](double v) { return Interval{v, v}.inside(band); });
        auto const [least, greatest] = std::ranges::minmax(x);
        return {point, {least, greatest}, !all ? Verdict::fails : x.size() < fewest_seeds ? Verdict::undecided : Verdict::holds, x.size()};
    }
    Interval const shown = estimated(x, number.estimate(), claim_risk);
    if (shown.inside(band)) return {point, shown, Verdict::holds, x.size()};
    bool const outside = estimated(x, number.estimate(), claim_risk / double(groups)).outside(band);
    return {point, shown, outside ? Verdict::fails : Verdict::undecided, x.size()};
}

std::string text_of(Part const& part, std::string const& name, Estimate estimate) {
    std::string said = fmt::format("{:.4g}", part.point);
    if (estimate == Estimate::every && part.shown.low < part.shown.high)
        said = fmt::format("{:.4g} to {:.4g}", part.shown.low, part.shown.high);
    else if (estimate != Estimate::every && part.seeds >= fewest_seeds)
        said += fmt::format(" [{:.4g}, {:.4g}]", part.shown.low, part.shown.high);
    return name.empty() ? said : said + " (" + name + ")";
}
std::string seeds_text(size_t fewest, size_t most) {
    if (most == 0) return "";
    return fmt::format(", {} {}", fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most),
                       most == 1 ? "seed" : "seeds");
}

}  // namespace

Finding within(Table const& table, std::vector<std::string> const& by, Number const& number, double from, double to) {
    auto const groups = table.groups(by);
    if (groups.empty()) return {Verdict::fails, "nothing was measured"};
    std::vector<std::pair<Part, std::string>> parts;
    for (auto const& [name, rows] : groups) parts.emplace_back(part(rows, number, {from, to}, groups.size()), name);
    for (auto const& [part, name] : parts)
        if (part.point != part.point) return {Verdict::fails, fmt::format("not a number{}", name.empty() ? "" : " (" + name + ")")};
    auto const point = [](auto const& p) { return p.first.point; };
    auto const [smallest, largest] = std::ranges::minmax_element(parts, {}, point);
    auto const [fewest, most] = std::ranges::minmax(parts, {}, [](auto const& p) { return p.first.seeds; });
    auto const worst = std::ranges::min_element(parts, {}, [](auto const& p) { return p.first.verdict; });
    auto const text = [&](auto const& p) { return text_of(p.first, p.second, number.estimate()); };
    std::string said = text(*smallest);
    if (groups.size() > 1) said += " ... " + text(*largest);
    Verdict const verdict = worst->first.verdict;
    // What decided, where it is neither end.
    if (verdict != Verdict::holds && worst != smallest && worst != largest)
        said += fmt::format("; {}: {}", verdict == Verdict::fails ? "fails" : "undecided", text(*worst));
    bool const random = number.estimate() != Estimate::every && most.first.seeds >= fewest_seeds;
    return {verdict, said + seeds_text(fewest.first.seeds, most.first.seeds), random ? claim_risk : 0};
}

Finding everywhere(Table const& table, std::string const& column, Cell const& value, std::string const& replicate) {
    size_t const at = table.index(column), rows = table.rows().size();
    size_t const good = size_t(std::ranges::count_if(table.rows(), [&](auto const& row) { return row[at] == value; }));
    size_t const seeds = table.has(replicate) ? table.distinct(replicate).size() : 0;
    bool const enough = !table.has(replicate) || seeds >= fewest_seeds;
    return {rows == 0 || good < rows ? Verdict::fails
            : enough                 ? Verdict::holds
                                     : Verdict::undecided,
            fmt::format("{} of {} are \"{}\"{}", good, rows, as_text(value), seeds_text(seeds, seeds))};
}

Finding proportion(size_t hits, size_t runs, double from, double to) {
    Interval const shown = proportion_interval(hits, runs, claim_risk), band{from, to};
    return {runs == 0 || shown.outside(band) ? Verdict::fails
            : shown.inside(band)             ? Verdict::holds
                                             : Verdict::undecided,
            fmt::format("{} of {}: [{:.3g}, {:.3g}]", hits, runs, shown.low, shown.high), claim_risk};
}

Finding operator&&(Finding const& a, Finding const& b) {
    return {std::min(a.verdict, b.verdict), a.measured + "; " + b.measured, a.risk + b.risk};
}
Finding together(std::vector<Finding> const& parts) {
    if (parts.empty()) return {Verdict::fails, "nothing was measured"};
    Finding out = parts[0];
    for (size_t i = 1; i < parts.size(); ++i) out = out && parts[i];
    return out;
}
Finding labelled(std::string const& label, Finding of) {
    of.measured = label + ": " + of.measured;
    return of;
}

}  // namespace rlslab
