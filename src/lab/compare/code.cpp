// The filter of a comparison as a program's text: C++, C++ for a microcontroller, C, Python. A template each.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/words.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

/// The arithmetics of the hardware, named as in C++, the shortest first.
constexpr std::string_view hardware[] = {"float", "double"};

/// "first, second, third" in lines of text_width; it begins at column `at`, further lines with `indent`.
std::string listed(std::vector<std::string> const& items, std::string const& indent, size_t at) {
    std::string out;
    for (size_t i = 0; i < items.size(); ++i) {
        std::string const item = items[i] + (i + 1 < items.size() ? "," : "");
        if (i > 0 && at + 1 + item.size() > text_width) {
            out += '\n' + indent;
            at = indent.size();
        } else if (i > 0) {
            out += ' ';
            ++at;
        }
        out += item;
        at += item.size();
    }
    return out;
}

std::string comment(std::string const& mark, std::string const& head, std::vector<std::string> const& items) {
    std::string const begin = mark + " " + head + "(";
    return begin + listed(items, mark + std::string(begin.size() - mark.size(), ' '), begin.size()) + ")\n";
}

/// The model, and the order and signs of the regressors.
std::string model_text(Comparison const& c, std::string const& mark) {
    std::string out =
        comment(mark, fmt::format("{} = psi'theta,  psi = ", c.model.output.empty() ? "y" : c.model.output),
                c.model.regressors) +
        comment(mark, "theta = ", c.names);
    std::vector<std::string> means;
    for (auto const& [column, mean] : c.model.means) means.push_back(fmt::format("{} less {}", column, mean));
    return out + (means.empty() ? "" : comment(mark, "the columns as the filter takes them: ", means));
}

/// With a point: a whole number may not narrow to float.
std::string number(double x) { return fmt::format("{:#}", x); }
/// `begin`, the numbers, `end`.
std::string numbers(std::string const& begin, std::vector<double> const& x, char const* end) {
    std::vector<std::string> out;
    for (double const one : x) out.push_back(number(one));
    size_t const line = begin.rfind('\n') + 1;
    return begin + listed(out, std::string(begin.size() - line, ' '), begin.size() - line) + end;
}

std::vector<double> diagonal(Comparison const& c) {
    Vector<double> const P0 = c.scaled_prior->prior().covariance->diagonal();
    return {P0.begin(), P0.end()};
}

/// ".noise_variance = 0.25, .memory = 100.0": the names of the rule's members, in the order of the control's numbers.
std::string members(Composition const& c) {
    std::vector<ControlParameter> const& parameters = control_named(c.control).parameters;
    std::vector<std::string> out;
    for (size_t i = 0; i < parameters.size(); ++i)
        out.push_back(parameters[i].whole ? fmt::format(".{} = {}", parameters[i].member, Index(c.parameters[i]))
                                          : fmt::format(".{} = {:#}", parameters[i].member, c.parameters[i]));
    return fmt::format("{{{}}}", fmt::join(out, ", "));
}

/// The headers of <rlslab/adapt/...> that the composition needs, a line each.
std::string composition_includes(Composition const& c) {
    std::vector<std::string_view> headers;
    if (!c.keeps_the_problem()) headers.push_back(control_named(c.control).header);
    if (!c.guard.empty()) headers.emplace_back("adapt/guard");
    if (c.window > 0) headers.emplace_back("adapt/window");
    std::string out;
    for (std::string_view const header : headers) out += fmt::format("#include <rlslab/{}.hpp>\n", header);
    return out;
}

/// The definition of `filter` around the type, which stands as text, of problem, which is defined above it.
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

std::string cpp_text(Comparison const& c, CodedFilter const& filter) {
    std::string const& T = filter.arithmetic;
    Composition const& composition = c.options.composition;
    std::string out = filter.guarded ? "#include <rlslab/adapt/guard.hpp>\n" : composition_includes(composition);
    std::string const variant = fmt::format("#include <rlslab/variants/{}.hpp>\n", filter.variant);
    out += (out.find(variant) == out.npos ? variant : "") + "\n" + model_text(c, "//");
    if (!filter.exponents.empty()) {
        std::vector<std::string> factors;
        for (int const e : filter.exponents) factors.push_back(fmt::format("2^{}", e));
        out += comment("//", "then each regressor times ", factors);
        out += fmt::format(
            "// and the output times 2^{}; theta_i of the columns before that = theta_i times the regressor's factor "
            "times 2^{}\n",
            filter.output_exponent, -filter.output_exponent);
    }
    std::string prior = fmt::format("{{.variance = {}}}", number(c.options.p0.value_or(0)));
    if (c.scaled_prior) {
        out += numbers(fmt::format("rlslab::Vector<{}> const P0{{{{", T), diagonal(c), "}};\n");
        prior = "{.covariance = P0.asDiagonal()}";
    }
    constexpr Index largest_fixed = 16;  // a fixed size keeps everything in the object: no heap after the start
    std::string type = fmt::format("rlslab::{}<{}{}>", class_of(filter.variant), T,
                                   c.size <= largest_fixed ? fmt::format(", {}", c.size) : "");
    if (filter.guarded) type = fmt::format("rlslab::Guarded<{}>", type);
    std::string const problem = fmt::format("{{.size = {}, .forgetting = {}, .prior = rlslab::Prior<{}>{}}}", c.size,
                                            number(c.options.forgetting), T, prior);
    if (composition.empty()) out += fmt::format("{} filter({});\n", type, problem);
    else
        out += fmt::format("rlslab::Problem<{}> const problem{};\n", T, problem) +
               composition_code(composition, type, filter.variant, T, c.size);
    out +=
        filter.guarded || !composition.guard.empty()
            ? "// each row: filter.update(psi, y); filter.signal() is what the guard saw, filter.counts() how often\n"
            : "// a row: step = filter.update(psi, y); use theta() if step.health is sound\n";
    return out;
}

