// A filter processes the rows. Its stored P is tested after each row; theta and P are compared with the reference at
// the checkpoints. Fast forms are compared by their predictions.
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/answer.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/fast/fast.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
namespace {

constexpr size_t least_draws = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Rows first ... last-1 of the problem in this order, one by one or as a block.
Health process_rows(AnyFilter& filter, Records const& records, std::vector<Index> const& order, Index first, Index last,
                    Index block) {
    if (block > 1)
        return order.empty() ? filter.update_block(records, first, last).health
                             : filter
                                   .update_block(in_order(records, {order.begin() + first, order.begin() + last}), 0,
                                                 last - first)
                                   .health;
    Index const k = order.empty() ? first : order[size_t(first)];
    return filter.update(records.sample(k), records.y[k]).health;
}

std::optional<double> asymmetry_of(Stored<Reference> const& stored) {
    if (stored.form == Stored<Reference>::Form::factor) return 0.0;
    Reference difference = 0, largest = 0;
    for (Index j = 0; j < stored.F.cols(); ++j)
        for (Index i = 0; i < stored.F.rows(); ++i) {
            if (!is_finite(stored.F(i, j))) return {};
            difference = std::max(difference, absolute(Reference(stored.F(i, j) - stored.F(j, i))));
            largest = std::max(largest, absolute(stored.F(i, j)));
        }
    return largest == 0 ? 0.0 : static_cast<double>(difference / largest);
}

std::vector<double> sorted(std::vector<std::optional<double>> const& digits) {
    std::vector<double> out;
    for (auto const& x : digits) out.push_back(x.value_or(-infinity));
    std::ranges::sort(out);
    return out;
}
size_t lowest_tenth(size_t count) { return size_t(std::floor(0.1 * double(count - 1))); }

constexpr double within = 0.5, hopeless = 2;  // digits

/// Odd numbers over a power of two, of few bits.
constexpr double factors[] = {1,          15. / 16,   31. / 32,   29. / 32,  27. / 32,   63. / 64,
                              61. / 64,   59. / 64,   57. / 64,   55. / 64,  127. / 128, 125. / 128,
                              123. / 128, 121. / 128, 119. / 128, 117. / 128};

/// The median of one run, as the spread has it; counted from row 2 d on.
double median_of(Run const& run, size_t measure, std::vector<Index> const& checkpoints, Index from) {
    std::vector<std::optional<double>> all;
    for (size_t c = 0; c < run.digits.size(); ++c)
        if (checkpoints[c] >= from) all.push_back(run.digits[c].*Digits::all()[measure]);
    return all.empty() ? std::nan("") : spread_of(all).median;
}

}  // namespace

double digits_of(Reference const& error, Reference const& size) {
    if (!is_finite(error) || !is_finite(size)) return std::numeric_limits<double>::quiet_NaN();
    if (error == 0) return infinity;
    return size == 0 ? -infinity : -correctly::log10(static_cast<double>(absolute(Reference(error / size))));
}

std::optional<double> at_most(double digits, double most) {
    if (std::isnan(digits)) return {};
    return std::min(digits, most);
}

Spread spread_of(std::vector<std::optional<double>> const& digits) {
    std::vector<double> const all = sorted(digits);
    double const last = double(all.size() - 1);
    auto const at = [&](size_t rank) { return std::round(10 * all[rank]) / 10; };
    return {at(lowest_tenth(all.size())), at(size_t(std::floor(0.5 * last))), at(size_t(std::ceil(0.9 * last)))};
}

