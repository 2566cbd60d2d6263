// Runs the comparison: each entry of the catalogue over the records, each step's stored P decided exactly, the last
// step's theta and P scored against the reference for the very bits the arithmetic was given.
#include "compare.hpp"

#include <rlslab/model/suggestion.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/probes.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <fmt/format.h>
#include <mutex>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

namespace rlslab {
namespace {

Problem<double> problem_for(Records const& records, CompareOptions const& options, double (*round)(double)) {
    return {.size = records.size(),
            .forgetting = round(options.forgetting),
            .prior = Prior<double>{.variance = round(options.p0)}};
}

double as_is(double x) { return x; }

Records rounded(Records const& records, double (*round)(double)) {
    Records out = records;
    out.psi = records.psi.unaryExpr(round);
    out.y = records.y.unaryExpr(round);
    return out;
}

/// What an arithmetic is compared with: the same problem with data, lambda and c^2 as it stores them.
struct Yardstick {
    Problem<double> problem;
    Records records;
    std::optional<Exact> exact;    ///< absent when the rounded problem has no exact solution (an overflow, a zero P0)
};

Yardstick yardstick(Records const& records, CompareOptions const& options, double (*round)(double), int digits) {
    Yardstick out{problem_for(records, options, round), rounded(records, round), {}};
    double const lambda = out.problem.forgetting, p0 = out.problem.prior->variance;
    if (!(0 < lambda && lambda <= 1 && 0 < p0 && std::isfinite(p0))) return out;
    std::vector<Exact> exact = certified(out.problem, out.records, {records.rows()}, digits);
    if (exact.front().status() == Status::certified) out.exact = std::move(exact.front());
    return out;
}

std::optional<double> number(double x, double largest) {
    if (std::isnan(x)) return {};
    return std::min(x, largest);
}

/// max |F_ij - F_ji| / max |F_ij|.
std::optional<double> asymmetry(Stored<Reference> const& stored) {
    if (stored.kind == Stored<Reference>::Kind::factor) return 0.0;
    Reference difference = 0, largest = 0;
    for (Index j = 0; j < stored.F.cols(); ++j)
        for (Index i = 0; i < stored.F.rows(); ++i) {
            if (!is_finite(stored.F(i, j))) return {};
            difference = std::max(difference, absolute(Reference(stored.F(i, j) - stored.F(j, i))));
            largest = std::max(largest, absolute(stored.F(i, j)));
        }
    return largest == 0 ? 0.0 : static_cast<double>(difference / largest);
}

Result run(Entry const& entry, Yardstick const& yard, Seed seed) {
    Result result{&entry, {}, {}, {}};
    Arithmetic const& arithmetic = *entry.arithmetic;
    double const lambda = yard.problem.forgetting;
    if (!(0 < lambda && lambda <= 1) || !(0 < yard.problem.prior->variance)) {    // the arithmetic stores a zero
        result.breakdown = Breakdown{0, "indefinite"};
        return result;
    }
    auto const filter = entry.make(yard.problem, seed);
    Index const rows = yard.records.rows();
    std::string kind = breakdown(*filter, arithmetic);
    if (!kind.empty()) result.breakdown = Breakdown{0, kind};
    for (Index k = 0; k < rows; k += entry.block) {
        Index const last = std::min(rows, k + entry.block);
        Step<double> const step = entry.block == 1 ? filter->update(yard.records.row(k), yard.records.y[k])
                                                   : filter->absorb(yard.records, k, last);
        if (result.breakdown) continue;
        kind = breakdown(*filter, arithmetic);    // what is stored decides, not what the step saw of it
        if (kind.empty() && step.health == Health::nonfinite && !is_finite(filter->theta())) kind = "nonfinite";
        if (!kind.empty()) result.breakdown = Breakdown{last, kind};
    }
    Vector<Reference> const theta = filter->theta();
    Stored<Reference> const stored = filter->stored();
    if (!result.breakdown && !is_finite(theta)) result.breakdown = Breakdown{rows, "nonfinite"};
    result.asymmetry = asymmetry(stored);
    if (yard.exact) {
        double const most = arithmetic.decimal_digits();
        result.theta_digits = number(yard.exact->theta_digits(theta), most);
        result.theta_digits_worst = number(yard.exact->theta_digits_worst(theta), most);
        result.covariance_digits = number(yard.exact->covariance_digits(stored), most);
    }
    return result;
}

/// The sound variant with the fewest operations among those as good as the best: within `noise` of it in theta, in its
/// worst component and in P. That many digits the same variant gains or loses when rows are merely taken in another order.
/// Batch and sparse variants are not recommended: they answer another need than a row at a time.
Recommendation recommend(Arithmetic const& of, Comparison const& comparison) {
    std::string const arithmetic(of.name);
    std::vector<Result> const& results = comparison.results;
    double const noise = std::min(1.0, of.decimal_digits() / 4);
    if (comparison.prior_bias > most_prior_bias)
        return {arithmetic, "", fmt::format("the prior, not the data, decides theta (it moves it by {:.2g}): {} first", comparison.prior_bias,
                                            comparison.better_p0 ? "raise --p0" : "rescale the columns")};
    for (Storage const& s : comparison.storage) {
        if (s.arithmetic != of.name) continue;
        if (s.rank < comparison.size)
            return {arithmetic, "", fmt::format("stored so short the regressors have rank {} of {}: the prior decides theta", s.rank,
                                                comparison.size)};
        if (s.prior_bias > most_prior_bias)
            return {arithmetic, "", fmt::format("of the data stored so short the prior, not they, decides theta (it moves it by {:.2g})",
                                                s.prior_bias)};
    }
    std::vector<Result const*> sound;
    int tried = 0;
    for (Result const& r : results) {
        if (r.entry->arithmetic->name != of.name || r.entry->block != 1 || !r.operations) continue;
        ++tried;
        if (!r.breakdown && r.theta_digits && r.covariance_digits) sound.push_back(&r);
    }
    if (tried == 0) return {arithmetic, "", "no variant was tried that takes one row at a time"};
    if (sound.empty())
        return {arithmetic, "", fmt::format("none of {} row-at-a-time variants got through without breaking down", tried)};
    auto const digits = [](Result const* r) { return std::array{*r->theta_digits, *r->theta_digits_worst, *r->covariance_digits}; };
    auto const least = [&](Result const* r) { return std::ranges::min(digits(r)); };
    // The best is the one whose least of the three is greatest.
    Result const* const best = *std::ranges::max_element(sound, {}, least);
    std::vector<Result const*> good;
    for (Result const* r : sound) {
        auto const mine = digits(r), bests = digits(best);
        bool keeps = least(r) >= 0.5;
        for (size_t i = 0; i < mine.size(); ++i) keeps = keeps && mine[i] >= bests[i] - noise;
        if (keeps) good.push_back(r);
    }
    if (good.empty())
        return {arithmetic, "", fmt::format("none of {} row-at-a-time variants keeps half a digit of every component of theta and of P",
                                            tried)};
    std::ranges::stable_sort(good, {}, [](Result const* r) { return *r->operations; });
    std::vector<std::string_view> others;
    for (Result const* r : good)
        if (r != good.front()) others.push_back(r->entry->variant);
    Result const& choice = *good.front();
    std::string const why =
        others.empty() ? fmt::format("no other comes within {:.1f} digits of it", noise)
                       : fmt::format("with the fewest operations ({}) of those within {:.1f} digits of the best (then {})",
                                     *choice.operations, noise, fmt::join(others, ", "));
    return {arithmetic, std::string(choice.entry->variant),
            fmt::format("keeps {:.1f} digits of theta ({:.1f} of its worst component) and {:.1f} of P, {}; {} of {} row-at-a-time "
                        "variants came through sound{}",
                        *choice.theta_digits, *choice.theta_digits_worst, *choice.covariance_digits, why, sound.size(), tried,
                        of.stochastic ? fmt::format("; one draw, seed {}", comparison.options.seed) : "")};
}

/// The least p0 10^k whose bias is at most 1e-3; nothing within binary64's range has none.
std::optional<double> less_biased(Records const& records, CompareOptions const& options, Exact const& without) {
    CompareOptions other = options;
    for (int exponent = int(std::ceil(std::log10(options.p0))); exponent <= 300; ++exponent) {
        other.p0 = std::pow(10, exponent);
        auto const with = certified(problem_for(records, other, &as_is), records, {records.rows()});
        if (relative_change(with.front(), without) <= 1e-3) return other.p0;
    }
    return {};
}

std::vector<std::string> printable_names(Records const& records) {
    std::vector<std::string> names;
    for (std::string const& name : records.names) names.push_back(printable(name));
    return names;
}

/// What the rounding of the data to this arithmetic does to the exact answer.
Storage storage(Arithmetic const& arithmetic, Yardstick const& yard, Exact const& with_prior) {
    Problem<double> problem = yard.problem;
    problem.prior.reset();
    Storage out{arithmetic.name, problem.forgetting, 0, {}, std::numeric_limits<double>::quiet_NaN()};
    if (0 < problem.forgetting && yard.records.psi.allFinite() && yard.records.y.allFinite()) {
        Exact const without = certified(problem, yard.records, {yard.records.rows()}).front();
        out.rank = without.rank();
        if (yard.exact) out.prior_bias = relative_change(*yard.exact, without);
    }
    if (yard.exact) out.theta_digits = number(-std::log10(relative_change(*yard.exact, with_prior)), 15.9);
    return out;
}

/// " (constant: b0, b1)", or nothing: the commonest reason for dependence, by name.
std::string constant_regressors(Records const& records) {
    std::vector<std::string> names;
    for (Index i = 0; i < records.size(); ++i)
        if ((records.psi.row(i).array() == records.psi(i, 0)).all()) names.push_back(records.names[size_t(i)]);
    return names.empty() ? "" : fmt::format(" (constant: {})", fmt::join(names, ", "));
}

/// The entries asked for, in the catalogue's order.
std::vector<Entry const*> chosen(CompareOptions const& options) {
    std::vector<std::string_view> variants, scalars;
    for (Entry const& entry : catalogue())
        if (std::find(variants.begin(), variants.end(), entry.variant) == variants.end()) variants.push_back(entry.variant);
    for (Arithmetic const& arithmetic : arithmetics()) scalars.push_back(arithmetic.name);
    for (std::string const& name : options.variants) expect_one_of(variants, name, "--variants", "variant");
    for (std::string const& name : options.arithmetics) expect_one_of(scalars, name, "--arithmetic", "arithmetic");
    auto const wanted = [](std::vector<std::string> const& asked, std::string_view name) {
        return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
    };
    std::vector<Entry const*> out;
    for (Entry const& entry : catalogue())
        if (wanted(options.variants, entry.variant) && wanted(options.arithmetics, entry.arithmetic->name))
            out.push_back(&entry);
    if (out.empty()) throw InputError("--variants, --arithmetic: expected a variant that exists in one of the arithmetics");
    return out;
}

}  // namespace

Comparison compare(Records const& records, CompareOptions const& options, Progress const& progress) {
    std::vector<Entry const*> const entries = chosen(options);
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);