/// Regressor i is taken times this, and y times 2^output_exponent; `units`: a prior of one number stands for s_i.
std::vector<double> scales(Comparison const& c, CodedFilter const& filter, bool units) {
    std::vector<double> out(size_t(c.size), 1.0);
    for (size_t i = 0; i < out.size(); ++i) {
        if (!filter.exponents.empty()) out[i] = std::ldexp(1.0, filter.exponents[i]);
        if (units && c.scaled_prior) out[i] /= c.scaled_prior->s[Index(i)];
    }
    return out;
}

std::string board_text(Comparison const& c, CodedFilter const& filter) {
    std::string const& T = filter.arithmetic;
    std::vector<double> const scale = scales(c, filter, true);
    double const of_y = std::ldexp(1.0, filter.output_exponent);
    std::string const by_y = fmt::format("{}({})", T, number(of_y));
    bool const in_float = T == "float" && std::ranges::all_of(scale, [&](double x) {
                              return std::isnormal(float(x)) && std::isnormal(float(x / of_y));
                          });
    std::string const policy = c.options.composition.guard;
    std::string type = fmt::format("rlslab::{}<{}, {}>", class_of(filter.variant), T, c.size);
    bool const guarded = obstacle({.guard = "reset"}, filter.variant).empty();
    if (guarded)
        type = fmt::format("rlslab::Guarded<{}{}>", type,
                           policy.empty() ? "" : fmt::format(", rlslab::{}", find_policy(policy)->constant));
    return fmt::format(
        R"(// For a microcontroller: a filter without heap and exceptions (docs/embedded.md has the compiler's options).
{guard}#include <rlslab/variants/{variant}.hpp>

{model}// A row is taken times powers of two, so that the prior is one number. That changes no bit of a digit.
{scale}static {type} filter(
    {{.size = {d}, .forgetting = {lambda}, .prior = rlslab::Prior<{T}>{{.variance = {variance}}}}});

{about}rlslab::Step<{T}> take({R} const (&row)[{d}], {R} y) {{
    {T} psi[{d}];
    for (int i = 0; i < {d}; ++i) psi[i] = {T}(row[i] * scale[i]);
    return filter.update(psi, {T}(y{by}));
}}
/// In units of the rows as they come. To be used where the last step was sound.
void theta({R} (&out)[{d}]) {{
    auto const own = filter.theta();
    for (int i = 0; i < {d}; ++i) out[i] = own[i] * scale[i]{back};
}}
)",
        fmt::arg("guard", guarded ? "#include <rlslab/adapt/guard.hpp>\n" : ""), fmt::arg("variant", filter.variant),
        fmt::arg("model", model_text(c, "//")),
        fmt::arg("scale",
                 numbers(fmt::format("constexpr {} scale[] = {{", in_float ? "float" : "double"), scale, "};\n")),
        fmt::arg("type", type), fmt::arg("d", c.size), fmt::arg("lambda", number(c.options.forgetting)),
        fmt::arg("T", T), fmt::arg("R", in_float ? "float" : "double"), fmt::arg("by", of_y == 1 ? "" : " * " + by_y),
        fmt::arg("back", of_y == 1 ? "" : " / " + by_y),
        fmt::arg("variance", number(c.scaled_prior ? c.scaled_prior->c * c.scaled_prior->c : *c.options.p0)),
        fmt::arg("about",
                 guarded ? "/// A row as it comes. The guard skips what is not finite, and outliers; filter.signal()"
                           " says so. compare judged the\n/// form without it, unless it was asked for.\n"
                         : "/// A row as it comes.\n"));
}