Run run(AnyFilter& filter, Arithmetic const& arithmetic, Index block, RoundedProblem const& rounded,
        std::vector<Index> const& order, std::function<Digits(size_t)> const& digits_at) {
    Run out{};
    if (Health const kind = breakdown(filter, arithmetic); kind != Health::sound) out.breakdown = Breakdown{0, kind};
    Index const rows = rounded.records.rows();
    std::vector<Index> const checkpoints = checkpoints_of(rows);
    Foretold foretold(rounded.problem.forgetting, checkpoints.size());
    Index first = 0;
    for (size_t c = 0; c < checkpoints.size(); ++c) {
        while (first < checkpoints[c]) {
            Index const last = std::min(checkpoints[c], first + block);
            Health const health = process_rows(filter, rounded.records, order, first, last, block);
            first = last;
            if (out.breakdown) continue;
            if (Health const kind = breakdown(filter, arithmetic, health); kind != Health::sound)
                out.breakdown = Breakdown{last, kind};
        }
        if (digits_at) out.digits.push_back(digits_at(c));
        if (order.empty() && rounded.problem.forgetting < 1) foretold.look(checkpoints[c], filter.stored());
    }
    Stored<Reference> const last = filter.stored();
    out.theta = filter.theta();
    if (!out.breakdown && !is_finite(out.theta)) out.breakdown = Breakdown{rows, Health::nonfinite};
    if (!out.breakdown) out.foretold = foretold.row();
    out.asymmetry = asymmetry_of(last);
    out.factor = last.form == Stored<Reference>::Form::factor;
    return out;
}

Result result_of(CatalogueEntry const& entry, RoundedProblem const& rounded, Runs const& runs) {
    // Not in range: a zero where something positive should stand, or an infinity.
    if (runs.own.empty()) return {.entry = &entry, .breakdown = Breakdown{0, Health::indefinite}};
    Run const& first = runs.own.front();
    Result out{.entry = &entry,
               .runs = int(runs.own.size()),
               .breakdown = first.breakdown,
               .foretold = first.foretold,
               .factor = first.factor,
               .path = first.digits,
               .asymmetry = first.asymmetry};
    PerMeasure<std::vector<std::optional<double>>> all;
    std::vector<Index> const checkpoints = checkpoints_of(rounded.records.rows());
    Index const from = counted_from(rounded.records.rows(), rounded.records.parameters());
    auto const spread = [&](std::vector<Run> const& of, int& broken) -> std::optional<PerMeasure<Spread>> {
        all = {};
        for (Run const& one : of) {
            broken += one.breakdown.has_value();
            out.ends.push_back(one.theta);
            for (size_t c = 0; c < one.digits.size(); ++c)
                if (checkpoints[c] >= from)
                    for (size_t m = 0; m < 3; ++m) (all.*all.all()[m]).push_back(one.digits[c].*Digits::all()[m]);
        }
        if (all.theta.empty()) return {};
        return PerMeasure<Spread>{spread_of(all.theta), spread_of(all.worst), spread_of(all.covariance)};
    };
    out.others.runs = int(runs.others.size());
    out.others.spread = spread(runs.others, out.others.broken);
    out.spread = spread(runs.own, out.broken);
    if (out.path.empty()) return out;
    out.last = out.path.back();
    out.worst_low = sorted(all.worst)[lowest_tenth(all.worst.size())];
    return out;
}

Run run_of(CatalogueEntry const& entry, RoundedProblem const& rounded, size_t number, Seed draws) {
    Arithmetic const& arithmetic = *entry.arithmetic;
    double const most = arithmetic.decimal_digits();
    RowOrder const& order = rounded.orders[number];
    auto const filter = entry.make(rounded.problem, draws);
    std::function<Digits(size_t)> against_exact;
    if (!order.exact.empty())
        against_exact = [&](size_t c) {
            CertifiedSolution const& exact = order.exact[c];
            Vector<Reference> const theta = filter->theta();
            return Digits{at_most(exact.theta_digits(theta), most), at_most(exact.theta_digits_worst(theta), most),
                          at_most(exact.covariance_digits(filter->stored()), most)};
        };
    return run(*filter, arithmetic, entry.block, rounded, order.rows, against_exact);
}

Seed seed_of_run(std::uint64_t seed, size_t run) { return run == 0 ? Seed{seed} : Seed{Seed{seed + run}.next()}; }

Runs runs_of(CatalogueEntry const& entry, RoundedProblem const& rounded, std::uint64_t seed) {
    Runs out;
    for (size_t i = 0; rounded.in_range && i < rounded.orders.size(); ++i)
        (i == 0 ? out.own : out.others).push_back(run_of(entry, rounded, i, seed_of_run(seed, i)));
    return out;
}

Result score(CatalogueEntry const& entry, RoundedProblem const& rounded, std::uint64_t seed) {
    Runs runs = runs_of(entry, rounded, seed);
    for (size_t i = 1; entry.arithmetic->stochastic && !runs.own.empty() && i < least_draws; ++i)
        runs.own.push_back(run_of(entry, rounded, 0, seed_of_run(seed, rounded.orders.size() + i)));
    return result_of(entry, rounded, runs);
}

