// Runs the comparison: each entry of the catalogue processes the records. The definiteness of the stored P is decided
// exactly after each step. theta and P are compared with the reference for the same bits that the arithmetic was given.
#include "src/lab/compare/compare.hpp"
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include "src/lab/compare/composed_score.hpp"
#include "src/lab/compare/prior_law.hpp"
#include "src/lab/compare/answer.hpp"

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

std::vector<CatalogueEntry const*> chosen(CompareOptions const& options) {
    std::vector<std::string_view> variants;
    std::vector<Arithmetic const*> used;
    for (CatalogueEntry const* const entry : one_entry_each()) variants.push_back(entry->variant);
    for (std::string const& name : options.variants) expect_one_of(variants, name, "--variants", "variant");
    for (std::string const& name : options.arithmetics) used.push_back(&arithmetic_named(name, "--arithmetic"));
    if (used.empty())
        for (Arithmetic const& arithmetic : arithmetics()) used.push_back(&arithmetic);
    auto const composes = [](std::string_view name) {
        return std::ranges::find(composed_arithmetics(), name) != composed_arithmetics().end();
    };
    for (std::string const& name : options.composition.empty() ? std::vector<std::string>() : options.arithmetics)
        if (!composes(name))
            refuse("--arithmetic: --control, --window and --guard exist in {}, not in {}",
                   fmt::join(composed_arithmetics(), " and "), name);
    if (options.certify && std::ranges::none_of(used, composes, &Arithmetic::name))
        refuse("--certify: expected --arithmetic {}", fmt::join(composed_arithmetics(), ", "));
    // From the shortest to the longest; the catalogue's before others of their length, in its order.
    auto const place = [](Arithmetic const* a) {
        return std::ranges::find_if(arithmetics(), [&](Arithmetic const& one) { return a == &one; }) -
               arithmetics().begin();
    };
    std::ranges::sort(used, {}, [&](Arithmetic const* a) { return std::tuple(a->digits, place(a), a->name); });
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<CatalogueEntry const*> out;
    for (Arithmetic const* const arithmetic : used)
        for (CatalogueEntry const* const entry : entries_in(*arithmetic))
            if (options.variants.empty() ||
                std::ranges::find(options.variants, entry->variant) != options.variants.end())
                out.push_back(entry);
    if (out.empty()) refuse("--variants, --arithmetic: expected a variant that exists in one of the arithmetics");
    return out;
}

std::vector<Arithmetic const*> arithmetics_of(std::vector<CatalogueEntry const*> const& entries) {
    std::vector<Arithmetic const*> out;
    for (CatalogueEntry const* const entry : entries)
        if (out.empty() || out.back() != entry->arithmetic) out.push_back(entry->arithmetic);
    return out;
}

namespace {

double as_is(double x) { return x; }

/// The effect on the exact solution of rounding the data to this arithmetic.
RoundingEffect effect_of(Arithmetic const& arithmetic, RoundedProblem const& rounded, CertifiedSolution const& given,
                         Vector<double> const& scales) {
    Problem<double> problem = rounded.problem;
    problem.prior.reset();
    RoundingEffect out{arithmetic.name, problem.forgetting, 0, rounded.in_range};
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

/// Digits in which two exact solutions agree, component by component.
std::vector<double> agreement(CertifiedSolution const& a, CertifiedSolution const& b) {
    constexpr double most = 30;  // to which they are certified
    std::vector<double> out;
    Vector<Reference> const x = a.theta(), y = b.theta();
    for (Index i = 0; i < x.size(); ++i) out.push_back(std::min(most, digits_of(Reference(x[i] - y[i]), y[i])));
    return out;
}

std::vector<Index> constant_regressors(Records const& records) {
    std::vector<Index> out;
    for (Index i = 0; i < records.parameters(); ++i)
        if (constant_value(records.psi.row(i))) out.push_back(i);
    return out;
}
/// " (constant: b0, b1)", the names of constant regressors, which are the most common reason for dependence; or "".
std::string constants_text(Records const& records) {
    std::vector<std::string> names;
    for (Index const i : constant_regressors(records))
        if (!records.names.empty()) names.push_back(records.names[size_t(i)]);
    return names.empty() ? "" : fmt::format(" (constant: {})", fmt::join(names, ", "));
}

/// The entries, unless none of them can be composed so, or take the probes that are asked for.
std::vector<CatalogueEntry const*> composable(std::vector<CatalogueEntry const*> const& entries,
                                              CompareOptions const& options) {
    Composition composition = options.composition;
    if (options.certify) composition.certify = probes_of_compare;
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
    refuse("--variants: none of them {}: {}", options.certify ? "goes with --certify" : "can be composed so",
           fmt::join(reasons, "; "));
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
    CertifiedSolution without = least_squares(records, options.forgetting);
    one_more();
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
                   .theta = given.with.theta_strings(30),
                   .least_squares = given.without.theta_strings(30),
                   .agreement = agreement(given.with, given.without),
                   .radius = given.with.radius(),
                   .bits = given.with.bits(),
                   .condition = condition(records, options.forgetting),
                   .scaled_prior = given.scaled,
                   .prior_bias = relative_change(given.with, given.without, given.scales),
                   .component_bias = largest_relative_change(given.with, given.without, given.scales),
                   .options = options,
                   .checkpoints = checkpoints_of(records.rows())};
    for (std::string const& name : records.names) out.names.push_back(printable(name));
    out.model.regressors = out.names;
    out.without_prior = given.without;
    if (constant_regressors(records).empty()) out.offset = deviations_off_zero(records.y);
    double const noise = needs_noise_variance(options.composition) ? noise_variance(records, given.without) : 0;
    out.options.composition = completed(options.composition, given.problem, noise);
    return out;
}

/// The problem in each way of rounding, and what a composition is compared with there.
struct Prepared {
    std::map<std::string_view, RoundedProblem> rounded;
    std::map<std::string_view, std::vector<RoundedProblem>> draws = {};  ///< from draw 1 on
    std::map<std::string_view, int> digits = {};                         ///< to which exact solutions are certified
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
        out.digits[name] = digits;
        RoundedProblem const& one = out.rounded[name] =
            rounded_problem(records, given.problem, round, orders, digits, one_more);
        out.references.try_emplace(name, as_stored(composition, round), one, digits);
        if (!wide) out.effects.push_back(effect_of(*a, one, given.with, given.scales));
    }
    return out;
}

