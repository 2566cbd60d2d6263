// Each sentence stands here once.
#include <rlslab/model/doubts.hpp>

#include <rlslab/model/default_prior.hpp>

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

}  // namespace rlslab
