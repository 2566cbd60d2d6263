// What keeps the digits that are wanted: in words, and in C++ to paste.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/words.hpp"

#include <rlslab/input/text.hpp>

#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

std::string bold(std::string const& text, bool colour) { return colour ? "\x1b[1m" + text + "\x1b[0m" : text; }

std::string digits_text(double digits) { return digits > 0 ? fmt::format("{:.1f}", tenth_below(digits)) : "no"; }

/// Why an arithmetic is not the answer.
std::string failing(ArithmeticTrial const& t) {
    std::string const where = t.exponents.empty() ? t.arithmetic : t.arithmetic + ", columns scaled";
    if (!t.in_range) return where + ": P0 or lambda leaves its range";
    KeptDigits const* const most = t.most();
    if (!most) return where + ": every variant that takes single rows broke down";
    std::string out = fmt::format("{}: {} keeps {} digits along the record, {} of least squares at the end", where,
                                  most->result->entry->variant, digits_text(most->along), digits_text(most->at_end));
    for (RoundingEffect const& s : t.comparison.rounding)
        if (s.theta_digits && *s.theta_digits < t.wanted)
            out += fmt::format("; rounding the data to it leaves {} of theta", digits_text(*s.theta_digits));
    return out;
}

std::string scaling_text(ArithmeticTrial const& t) {
    if (t.exponents.empty()) return "none: P0 is scaled to the columns";
    std::vector<std::string> factors;
    for (int const e : t.exponents) factors.push_back(fmt::format("2^{}", e));
    return fmt::format(
        "regressors times {}, output times 2^{}; theta_i of the columns as given is theta_i times the regressor's "
        "factor times 2^{}",
        fmt::join(factors, ", "), t.output_exponent, -t.output_exponent);
}

std::string guard_text(DigitsAnswer const& a) {
    if (!a.guard)
        return fmt::format("not tried: there is none for {} in {}", a.choice()->result->entry->variant,
                           a.chosen()->arithmetic);
    CompositionCounts const& n = a.guard->counts;
    std::string const met = fmt::format("{} outliers, {} changes, {} windups, {} breakdowns, {} unusable rows",
                                        n.outliers, n.changes, n.windups, n.breakdowns, n.unusable);
    if (a.guard->same_bits)
        return fmt::format("Guarded<> with its default policy changed no number of theta after any row ({})", met);
    return fmt::format(
        "Guarded<> with its default policy is in the code and was at work on this record ({}): its theta departs from "
        "the least squares of all rows, of which the digits here are. Leave it out if those rows are to count as the "
        "others do",
        met);
}

}  // namespace

std::string code(DigitsAnswer const& a, std::string_view word) {
    ArithmeticTrial const* const t = a.chosen();
    return t ? code(t->comparison,
                    {.variant = std::string(a.choice()->result->entry->variant),
                     .arithmetic = t->arithmetic,
                     .guarded = a.guarded(),
                     .exponents = t->exponents,
                     .output_exponent = t->output_exponent},
                    word)
             : "";
}

std::string answer_text(DigitsAnswer const& a, bool colour, size_t columns) {
    size_t const width = line_width(columns, text_width);
    auto const paragraph = [width](std::string const& text) { return wrapped(text, 0, 4, width) + "\n"; };
    auto const line = [width](std::string const& head, std::string const& text) {
        return "  " + head + std::string(12 - head.size(), ' ') + wrapped(text, 14, 14, width) + "\n";
    };
    std::string out =
        paragraph(fmt::format("wanted: {:g} digits of every parameter, those in which a filter agrees with the "
                              "least-squares solution for these data; how well the data determine that is another "
                              "question",
                              a.wanted));
    if (auto const none = a.trials.back().zeros(); !none.empty())
        out +=
            paragraph(fmt::format("{}: zero in the least-squares solution, and without digits", fmt::join(none, ", ")));
    for (ArithmeticTrial const& t : a.trials)
        if (!t.first_enough()) out += paragraph(failing(t));
    ArithmeticTrial const* const t = a.chosen();
    if (!t)
        return out + bold("nothing tried keeps them", colour) +
               "; what may: a longer arithmetic (--arithmetic), less dependent regressors\n";
    KeptDigits const& k = *a.choice();
    size_t const runs = k.result->ends.size();
    out += fmt::format("{}\n", bold(fmt::format("use {} in {}", k.result->entry->variant, t->arithmetic), colour));
    out +=
        line("keeps",
             fmt::format(
                 "{} digits of the worst parameter after the last row{}, against least squares for the data as given",
                 digits_text(k.at_end), runs > 1 ? fmt::format(" in each of {} runs", runs) : ""));
    out += line(
        "along",
        fmt::format(
            "{} digits at nine tenths of the checkpoints, against the solution there with this prior; never broke down",
            digits_text(k.along)));
    if (runs > 1) out += line("runs", "each with other draws of the rounding, or with the rows in another order");
    out += line("costs", fmt::format("{} operations a row", *k.result->operations));
    out +=
        line("prior", fmt::format("theta 0, P0 = diag({})", fmt::join(diagonal_of(*t->comparison.scaled_prior), ", ")));
    out += line("scaling", scaling_text(*t));
    out += line("guard", guard_text(a));
    std::vector<std::string> others;
    for (KeptDigits const& other : t->sound)
        if (&other != &k && other.both() >= t->wanted)
            others.push_back(fmt::format("{} {} ({})", other.result->entry->variant, digits_text(other.both()),
                                         *other.result->operations));
    out += line("also",
                others.empty() ? "no other variant" : fmt::format("{} (digits, operations)", fmt::join(others, ", ")));
    std::string const text = code(a);
    return out + (text.empty() ? fmt::format("\nno C++ here: {} is no type of the hardware\n", t->arithmetic)
                               : fmt::format("\n{}", columns > 0 ? folded(text, width) : text));
}

}  // namespace rlslab::compare
