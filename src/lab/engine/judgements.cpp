// What claims measure, and the verdicts on it.
#include <rlslab/studies/judgements.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace rlslab::studies {
namespace {

double fitted(std::vector<double> const& x, std::vector<double> const& y) {
    double const n = double(x.size());
    if (x.size() < 2) return std::nan("");
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
    for (size_t i = 0; i < x.size(); ++i)
        xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
    return xy / xx;
}

Statistic of_column(std::string column, double (*of)(std::vector<double>), Estimate estimate) {
    return {[=](Table const& table) { return of(table.numbers(column)); }, estimate};
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Interval anywhere{-infinity, infinity};

/// The scaled x and y of the rows with finite scaled x. NaN counts as infinity.
struct Line {
    std::vector<double> x, y;

    Line(Table const& table, std::string const& of_x, double (*scale_x)(double), std::string const& of_y,
         double (*scale_y)(double)) {
        std::vector<double> const all_x = table.numbers(of_x), all_y = table.numbers(of_y);
        for (size_t i = 0; i < all_x.size(); ++i) {
            if (!std::isfinite(scale_x(all_x[i]))) continue;
            x.push_back(scale_x(all_x[i]));
            double const value = scale_y(all_y[i]);
            y.push_back(value != value ? infinity : value);
        }
    }
    double slope() const {
        std::vector<double> kept_x, kept_y;
        for (size_t i = 0; i < x.size(); ++i)
            if (std::isfinite(y[i])) kept_x.push_back(x[i]), kept_y.push_back(y[i]);
        return fitted(kept_x, kept_y);
    }
    /// A row at infinity lies at `greatest` or above, one at minus infinity at `least` or below. The slope is linear in
    /// each.
    Interval bounds() const {
        double least = infinity, greatest = -infinity, mean = 0;
        for (double const v : y)
            if (std::isfinite(v)) least = std::min(least, v), greatest = std::max(greatest, v);
        if (least > greatest) return anywhere;
        std::vector<double> closest = y;
        for (double& v : closest) v = std::clamp(v, least, greatest);
        for (double const v : x) mean += v / double(x.size());
        Interval out{fitted(x, closest), fitted(x, closest)};
        if (out.low != out.low) return anywhere;
        for (size_t i = 0; i < x.size(); ++i) {
            if (std::isfinite(y[i]) || x[i] == mean) continue;
            ((x[i] > mean) == (y[i] > 0) ? out.high = infinity : out.low = -infinity);
        }
        return out;
    }
};
Statistic fit(std::string x, double (*of_x)(double), std::string y, double (*of_y)(double)) {
    return {[=](Table const& table) { return Line(table, x, of_x, y, of_y).slope(); },
            [=](Table const& table) { return Line(table, x, of_x, y, of_y).bounds(); }};
}
bool is_empty_or_has_nan(std::vector<double> const& v) {
    return v.empty() || std::ranges::any_of(v, [](double x) { return x != x; });
}
double as_it_is(double x) { return x; }
double log_10(double x) { return correctly::log10(x); }
double log_e(double x) { return correctly::log(x); }
double mean_of(std::vector<double> const& v, double (*of)(double) = &as_it_is) {
    double sum = 0;
    for (double const x : v) sum += of(x) / double(v.size());
    return v.empty() ? std::nan("") : sum;
}

}  // namespace

Statistic slope(std::string x, std::string y) { return fit(std::move(x), &log_10, std::move(y), &log_10); }
Statistic rate(std::string x, std::string y) { return fit(std::move(x), &as_it_is, std::move(y), &log_e); }
Statistic linear_slope(std::string x, std::string y) { return fit(std::move(x), &as_it_is, std::move(y), &as_it_is); }

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    // NaN is worse than any number.
    std::ranges::sort(values, [](double a, double b) { return b != b ? a == a : a < b; });
    size_t const middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : values[middle - 1] / 2 + values[middle] / 2;
}

