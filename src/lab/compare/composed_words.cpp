// The sentences of a comparison with a composition, and its C++.
#include "src/lab/compare/composed_words.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

/// ".noise_variance = 0.25, .memory = 100.0": the names of the rule's members, in the order of the control's numbers.
std::string members(Composition const& c) {
    std::vector<ControlParameter> const& parameters = control_named(c.control).parameters;
    std::vector<std::string> out;
    for (size_t i = 0; i < parameters.size(); ++i)
        out.push_back(parameters[i].whole ? fmt::format(".{} = {}", parameters[i].member, Index(c.parameters[i]))
                                          : fmt::format(".{} = {:#}", parameters[i].member, c.parameters[i]));
    return fmt::format("{{{}}}", fmt::join(out, ", "));
}
}  // namespace

std::string against_text(Comparison const& comparison) {
    Composition const& c = comparison.options.composition;
    if (!c.keeps_the_problem())
        return "against the same recursion in 257 bits (ud, checked by qr; kalman, which adds all of Q at each row, by "
               "itself)";
    std::string out = "against the certified least-squares solution of ";
    out += c.window > 0 ? "the rows in the window, with the prior" : "the rows so far";
    if (!c.guard.empty())
        out +=
            "; from the first row at which the guard changed anything on, against the same recursion in 257 bits (ud, "
            "checked by qr), whose guard decides by itself";
    return out;
}

std::string counts_text(Comparison const& comparison, Result const& r) {
    if (!r.obstacle.empty()) return r.obstacle;
    if (r.happened.empty()) return "";
    std::string const what = counts_text(r.happened.back());
    std::vector<std::string> out(what.empty() ? 0 : 1, what);
    if (comparison.options.composition.keeps_the_problem() && r.certified_to < comparison.rows)
        out.push_back(r.certified_to == 0 ? "recursion" : fmt::format("recursion from row {}", r.certified_to + 1));
    return fmt::format("{}", fmt::join(out, ", "));
}

std::vector<std::string> composition_warnings(Comparison const& c) {
    Composition const& of = c.options.composition;
    std::vector<std::string> out = warnings_of(of, c.rows, c.size);
    double const weighs = double(c.rows) / double(std::max<Index>(of.window, 1));
    if (of.window >= c.size && of.window < c.rows && !(c.component_bias * weighs <= most_component_bias / 10))
        out.push_back(
            fmt::format("the prior's bias is that of all rows; in a window of {} rows it is {:.2g} times as large",
                        of.window, weighs));
    return out;
}

std::string composition_includes(Composition const& c) {
    std::vector<std::string_view> headers;
    if (!c.keeps_the_problem()) headers.push_back(control_named(c.control).header);
    if (!c.guard.empty()) headers.emplace_back("adapt/guard");
    if (c.window > 0) headers.emplace_back("adapt/window");
    std::string out;
    for (std::string_view const header : headers) out += fmt::format("#include <rlslab/{}.hpp>\n", header);
    return out;
}

std::string composition_code(Composition const& c, std::string const& type, std::string const& variant,
                             std::string const& scalar, Index size) {
    if (is_its_own_rule(c, variant))
        return fmt::format("{} filter(problem, rlslab::Matrix<{}>::Identity({}, {}) * {}({:#}));\n", type, scalar, size,
                           size, scalar, c.parameters[0]);
    std::string inner = type, arguments = "problem";
    if (c.window > 0) {
        inner = fmt::format("rlslab::Windowed<{}>", type);
        arguments += fmt::format(", {{.rows = {}}}", c.window);
    }
    if (!c.keeps_the_problem()) {
        inner = fmt::format("rlslab::Forgetting<{}, rlslab::{}<{}>>", type, control_named(c.control).type, scalar);
        arguments += ", " + members(c);
    }
    if (c.guard.empty()) return fmt::format("{} filter({});\n", inner, arguments);
    return fmt::format("{} const unguarded({});\nrlslab::Guarded<{}, rlslab::{}> filter(unguarded, problem);\n", inner,
                       arguments, inner, find_policy(c.guard)->constant);
}

}  // namespace rlslab::compare
