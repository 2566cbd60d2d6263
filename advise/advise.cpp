// Tries one arithmetic after another by `compare`, with a prior that leaves the wanted digits.
#include "advise/advise.hpp"
#include "compare/recommend.hpp"
#include "compare/stored_problem.hpp"

#include <algorithm>
#include <cmath>

namespace rlslab {
namespace {

constexpr double margin = 0.3;                             // digits that the prior leaves beyond those wanted
constexpr double digits_a_doubling = 0.60205999132796239;  // 2 log10 2: the prior's weight falls with c^2
constexpr double most_doublings = 60;                      // of c: 36 digits

Comparison compared(Records const& records, AdviseOptions const& options, std::string const& arithmetic, double prior_times) {
    return compare(records, {.forgetting = options.forgetting,
                             .prior_times = prior_times,
                             .arithmetics = {arithmetic},
                             .seed = options.seed,
                             .threads = options.threads,
                             .timings = false});
}

/// (3), and all that follows for these columns.
Tried tried(Records const& records, AdviseOptions const& options, std::string const& arithmetic) {
    auto const left_by_prior = [](Comparison const& c) { return std::ranges::min(c.agreement); };
    Comparison comparison = compared(records, options, arithmetic, 1);
    if (double const missing = options.digits + margin - left_by_prior(comparison); missing > 0) {
        double const doublings = std::min(std::ceil(missing / digits_a_doubling), most_doublings);
        comparison = compared(records, options, arithmetic, std::ldexp(1.0, int(doublings)));
    }
    Tried out{.comparison = std::move(comparison), .scaling = {}, .from_prior = 0, .from_data = 99, .enough = {}, .nearest = nullptr};
    out.from_prior = left_by_prior(out.comparison);
    for (Storage const& s : out.comparison.storage) out.from_data = s.theta_digits.value_or(0);
    return out;
}

/// enough and nearest, whose pointers are into the comparison where it stays.
void rank(Tried& t, double digits) {
    for (Result const& r : t.comparison.results) {
        if (r.entry->block != 1 || !r.operations || r.broken > 0 || !r.spread) continue;
        double const here = kept(t, r);
        if (here >= digits) t.enough.push_back(&r);
        if (!t.nearest || here > kept(t, *t.nearest)) t.nearest = &r;
    }
    std::ranges::stable_sort(t.enough, [](Result const* a, Result const* b) { return preferred(*a, *b); });
}

double to_one(double scale) { return std::isfinite(scale) && scale > 0 ? std::ldexp(1.0, -std::ilogb(scale)) : 1; }

/// (4)
Records scaled(Records records, Vector<double>& columns, double& output) {
    columns = regressor_scales(records).unaryExpr([](double s) { return to_one(s); });
    output = to_one(std::sqrt(records.y.squaredNorm() / double(records.rows())));
    for (Index i = 0; i < records.parameters(); ++i) records.psi.row(i) *= columns[i];
    records.y *= output;
    return records;
}

/// Whether numbers of the record, or of P0, leave the arithmetic's range.
bool range_is_in_the_way(Tried const& t) {
    return std::ranges::any_of(t.comparison.storage, [](Storage const& s) { return !s.in_range || !s.theta_digits; }) || !t.nearest;
}

}  // namespace

double kept(Tried const& tried, Result const& result) { return std::min({result.spread->worst.low, tried.from_prior, tried.from_data}); }

Advice advise(Records const& records, AdviseOptions const& options, Progress const& progress) {
    Advice out{.options = options, .model = {}, .tried = {}, .guard = {}};
    out.tried.reserve(2 * options.arithmetics.size());  // results are pointed at
    for (size_t i = 0; i < options.arithmetics.size() && !out.chosen(); ++i) {
        out.tried.push_back(tried(records, options, options.arithmetics[i]));
        rank(out.tried.back(), options.digits);
        if (out.tried.back().enough.empty() && range_is_in_the_way(out.tried.back())) {
            Vector<double> columns;
            double output = 1;
            Tried again = tried(scaled(records, columns, output), options, options.arithmetics[i]);
            again.scaling = columns;
            again.output_scaling = output;
            out.tried.push_back(std::move(again));
            rank(out.tried.back(), options.digits);
        }
        if (progress) progress(double(i + 1) / double(options.arithmetics.size()));
    }
    if (Tried const* const t = out.chosen()) {
        Records taken = records;
        double output = 1;
        Vector<double> columns;
        if (t->scaling.size() > 0) taken = scaled(std::move(taken), columns, output);
        Problem<double> const problem{
            .size = records.parameters(), .forgetting = options.forgetting, .prior = t->comparison.scaled_prior->prior()};
        out.guard = guard_trial(out.choice()->entry->variant, out.choice()->entry->arithmetic->name, problem, taken);
    }
    return out;
}

}  // namespace rlslab