Statistic number(std::string column) {
    return [=](Table const& table) { return table.number(column); };
}
Statistic sum(std::string column) {
    return [=](Table const& table) {
        double out = 0;
        for (double const x : table.numbers(column)) out += x;
        return out;
    };
}
Statistic mean(std::string column) {
    return of_column(
        std::move(column), [](std::vector<double> v) { return mean_of(v); }, Estimate::middle);
}
Statistic median(std::string column) { return of_column(std::move(column), &median, Estimate::middle); }
Statistic least(std::string column) {
    return of_column(
        std::move(column),
        [](std::vector<double> v) { return is_empty_or_has_nan(v) ? std::nan("") : std::ranges::min(v); },
        Estimate::most);
}
Statistic greatest(std::string column) {
    return of_column(
        std::move(column),
        [](std::vector<double> v) { return is_empty_or_has_nan(v) ? std::nan("") : std::ranges::max(v); },
        Estimate::most);
}
Statistic ratio_of_errors(std::string variant, std::string other) {
    auto const mean_log = [](Table const& table, std::string const& of) {
        return mean_of(table.where("variant", of).numbers("error"), &log_10);
    };
    return [=](Table const& table) { return correctly::pow(10, mean_log(table, variant) - mean_log(table, other)); };
}
Statistic root_mean_square(std::string column) {
    auto const of = [](std::vector<double> v) {
        return v.empty() ? 0 : std::sqrt(mean_of(v, [](double x) { return x * x; }));
    };
    return of_column(std::move(column), of, Estimate::quadratic);
}

Statistic share_of_groups(std::vector<std::string> by, std::function<bool(Table const& group)> holds) {
    return {[=](Table const& table) {
                double yes = 0, all = 0;
                for (auto const& [name, group] : table.groups(by)) yes += holds(group), ++all;
                return yes / all;
            },
            Estimate::share};
}

Interval Statistic::bounds(Table const& table) const {
    if (bounds_) return bounds_(table);
    double const itself = of_(table);
    return itself != itself ? anywhere : Interval{itself, itself};
}
Statistic Statistic::as(Estimate estimate) const {
    Statistic out = *this;
    out.estimate_ = estimate;
    return out;
}
Statistic Statistic::over(std::string replicate) const {
    Statistic out = *this;
    out.replicate_ = std::move(replicate);
    return out;
}
Statistic Statistic::on(Selection rows) const {
    return Statistic([of = *this, rows](Table const& table) { return of(rows(table)); }).over(replicate_);
}
Statistic operator-(Statistic a, Statistic b) {
    return Statistic([=](Table const& table) { return a(table) - b(table); }).over(a.replicate());
}
Statistic operator/(Statistic a, Statistic b) {
    return Statistic([=](Table const& table) { return a(table) / b(table); }).over(a.replicate());
}

