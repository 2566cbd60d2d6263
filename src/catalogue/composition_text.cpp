// The words of a composition.
#include <rlslab/catalogue/composition_text.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab {
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
