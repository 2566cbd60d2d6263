// One arithmetic after another is compared, with a prior that leaves the digits that are wanted; the answer in words.
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/words.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

constexpr double margin = 0.3;                             // digits that the prior leaves beyond those wanted
constexpr double digits_a_doubling = 0.60205999132796239;  // 2 log10 2: the prior's weight falls with c^2

/// Those that the options name, in that order, or all; each once, and with one of the variants.
std::vector<Arithmetic const*> to_try(CompareOptions options) {
    options.composition = {};
    std::vector<Arithmetic const*> out = arithmetics_of(chosen(options));
    std::ranges::stable_sort(out, {}, [&](Arithmetic const* a) {
        return std::ranges::find_if(
            options.arithmetics, [&](std::string const& name) { return &arithmetic_named(name, "--arithmetic") == a; });
    });
    return out;
}

// --- (3) -------------------------------------------------------------------------------------------------------------

int exponent(double largest) { return largest > 0 ? std::ilogb(largest) : 0; }

Vector<double> largest_of_columns(Records const& records) { return records.psi.cwiseAbs().rowwise().maxCoeff(); }

/// Whether every number is well within the range.
bool fits(Records const& records, Arithmetic const& arithmetic) {
    auto const fits = [&](double x) { return x == 0 || std::abs(exponent(std::abs(x))) <= arithmetic.max_exp / 4; };
    return fits(records.y.cwiseAbs().maxCoeff()) && std::ranges::all_of(largest_of_columns(records), fits);
}

void choose_scaling(Records const& records, ArithmeticTrial& t) {
    for (double const x : largest_of_columns(records)) t.exponents.push_back(-exponent(x));
    t.output_exponent = -exponent(records.y.cwiseAbs().maxCoeff());
}

Records scaled(Records records, ArithmeticTrial const& t) {
    if (t.exponents.empty()) return records;
    for (Index i = 0; i < records.parameters(); ++i)
        for (double& x : records.psi.row(i)) x = std::ldexp(x, t.exponents[size_t(i)]);
    for (double& y : records.y) y = std::ldexp(y, t.output_exponent);
    return records;
}

// --- (4) -------------------------------------------------------------------------------------------------------------

Comparison compared(Records const& records, CompareOptions options, Arithmetic const& arithmetic, int doublings) {
    options.prior_times = std::ldexp(1.0, doublings);
    options.arithmetics = {std::string(arithmetic.name)};
    options.p0.reset();
    options.composition = {};
    options.timings = false;
    return compare(records, options);
}

/// Doublings of c after which P0 is still in range: P0_ii = (c / s_i)^2 below 2^(e - 8).
int most_doublings(DefaultPrior const& prior, Arithmetic const& arithmetic) {
    int const largest = 2 * (std::ilogb(prior.c) - std::ilogb(prior.s.minCoeff()));
    return std::max(0, (std::min(arithmetic.max_exp, 1000) - 8 - largest) / 2);
}

Comparison with_a_prior_that_leaves_digits(Records const& records, std::vector<bool> const& is_zero,
                                           CompareOptions const& options, Arithmetic const& arithmetic) {
    Comparison out = compared(records, options, arithmetic, 0);
    int const most = most_doublings(*out.scaled_prior, arithmetic);
    for (int doublings = 0; doublings < most;) {
        double left = 99;  // by the prior, of what has digits
        for (size_t i = 0; i < out.agreement.size(); ++i)
            if (!is_zero[i]) left = std::min(left, out.agreement[i]);
        double const missing = std::min(wanted_digits(options), arithmetic.decimal_digits()) + margin - left;
        if (missing <= 0) break;
        // by the law of the norm; a component may ask for more
        doublings = std::min(doublings + int(std::ceil(missing / digits_a_doubling)), most);
        out = compared(records, options, arithmetic, doublings);
    }
    return out;
}

// --- (1), (2), (5) ---------------------------------------------------------------------------------------------------

/// Parameters that are zero, as far as the certificate tells: below 1e-38 of the largest, in units of their regressors.
std::vector<bool> zeros_of(Vector<Reference> const& exact, Records const& records) {
    Vector<double> const s = regressor_scales(records);
    Reference largest = 0;
    std::vector<Reference> sizes;
    for (Index i = 0; i < exact.size(); ++i) {
        sizes.push_back(absolute(Reference(exact[i] * Reference(s[i]))));
        largest = std::max(largest, sizes.back());
    }
    std::vector<bool> out;
    for (Reference const& size : sizes) out.push_back(!(size > largest * Reference(1e-38)));
    return out;
}