void Foretold::look(Index row, Stored<Reference> const& stored) {
    ++seen_;
    if (2 * seen_ < looks_ || !(forgetting_ < 1) || !grows_) return;
    grows_ = stored.form == Stored<Reference>::Form::plain;
    double largest = 0, share = 0;
    for (Index j = 0; j < stored.F.cols() && grows_; ++j)
        for (Index i = 0; i < j; ++i) {
            double const apart = std::abs(static_cast<double>(Reference(stored.F(i, j) - stored.F(j, i)))),
                         size = std::sqrt(static_cast<double>(stored.F(i, i))) *
                                std::sqrt(static_cast<double>(stored.F(j, j)));
            largest = std::max(largest, apart), share = std::max(share, apart / size);
        }
    double const growth = correctly::exp(-double(row - last_) * correctly::log(forgetting_));
    grows_ = grows_ && share > 0 && std::isfinite(share) && (largest_ == 0 || largest > 0.97 * growth * largest_);
    last_ = row, largest_ = largest, share_ = share;
}

std::optional<double> Foretold::row() const {
    if (!(forgetting_ < 1) || seen_ < 2 || !grows_ || !(share_ > 0)) return {};
    return double(last_) + std::max(0.0, correctly::log(share_) / correctly::log(forgetting_));
}

double rounded_row(double row) {
    double unit = 1;
    while (row >= 100 * unit) unit *= 10;
    return std::round(row / unit) * unit;
}

Records drawn(Records records, size_t draw) {
    double const factor = factors[draw % std::size(factors)];
    records.psi *= factor, records.y *= factor;
    return records;
}

size_t most_draws(Index rows, CompareOptions const& options) {
    if (!options.composition.empty()) return 1;
    constexpr Index together = Index(1) << 17;
    return size_t(std::clamp<Index>(together / std::max<Index>(rows, 1), 1, Index(std::size(factors))));
}

bool is_contender(Result const& r, std::vector<Result const*> const& sound) {
    return takes_single_rows(r) && is_sound(r) && loss_of(r, sound).digits <= hopeless;
}

bool settled(std::vector<Result const*> const& results, std::vector<Runs const*> const& runs,
             std::vector<Index> const& checkpoints, std::string const& named, std::string const& before) {
    if (named.empty() || named == before) return true;
    auto const place = [&](auto const& is_it) {
        return size_t(std::ranges::find_if(results, is_it) - results.begin());
    };
    size_t const of_named = place([&](Result const* r) { return r->entry->variant == named; });
    std::vector<Run> const& own = runs[of_named]->own;
    if (own.size() < 2) return false;
    Index const from = counted_from(checkpoints.back(), Index(own.front().theta.size()));
    for (size_t m = 0; m < 3; ++m) {
        size_t best = of_named;
        auto const mid = [&](size_t i) { return ((*results[i]->spread).*PerMeasure<Spread>::all()[m]).median; };
        for (size_t i = 0; i < results.size(); ++i)
            if (takes_single_rows(*results[i]) && is_sound(*results[i]) && runs[i]->own.size() == own.size() &&
                mid(i) > mid(best))
                best = i;
        double mean = 0, squares = 0;
        size_t const n = own.size();
        std::vector<double> lacks;
        for (size_t k = 0; k < n; ++k) {
            double const a = median_of(runs[best]->own[k], m, checkpoints, from),
                         b = median_of(own[k], m, checkpoints, from);
            lacks.push_back(a == b ? 0 : a - b);
            mean += lacks.back() / double(n);
        }
        for (double const x : lacks) squares += (x - mean) * (x - mean);
        if (!(mean + 2 * std::sqrt(squares / double(n * (n - 1))) <= within)) return false;
    }
    return true;
}

// --- fast forms: their prediction errors beside the certified ones ---------------------------------------------------

namespace {

/// The record as T stores it, with zeros before its first sample, and the certified theta at the checkpoints.
template <class T>
struct Line {
    FastProblem<T> problem;
    Records records;
    std::vector<CertifiedSolution> exact = {};

