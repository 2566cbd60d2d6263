// Tries one arithmetic after another by `compare`, with a prior that leaves the wanted digits.
#include "advise/advise.hpp"
#include <rlslab/catalogue/catalogue.hpp>
#include "compare/recommend.hpp"

#include <rlslab/input/suggestion.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

constexpr double margin = 0.3;                             // digits that the prior leaves beyond those wanted
constexpr double digits_a_doubling = 0.60205999132796239;  // 2 log10 2: the prior's weight falls with c^2

std::vector<Arithmetic const*> asked(AdviseOptions const& options) {
    std::vector<std::string_view> names;
    for (Arithmetic const& a : arithmetics()) names.push_back(a.name);
    std::vector<Arithmetic const*> out;
    if (options.arithmetics.empty()) throw InputError("--arithmetic: expected at least one");
    for (std::string const& name : options.arithmetics) {
        expect_one_of(names, name, "--arithmetic", "arithmetic");
        Arithmetic const* const a = &*std::ranges::find(arithmetics(), name, &Arithmetic::name);
        if (std::ranges::find(out, a) != out.end()) throw InputError(fmt::format("--arithmetic: {} is named twice", name));
        out.push_back(a);
    }
    return out;
}

// --- (3) ------------------------------------------------------------------------------------------------------------------------

int exponent(double largest) { return largest > 0 ? std::ilogb(largest) : 0; }

/// exponents and output_exponent; none where no number asks for them.
void choose_scaling(Records const& records, Arithmetic const& arithmetic, Tried& t) {
    int const quarter = arithmetic.max_exp / 4;
    auto const fits = [&](double largest) { return largest == 0 || std::abs(exponent(largest)) <= quarter; };
    Vector<double> const columns = records.psi.cwiseAbs().rowwise().maxCoeff();
    double const output = records.y.cwiseAbs().maxCoeff();
    bool all = fits(output);
    for (double const x : columns) all = all && fits(x);
    if (all) return;
    for (double const x : columns) t.exponents.push_back(-exponent(x));
    t.output_exponent = -exponent(output);
}

Records scaled(Records records, Tried const& t) {
    if (t.exponents.empty()) return records;
    for (Index i = 0; i < records.parameters(); ++i)
        for (double& x : records.psi.row(i)) x = std::ldexp(x, t.exponents[size_t(i)]);
    for (double& y : records.y) y = std::ldexp(y, t.output_exponent);
    return records;
}

// --- (4) ------------------------------------------------------------------------------------------------------------------------

Comparison compared(Records const& records, AdviseOptions const& options, Arithmetic const& arithmetic, int doublings) {
    return compare(records, {.forgetting = options.forgetting,
                             .prior_times = std::ldexp(1.0, doublings),
                             .arithmetics = {std::string(arithmetic.name)},
                             .seed = options.seed,
                             .threads = options.threads,
                             .timings = false});
}

/// Doublings of c after which P0 is still in range: P0_ii = (c / s_i)^2 below 2^(e - 8).
int most_doublings(DefaultPrior const& prior, Arithmetic const& arithmetic) {
    int const largest = 2 * (std::ilogb(prior.c) - std::ilogb(prior.s.minCoeff()));
    return std::max(0, (std::min(arithmetic.max_exp, 1000) - 8 - largest) / 2);
}

Comparison with_a_prior_that_leaves_digits(Records const& records, std::vector<bool> const& is_zero, AdviseOptions const& options,
                                           Arithmetic const& arithmetic) {
    Comparison out = compared(records, options, arithmetic, 0);
    int const most = most_doublings(*out.scaled_prior, arithmetic);
    for (int doublings = 0; doublings < most;) {
        double left = 99;  // by the prior, of what has digits
        for (size_t i = 0; i < out.agreement.size(); ++i)
            if (!is_zero[i]) left = std::min(left, out.agreement[i]);
        double const missing = std::min(options.digits, arithmetic.decimal_digits()) + margin - left;
        if (missing <= 0) break;
        // by the law of the norm; a component may ask for more
        doublings = std::min(doublings + int(std::ceil(missing / digits_a_doubling)), most);
        out = compared(records, options, arithmetic, doublings);
    }
    return out;
}

// --- (1), (2), (5) --------------------------------------------------------------------------------------------------------------

/// Which parameters are zero, as far as the certificate tells: below 1e-38 of the largest, each in units of its regressor.
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
double digits_of(Vector<Reference> const& theta, Vector<Reference> const& exact, std::vector<bool> const& is_zero) {
    double out = INFINITY;
    for (Index i = 0; i < theta.size(); ++i) {
        if (!is_finite(theta[i])) return -INFINITY;
        if (is_zero[size_t(i)]) continue;
        Reference const error = absolute(Reference(theta[i] - exact[i])), size = absolute(exact[i]);
        if (error != 0) out = std::min(out, static_cast<double>(Reference(-log10(Reference(error / size)))));
    }
    return out;
}

static_assert(std::is_nothrow_move_constructible_v<Tried> && !std::is_copy_constructible_v<Tried>);  // Kept points into it

Tried tried(Records const& records, AdviseOptions const& options, Arithmetic const& arithmetic) {
    Tried out;
    out.arithmetic = arithmetic.name;
    out.wanted = options.digits;
    choose_scaling(records, arithmetic, out);
    Records const taken = scaled(records, out);
    Vector<Reference> const exact =
        certified({.size = taken.parameters(), .forgetting = options.forgetting, .prior = std::nullopt}, taken, {taken.rows()})
            .front()
            .theta();
    out.is_zero = zeros_of(exact, taken);
    out.comparison = with_a_prior_that_leaves_digits(taken, out.is_zero, options, arithmetic);
    for (RoundingEffect const& s : out.comparison.rounding) out.in_range = s.in_range;
    std::vector<Result const*> sound;
    for (Result const& r : out.comparison.results)
        if (takes_single_rows(r) && is_sound(r)) sound.push_back(&r);
    std::ranges::stable_sort(sound, [](Result const* a, Result const* b) { return preferred(*a, *b); });
    for (Result const* r : sound) {
        double at_end = arithmetic.decimal_digits();
        for (Vector<Reference> const& theta : r->ends) at_end = std::min(at_end, digits_of(theta, exact, out.is_zero));
        out.sound.push_back({r, r->worst_low, at_end});
    }
    return out;
}

}  // namespace

Kept const* Tried::first_enough() const {
    auto const found = std::ranges::find_if(sound, [&](Kept const& k) { return k.both() >= wanted; });
    return found == sound.end() ? nullptr : &*found;
}
Kept const* Tried::most() const { return sound.empty() ? nullptr : &*std::ranges::max_element(sound, {}, &Kept::both); }

Advice advise(Records const& records, AdviseOptions const& options, Progress const& progress) {
    Advice out{.options = options, .tried = {}, .guard = {}};
    std::vector<Arithmetic const*> const arithmetics = asked(options);
    for (Arithmetic const* const a : arithmetics) {
        out.tried.push_back(tried(records, options, *a));
        if (progress) progress(double(out.tried.size()) / double(arithmetics.size()));
        if (out.chosen()) break;
    }
    if (Tried const* const t = out.chosen()) {
        Problem<double> const problem{
            .size = records.parameters(), .forgetting = options.forgetting, .prior = t->comparison.scaled_prior->prior()};
        out.guard = guard_trial(out.choice()->result->entry->variant, t->arithmetic, problem, scaled(records, *t));
    }
    return out;
}

}  // namespace rlslab::compare
