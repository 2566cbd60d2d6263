// Sentences, also those of a composition and of the record.
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/prior_law.hpp"
#include "src/lab/compare/composed_score.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/constant.hpp>
#include <rlslab/model/doubts.hpp>
#include <rlslab/model/outliers.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace rlslab::compare {
namespace {

bool is_another_in_other_orders(Result const& r) {
    if (r.others.broken > 0 || !r.spread || !r.others.spread) return true;
    auto const apart = [](double a, double b) { return a != b && !(std::round(10 * std::abs(a - b)) <= 5); };
    return std::ranges::any_of(PerMeasure<Spread>::all(), [&](auto const m) {
        Spread const &own = (*r.spread).*m, &other = (*r.others.spread).*m;
        return apart(own.low, other.low) || apart(own.median, other.median);
    });
}

}  // namespace

std::string tenths(double digits) {
    if (!std::isfinite(digits)) return "-";
    return fmt::format("{:.{}f}", digits + 0.0, digits < -9.94 ? 0 : 1);  // four letters, the width of a column
}

std::string breakdown_text(Result const& r) {
    if (!r.obstacle.empty()) return "-";
    if (r.breakdown) return fmt::format("{} at {}", name_of(r.breakdown->kind), r.breakdown->step);
    if (r.broken > 0) return fmt::format("in {} of {} draws", r.broken, r.runs);
    if (r.others.broken > 0) return fmt::format("in {} of {} orders", r.others.broken, r.others.runs);
    return r.foretold ? fmt::format("about row {:.0f}", rounded_row(*r.foretold)) : "none";
}

std::vector<double> diagonal_of(DefaultPrior const& prior) {
    Matrix<double> const P0 = *prior.prior().covariance;
    return {P0.diagonal().begin(), P0.diagonal().end()};
}

std::string rounding_text(RoundingEffect const& s, Comparison const& c) {
    return fmt::format("as stored: lambda {:.6g}, rank {} of {}; {}", s.forgetting, s.rank, c.size,
                       s.theta_digits
                           ? fmt::format("rounding the data leaves {:.1f} digits of the exact theta", *s.theta_digits)
                           : "no exact theta: the problem leaves the range");
}

std::string foretold_text(Comparison const& c) {
    if (std::ranges::none_of(c.results, [](Result const& r) { return r.foretold.has_value(); })) return "";
    return "About row N: sound on this record, but if such rows go on, the stored P is indefinite at about that row: "
           "its asymmetry grows by 1/lambda at each (docs/theory.md 37).";
}

std::string other_orders_text(Comparison const& c, std::string_view arithmetic) {
    std::string out;
    bool any = false;
    for (bool const named : {true, false})
        for (Result const& r : c.results) {
            if (r.entry->arithmetic->name != arithmetic || r.others.runs == 0 || named != is_recommended(c, r))
                continue;
            any = true;
            if (!named && !(is_shown(c, r.entry->variant) && is_another_in_other_orders(r))) continue;
            std::optional<PerMeasure<Spread>> const& kept = r.others.spread;
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", r.entry->variant,
                               kept ? tenths(kept->theta.median) : "-");
            if (r.others.broken > 0) out += fmt::format(" (broke down in {})", r.others.broken);
        }
    if (!any) return "";
    return fmt::format("reordered, {}: {}", arithmetic, out.empty() ? "as in this" : out);
}

bool is_shown(Comparison const& c, std::string_view variant) {
    constexpr std::string_view to_use[] = {"conventional", "symmetric", "joseph_rank_two", "potter",
                                           "carlson",      "ud",        "ud_delta",        "inverse_qr",
                                           "qr",           "gentleman", "qr_block"};
    if (!c.options.variants.empty() || std::ranges::find(to_use, variant) != std::end(to_use)) return true;
    return std::ranges::any_of(c.results,
                               [&](Result const& r) { return r.entry->variant == variant && is_recommended(c, r); });
}

std::string recommended_in(Comparison const& c, std::string_view arithmetic) {
    if (c.digits) {
        KeptDigits const* const choice = c.digits->choice();
        return choice && choice->result->entry->arithmetic->name == arithmetic
                   ? std::string(choice->result->entry->variant)
                   : "";
    }
    auto const found = std::ranges::find(c.recommendations, arithmetic, &Recommendation::arithmetic);
    return found == c.recommendations.end() ? "" : found->variant;
}