    Line(Records const& given, double forgetting, double p0, std::vector<Index> const& checkpoints)
        : problem{.size = given.parameters(), .forgetting = T(forgetting), .energy = T(1 / p0)},
          records{.psi = Matrix<double>::Zero(given.parameters(), given.rows()),
                  .y = Vector<double>(given.rows()),
                  .names = given.names} {
        for (Index k = 0; k < given.rows(); ++k) {
            for (Index i = problem.size - 1; i > 0 && k > 0; --i) records.psi(i, k) = records.psi(i - 1, k - 1);
            records.psi(0, k) = double(T(given.psi(0, k)));
            records.y[k] = double(T(given.y[k]));
        }
        Matrix<double> P0 = Matrix<double>::Zero(problem.size, problem.size);
        double p = 1 / double(problem.energy);
        for (Index i = 0; i < problem.size; ++i, p *= double(problem.forgetting)) P0(i, i) = p;
        Problem<double> const same{
            .size = problem.size, .forgetting = double(problem.forgetting), .prior = Prior<double>{.covariance = P0}};
        exact = certified(same, records, checkpoints);
    }
};

template <class F>
long operations_of(Index d) {
    F form({.size = d});
    using T = typename F::scalar;
    for (Index k = 0; k < d; ++k) form.update(T(double(k % 3)), T(1));
    return counted([&] { form.update(T(2), T(1)); }).total();
}

/// Nothing where T cannot hold the problem.
template <class T>
void score_in(Records const& given, double forgetting, double p0, std::vector<Index> const& checkpoints,
              std::vector<FastResult>& out) {
    if (!is_forgetting_factor(T(forgetting)) || !(T(0) < T(1 / p0)) || !is_finite(T(1 / p0))) return;
    Line<T> const line(given, forgetting, p0, checkpoints);
    for_each(FastForms<T>{}, [&]<class F>() {
        FastResult result{.form = F::name, .arithmetic = ArithmeticTraits<T>::name};
        F form(line.problem);
        Reference apart = 0, size = 0;
        bool finite = true;
        size_t next = 0;
        for (Index k = 0; k < line.records.rows(); ++k) {
            Step<T> const step = form.update(T(line.records.psi(0, k)), T(line.records.y[k]));
            if (step.health != Health::sound && !result.breakdown) result.breakdown = Breakdown{k + 1, step.health};
            if (next == checkpoints.size() || checkpoints[next] != k) continue;
            CertifiedSolution const& exact = line.exact[next++];
            if (exact.status() != Status::certified) continue;
            Vector<Reference> const theta = exact.theta();
            Reference e = line.records.y[k];
            for (Index i = 0; i < theta.size(); ++i) e -= theta[i] * line.records.psi(i, k);
            finite = finite && is_finite(step.innovation);
            if (!finite) continue;
            Reference const difference = Reference(double(step.innovation)) - e;
            apart += difference * difference, size += e * e;
        }
        double const most = ArithmeticTraits<T>::digits * correctly::log10(2.0);
        if (finite && size > 0)
            result.digits = apart > 0 ? std::min(most, -0.5 * correctly::log10(double(Reference(apart / size)))) : most;
        out.push_back(result);
    });
}

}  // namespace

bool is_delay_line(Records const& records) {
    Index const d = records.parameters(), N = records.rows();
    return d >= 2 && N >= 2 && records.psi.bottomRightCorner(d - 1, N - 1) == records.psi.topLeftCorner(d - 1, N - 1);
}

std::vector<FastResult> score_fast_forms(Records const& records, double forgetting, double p0,
                                         std::vector<std::string_view> const& arithmetics,
                                         std::vector<Index> const& checkpoints) {
    std::vector<FastResult> out;
    if (!is_delay_line(records)) return out;
    for (std::string_view const arithmetic : arithmetics) {
        if (arithmetic == "float") score_in<float>(records, forgetting, p0, checkpoints, out);
        if (arithmetic == "double") score_in<double>(records, forgetting, p0, checkpoints, out);
    }
    for_each(FastForms<Counted<double>>{}, [&]<class F>() {
        long const operations = operations_of<F>(records.parameters());
        for (FastResult& result : out)
            if (result.form == F::name) result.operations = operations;
    });
    return out;
}

}  // namespace rlslab::compare
