// The rules of recommend.hpp, over digits as they are printed.
#include "compare/recommend.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace rlslab {
namespace {

constexpr double least_digits = 0.5;

double least_median(Result const& r) { return std::min({r.spread->theta.median, r.spread->worst.median, r.spread->covariance.median}); }

std::string spread_text(Spread const& s) { return fmt::format("{:.1f} ({:.1f} to {:.1f})", s.median, s.low, s.high); }

/// The part of theta that the prior decides: all of it, a component, or nothing.
std::string decided_by_prior(double prior_bias, double component_bias) {
    if (!(prior_bias <= most_prior_bias)) return fmt::format("the prior, not the data, decides theta (it moves it by {:.2g})", prior_bias);
    if (!(component_bias <= most_component_bias))
        return fmt::format("the prior, not the data, decides a component of theta (it moves it by {:.2g} of itself)", component_bias);
    return "";
}

/// The reason for no recommendation that is known before any variant computes; or "".
std::string unanswerable(Arithmetic const& arithmetic, Comparison const& c) {
    if (std::string const why = decided_by_prior(c.prior_bias, c.component_bias); !why.empty())
        return why + (c.options.p0 ? ": leave out --p0" : ": rescale the columns");
    for (Storage const& s : c.storage) {
        if (s.arithmetic != arithmetic.name) continue;
        if (!s.in_range) return s.forgetting > 0 ? "P0 leaves its range" : "lambda is zero there";
        if (s.rank < c.size) return fmt::format("as stored there the regressors have rank {} of {}", s.rank, c.size);
        if (std::string const why = decided_by_prior(s.prior_bias, s.component_bias); !why.empty()) return "as stored there " + why;
    }
    return "";
}

}  // namespace

bool takes_single_rows(Result const& r) { return r.entry->block == 1 && r.operations; }
bool is_sound(Result const& r) { return r.broken == 0 && r.spread; }

bool preferred(Result const& a, Result const& b) {
    auto const key = [](Result const& r) { return std::tuple(!r.factor, r.entry->propagates != "covariance", *r.operations); };
    return key(a) < key(b);
}

Result const* chosen_of(std::vector<Result const*> const& sound) {
    std::vector<Result const*> able;
    for (Result const* r : sound)
        if (least_median(*r) >= least_digits) able.push_back(r);
    if (able.empty()) return nullptr;
    std::ranges::stable_sort(able, [](Result const* a, Result const* b) { return preferred(*a, *b); });
    Result const* const best = *std::ranges::max_element(able, {}, [](Result const* r) { return least_median(*r); });  // (1)
    auto const as_good = [&](Result const* r) {                                                                        // (2)
        return std::ranges::all_of(PerMeasure<Spread>::all(), [&](auto m) { return ((*r->spread).*m).high >= ((*best->spread).*m).low; });
    };
    return *std::ranges::find_if(able, as_good);  // (3)
}

Recommendation recommend(Arithmetic const& arithmetic, Comparison const& c) {
    Recommendation out{std::string(arithmetic.name), "", unanswerable(arithmetic, c)};
    if (!out.why.empty()) return out;
    std::vector<Result const*> sound;
    int tried = 0;
    for (Result const& r : c.results) {
        if (r.entry->arithmetic->name != arithmetic.name || !takes_single_rows(r)) continue;
        ++tried;
        if (is_sound(r)) sound.push_back(&r);
    }
    Result const* const choice = chosen_of(sound);
    if (choice) {
        PerMeasure<Spread> const& spread = *choice->spread;
        out.variant = choice->entry->variant;
        out.why = fmt::format("keeps {} digits of theta, {} of its worst component, {} of P", spread_text(spread.theta),
                              spread_text(spread.worst), spread_text(spread.covariance));
    } else if (tried == 0) {
        out.why = c.options.composition.empty() ? "no variant was tried that takes single rows" : "no variant can be composed so";
    } else if (sound.empty()) {
        out.why = fmt::format("all {} variants that take single rows broke down", tried);
    } else {
        out.why = fmt::format("none of {} variants keeps half a digit of each component of theta and of P", tried);
    }
    return out;
}

}  // namespace rlslab