/// Calls work(i) for each of these, on as many threads as the options say; the last ones, slow arithmetics, first.
/// Their progress goes from one part of the whole to another.
void for_each_entry(std::vector<size_t> const& which, CompareOptions const& options, StagedProgress const& progress,
                    double from, double to, std::function<void(size_t)> const& work) {
    std::vector<size_t> const order(which.rbegin(), which.rend());
    std::mutex one_at_a_time;
    size_t done = 0;
    tbb::task_arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic).execute([&] {
        tbb::parallel_for_each(order.begin(), order.end(), [&](size_t i) {
            work(i);
            std::lock_guard const lock(one_at_a_time);
            if (progress && ++done < order.size())
                progress("comparing", from + (to - from) * double(done) / double(order.size()));
        });
    });
}

/// The results of all entries, and their runs, to which draws are added.
struct Scores {
    std::vector<Result> results;
    std::vector<Runs> runs;
};

Scores score_once(std::vector<CatalogueEntry const*> const& entries, Prepared& prepared, CompareOptions const& options,
                  StagedProgress const& progress, double to) {
    Scores out{std::vector<Result>(entries.size()), std::vector<Runs>(entries.size())};
    Index const size = prepared.rounded.begin()->second.records.parameters();
    std::vector<size_t> all(entries.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    for_each_entry(all, options, progress, 0, to, [&](size_t i) {
        std::string_view const name = rounding_of(*entries[i]->arithmetic);
        RoundedProblem const& rounded = prepared.rounded.at(name);
        if (!options.composition.empty()) {
            out.results[i] = score_composed(*entries[i], rounded, prepared.references.at(name));
            return;
        }
        out.runs[i] = runs_of(*entries[i], rounded, options.seed);
        out.results[i] = result_of(*entries[i], rounded, out.runs[i]);
    });
    for (Result& r : out.results)  // which do not depend on the record
        if (auto const counted = r.obstacle.empty() ? cost(r.entry->variant, size) : std::nullopt)
            r.operations = counted->total();
    return out;
}

/// The next draws of what may be named in these arithmetics.
void draw_more(std::vector<CatalogueEntry const*> const& entries, std::vector<Arithmetic const*> const& in,
               size_t first, size_t last, Prepared& prepared, Records const& records, Solved const& given,
               Comparison const& c, Scores& scores, StagedProgress const& progress, double from) {
    for (Arithmetic const* const a : in) {
        std::string_view const name = rounding_of(*a);
        std::vector<RoundedProblem>& known = prepared.draws[name];
        for (size_t i = known.size() + 1; i < last && !a->stochastic; ++i)
            known.push_back(rounded_problem(drawn(records, i), given.problem,
                                            name == "double" ? std::function<double(double)>(as_is) : a->round, {{}},
                                            prepared.digits.at(name), {}, false));
    }
    std::vector<size_t> which;
    for (Arithmetic const* const a : in) {
        std::vector<Result const*> sound;
        for (Result const& r : scores.results)
            if (r.entry->arithmetic == a && takes_single_rows(r) && is_sound(r)) sound.push_back(&r);
        for (size_t i = 0; i < entries.size(); ++i)
            if (entries[i]->arithmetic == a && is_contender(scores.results[i], sound)) which.push_back(i);
    }
    for_each_entry(which, c.options, progress, from, (1 + from) / 2, [&](size_t i) {
        Arithmetic const& a = *entries[i]->arithmetic;
        std::string_view const name = rounding_of(a);
        RoundedProblem const& base = prepared.rounded.at(name);
        bool const exact = std::ranges::find(c.exact, a.name, &ExactSums::arithmetic) != c.exact.end();
        for (size_t k = first; k < last; ++k) {
            RoundedProblem const& drawn_problem = a.stochastic ? base : prepared.draws.at(name)[k - 1];
            if (exact && !exact_rows(drawn_problem.records, drawn_problem.problem, a)) continue;
            scores.runs[i].own.push_back(
                run_of(*entries[i], drawn_problem, 0, seed_of_run(c.options.seed, base.orders.size() + k)));
        }
        std::optional<long> const operations = scores.results[i].operations;
        scores.results[i] = result_of(*entries[i], base, scores.runs[i]);
        scores.results[i].operations = operations;
    });
}

/// Draws until each arithmetic is settled.
void draw(std::vector<CatalogueEntry const*> const& entries, std::vector<Arithmetic const*> in, Prepared& prepared,
          Records const& records, Solved const& given, Comparison& c, Scores& scores, StagedProgress const& progress) {
    std::map<std::string_view, std::string> before;
    double from = 0.5;
    size_t const most = most_draws(records.rows(), c.options);
    for (size_t drawn = 1; drawn < most && !in.empty();) {
        size_t const last = std::min(most, drawn == 1 ? draws_at_a_time : drawn + draws_at_a_time);
        draw_more(entries, in, drawn, last, prepared, records, given, c, scores, progress, from);
        drawn = last, from = (1 + from) / 2;
        c.results = scores.results;
        std::erase_if(in, [&](Arithmetic const* a) {
            std::vector<Result const*> results;
            std::vector<Runs const*> runs;
            for (size_t i = 0; i < entries.size(); ++i)
                if (entries[i]->arithmetic == a) results.push_back(&scores.results[i]), runs.push_back(&scores.runs[i]);
            std::string const named = recommend(*a, c).variant;
            bool const enough = settled(results, runs, c.checkpoints, named, before[a->name]);
            before[a->name] = named;
            return enough;
        });
    }
}

}  // namespace

