// A composition in words; what follows from a record, and what is odd about it.
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/catalogue/composition.hpp>
#include <rlslab/catalogue/composition_text.hpp>
#include <rlslab/core/input_error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rlslab {

std::vector<std::string_view> const& composed_arithmetics() {
    static std::vector<std::string_view> const all{"float", "double"};
    return all;
}

bool needs_noise_variance(Composition const& c) {
    for (size_t i = 0; i < c.parameters.size(); ++i)
        if (std::isnan(c.parameters[i]) &&
            control_named(c.control).parameters.at(i).range.otherwise == RuleDefault::noise_variance)
            return true;
    return false;
}

Composition completed(Composition composition, Problem<double> const& problem, double noise_variance) {
    for (size_t i = 0; i < composition.parameters.size(); ++i) {
        double& x = composition.parameters[i];
        bool const of_noise =
            control_named(composition.control).parameters.at(i).range.otherwise == RuleDefault::noise_variance;
        if (std::isnan(x))
            x = of_noise                    ? noise_variance
                : problem.prior->covariance ? problem.prior->covariance->diagonal().maxCoeff()
                                            : problem.prior->variance;
        if (!std::isfinite(x) || (of_noise && !(x > 0)))
            throw InputError(fmt::format(
                "--control {}: expected its number: none follows from a record that the model fits exactly, or of "
                "whose residuals double cannot hold the squares",
                composition.control));
    }
    return composition;
}

std::vector<std::string> warnings_of(Composition const& c, Index rows, Index parameters) {
    std::vector<std::string> out;
    if (c.window >= std::max<Index>(rows, 1))
        out.push_back(
            fmt::format("the window of {} rows is as long as the record, or longer: no row leaves it", c.window));
    if (c.control == CovarianceReset<double>::name && c.parameters[0] > double(rows))
        out.emplace_back("the control resets P after the record's end: it did nothing");
    if (c.window > 0 && c.window < parameters)
        out.push_back(fmt::format("the window of {} does not determine {} parameters: the prior does",
                                  c.window == 1 ? "1 row" : fmt::format("{} rows", c.window), parameters));
    return out;
}

namespace {
std::string times(Index n, char const* one, char const* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

}  // namespace

std::string composition_text(Composition const& c) {
    std::vector<std::string> out;
    if (!c.control.empty()) {
        std::string text = "control " + c.control;
        Control const& control = control_named(c.control);
        for (size_t i = 0; i < c.parameters.size(); ++i)
            text += fmt::format("{} {} {}", i == 0 ? "," : " and", control.parameters[i].name, c.parameters[i]);
        out.push_back(text);
    }
    if (c.window > 0) out.push_back("window of " + times(c.window, "row", "rows"));
    if (!c.guard.empty()) out.push_back("guard " + c.guard);
    return fmt::format("{}", fmt::join(out, "; "));
}

std::string counts_text(CompositionCounts const& h) {
    std::vector<std::string> out;
    if (h.refactored > 0) out.push_back(fmt::format("factored anew {}", times(h.refactored, "time", "times")));
    if (h.unusable > 0) out.push_back(times(h.unusable, "unusable row", "unusable rows"));
    if (h.outliers > 0) out.push_back(times(h.outliers, "outlier", "outliers"));
    if (h.changes > 0) out.push_back(times(h.changes, "change", "changes"));
    if (h.windups > 0) out.push_back(fmt::format("windup in {}", times(h.windups, "row", "rows")));
    if (h.breakdowns > 0) out.push_back(times(h.breakdowns, "breakdown met", "breakdowns met"));
    return fmt::format("{}", fmt::join(out, ", "));
}

}  // namespace rlslab