namespace {

double power_of_10(double x) { return std::isfinite(x) ? correctly::pow(10, x) : x < 0 ? 0 : x; }
double squared(double x) { return x * x; }
double root(double x) { return x > 0 ? std::sqrt(x) : 0; }

std::vector<double> on(std::vector<double> x, double (*scale)(double)) {
    for (double& v : x) v = scale(v);
    return x;
}
Interval back(Interval const& of, double (*scale)(double)) { return {scale(of.low), scale(of.high)}; }

/// Seeds of which no number is known, or only bounds, are in the median's interval alone.
Interval estimated(std::vector<Interval> const& seeds, Estimate estimate, double risk) {
    if (seeds.size() < fewest_seeds) return anywhere;
    std::vector<double> low, high;
    for (Interval const& seed : seeds) low.push_back(seed.low), high.push_back(seed.high);
    if (estimate == Estimate::middle) return {median_interval(low, risk).low, median_interval(high, risk).high};
    if (low != high) return anywhere;
    switch (estimate) {
        case Estimate::geometric: return back(student_interval(on(low, &log_10), risk), &power_of_10);
        case Estimate::quadratic: return back(square_interval(on(low, &squared), risk), &root);
        case Estimate::share: {
            double hits = 0;
            for (double const v : low) {
                if (v < 0 || v > 1) throw std::logic_error(fmt::format("a share of {}", v));
                hits += v;
            }
            return proportion_interval(hits, double(low.size()), risk);
        }
        default: return student_interval(low, risk);
    }
}

bool of_each_seed(Estimate estimate) {
    return estimate == Estimate::most || estimate == Estimate::every || estimate == Estimate::proven;
}

/// The seeds' numbers in one, on the scale on which their interval is; NaN only where each of them is.
double in_one(std::vector<double> x, Estimate estimate) {
    std::erase_if(x, [](double v) { return v != v; });
    if (x.empty()) return std::nan("");
    if (estimate == Estimate::middle || of_each_seed(estimate)) return median(x);
    bool const logarithmic = estimate == Estimate::geometric, square = estimate == Estimate::quadratic;
    double sum = 0;
    for (double const v : x) sum += (logarithmic ? log_10(v) : square ? v * v : v) / double(x.size());
    return logarithmic ? power_of_10(sum) : square ? root(sum) : sum;
}

/// The statistic of a group, the interval that is printed, and the verdict.
struct Part {
    double point;
    Interval shown;
    Verdict verdict;
    size_t seeds;        ///< 0: none matters
    size_t outside = 0;  ///< how many seeds lie outside, for claims about each
    size_t broken = 0;   ///< how many have rows that broke down
};

/// P(Bin(n, 1/2) <= k): if half of all seeds lie outside, the probability that at most k of n do.
double at_most_of_half(size_t k, size_t n) {
    double term = std::ldexp(1.0, -int(std::min<size_t>(n, 1000))), sum = 0;
    for (size_t i = 0; i <= k; ++i) {
        sum += term;
        term = term * double(n - i) / double(i + 1);
    }
    return sum;
}

/// The verdict on a claim about each seed, if `outside` of them fail it.
Verdict of_seeds(size_t outside, size_t seeds, Estimate estimate, size_t groups) {
    if (estimate == Estimate::proven) return outside == 0 ? Verdict::holds : Verdict::fails;
    if (estimate == Estimate::every) return outside == 0 ? Verdict::undecided : Verdict::fails;
    return at_most_of_half(outside, seeds) <= claim_risk                            ? Verdict::holds
           : at_most_of_half(seeds - outside, seeds) <= claim_risk / double(groups) ? Verdict::fails
                                                                                    : Verdict::undecided;
}

/// Computes `number` from the rows of each seed, or from all rows if it depends on no seed.
Part part(Table const& rows, Statistic const& number, Interval const& band, size_t groups) {
    if (number.estimate() == Estimate::fixed || !rows.has(number.replicate())) {
        double const point = number(rows);
        Interval const itself{point, point};
        return {point, itself, itself.inside(band) ? Verdict::holds : Verdict::fails, 0};
    }
    std::vector<double> x;
    std::vector<Interval> seeds;
    Part out{};
    for (auto const& [seed, own] : rows.groups({number.replicate()})) {
        x.push_back(number(own));
        seeds.push_back(number.bounds(own));
        out.outside += x.back() != x.back() || !Interval{x.back(), x.back()}.inside(band);
        out.broken += seeds.back().low < seeds.back().high;
    }
    out.seeds = x.size();
    out.point = in_one(x, number.estimate());
    if (out.point != out.point) return {out.point, {out.point, out.point}, Verdict::fails, x.size()};
    if (of_each_seed(number.estimate())) {
        auto const [least, greatest] = std::ranges::minmax(x);
        out.shown = {least, greatest};
        out.verdict = of_seeds(out.outside, x.size(), number.estimate(), groups);
        return out;
    }
    out.shown = estimated(seeds, number.estimate(), claim_risk);
    bool const outside = estimated(seeds, number.estimate(), claim_risk / double(groups)).outside(band);
    out.verdict = out.shown.inside(band) ? Verdict::holds : outside ? Verdict::fails : Verdict::undecided;
    return out;
}

std::string text_of(Part const& part, std::string const& name, Estimate estimate) {
    std::string said = fmt::format("{:.4g}", part.point);
    if (of_each_seed(estimate) && part.shown.low < part.shown.high)
        said = fmt::format("{:.4g} to {:.4g}", part.shown.low, part.shown.high);
    else if (!of_each_seed(estimate) && part.seeds >= fewest_seeds)
        said += fmt::format(" [{:.4g}, {:.4g}]", part.shown.low, part.shown.high);
    return name.empty() ? said : said + " (" + name + ")";
}
/// "2 of 20 seeds outside: fewer than 41 % of all", of the group that has most.
std::string outside_text(size_t outside, size_t seeds) {
    if (outside == seeds) return fmt::format(", all {} seeds outside", seeds);
    return fmt::format(", {} of {} seeds outside: fewer than {:.2g} % of all", outside, seeds,
                       100 * proportion_interval(double(outside), double(seeds), 2 * claim_risk).high);
}
std::string seeds_text(size_t fewest, size_t most) {
    if (most == 0) return "";
    return fmt::format(", {} {}", fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most),
                       most == 1 ? "seed" : "seeds");
}

