// The law of prior_law.hpp for the arithmetics and the prior of a comparison, in numbers and in a sentence.
#include "compare/prior_costs.hpp"
#include "compare/prior_law.hpp"

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

}  // namespace

std::vector<PriorCost> prior_costs(Records const& records, Comparison const& c) {
    if (!c.options.composition.empty() || c.options.forgetting != 1) return {};
    PriorLaw const law = prior_law(records, *c.without_prior, c.scaled_prior ? c.scaled_prior->s : Vector<double>());
    if (law.empty()) return {};
    double const given = c.scaled_prior ? c.scaled_prior->c * c.scaled_prior->c : *c.options.p0;
    std::vector<PriorCost> out;
    for (Result const& r : c.results) {
        Arithmetic const& word = *r.entry->arithmetic;
        auto const stored = std::ranges::find(c.rounding, word.name, &RoundingEffect::arithmetic);
        if (word.digits > most_bits || word.stochastic || (!out.empty() && out.back().arithmetic == word.name) ||
            (stored != c.rounding.end() && !(stored->in_range && stored->data_in_range)))
            continue;
        double const u = std::ldexp(1.0, -word.digits);
        for (auto const& [name, form] : forms) {
            PriorPoint const best = law.best(form, u);
            double const digits = digits_of_error(best.total(form, u));
            out.push_back({word.name, name, best.c2, digits,
                           std::max(0.0, digits - digits_of_error(law.at(given).total(form, u)))});
        }
    }
    return out;
}

std::string prior_cost_text(Comparison const& c) {
    std::string out;
    std::string_view arithmetic;
    for (PriorCost const& cost : c.prior_costs) {
        if (!c.options.p0 || std::round(10 * cost.loss) < 10 * least_prior_loss) continue;
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
