// The rules of answer.hpp, over digits as they are printed.
#include "src/lab/compare/answer.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>

namespace rlslab::compare {
namespace {

constexpr double least_digits_of_P = 0.5, least_digits_of_data = 0.5;
/// That forms may differ by and count as alike: of `low`, and of what is named beside the best.
constexpr double half_a_digit = 0.5;

std::string spread_text(Spread const& s) { return fmt::format("{:.1f} ({:.1f} to {:.1f})", s.median, s.low, s.high); }

/// The part of theta that the prior decides: all of it, a component, or nothing.
std::string decided_by_prior(double prior_bias, double component_bias) {
    if (!(prior_bias <= most_prior_bias))
        return fmt::format("the prior, not the data, decides theta (it moves it by {:.2g})", prior_bias);
    if (!(component_bias <= most_component_bias))
        return fmt::format("the prior, not the data, decides a component of theta (it moves it by {:.2g} of itself)",
                           component_bias);
    return "";
}

std::string condition_text(Comparison const& c) {
    return fmt::format("; the condition number of the rows is {:.2g}", c.condition);
}

/// The reason why nothing can be answered in this arithmetic that is known before any variant computes; or "".
std::string unanswerable(Arithmetic const& arithmetic, Comparison const& c) {
    for (RoundingEffect const& s : c.rounding) {
        if (s.arithmetic != arithmetic.name) continue;
        if ((!s.in_range && s.forgetting > 0) || s.prior_subnormal)
            return c.options.p0 ? "P0 leaves its range: another --p0"
                                : "P0 leaves its range: rescale the columns, or --p0";
        if (!s.in_range) return "lambda is zero there";
        if (!s.data_in_range) return "numbers of the data leave its range: rescale them";
        if (s.rank < c.size) return fmt::format("as stored there the regressors have rank {} of {}", s.rank, c.size);
        if (std::string const why = decided_by_prior(s.prior_bias, s.component_bias); !why.empty())
            return "as stored there " + why;
        if (s.theta_digits && *s.theta_digits < least_digits_of_data)
            return "rounding the data to it leaves no digit of the exact theta: rescale them";
    }
    return "";
}

/// Whether a comes before b among forms that are equally accurate:
///   (1) a form that propagates a factor before one that propagates P or its inverse: no rounding makes the first
///     indefinite
///   (2) covariance before information: gain and P are at hand, theta needs no solve
///   (3) fewer operations a row
bool preferred(Result const& a, Result const& b) {
    auto const key = [](Result const& r) {
        return std::tuple(!r.factor, r.entry->propagates != "covariance", *r.operations);
    };
    return key(a) < key(b);
}

/// Keeps so many, and half a digit of P (the median).
bool is_usable(Result const& r, double wanted) {
    return r.spread->worst.low >= wanted && r.spread->covariance.median >= least_digits_of_P && !r.foretold;
}

/// By how many digits its `low` is below another's, in the measure and against the form where that is most.
double behind(Result const& r, std::vector<Result const*> const& sound) {
    double out = 0;
    for (auto const m : PerMeasure<Spread>::all())
        for (Result const* other : sound) {
            double const a = ((*other->spread).*m).low, b = ((*r.spread).*m).low;
            if (a > b) out = std::max(out, a - b);
        }
    return out;
}

double tenths_of(double digits) { return std::round(10 * digits); }
/// Tenths beyond half a digit.
double too_far_behind(Result const& r, std::vector<Result const*> const& sound) {
    return std::max(0.0, tenths_of(behind(r, sound)) - 10 * half_a_digit);
}
bool is_near_the_best(Result const& r, std::vector<Result const*> const& sound, double wanted) {
    return is_usable(r, wanted) && too_far_behind(r, sound) == 0 &&
           tenths_of(loss_of(r, sound).digits) <= 10 * half_a_digit;
}

/// The cheapest form that propagates a factor and is within half a digit of the best, if it costs less than the named.
std::string cheapest(std::vector<Result const*> const& ranking, double wanted) {
    Result const* out = ranking.front();
    for (Result const* r : ranking)
        if (r->factor && *r->operations < *out->operations && is_near_the_best(*r, ranking, wanted)) out = r;
    return out == ranking.front() ? "" : std::string(out->entry->variant);
}

/// Of the first two, and of `conventional` where it takes part.
std::vector<Loss> losses(std::vector<Result const*> const& ranking, Arithmetic const& arithmetic, Comparison const& c) {
    std::vector<Loss> out;
    for (size_t i = 0; i < std::min<size_t>(2, ranking.size()); ++i) out.push_back(loss_of(*ranking[i], ranking));
    for (Result const& r : c.results)
        if (r.entry->arithmetic->name == arithmetic.name && r.entry->variant == "conventional" && r.obstacle.empty() &&
            std::ranges::find(out, "conventional", &Loss::variant) == out.end())
            out.push_back(is_sound(r) ? loss_of(r, ranking) : Loss{.variant = "conventional", .digits = INFINITY});
    return out;
}

}  // namespace

bool takes_single_rows(Result const& r) { return r.entry->block == 1 && r.operations; }
bool is_sound(Result const& r) { return r.broken == 0 && r.others.broken == 0 && r.spread; }

double wanted_digits(CompareOptions const& options) { return options.digits.value_or(3); }

Loss loss_of(Result const& r, std::vector<Result const*> const& sound) {
    static constexpr char const* names[] = {"theta", "its worst component", "P"};
    Loss out{.variant = std::string(r.entry->variant)};
    for (size_t m = 0; m < 3; ++m) {
        auto const median = [&](Result const& x) { return ((*x.spread).*PerMeasure<Spread>::all()[m]).median; };
        double best = median(r);
        for (Result const* other : sound) best = std::max(best, median(*other));
        double const lost = best == median(r) ? 0 : best - median(r);  // also where both are infinite
        if (m == 0 || lost > out.digits) out.digits = lost, out.of = names[m];
    }
    return out;
}

std::vector<Result const*> ranked(std::vector<Result const*> sound, double wanted, bool exact_sums) {
    std::vector<Result const*> const all = sound;
    std::ranges::stable_sort(sound, [](Result const* a, Result const* b) { return preferred(*a, *b); });
    std::ranges::stable_sort(sound, {}, [&](Result const* r) {
        return std::tuple(!(exact_sums && r->entry->variant == "information" && is_near_the_best(*r, all, wanted)),
                          !is_usable(*r, wanted), too_far_behind(*r, all), tenths_of(loss_of(*r, all).digits));
    });
    return sound;
}

Recommendation recommend(Arithmetic const& arithmetic, Comparison const& c) {
    double const wanted = wanted_digits(c.options);
    Recommendation out{std::string(arithmetic.name), "", decided_by_prior(c.prior_bias, c.component_bias)};
    if (!out.why.empty()) {
        out.why += c.options.p0 ? ": leave out --p0" : ": rescale the columns";
        return out;
    }
    if (Index const window = c.options.composition.window; window > 0 && window < c.size) {
        out.why = fmt::format(
            "the prior, not the data, decides theta: {} rows do not determine {} parameters: a longer --window", window,
            c.size);
        return out;
    }
    std::vector<Result const*> sound;
    int tried = 0;
    for (Result const& r : c.results) {
        if (r.entry->arithmetic->name != arithmetic.name || !takes_single_rows(r)) continue;
        ++tried;
        if (is_sound(r)) sound.push_back(&r);
    }
    if (tried == 0) {
        Composition const& composed = c.options.composition;
        bool const can = std::ranges::any_of(c.results, [&](Result const& r) {
            return r.entry->arithmetic->name == arithmetic.name && obstacle(composed, r.entry->variant).empty();
        });
        out.why = composed.empty() ? "no variant was tried that takes single rows"
                  : can            ? "a number of the control is 0 or infinite here"
                                   : "no variant can be composed so";
        return out;
    }
    auto const exact = std::ranges::find(c.exact, arithmetic.name, &ExactSums::arithmetic);
    std::vector<Result const*> const ranking = ranked(sound, wanted, exact != c.exact.end());
    out.why = unanswerable(arithmetic, c);
    out.too_short = !out.why.empty() || ranking.empty() || !is_usable(*ranking.front(), wanted);
    if (!out.why.empty()) return out;
    if (!out.too_short) {
        PerMeasure<Spread> const& spread = *ranking.front()->spread;
        out.variant = ranking.front()->entry->variant;
        out.why = fmt::format("keeps {} digits of theta, {} of its worst component, {} of P", spread_text(spread.theta),
                              spread_text(spread.worst), spread_text(spread.covariance));
        out.losses = losses(ranking, arithmetic, c);
        out.cheapest = cheapest(ranking, wanted);
        if (exact != c.exact.end() && out.variant == "information") out.exact_rows = exact->rows;
    } else if (arithmetic.decimal_digits() < wanted) {
        out.why = fmt::format("it has {:.1f} digits, {} are wanted", arithmetic.decimal_digits(), wanted);
    } else if (sound.empty()) {
        out.why = fmt::format("all {} variants that take single rows broke down{}", tried, condition_text(c));
    } else {
        Result const* const most =
            *std::ranges::max_element(ranking, {}, [](Result const* r) { return r->spread->worst.low; });
        double const low = most->spread->worst.low;
        out.why = low >= wanted ? fmt::format("none of {} variants keeps half a digit of P", tried)
                                : fmt::format(
                                      "{}, the best, keeps {} digits of theta's worst component at nine tenths of the "
                                      "checkpoints, {} are wanted{}",
                                      most->entry->variant, std::isfinite(low) ? fmt::format("{:.1f}", low) : "no",
                                      wanted, condition_text(c));
    }
    return out;
}

}  // namespace rlslab::compare