template <class Holds>
Selection restricted(Selection const& rows, std::string const& column, Holds const& holds) {
    return [=](Table const& table) { return rows(table).where(column, holds); };
}

}  // namespace

Judgement within(Table const& table, std::vector<std::string> const& by, Statistic const& number, double from,
                 double to) {
    auto const groups = table.groups(by);
    if (groups.empty()) return {Verdict::fails, "nothing was measured"};
    std::vector<std::pair<Part, std::string>> parts;
    for (auto const& [name, rows] : groups) parts.emplace_back(part(rows, number, {from, to}, groups.size()), name);
    for (auto const& [part, name] : parts)
        if (part.point != part.point)
            return {Verdict::fails, fmt::format("not a number{}", name.empty() ? "" : " (" + name + ")")};
    Estimate const estimate = number.estimate();
    auto const point = [](auto const& p) { return p.first.point; };
    auto const [smallest, largest] = std::ranges::minmax_element(parts, {}, point);
    auto const [fewest, most] = std::ranges::minmax(parts, {}, [](auto const& p) { return p.first.seeds; });
    auto const worst = std::ranges::min_element(parts, {}, [](auto const& p) { return p.first.verdict; });
    auto const text = [&](auto const& p) { return text_of(p.first, p.second, estimate); };
    std::string said = text(*smallest);
    if (groups.size() > 1) said += " ... " + text(*largest);
    Verdict const verdict = worst->first.verdict;
    // The group that decided, if it is neither end.
    if (verdict != Verdict::holds && worst != smallest && worst != largest)
        said += fmt::format("; {}: {}", verdict == Verdict::fails ? "fails" : "undecided", text(*worst));
    size_t const seeds = most.first.seeds;
    if ((estimate == Estimate::most || estimate == Estimate::every) && seeds > 0) {
        auto const farthest = std::ranges::max_element(parts, {}, [](auto const& p) {
            return p.first.seeds == 0 ? 1.0 : (double(p.first.outside) + 1) / double(p.first.seeds);
        });
        said += outside_text(farthest->first.outside, farthest->first.seeds);
    } else said += seeds_text(fewest.first.seeds, seeds);
    bool const random = seeds >= fewest_seeds && estimate != Estimate::proven && estimate != Estimate::every;
    if (random && groups.size() > 1) said += ", each by itself";
    size_t const broken = std::ranges::max(parts, {}, [](auto const& p) { return p.first.broken; }).first.broken;
    if (broken > 0 && !of_each_seed(estimate)) said += fmt::format("; with rows that broke down up to {}", broken);
    Judgement out{verdict, said, random ? claim_risk : 0};
    out.proven = estimate == Estimate::proven;
    return out;
}

Judgement everywhere(Table const& table, std::string const& column, Cell const& value, Estimate seeds) {
    size_t const at = table.index(column), rows = table.rows().size();
    auto const good = [&](Table const& of) {
        return size_t(std::ranges::count_if(of.rows(), [&](auto const& row) { return row[at] == value; }));
    };
    if (rows == 0) return {Verdict::fails, "nothing was measured"};
    Statistic const all([&](Table const& of) { return good(of) == of.rows().size() ? 1.0 : 0.0; }, seeds);
    Judgement out = within(table, {}, all, 1, 1);
    size_t const comma = out.measured.find(',');
    out.measured = fmt::format("{} of {} are \"{}\"{}", good(table), rows, as_text(value),
                               comma == std::string::npos ? "" : out.measured.substr(comma));
    return out;
}