/// Digits of the worst parameter that is not zero.
double worst_digits(Vector<Reference> const& theta, Vector<Reference> const& exact, std::vector<bool> const& is_zero) {
    double out = INFINITY;
    for (Index i = 0; i < theta.size(); ++i) {
        if (!is_finite(theta[i])) return -INFINITY;
        if (!is_zero[size_t(i)]) out = std::min(out, digits_of(Reference(theta[i] - exact[i]), exact[i]));
    }
    return out;
}

static_assert(std::is_nothrow_move_constructible_v<ArithmeticTrial> &&
              !std::is_copy_constructible_v<ArithmeticTrial>);  // see there

/// Scaled where the numbers, or the prior proposed for them, leave the range.
ArithmeticTrial tried(Records const& records, CompareOptions const& options, Arithmetic const& arithmetic, bool scale) {
    ArithmeticTrial out;
    out.arithmetic = arithmetic.name;
    out.wanted = wanted_digits(options);
    if (scale) choose_scaling(records, out);
    Records const taken = scaled(records, out);
    Vector<Reference> const exact =
        certified({.size = taken.parameters(), .forgetting = options.forgetting, .prior = std::nullopt}, taken,
                  {taken.rows()})
            .front()
            .theta();
    out.is_zero = zeros_of(exact, taken);
    out.comparison = with_a_prior_that_leaves_digits(taken, out.is_zero, options, arithmetic);
    for (RoundingEffect const& s : out.comparison.rounding) out.in_range = s.in_range;
    if (!out.in_range && !scale) return tried(records, options, arithmetic, true);
    std::vector<Result const*> sound;
    for (Result const& r : out.comparison.results)
        if (takes_single_rows(r) && is_sound(r)) sound.push_back(&r);
    for (Result const* r : ranked(sound, out.wanted)) {
        double at_end = arithmetic.decimal_digits();
        for (Vector<Reference> const& theta : r->ends)
            at_end = std::min(at_end, worst_digits(theta, exact, out.is_zero));
        out.sound.push_back({r, r->worst_low, at_end});
    }
    return out;
}

/// nullopt for an arithmetic other than float and double, and for a variant that cannot be guarded.
std::optional<GuardTrial> guard_trial(CatalogueEntry const& entry, Problem<double> const& problem,
                                      Records const& records) {
    if (std::ranges::find(composed_arithmetics(), entry.arithmetic->name) == composed_arithmetics().end()) return {};
    auto const alone = entry.make(problem, Seed{1});
    auto const guarded = composed({.guard = "reset"}, entry.variant, entry.arithmetic->name, problem);
    if (!guarded) return {};
    bool same_bits = true;
    for (Index k = 0; k < records.rows(); ++k) {
        alone->update(records.sample(k), records.y[k]);
        guarded->update(records.sample(k), records.y[k]);
        same_bits = same_bits && alone->theta() == guarded->theta();
    }
    return GuardTrial{guarded->counts(), same_bits};
}

}  // namespace

std::vector<std::string> ArithmeticTrial::zeros() const {
    std::vector<std::string> out;
    for (size_t i = 0; i < is_zero.size(); ++i)
        if (is_zero[i]) out.push_back(comparison.names[i]);
    return out;
}
KeptDigits const* ArithmeticTrial::first_enough() const {
    auto const found = std::ranges::find_if(sound, [&](KeptDigits const& k) { return k.both() >= wanted; });
    return found == sound.end() ? nullptr : &*found;
}
KeptDigits const* ArithmeticTrial::most() const {
    return sound.empty() ? nullptr : &*std::ranges::max_element(sound, {}, &KeptDigits::both);
}

DigitsAnswer digits_answer(Records const& records, CompareOptions const& options, ModelText const& model,
                           Progress const& progress) {
    DigitsAnswer out{.wanted = wanted_digits(options), .trials = {}, .guard = {}};
    std::vector<Arithmetic const*> const arithmetics = to_try(options);
    for (Arithmetic const* const a : arithmetics) {
        out.trials.push_back(tried(records, options, *a, !fits(records, *a)));
        out.trials.back().comparison.model = model;
        if (progress) progress(double(out.trials.size()) / double(arithmetics.size()));
        if (out.chosen()) break;
    }
    if (ArithmeticTrial const* const t = out.chosen()) {
        Problem<double> const problem{.size = records.parameters(),
                                      .forgetting = options.forgetting,
                                      .prior = t->comparison.scaled_prior->prior()};
        out.guard = guard_trial(*out.choice()->result->entry, problem, scaled(records, *t));
    }
    return out;
}

// --- the answer, in words and in C++ to paste ------------------------------------------------------------------------

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
    return fmt::format(
        "regressors times 2^{}, output times 2^{}; theta_i of the columns as given is theta_i times the regressor's "
        "factor times 2^{}",
        fmt::join(t.exponents, ", 2^"), t.output_exponent, -t.output_exponent);
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