CertifiedSolution least_squares(Records const& records, double forgetting) {
    Problem<double> const problem{.size = records.parameters(), .forgetting = forgetting, .prior = std::nullopt};
    CertifiedSolution out = certified(problem, records, {records.rows()}).front();
    if (out.status() == Status::singular)
        refuse(
            "{}{}the regressors are linearly dependent, so theta is not determined: exact rank {} of {} over {} rows{}",
            records.file, records.file.empty() ? "" : ": ", out.rank(), records.parameters(), records.rows(),
            constants_text(records));
    return out;
}

Comparison compare(Records const& records, CompareOptions const& options, StagedProgress const& progress) {
    std::vector<CatalogueEntry const*> const entries = composable(chosen(options), options);
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
    for (Arithmetic const* const a : used)
        if (RoundedProblem const& one = prepared.rounded.at(rounding_of(*a));
            options.composition.empty() && one.in_range)
            if (auto const rows = exact_rows(one.records, one.problem, *a)) out.exact.push_back({a->name, *rows});
    bool const draws = most_draws(records.rows(), options) > 1;
    Scores scores = score_once(entries, prepared, options, progress, draws ? 0.5 : 1);
    if (draws) draw(entries, used, prepared, records, given, out, scores, progress);
    if (progress) progress("comparing", 1);
    out.results = std::move(scores.results);
    if (options.composition.empty()) predict(out.results, prepared.rounded);
    if (options.certify) probe(out.results, prepared.rounded);
    for (Result& r : out.results)  // when no other thread of this program runs
        if (options.timings && options.composition.empty() && r.breakdown.value_or(Breakdown{1, {}}).step > 0)
            r.ns_per_update = r.entry->time(prepared.rounded.at(rounding_of(*r.entry->arithmetic)).problem, records,
                                            Seed{options.seed});
    std::vector<std::string_view> names;
    for (Arithmetic const* const a : used) names.push_back(a->name), out.recommendations.push_back(recommend(*a, out));
    Prior<double> const& prior = *given.problem.prior;  // the fast forms take the variance of the newest sample
    if (options.composition.empty())
        out.fast =
            score_fast_forms(records, given.problem.forgetting,
                             prior.covariance ? (*prior.covariance)(0, 0) : prior.variance, names, out.checkpoints);
    return out;
}

}  // namespace rlslab::compare