bool is_recommended(Comparison const& c, Result const& result) {
    return result.entry->variant == recommended_in(c, result.entry->arithmetic->name);
}

std::string probes_sentence(Comparison const& c) {
    Index seen = 0, above = 0;
    for (Result const& r : c.results)
        if (r.probed && r.probed->truth) ++seen, above += *r.probed->truth > r.probed->bound;
    std::vector<std::string_view> none;
    for (Result const& r : c.results) {
        std::string_view const name = r.entry->variant;
        if (std::ranges::none_of(c.results, [&](Result const& o) { return o.entry->variant == name && o.probed; }) &&
            std::ranges::find(none, name) == none.end())
            none.push_back(name);
    }
    return fmt::format(
        "Probes: {} in a filter estimate ||Phat P^-1 - I||_F after the last row, in the prior's units: not the digits "
        "above, which are of P itself and medians over rows. The bound fails with probability 5e-4; truth, in 257 "
        "bits, is above it in {} of {} filters.{}",
        probes_of_compare, above, seen, none.empty() ? "" : fmt::format(" None in {}.", fmt::join(none, ", ")));
}

std::string prior_text(Comparison const& c) {
    std::string out = "P0 = ";
    if (c.scaled_prior) {
        auto const [least, largest] = std::minmax_element(c.scaled_prior->s.begin(), c.scaled_prior->s.end());
        out += fmt::format("diag(({} / s_i)^2), s_i = {} to {}, the regressors' sizes; ", c.scaled_prior->c, *least,
                           *largest);
    } else {
        out += fmt::format("{} I; ", *c.options.p0);
    }
    out += fmt::format("moves theta{} by {:.1e} of itself, a component by {:.1e}",
                       c.options.composition.empty() ? "" : ", of all rows without the composition,", c.prior_bias,
                       c.component_bias);
    return out;
}

std::vector<std::string> warnings(Comparison const& c) {
    Composition const& of = c.options.composition;
    std::vector<std::string> out = warnings_of(of, c.rows, c.size);
    double const weighs = double(c.rows) / double(std::max<Index>(of.window, 1));
    if (of.window >= c.size && of.window < c.rows && !(c.component_bias * weighs <= most_component_bias / 10))
        out.push_back(
            fmt::format("the prior's bias is that of all rows; in a window of {} rows it is {:.2g} times as large",
                        of.window, weighs));
    out.insert(out.end(), c.model.warnings.begin(), c.model.warnings.end());
    std::string const remedy = c.options.p0 ? "leave out --p0 for one that is scaled to the data"
                                            : "no prior in range will do; rescale the columns";
    if (!(c.prior_bias <= most_prior_bias))
        out.push_back(fmt::format("the prior moves theta by {:.2g} of itself: {}", c.prior_bias, remedy));
    else if (!(c.component_bias <= most_component_bias))
        out.push_back(
            fmt::format("the prior moves a component of theta by {:.2g} of itself: {}", c.component_bias, remedy));
    for (std::string const& cost : {prior_cost_text(c), start_cost_text(c)})
        if (!cost.empty()) out.push_back(cost);
    if (c.offset > most_offset)
        out.push_back(
            fmt::format("the mean of {} is {:.3g} times its standard deviation and the model has no constant, so that "
                        "the offset is fitted as dynamics: --detrend or --intercept",
                        c.model.output.empty() ? "y" : c.model.output, c.offset));
    return out;
}

std::string against_text(Comparison const& comparison) {
    Composition const& c = comparison.options.composition;
    if (!c.keeps_the_problem())
        return "against the same recursion in 257 bits (ud, checked by qr; kalman, which adds all of Q at each row, by "
               "itself)";
    std::string out = "against the certified least-squares solution of ";
    out += c.window > 0 ? "the rows in the window, with the prior" : "the rows so far";
    if (!c.guard.empty())
        out +=
            "; from the first row at which the guard changed anything on, against the same recursion in 257 bits (ud, "
            "checked by qr), whose guard decides by itself";
    return out;
}

