// A filter processes the rows. Its stored P is tested after each row; theta and P are compared with the exact ones at the checkpoints.
#include "compare/score.hpp"

#include <rlslab/catalogue/breakdown.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
using namespace report;
namespace {

constexpr int least_draws = 4;

std::optional<double> at_most(double digits, double largest) {
    if (std::isnan(digits)) return {};
    return std::min(digits, largest);
}

/// One pass over the rows in one order.
struct Run {
    std::vector<Digits> digits;  ///< at each checkpoint
    std::optional<Breakdown> breakdown;
    std::optional<double> asymmetry;
    bool factor;
    Vector<Reference> theta;  ///< after the last row
};

Run run(CatalogueEntry const& entry, StoredProblem const& stored, RowOrder const& order, Seed seed) {
    Run out{};
    Arithmetic const& arithmetic = *entry.arithmetic;
    bool const permuted = !order.rows.empty();
    auto const filter = entry.make(stored.problem, seed);
    if (std::string const kind = breakdown(*filter, arithmetic); !kind.empty()) out.breakdown = Breakdown{0, kind};
    Index first = 0;
    std::vector<Index> const checkpoints = checkpoints_of(stored.records.rows());
    for (size_t c = 0; c < checkpoints.size(); ++c) {
        while (first < checkpoints[c]) {
            Index const last = std::min(checkpoints[c], first + entry.block);
            Health health;
            if (entry.block == 1) {
                Index const k = permuted ? order.rows[size_t(first)] : first;
                health = filter->update(stored.records.sample(k), stored.records.y[k]).health;
            } else if (permuted) {
                health =
                    filter->update_block(in_order(stored.records, {order.rows.begin() + first, order.rows.begin() + last}), 0, last - first)
                        .health;
            } else {
                health = filter->update_block(stored.records, first, last).health;
            }
            first = last;
            if (out.breakdown) continue;
            std::string kind = breakdown(*filter, arithmetic);  // the stored numbers decide, not the step's health
            if (kind.empty() && health == Health::nonfinite && !is_finite(filter->theta())) kind = "nonfinite";
            if (!kind.empty()) out.breakdown = Breakdown{last, kind};
        }
        if (order.exact.empty()) continue;
        CertifiedSolution const& exact = order.exact[c];
        Vector<Reference> const theta = filter->theta();
        double const most = arithmetic.decimal_digits();
        out.digits.push_back({at_most(exact.theta_digits(theta), most), at_most(exact.theta_digits_worst(theta), most),
                              at_most(exact.covariance_digits(filter->stored()), most)});
    }
    Stored<Reference> const last = filter->stored();
    out.theta = filter->theta();
    if (!out.breakdown && !is_finite(out.theta)) out.breakdown = Breakdown{stored.records.rows(), "nonfinite"};
    out.asymmetry = asymmetry_of(last);
    out.factor = last.form == Stored<Reference>::Form::factor;
    return out;
}

std::vector<double> sorted(std::vector<std::optional<double>> const& digits) {
    std::vector<double> out;
    for (auto const& x : digits) out.push_back(x.value_or(-std::numeric_limits<double>::infinity()));
    std::ranges::sort(out);
    return out;
}
size_t lowest_tenth(size_t count) { return size_t(std::floor(0.1 * double(count - 1))); }

}  // namespace

Spread spread_of(std::vector<std::optional<double>> const& digits) {
    std::vector<double> const all = sorted(digits);
    double const last = double(all.size() - 1);
    auto const at = [&](size_t rank) { return std::round(10 * all[rank]) / 10; };
    return {at(lowest_tenth(all.size())), at(size_t(std::floor(0.5 * last))), at(size_t(std::ceil(0.9 * last)))};
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

void set_spread(Result& result, PerMeasure<std::vector<std::optional<double>>> const& all) {
    result.last = result.path.back();
    result.spread = {spread_of(all.theta), spread_of(all.worst), spread_of(all.covariance)};
    result.worst_low = sorted(all.worst)[lowest_tenth(all.worst.size())];
}

Result score(CatalogueEntry const& entry, StoredProblem const& stored, std::uint64_t seed) {
    Result result{.entry = &entry};
    if (!stored.in_range) {
        result.breakdown = Breakdown{0, "indefinite"};  // a zero where something positive should stand, or an infinity
        return result;
    }
    size_t const runs = std::max(stored.orders.size(), size_t(entry.arithmetic->stochastic ? least_draws : 1));
    Seed draws{seed};
    PerMeasure<std::vector<std::optional<double>>> all;
    std::vector<Index> const checkpoints = checkpoints_of(stored.records.rows());
    Index const settled = std::min(stored.records.rows(), 2 * stored.records.parameters());
    for (size_t i = 0; i < runs; ++i) {
        RowOrder const& order = stored.orders[i % stored.orders.size()];
        Run const one = run(entry, stored, order, i == 0 ? Seed{seed} : Seed{draws.next()});
        ++result.runs;
        result.broken += one.breakdown.has_value();
        result.ends.push_back(one.theta);
        for (size_t c = 0; c < one.digits.size(); ++c)
            if (checkpoints[c] >= settled)
                for (size_t m = 0; m < 3; ++m) (all.*all.all()[m]).push_back(one.digits[c].*Digits::all()[m]);
        if (i > 0) continue;
        result.breakdown = one.breakdown;
        result.asymmetry = one.asymmetry;
        result.factor = one.factor;
        result.path = one.digits;
    }
    if (!result.path.empty()) set_spread(result, all);
    return result;
}

}  // namespace rlslab::compare