    // The data as they are: the reference that is shown, and whether they determine theta at all.
    Problem<double> problem = problem_for(records, options, &as_is);
    std::vector<Exact> const with_prior = certified(problem, records, {records.rows()});
    problem.prior.reset();
    std::vector<Exact> const without = certified(problem, records, {records.rows()});
    if (without.front().status() == Status::singular)
        throw InputError(fmt::format("the regressors are linearly dependent, so theta is not determined: exact rank {} of {} "
                                     "over {} rows{}",
                                     without.front().rank(), records.size(), records.rows(), constant_regressors(records)));
    Comparison out{.rows = records.rows(), .skipped = records.skipped, .size = records.size(), .names = printable_names(records),
                   .theta = with_prior.front().theta_strings(30), .radius = with_prior.front().radius(),
                   .bits = with_prior.front().bits(), .condition = condition(records, options.forgetting),
                   .prior_bias = relative_change(with_prior.front(), without.front()),
                   .options = options, .better_p0 = {}, .storage = {}, .results = {}, .recommendations = {}};

    if (out.prior_bias > most_prior_bias) out.better_p0 = less_biased(records, options, without.front());

    // One yardstick for each way of rounding the data: arithmetics that hold binary64 share one.
    std::vector<Arithmetic const*> used;
    for (Entry const* entry : entries)
        if (used.empty() || used.back() != entry->arithmetic) used.push_back(entry->arithmetic);
    int most_digits = 0;
    for (Arithmetic const* a : used) most_digits = std::max(most_digits, int(a->decimal_digits()));
    auto const yard_of = [&](Arithmetic const* a) { return a->digits >= 53 ? std::string_view("double") : a->name; };
    std::vector<std::pair<std::string_view, Yardstick>> yards;
    for (Arithmetic const* a : used)
        if (std::none_of(yards.begin(), yards.end(), [&](auto const& y) { return y.first == yard_of(a); })) {
            bool const wide = a->digits >= 53;
            yards.emplace_back(yard_of(a), yardstick(records, options, a->round, wide ? std::max(30, most_digits + 15) : 30));
            if (!wide) out.storage.push_back(storage(*a, yards.back().second, with_prior.front()));
        }

