// The sentences of a comparison with a composition, and its C++.
#include "compare/composed_words.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

/// ".noise_variance = 0.25, .memory = 100.0": the names of the rule's members, in the order of the control's numbers.
std::string members(Composition const& c) {
    static std::vector<std::pair<std::string_view, std::vector<std::string_view>>> const names{
        {"fortescue", {"noise_variance", "memory", "least"}},
        {"kulhavy", {"forgetting", "least_excitation"}},
        {"cao_schwartz", {"forgetting", "least_excitation"}},
        {"ridge", {"ridge"}},
        {"reset", {"period", "variance"}},
        {"random_walk", {"variance"}}};
    auto const& of = std::ranges::find(names, c.control, &std::pair<std::string_view, std::vector<std::string_view>>::first)->second;
    std::vector<std::string> out;
    for (size_t i = 0; i < of.size(); ++i)
        out.push_back(of[i] == "period" ? fmt::format(".period = {}", Index(c.parameters[i]))
                                        : fmt::format(".{} = {:#}", of[i], c.parameters[i]));
    return fmt::format("{{{}}}", fmt::join(out, ", "));
}
std::string rule_type(std::string const& control) {
    if (control == "fortescue") return "Fortescue";
    if (control == "kulhavy") return "Kulhavy";
    if (control == "cao_schwartz") return "CaoSchwartz";
    if (control == "ridge") return "RotatingRidge";
    return control == "reset" ? "CovarianceReset" : "RandomWalk";
}
std::string policy_of(std::string const& guard) {
    if (guard == "report") return "reporting";
    if (guard == "reset") return "resetting";
    return guard == "rebuild" ? "rebuilding" : "handing_over";
}
}  // namespace

std::string against_text(Comparison const& comparison) {
    Composition const& c = comparison.options.composition;
    if (!c.keeps_the_problem())
        return "against the same recursion in 257 bits (ud, checked by qr; kalman, which adds all of Q at each row, by itself)";
    std::string out = "against the certified least-squares solution of ";
    out += c.window > 0 ? "the rows in the window, with the prior" : "the rows so far";
    if (!c.guard.empty())
        out +=
            "; from the first row at which the guard changed anything on, against the same recursion in 257 bits (ud, checked by qr), "
            "whose guard decides by itself";
    return out;
}

std::string happened_text(Comparison const& comparison, Result const& r) {
    if (!r.obstacle.empty()) return r.obstacle;
    if (r.happened.empty()) return "";
    std::string const what = happened_text(r.happened.back());
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
            fmt::format("the prior's bias is that of all rows; in a window of {} rows it is {:.2g} times as large", of.window, weighs));
    return out;
}

std::string composition_includes(Composition const& c, std::string const& scalar) {
    std::vector<std::string_view> headers;
    if (!c.keeps_the_problem()) headers.emplace_back("adapt/forgetting");
    if (!c.guard.empty()) headers.emplace_back("adapt/guard");
    if (c.guard == "hand_over") headers.insert(headers.end(), {"adapt/hand_over", "variants/ud"});
    if (c.guard == "hand_over" && scalar == "double") headers.emplace_back("arithmetic/quad");
    if (c.window > 0) headers.emplace_back("adapt/window");
    std::string out;
    for (std::string_view const header : headers) out += fmt::format("#include <rlslab/{}.hpp>\n", header);
    return out;
}

std::string composition_code(Composition const& c, std::string const& type, std::string const& variant, std::string const& scalar,
                             Index size) {
    if (c.control == "random_walk" && variant == "kalman" && c.guard.empty())
        return fmt::format("{} filter(problem, rlslab::Matrix<{}>::Identity({}, {}) * {}({:#}));\n", type, scalar, size, size, scalar,
                           c.parameters[0]);
    std::string inner = type, arguments = "problem";
    if (c.guard == "hand_over") {
        size_t const comma = type.find(',');  // before the fixed size
        inner = fmt::format("rlslab::Relay<{}, rlslab::Ud<{}{}>", type, scalar == "float" ? "double" : "rlslab::Quad",
                            comma == std::string::npos ? ">" : type.substr(comma));
    }
    if (c.window > 0) {
        inner = fmt::format("rlslab::Windowed<{}>", type);
        arguments += fmt::format(", {{.rows = {}}}", c.window);
    }
    if (!c.keeps_the_problem()) {
        inner = fmt::format("rlslab::Forgetting<{}, rlslab::{}<{}>>", type, rule_type(c.control), scalar);
        arguments += ", " + members(c);
    }
    if (c.guard.empty()) return fmt::format("{} filter({});\n", inner, arguments);
    return fmt::format("{} const unguarded({});\nrlslab::Guarded<{}, rlslab::{}> filter(unguarded, problem);\n", inner, arguments, inner,
                       policy_of(c.guard));
}

}  // namespace rlslab::compare