std::string counts_text(Comparison const& comparison, Result const& r) {
    if (!r.obstacle.empty()) return r.obstacle;
    if (r.happened.empty()) return "";
    std::string const what = counts_text(r.happened.back());
    std::vector<std::string> out(what.empty() ? 0 : 1, what);
    if (comparison.options.composition.keeps_the_problem() && r.certified_to < comparison.rows)
        out.push_back(r.certified_to == 0 ? "recursion" : fmt::format("recursion from row {}", r.certified_to + 1));
    return fmt::format("{}", fmt::join(out, ", "));
}

// --- what is to be said of the record: the minimiser without a prior, its residuals, and what they and the columns say

namespace {

std::optional<Outlier> outlier_of(Records const& records, Vector<Reference> const& theta, InFile const& in_file) {
    Signal residuals(in_file.lines.size(), NAN);  // those of rows that are left out are missing
    for (Index k = 0; k < records.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < records.parameters(); ++i) sum += records.psi(i, k) * static_cast<double>(theta[i]);
        residuals[size_t(in_file.rows[size_t(k)])] = records.y[k] - sum;
    }
    residuals.erase(residuals.begin(), residuals.begin() + records.presample);
    auto const found = outlier_in(residuals, in_file.order);
    if (!found) return {};
    Index const row = records.presample + found->at;
    return Outlier{row + 1, in_file.lines[size_t(row)], false, found->deviations, found->share};
}

std::string sentence_on_offset(Records const& records, std::vector<std::string> const& regressors) {
    double most = 0;
    bool constant = false;
    std::vector<Index> far;
    for (Index i = 0; i < records.parameters(); ++i) {
        bool const still = constant_value(records.psi.row(i)).has_value();
        double const off = still ? 0 : deviations_off_zero(records.psi.row(i));
        constant = constant || still, most = std::max(most, off);
        if (off > much_offset) far.push_back(i);
    }
    if (!constant || far.empty()) return "";
    return fmt::format(
        "{}: the mean is {}{:.3g} standard deviations off 0, beside a constant: that costs factor forms about {:.1f} "
        "digits of theta, forms that store P up to twice as many or more, and the rounding of the data to a short word "
        "as many again; --detrend gives them back",
        names_of(far, regressors), far.size() > 1 ? "up to " : "", most, correctly::log10(most));
}

}  // namespace

double deviations_off_zero(Vector<double> const& x) {
    if (auto const value = constant_value(x)) return *value == 0 ? 0 : std::numeric_limits<double>::infinity();
    int unit = 0;  // in units of a power of two, whose squares double can hold
    std::frexp(x.cwiseAbs().maxCoeff(), &unit);
    double mean = 0, squares = 0, N = double(x.size());
    for (double const v : x) mean += std::ldexp(v, -unit) / N;
    for (double const v : x) squares += (std::ldexp(v, -unit) - mean) * (std::ldexp(v, -unit) - mean) / N;
    return mean == 0 ? 0 : std::abs(mean) / std::sqrt(squares);
}

std::vector<std::string> doubts(Records const& records, CompareOptions const& options,
                                std::vector<std::string> const& regressors, InFile const& in_file) {
    Problem<double> const problem{
        .size = records.parameters(), .forgetting = options.forgetting, .prior = std::nullopt};
    Scattered const free = scattered(problem, records, {records.rows()}).front();
    if (free.exact.status() != Status::certified) return {};
    std::vector<std::string> out;
    Vector<double> const resolution =
        Eigen::Map<Vector<double> const>(in_file.resolution.data(), Index(in_file.resolution.size()));
    if (auto const dependent = dependent_but_for_rounding(records, free.scatter, resolution); !dependent.empty()) {
        std::string const names = names_of(dependent, regressors);
        out.push_back(sentence_on_dependence(names, "leave out one of " + names));
    }
    if (auto const outlier = outlier_of(records, free.exact.theta(), in_file))
        out.push_back(sentence_on(*outlier, options.composition.policy().intervenes()));
    if (std::string const offset = sentence_on_offset(records, regressors); !offset.empty()) out.push_back(offset);
    return out;
}

}  // namespace rlslab::compare
