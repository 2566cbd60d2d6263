// Runs the comparison: each entry of the catalogue processes the records. The definiteness of the stored P is decided
// exactly after each step. theta and P are compared with the reference for the same bits that the arithmetic was given.
#include "compare/compare.hpp"
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "compare/composed_score.hpp"
#include "compare/fast_score.hpp"
#include "compare/recommend.hpp"
#include "compare/score.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/constant.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <set>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

namespace rlslab::compare {
using namespace report;
namespace {

double as_is(double x) { return x; }

std::vector<std::string> printable_names(Records const& records) {
    std::vector<std::string> names;
    for (std::string const& name : records.names) names.push_back(printable(name));
    return names;
}

/// The effect on the exact solution of rounding the data to this arithmetic.
RoundingEffect effect_of(Arithmetic const& arithmetic, RoundedProblem const& rounded, CertifiedSolution const& given,
                         Vector<double> const& scales) {
    Problem<double> problem = rounded.problem;
    problem.prior.reset();
    RoundingEffect out{arithmetic.name,
                       problem.forgetting,
                       0,
                       rounded.in_range,
                       {},
                       std::numeric_limits<double>::quiet_NaN(),
                       std::numeric_limits<double>::quiet_NaN()};
    CertifiedSolution const* const exact =
        rounded.orders.front().exact.empty() ? nullptr : &rounded.orders.front().exact.back();
    out.data_in_range = rounded.records.psi.allFinite() && rounded.records.y.allFinite();
    Prior<double> const& prior = *rounded.problem.prior;
    double const least = std::ldexp(1.0, arithmetic.min_exp),
                 P0 = prior.covariance ? prior.covariance->diagonal().minCoeff() : prior.variance;
    out.prior_subnormal = rounded.in_range && P0 < least;
    if (is_forgetting_factor(problem.forgetting) && out.data_in_range) {
        CertifiedSolution const without = certified(problem, rounded.records, {rounded.records.rows()}).front();
        out.rank = without.rank();
        if (exact)
            out.prior_bias = relative_change(*exact, without, scales),
            out.component_bias = largest_relative_change(*exact, without, scales);
    }
    if (exact) {
        double const digits = -correctly::log10(relative_change(*exact, given));
        if (!std::isnan(digits)) out.theta_digits = std::min(digits, 15.9);
    }
    return out;
}

std::vector<Index> constant_regressors(Records const& records) {
    std::vector<Index> out;
    for (Index i = 0; i < records.parameters(); ++i)
        if (constant_value(records.psi.row(i))) out.push_back(i);
    return out;
}

/// |mean of y| in standard deviations of y: 0 if a regressor is constant, infinite if y is.
double offset(Records const& records) {
    if (!constant_regressors(records).empty()) return 0;
    if (auto const y = constant_value(records.y)) return *y == 0 ? 0 : std::numeric_limits<double>::infinity();
    Index const N = records.rows();
    int unit = 0;  // in units of a power of two, whose squares double can hold
    std::frexp(records.y.cwiseAbs().maxCoeff(), &unit);
    auto const y = [&](Index k) { return std::ldexp(records.y[k], -unit); };
    double mean = 0, squares = 0;
    for (Index k = 0; k < N; ++k) mean += y(k) / double(N);
    for (Index k = 0; k < N; ++k) squares += (y(k) - mean) * (y(k) - mean) / double(N);
    return mean == 0 ? 0 : std::abs(mean) / std::sqrt(squares);
}

/// Digits in which two exact solutions agree, component by component.
std::vector<double> agreement(CertifiedSolution const& a, CertifiedSolution const& b) {
    constexpr double most = 30;  // to which they are certified
    std::vector<double> out;
    Vector<Reference> const x = a.theta(), y = b.theta();
    for (Index i = 0; i < x.size(); ++i) out.push_back(std::min(most, digits_of(Reference(x[i] - y[i]), y[i])));
    return out;
}

/// " (constant: b0, b1)", the names of constant regressors, which are the most common reason for dependence; or "".
std::string constants_text(Records const& records) {
    std::vector<std::string> names;
    for (Index const i : constant_regressors(records)) names.push_back(records.names[size_t(i)]);
    return names.empty() ? "" : fmt::format(" (constant: {})", fmt::join(names, ", "));
}

/// The entries that the options select, each arithmetic's in the catalogue's order.
std::vector<CatalogueEntry const*> chosen(CompareOptions const& options) {
    std::vector<std::string_view> variants;
    std::vector<Arithmetic const*> used;
    for (CatalogueEntry const* const entry : one_entry_each()) variants.push_back(entry->variant);
    for (std::string const& name : options.variants) expect_one_of(variants, name, "--variants", "variant");
    for (std::string const& name : options.arithmetics) used.push_back(&arithmetic_named(name, "--arithmetic"));
    if (used.empty())
        for (Arithmetic const& arithmetic : arithmetics()) used.push_back(&arithmetic);
    for (std::string const& name : options.composition.empty() ? std::vector<std::string>() : options.arithmetics)
        if (std::ranges::find(composed_arithmetics(), name) == composed_arithmetics().end())
            throw InputError(fmt::format("--arithmetic: --control, --window and --guard exist in {}, not in {}",
                                         fmt::join(composed_arithmetics(), " and "), name));
    // From the shortest to the longest; the catalogue's before others of their length, in its order.
    auto const place = [](Arithmetic const* a) {
        for (size_t i = 0; i < arithmetics().size(); ++i)
            if (a == &arithmetics()[i]) return i;
        return arithmetics().size();
    };
    std::ranges::sort(used, {}, [&](Arithmetic const* a) { return std::tuple(a->digits, place(a), a->name); });
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<CatalogueEntry const*> out;
    for (Arithmetic const* const arithmetic : used)
        for (CatalogueEntry const* const entry : entries_in(*arithmetic))
            if (options.variants.empty() ||
                std::ranges::find(options.variants, entry->variant) != options.variants.end())
                out.push_back(entry);
    if (out.empty())
        throw InputError("--variants, --arithmetic: expected a variant that exists in one of the arithmetics");
    return out;
}

/// The entries, unless none of them can be composed so.
std::vector<CatalogueEntry const*> composable(std::vector<CatalogueEntry const*> const& entries,
                                              Composition const& composition) {
    if (composition.empty()) return entries;
    if (std::string const why = contradiction(composition); !why.empty())
        throw InputError("--control, --window, --guard: do not go together: " + why);
    std::vector<std::string> reasons;
    for (CatalogueEntry const* const entry : entries) {
        std::string const why = obstacle(composition, entry->variant);
        if (why.empty()) return entries;
        if (std::string const text = fmt::format("{} {}", entry->variant, why);
            std::ranges::find(reasons, text) == reasons.end())
            reasons.push_back(text);
    }
    throw InputError(fmt::format("--variants: none of them can be composed so: {}", fmt::join(reasons, "; ")));
}

/// The mean square of the solution's residuals, over the rows that are more than it takes.
double noise_variance(Records const& records, CertifiedSolution const& solution) {
    Vector<Reference> const theta = solution.theta();
    Reference squares = 0;
    for (Index k = 0; k < records.rows(); ++k) {
        Reference e = records.y[k];
        for (Index i = 0; i < theta.size(); ++i) e -= theta[i] * records.psi(i, k);
        squares += e * e;
    }
    return static_cast<double>(squares) / double(records.rows() - records.parameters());
}
Composition as_stored(Composition composition, std::function<double(double)> const& round) {
    for (double& x : composition.parameters) x = round(x);
    return composition;
}

// --- the steps of a comparison ---------------------------------------------------------------------------------------

/// The ways in which the chosen arithmetics round the data: those that hold binary64 share one.
std::string_view rounding_of(Arithmetic const& a) { return a.digits >= 53 ? std::string_view("double") : a.name; }

std::vector<Arithmetic const*> arithmetics_of(std::vector<CatalogueEntry const*> const& entries) {
    std::vector<Arithmetic const*> out;
    for (CatalogueEntry const* const entry : entries)
        if (out.empty() || out.back() != entry->arithmetic) out.push_back(entry->arithmetic);
    return out;
}

/// The data as they are: the problem with its prior, and its solutions with it and without.
struct Solved {
    Problem<double> problem;
    std::optional<DefaultPrior> scaled;  ///< the prior; absent: the options give one
    CertifiedSolution without, with;
    Vector<double> scales;  ///< of the regressors
};
/// Throws InputError where the data do not determine theta.
Solved solved(Records const& records, CompareOptions const& options, std::function<void()> const& one_more) {
    Problem<double> problem{.size = records.parameters(), .forgetting = options.forgetting, .prior = std::nullopt};
    CertifiedSolution without = certified(problem, records, {records.rows()}).front();
    one_more();
    if (without.status() == Status::singular)
        throw InputError(
            fmt::format("the regressors are linearly dependent, so theta is not determined: exact rank {} of {} "
                        "over {} rows{}",
                        without.rank(), records.parameters(), records.rows(), constants_text(records)));
    std::optional<DefaultPrior> scaled;
    if (!options.p0) {
        scaled = default_prior(records, options.forgetting);
        scaled->c *= options.prior_times;
    }
    one_more();
    problem.prior = scaled ? scaled->prior() : Prior<double>{.variance = *options.p0};
    Vector<double> scales = regressor_scales(records);
    CertifiedSolution with = certified(problem, records, {records.rows()}).front();
    one_more();
    return {std::move(problem), std::move(scaled), std::move(without), std::move(with), std::move(scales)};
}

/// The comparison before any variant has computed.
Comparison described(Records const& records, CompareOptions const& options, Solved const& given) {
    Comparison out{.rows = records.rows(),
                   .skipped = records.skipped,
                   .size = records.parameters(),
                   .names = printable_names(records),
                   .model = {},
                   .theta = given.with.theta_strings(30),
                   .least_squares = given.without.theta_strings(30),
                   .agreement = agreement(given.with, given.without),
                   .radius = given.with.radius(),
                   .bits = given.with.bits(),
                   .condition = condition(records, options.forgetting),
                   .scaled_prior = given.scaled,
                   .prior_bias = relative_change(given.with, given.without, given.scales),
                   .component_bias = largest_relative_change(given.with, given.without, given.scales),
                   .offset = offset(records),
                   .options = options,
                   .checkpoints = checkpoints_of(records.rows()),
                   .rounding = {},
                   .results = {},
                   .recommendations = {}};
    out.model.regressors = out.names;
    out.without_prior = given.without;
    double const noise = needs_noise_variance(options.composition) ? noise_variance(records, given.without) : 0;
    out.options.composition = completed(options.composition, given.problem, noise);
    return out;
}

/// The problem in each way of rounding, and what a composition is compared with there.
struct Prepared {
    std::map<std::string_view, RoundedProblem> rounded;
    std::map<std::string_view, CompositionReference> references;
    std::vector<RoundingEffect> effects;  ///< where the arithmetic is shorter than binary64
};
Prepared prepare(std::vector<Arithmetic const*> const& used, Records const& records, Composition composition,
                 Solved const& given, std::vector<std::vector<Index>> const& orders,
                 std::function<void()> const& one_more) {
    composition.window =
        std::min(composition.window, records.rows());  // a longer one takes memory alone: nothing leaves either
    double most_digits = 0;
    for (Arithmetic const* const a : used) most_digits = std::max(most_digits, a->decimal_digits());
    Prepared out;
    for (Arithmetic const* const a : used) {
        std::string_view const name = rounding_of(*a);
        if (out.rounded.contains(name)) continue;
        bool const wide = name == "double";
        std::function<double(double)> const round = wide ? as_is : a->round;
        int const digits = wide ? std::max(30, int(most_digits) + 15) : 30;
        RoundedProblem const& one = out.rounded[name] =
            rounded_problem(records, given.problem, round, orders, digits, one_more);
        out.references.try_emplace(name, as_stored(composition, round), one, digits);
        if (!wide) out.effects.push_back(effect_of(*a, one, given.with, given.scales));
    }
    return out;
}

std::vector<Result> score_all(std::vector<CatalogueEntry const*> const& entries, Prepared& prepared,
                              CompareOptions const& options, StagedProgress const& progress) {
    std::vector<Result> out(entries.size());
    std::vector<size_t> order(entries.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = order.size() - 1 - i;  // the slow arithmetics first
    std::mutex one_at_a_time;
    size_t done = 0;
    tbb::task_arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic).execute([&] {
        tbb::parallel_for_each(order.begin(), order.end(), [&](size_t i) {
            std::string_view const name = rounding_of(*entries[i]->arithmetic);
            out[i] = options.composition.empty()
                         ? score(*entries[i], prepared.rounded.at(name), options.seed)
                         : score_composed(*entries[i], prepared.rounded.at(name), prepared.references.at(name));
            std::lock_guard const lock(one_at_a_time);
            if (progress) progress("comparing", double(++done) / double(entries.size()));
        });
    });
    return out;
}

/// Operations and nanoseconds of each. Called when no other thread of this program runs.
void time_all(std::vector<Result>& results, Prepared const& prepared, Records const& records,
              CompareOptions const& options) {
    for (Result& r : results) {
        if (!r.obstacle.empty()) continue;
        if (auto const counted = cost(r.entry->variant, records.parameters())) r.operations = counted->total();
        if (options.timings && options.composition.empty() && r.breakdown.value_or(Breakdown{1, {}}).step > 0)
            r.ns_per_update = r.entry->time(prepared.rounded.at(rounding_of(*r.entry->arithmetic)).problem, records,
                                            Seed{options.seed});
    }
}

std::vector<Recommendation> recommend_all(std::vector<Arithmetic const*> const& used, Comparison const& c) {
    std::vector<Recommendation> out;
    for (Arithmetic const* const a : used) out.push_back(recommend(*a, c));
    return out;
}

/// With the variance that the prior gives the newest sample.
std::vector<FastResult> fast_forms(std::vector<Arithmetic const*> const& used, Records const& records,
                                   Solved const& given, std::vector<Index> const& checkpoints) {
    std::vector<std::string_view> names;
    for (Arithmetic const* const a : used) names.push_back(a->name);
    Prior<double> const& prior = *given.problem.prior;
    return score_fast_forms(records, given.problem.forgetting,
                            prior.covariance ? (*prior.covariance)(0, 0) : prior.variance, names, checkpoints);
}

}  // namespace

Comparison compare(Records const& records, CompareOptions const& options, StagedProgress const& progress) {
    std::vector<CatalogueEntry const*> const entries = composable(chosen(options), options.composition);
    std::vector<Arithmetic const*> const used = arithmetics_of(entries);
    std::set<std::string_view> roundings;
    for (Arithmetic const* const a : used) roundings.insert(rounding_of(*a));
    auto const orders = options.composition.empty() ? row_orders(records.rows(), options.forgetting, options.seed)
                                                    : std::vector<std::vector<Index>>(1);
    size_t done = 0;
    auto const one_more = [&] {  // of three for the data as they are, and one for each order in each rounding
        if (progress) progress("reference", double(++done) / double(3 + orders.size() * roundings.size()));
    };
    Solved const given = solved(records, options, one_more);
    Comparison out = described(records, options, given);
    Prepared prepared = prepare(used, records, out.options.composition, given, orders, one_more);
    out.rounding = prepared.effects;
    out.results = score_all(entries, prepared, options, progress);
    time_all(out.results, prepared, records, options);
    out.recommendations = recommend_all(used, out);
    if (options.composition.empty()) out.fast = fast_forms(used, records, given, out.checkpoints);
    return out;
}

}  // namespace rlslab::compare
