// --control NAME:NUMBER:NUMBER, --window ROWS, --guard POLICY.
#include "src/lab/program/composition_options.hpp"

#include <rlslab/input/suggestion.hpp>

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::program {
using namespace report;
namespace {

/// "fortescue[:VARIANCE[:MEMORY[:LEAST]]]"; what must be given stands without brackets.
std::string usage(Control const& control) {
    std::string out(control.name), end;
    for (ControlParameter const& p : control.parameters) {
        bool const required = p.range.otherwise == RuleDefault::none;
        out += fmt::format("{}:{}", required ? "" : "[", p.name);
        if (!required) end += ']';
    }
    return out + end;
}

size_t numbers_needed(Control const& control) {
    size_t n = 0;
    for (size_t i = 0; i < control.parameters.size(); ++i)
        if (control.parameters[i].range.otherwise == RuleDefault::none) n = i + 1;
    return n;
}

double number_of(Control const& control, ControlParameter const& p, std::string const& text) {
    double x = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    auto const& [least, most, positive, otherwise, inverted] = p.range;
    bool const fits = least <= x && x <= most && !(positive && x == least) && (!p.whole || x == std::floor(x));
    if (error != std::errc() || end != text.data() + text.size() || !fits)
        refuse("--control {}: {}: expected a {} {} {}{}{}, found \"{}\"", control.name, p.name,
               p.whole ? "whole number" : "number", positive ? "above" : "from", least,
               most < 1e300 ? fmt::format(" to {}", most) : "",
               error == std::errc::result_out_of_range ? " that double can hold" : "", printable(text));
    return x;
}

}  // namespace

void define_composition(CLI::App& command, CompositionArguments& a) {
    std::vector<std::string> names;
    for (Control const& control : controls()) names.push_back(usage(control));
    std::vector<std::string> policies;
    for (NamedPolicy const& policy : guard_policies) policies.push_back(fmt::format("{} {}", policy.name, policy.what));
    define(command, {{"--control", a.control, "NAME", named("the name of a control"),
                      fmt::format("a rule of forgetting around the variant: {}", fmt::join(names, ", "))},
                     {"--window", a.window, "N", whole(1, 1000000000),
                      "an estimate from the last N rows: older ones are removed"},
                     {"--guard", a.guard, "POLICY", named("the name of a guard"),
                      fmt::format("a guard around the variant, which skips rows that are not finite: {}",
                                  fmt::join(policies, "; "))}});
}

std::string control_notes() {
    std::string out = "Controls, which are rules of forgetting:\n";
    for (Control const& control : controls()) {
        std::vector<std::string> starts;
        for (ControlParameter const& parameter : control.parameters)
            if (!std::isnan(parameter.start)) starts.push_back(fmt::format("{} {}", parameter.name, parameter.start));
        out += fmt::format("  {}:  {}{}\n", usage(control), control.what,
                           starts.empty() ? "" : fmt::format("; default {}", fmt::join(starts, ", ")));
    }
    return out;
}

Composition composition_of(CompositionArguments const& a, double forgetting) {
    Composition out{.window = a.window, .guard = a.guard};
    if (!a.guard.empty()) expect_one_of(guard_names(), a.guard, "--guard", "policy");
    if (!a.control.empty()) {
        size_t colon = std::min(a.control.find(':'), a.control.size());
        out.control = a.control.substr(0, colon);
        std::vector<std::string_view> known;
        for (Control const& control : controls()) known.push_back(control.name);
        expect_one_of(known, out.control, "--control", "control");
        Control const& control = control_named(out.control);
        std::vector<std::string> texts;
        while (colon < a.control.size()) {
            size_t const next = std::min(a.control.find(':', colon + 1), a.control.size());
            texts.push_back(a.control.substr(colon + 1, next - colon - 1));
            colon = next;
        }
        if (texts.size() > control.parameters.size() || texts.size() < numbers_needed(control))
            refuse("--control: expected {}, found \"{}\"", usage(control), printable(a.control));
        for (size_t i = 0; i < control.parameters.size(); ++i)
            out.parameters.push_back(i < texts.size() ? number_of(control, control.parameters[i], texts[i])
                                                      : control.parameters[i].start);
        if (control.below_one && forgetting == 1)
            refuse("--control {}: expected --forgetting below 1: without it nothing wears the prior down",
                   control.name);
    }
    if (std::string const why = contradiction(out); !why.empty())
        refuse("{}{}{}do not go together: {}", a.control.empty() ? "" : "--control ", a.window > 0 ? "--window " : "",
               a.guard.empty() ? "" : "--guard ", why);
    return out;
}

}  // namespace rlslab::program
