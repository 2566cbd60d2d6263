// What is odd about a record: each sentence stands here once; outliers (outliers.hpp).
#include <rlslab/model/doubts.hpp>

#include <rlslab/model/default_prior.hpp>
#include <rlslab/model/outliers.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab {

std::string row_text(Outlier const& o) {
    return o.line == o.row ? fmt::format("row {}", o.row) : fmt::format("row {} (line {})", o.row, o.line);
}

std::string sentence_on(Outlier const& o, bool guarded) {
    std::string const advice = o.held_out ? "The held-out fit says little. "
                                          : "Do not believe the estimate, nor that residuals pass for white. ";
    return fmt::format(
        "{} is {:.2g} standard deviations off what the model predicts{}: it alone has {:.3g} % of the sum of "
        "squares{}. {}If it is wrong, or a row just before it, empty that cell, and it is skipped; {}",
        row_text(o), o.deviations, o.held_out ? ", in the part held out" : "", 100 * o.share,
        o.held_out ? " there" : "", o.dominates() ? advice : "",
        guarded ? "the guard leaves such rows out as they come, least squares has them"
                : "--guard reset leaves such rows out as they come");
}

std::vector<Index> dependent_but_for_rounding(Records const& records, Scatter const& free,
                                              Vector<double> const& resolution) {
    Index const d = records.parameters();
    Vector<double> const s = regressor_scales(records);
    Index i = 0;
    for (Index j = 1; j < d; ++j)
        if (s[j] * free.sd[j] > s[i] * free.sd[i]) i = j;
    Vector<double> w(d);
    double rounding = 0, largest = 0;
    for (Index j = 0; j < d; ++j) {
        w[j] = free.correlation(i, j) * free.sd[j] / free.sd[i];
        rounding += w[j] * w[j] * resolution[j] * resolution[j] / 12;
        largest = std::max(largest, std::abs(w[j]) * s[j]);
    }
    double const unexplained = 1 / (free.freedom + double(d)) / free.sd[i] / free.sd[i];
    std::vector<Index> out;
    for (Index j = 0; j < d && unexplained < 4 * rounding; ++j)
        if (std::abs(w[j]) * s[j] > 1e-3 * largest) out.push_back(j);
    return out;
}

std::string names_of(std::vector<Index> const& places, std::vector<std::string> const& regressors) {
    if (places.size() > 8) return fmt::format("{} of the {} regressors", places.size(), regressors.size());
    std::vector<std::string> names;
    for (Index const i : places) names.push_back(regressors[size_t(i)]);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string sentence_on_dependence(std::string const& names, std::string const& instead) {
    return fmt::format(
        "{} depend on one another but for the rounding of their numbers: this record does not determine their "
        "parameters, in whatever arithmetic: {}",
        names, instead);
}

// --- outliers: each value is compared with statistics of the others --------------------------------------------------

std::optional<LargestResidual> outlier_in(Signal residuals, Index lags) {
    double J = 0, count = 0, largest = 0;
    for (double const e : residuals)
        if (largest < std::abs(e)) largest = std::abs(e);
    if (!(largest > 0) || std::isinf(largest)) return {};
    for (double& e : residuals) e = std::ldexp(e, -std::ilogb(largest));  // so that no square is lost
    Index at = 0;
    for (size_t k = 0; k < residuals.size(); ++k) {
        double const e = residuals[k];
        if (std::isnan(e)) continue;
        J += e * e, ++count;
        if (!(std::abs(e) <= std::abs(residuals[size_t(at)]))) at = Index(k);
    }
    double const e = residuals[size_t(at)], F = e * e / ((J - e * e) / (count - 1));  // against the others
    if (count < 2 || !(J - e * e > 0 ? correctly::fisher_tail(1, count - 1, F) * count < 0.001 : count > 2)) return {};
    // As a past output it makes the residuals after it large, too.
    for (Index before = at; before >= std::max<Index>(0, at - lags); --before)
        if (std::abs(residuals[size_t(before)]) >= std::abs(e) / 2) at = before;
    double const square = residuals[size_t(at)] * residuals[size_t(at)];
    return LargestResidual{at, std::sqrt(square / (J / count)), square / J};
}

Spike largest_spike(Signal const& u, Index count) {
    double sum = 0, n = 0;
    for (Index k = 0; k < count; ++k)
        if (double const x = u[size_t(k)]; !std::isnan(x)) sum += x, ++n;
    Spike out;
    double most = 0, squares = 0;
    for (Index k = 0; k < count; ++k)
        if (double const off = u[size_t(k)] - sum / n; !std::isnan(off)) {
            squares += off * off;
            if (std::abs(off) > most) most = std::abs(off), out.row = k + 1;
        }
    // Without it the mean moves by most / (n - 1), and the squares lose it.
    double const others = squares - most * most * n / (n - 1);
    if (n > 2) out.deviations = others > 0 ? most * n / (n - 1) / std::sqrt(others / (n - 2)) : 0;
    return out;
}

}  // namespace rlslab