    out.results.assign(entries.size(), {});
    std::vector<size_t> order(entries.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = order.size() - 1 - i;    // the slow arithmetics first
    std::mutex one_at_a_time;
    size_t done = 0;
    arena.execute([&] {
        tbb::parallel_for_each(order.begin(), order.end(), [&](size_t i) {
            auto const yard = std::find_if(yards.begin(), yards.end(),
                                           [&](auto const& y) { return y.first == yard_of(entries[i]->arithmetic); });
            out.results[i] = run(*entries[i], yard->second, Seed{options.seed});
            std::lock_guard const lock(one_at_a_time);
            if (progress) progress(double(++done) / double(entries.size()));
        });
    });
    // Alone on the machine, as far as this program goes.
    for (size_t i = 0; i < entries.size(); ++i) {
        Problem<double> const rounded_problem = problem_for(records, options, entries[i]->arithmetic->round);
        if (auto const counted = cost(entries[i]->variant, records.size())) out.results[i].operations = counted->total();
        if (options.timings && out.results[i].breakdown.value_or(Breakdown{1, ""}).step > 0)
            out.results[i].ns_per_update = entries[i]->time(rounded_problem, records, Seed{options.seed});
    }
    for (Arithmetic const* a : used) out.recommendations.push_back(recommend(*a, out));
    return out;
}

}  // namespace rlslab