Verdict verdict_of(Interval const& shown, Interval const& band) {
    return shown.outside(band) ? Verdict::fails : shown.inside(band) ? Verdict::holds : Verdict::undecided;
}

Judgement proportion(size_t hits, size_t runs, double from, double to) {
    Interval const shown = proportion_interval(double(hits), double(runs), claim_risk);
    return {runs == 0 ? Verdict::fails : verdict_of(shown, {from, to}),
            fmt::format("{} of {}: [{:.3g}, {:.3g}]", hits, runs, shown.low, shown.high), claim_risk};
}

Judgement operator&&(Judgement const& a, Judgement const& b) {
    Judgement out{std::min(a.verdict, b.verdict), a.measured + "; " + b.measured, a.risk + b.risk};
    out.proven = a.proven || b.proven;
    return out;
}
Judgement together(std::vector<Judgement> const& parts) {
    if (parts.empty()) return {Verdict::fails, "nothing was measured"};
    Judgement out = parts[0];
    for (size_t i = 1; i < parts.size(); ++i) out = out && parts[i];
    return out;
}
Judgement labelled(std::string const& label, Judgement of) {
    of.measured = label + ": " + of.measured;
    return of;
}

Judge operator&&(Judge a, Judge b) {
    return [=](Table const& table) { return a(table) && b(table); };
}
Judge together(std::vector<Judge> parts) {
    return [=](Table const& table) {
        std::vector<Judgement> all;
        for (Judge const& part : parts) all.push_back(part(table));
        return together(all);
    };
}
Judge labelled(std::string label, Judge of) {
    return [=](Table const& table) { return labelled(label, of(table)); };
}

Selection Selection::where(std::string column, Cell value) const { return restricted(*this, column, value); }
Selection Selection::where(std::string column, std::function<bool(double)> holds) const {
    return restricted(*this, column, holds);
}
Selection Selection::where(std::string column, std::vector<std::string> words) const {
    return restricted(*this, column, words);
}
Judge Selection::judged(Judge by) const {
    return [rows = *this, by](Table const& table) { return by(rows(table)); };
}
Judge Selection::each_judged(std::vector<std::string> by, Judge group) const {
    return judged([=](Table const& table) {
        std::vector<Judgement> all;
        for (auto const& [name, rows] : table.groups(by)) all.push_back(labelled(name, group(rows)));
        return together(all);
    });
}
std::function<bool(double)> at_most(double x) { return std::bind_front(std::greater_equal<double>(), x); }
std::function<bool(double)> at_least(double x) { return std::bind_front(std::less_equal<double>(), x); }
std::function<bool(double)> below(double x) { return std::bind_front(std::greater<double>(), x); }
std::function<bool(double)> above(double x) { return std::bind_front(std::less<double>(), x); }
std::function<bool(double)> between(double from, double to) {
    return [=](double y) { return from <= y && y <= to; };
}

Judge within(Selection const& rows, std::vector<std::string> const& by, Statistic const& number, double from,
             double to) {
    return rows.judged([=](Table const& table) { return within(table, by, number, from, to); });
}
Judge everywhere(Selection const& rows, std::string const& column, Cell const& value, Estimate seeds) {
    return rows.judged([=](Table const& table) { return everywhere(table, column, value, seeds); });
}

Judge of_each(std::vector<std::string> const& names, std::function<Judge(std::string const&)> const& judge) {
    std::vector<Judge> parts;
    for (std::string const& name : names) parts.push_back(labelled(name, judge(name)));
    return together(parts);
}

Factors::Factors(std::initializer_list<Factor> list)
    : of_([own = std::vector<Factor>(list)](Budget budget) {
          std::vector<Factor> out = own;
          for (Factor& factor : out)
              if (auto quick = std::exchange(factor.quick, {}); budget == Budget::quick && !quick.empty())
                  factor.values = std::move(quick);
          return out;
      }) {}

}  // namespace rlslab::studies
