// If more than half of the steps are equal, that step is their median.
#include <rlslab/input/counting.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rlslab {

std::optional<double> counting_step(std::vector<double> const& x) {
    std::vector<double> steps;
    double before = NAN;
    for (double const v : x) {
        if (std::isnan(v)) continue;
        if (v <= before) return std::nullopt;
        if (!std::isnan(before)) steps.push_back(v - before);
        before = v;
    }
    if (steps.size() + 1 < 10) return std::nullopt;
    auto const middle = steps.begin() + std::ssize(steps) / 2;
    std::ranges::nth_element(steps, middle);
    double const median = *middle;
    auto const same =
        std::ranges::count_if(steps, [&](double step) { return std::abs(step - median) <= 1e-6 * median; });
    return 2 * same > std::ssize(steps) ? std::optional(median) : std::nullopt;
}

std::vector<std::string> counting_warnings(Columns const& data, std::vector<std::string> const& columns) {
    std::vector<std::string> out;
    for (std::string const& name : columns)
        if (auto const step = counting_step(data[name]))
            out.push_back(fmt::format(
                "column {} counts upwards by steps of {:.6g}: a date, a time, the number of the row? As a regressor "
                "it is a trend",
                printable(name), *step));
    return out;
}

}  // namespace rlslab