std::string c_text(Comparison const& c, CodedFilter const& filter) {
    Composition const& composition = c.options.composition;
    std::string const guard = filter.guarded ? "reset" : composition.guard;
    std::string data, set;
    auto const option = [&](char const* name, auto const& value) {
        set += fmt::format("    options.{} = {};\n", name, value);
    };
    option("size", c.size);
    option("forgetting", number(c.options.forgetting));
    if (c.scaled_prior) {
        data = numbers("    static double const variances[] = {", diagonal(c), "};\n") +
               fmt::format("    static double P0[{}];\n    int i;\n", c.size * c.size);
        set += fmt::format("    for (i = 0; i < {}; ++i) P0[{} * i] = variances[i];\n", c.size, c.size + 1);
        option("prior_covariance", "P0");
    } else {
        option("prior_variance", number(*c.options.p0));
    }
    if (composition.window > 0) option("window", composition.window);
    if (!guard.empty()) option("guard", '"' + guard + '"');
    if (!composition.keeps_the_problem()) {
        data = numbers("    static double const numbers[] = {", composition.parameters, "};\n") + data;
        option("control", '"' + composition.control + '"');
        option("control_numbers", "numbers");
        option("control_count", composition.parameters.size());
    }
    std::string scaled;
    if (!filter.exponents.empty())
        scaled =
            fmt::format(R"(
{scale}// A row as it comes, taken times powers of two, without which its numbers leave the arithmetic.
rlslab_status take(rlslab_filter *filter, double const row[{d}], double y, rlslab_step *step) {{
    double psi[{d}];
    int i;
    for (i = 0; i < {d}; ++i) psi[i] = row[i] * scale[i];
    return rlslab_update(filter, psi, y * {of_y}, step);
}}
// In units of the rows as they come.
rlslab_status theta(rlslab_filter const *filter, double out[{d}]) {{
    rlslab_status const status = rlslab_theta(filter, out);
    int i;
    for (i = 0; status == RLSLAB_OK && i < {d}; ++i) out[i] *= scale[i] / {of_y};
    return status;
}}
)",
                        fmt::arg("scale", numbers("static double const scale[] = {", scales(c, filter, false), "};\n")),
                        fmt::arg("d", c.size), fmt::arg("of_y", number(std::ldexp(1.0, filter.output_exponent))));
    return fmt::format(
        R"(// C99: cc -std=c99 ... $(pkg-config --cflags --libs rlslab-c)
#include <rlslab.h>

{}
// A new filter, which rlslab_free ends; null: rlslab_message() says why.
rlslab_filter *new_filter(void) {{
    rlslab_options options;
    rlslab_filter *filter = 0;
{}    rlslab_defaults(&options, sizeof options);
{}    rlslab_new("{}", "{}", &options, &filter);
    return filter;
}}
{})",
        model_text(c, "//"), data, set, filter.variant, filter.arithmetic,
        scaled.empty() ? "// a row: rlslab_update(filter, psi, y, &step); use theta if step.health is 0\n" : scaled);
}

std::string python_text(Comparison const& c, CodedFilter const& filter) {
    Composition const& composition = c.options.composition;
    std::string const guard = filter.guarded ? "reset" : composition.guard;
    std::string options = fmt::format("forgetting={}", number(c.options.forgetting));
    if (composition.window > 0) options += fmt::format(", window={}", composition.window);
    if (!guard.empty()) options += fmt::format(", guard=\"{}\"", guard);
    if (!composition.keeps_the_problem())
        options += fmt::format(", control=(\"{}\", {})", composition.control, fmt::join(composition.parameters, ", "));
    if (c.scaled_prior) options += numbers(",\n    prior_covariance=np.diag([", diagonal(c), "]),");
    else options += fmt::format(", prior_variance={}", number(*c.options.p0));
    bool const scaled = !filter.exponents.empty();
    std::string const of_y = number(std::ldexp(1.0, filter.output_exponent)), psi = scaled ? "psi * scale" : "psi",
                      y = scaled ? "y * " + of_y : "y", theta = scaled ? "f.theta * scale / " + of_y : "f.theta";
    return fmt::format(R"({}import rlslab

{}{}f = rlslab.filter(
    "{}", {}, dtype="{}", {}
)
# a row: step = f.update({}, {}); use {} if step.health is "sound"
)",
                       c.scaled_prior || scaled ? "import numpy as np\n" : "", model_text(c, "#"),
                       scaled ? numbers("scale = np.array([", scales(c, filter, false), "])\n") : "", filter.variant,
                       c.size, filter.arithmetic == "float" ? "float32" : "float64", options, psi, y, theta);
}

struct Door {
    std::string_view word;
    std::string (*text)(Comparison const&, CodedFilter const&);
};
constexpr Door doors[] = {{"board", board_text}, {"c", c_text}, {"cpp", cpp_text}, {"python", python_text}};

}  // namespace

std::vector<std::string_view> code_words() {
    std::vector<std::string_view> out;
    for (Door const& door : doors) out.push_back(door.word);
    return out;
}

Recommendation const* coded(Comparison const& c) {
    for (std::string_view const name : hardware)
        for (Recommendation const& r : c.recommendations)
            if (r.arithmetic == name && !r.variant.empty()) return &r;
    return nullptr;
}

std::string code(Comparison const& c, std::string_view word) {
    if (c.digits) return code(*c.digits, word);
    Recommendation const* const r = coded(c);
    return r ? code(c, {.variant = r->variant, .arithmetic = r->arithmetic}, word) : "";
}

std::string code(Comparison const& c, CodedFilter const& filter, std::string_view word) {
    if (std::ranges::find(hardware, filter.arithmetic) == std::end(hardware)) return "";
    return std::ranges::find(doors, word, &Door::word)->text(c, filter);
}

}  // namespace rlslab::compare
