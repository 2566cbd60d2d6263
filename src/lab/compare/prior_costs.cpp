// The law of prior_law.hpp for the arithmetics and the prior of a comparison, in numbers and in a sentence.
#include "src/lab/compare/prior_costs.hpp"
#include "src/lab/compare/prior_law.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

constexpr int most_bits = 53;  // the law's priors end at 2^53 / tr M
constexpr std::pair<char const*, PriorForm> forms[] = {{"symmetric", PriorForm::stored},
                                                       {"joseph", PriorForm::products}};

/// A relative error of 1 or more has no digits.
double digits_of_error(double error) { return std::max(0.0, -correctly::log10(error)); }
bool is_a_loss(double digits) { return std::round(10 * digits) >= 10 * least_prior_loss; }

double c2_of(Comparison const& c) { return c.scaled_prior ? c.scaled_prior->c * c.scaled_prior->c : *c.options.p0; }
Vector<double> units_of(Comparison const& c) { return c.scaled_prior ? c.scaled_prior->s : Vector<double>(); }

/// Arithmetics that round to nearest, have at most 53 bits and hold data and prior.
std::vector<Arithmetic const*> words_of(Comparison const& c) {
    std::vector<Arithmetic const*> out;
    for (Result const& r : c.results) {
        Arithmetic const& word = *r.entry->arithmetic;
        auto const stored = std::ranges::find(c.rounding, word.name, &RoundingEffect::arithmetic);
        if (word.digits <= most_bits && !word.stochastic && std::ranges::find(out, &word) == out.end() &&
            (stored == c.rounding.end() || (stored->in_range && stored->data_in_range)))
            out.push_back(&word);
    }
    return out;
}

}  // namespace

std::vector<PriorCost> prior_costs(Records const& records, Comparison const& c) {
    if (!c.options.composition.empty() || c.options.forgetting != 1) return {};
    PriorLaw const law = prior_law(records, *c.without_prior, units_of(c));
    if (law.empty()) return {};
    double const given = c2_of(c);
    std::vector<PriorCost> out;
    for (Arithmetic const* const word : words_of(c)) {
        double const u = std::ldexp(1.0, -word->digits);
        for (auto const& [name, form] : forms) {
            PriorPoint const best = law.best(form, u);
            double const digits = digits_of_error(best.total(form, u));
            out.push_back({word->name, name, best.c2, digits,
                           std::max(0.0, digits - digits_of_error(law.at(given).total(form, u)))});
        }
    }
    return out;
}

std::vector<StartCost> start_costs(Records const& records, Comparison const& c) {
    if (!c.options.composition.empty() || c.options.forgetting != 1) return {};
    std::optional<PriorPoint> const given = prior_point(records, *c.without_prior, c2_of(c), units_of(c));
    if (!given || !(given->steady > 0)) return {};
    double const loss = std::max(0.0, correctly::log10(given->corrected / given->steady));
    PriorLaw const law = is_a_loss(loss) ? prior_law(records, *c.without_prior, units_of(c)) : PriorLaw{};
    std::vector<StartCost> out;
    for (Arithmetic const* const word : words_of(c)) {
        double const u = std::ldexp(1.0, -word->digits), digits = digits_of_error(u * given->corrected);
        out.push_back({word->name, digits, std::min(loss, digits_of_error(u * given->steady))});
        if (law.empty()) continue;
        if (double const best = law.best(PriorForm::corrected, u).c2; best < c2_of(c)) out.back().best_c2 = best;
    }
    return out;
}

std::string start_cost_text(Comparison const& c) {
    std::string out;
    for (StartCost const& cost : c.start_costs)
        if (is_a_loss(cost.loss))
            out += fmt::format("{}in {} about {:.1f} digits of theta, to {:.1f}{}", out.empty() ? "" : "; ",
                               cost.arithmetic, cost.loss, cost.digits,
                               cost.best_c2 ? fmt::format(" (best c^2 {:.1g})", *cost.best_c2) : "");
    return out.empty() ? ""
                       : fmt::format(
                             "the first rows excite so little that with this prior theta is far off at first: forms "
                             "that correct theta row by row keep the roundings of that, {}; qr and gentleman do not",
                             out);
}

std::string prior_cost_text(Comparison const& c) {
    std::string out;
    std::string_view arithmetic;
    for (PriorCost const& cost : c.prior_costs) {
        if (!c.options.p0 || !is_a_loss(cost.loss)) continue;
        bool const more = cost.arithmetic == arithmetic;
        out += fmt::format("{}{} about {:.1f}{} (best c^2 {:.1g})",
                           more          ? ", "
                           : out.empty() ? fmt::format("in {} ", cost.arithmetic)
                                         : fmt::format("; in {} ", cost.arithmetic),
                           cost.form, cost.loss, more ? "" : " digits", cost.best_c2);
        arithmetic = cost.arithmetic;
    }
    return out.empty()
               ? ""
               : fmt::format(
                     "against least squares --p0 {} costs forms that store P, {}; symmetric stands for all that "
                     "update P by a difference",
                     *c.options.p0, out);
}

}  // namespace rlslab::compare
