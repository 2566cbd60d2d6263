// Sentences, and lines of a certain width.
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/composed_words.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/foretold.hpp"
#include "src/lab/compare/prior_costs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;

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

std::string tenths(double digits) {
    if (!std::isfinite(digits)) return "-";
    return fmt::format("{:.{}f}", digits + 0.0, digits < -9.94 ? 0 : 1);  // four letters, the width of a column
}

std::string breakdown_text(Result const& r) {
    if (!r.obstacle.empty()) return "-";
    if (r.breakdown) return fmt::format("{} at {}", name_of(r.breakdown->kind), r.breakdown->step);
    if (r.broken > 0) return fmt::format("in {} of {} draws", r.broken, r.runs);
    if (r.others.broken > 0) return fmt::format("in {} of {} orders", r.others.broken, r.others.runs);
    return r.foretold ? fmt::format("about row {:.0f}", rounded_row(*r.foretold)) : "none";
}

std::string asymmetry_text(std::optional<double> const& asymmetry) {
    if (!asymmetry) return "-";
    return *asymmetry == 0 ? "0" : fmt::format("{:.0e}", *asymmetry);
}

std::string operations_text(std::optional<long> const& operations) {
    return operations ? fmt::format("{}", *operations) : "-";
}

std::string nanoseconds_text(std::optional<double> const& ns) { return ns ? fmt::format("{:.0f}", *ns) : "-"; }

std::string rounding_text(RoundingEffect const& s, Comparison const& c) {
    return fmt::format("as stored: lambda {:.6g}, rank {} of {}; {}", s.forgetting, s.rank, c.size,
                       s.theta_digits
                           ? fmt::format("rounding the data leaves {:.1f} digits of the exact theta", *s.theta_digits)
                           : "no exact theta: the problem leaves the range");
}

std::string foretold_text(Comparison const& c) {
    if (std::ranges::none_of(c.results, [](Result const& r) { return r.foretold.has_value(); })) return "";
    return "About row N: sound on this record, but if such rows go on, the stored P is indefinite at about that row: "
           "its asymmetry grows by 1/lambda at each (docs/theory.md 37).";
}

namespace {

bool is_another_in_other_orders(Result const& r) {
    if (r.others.broken > 0 || !r.spread || !r.others.spread) return true;
    auto const apart = [](double a, double b) { return a != b && !(std::round(10 * std::abs(a - b)) <= 5); };
    return std::ranges::any_of(PerMeasure<Spread>::all(), [&](auto const m) {
        Spread const &own = (*r.spread).*m, &other = (*r.others.spread).*m;
        return apart(own.low, other.low) || apart(own.median, other.median);
    });
}

}  // namespace

std::string other_orders_text(Comparison const& c, std::string_view arithmetic) {
    std::string out;
    bool any = false;
    for (bool const named : {true, false})
        for (Result const& r : c.results) {
            if (r.entry->arithmetic->name != arithmetic || r.others.runs == 0 || named != is_recommended(c, r))
                continue;
            any = true;
            if (!named && !(is_shown(c, r.entry->variant) && is_another_in_other_orders(r))) continue;
            std::optional<PerMeasure<Spread>> const& kept = r.others.spread;
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", r.entry->variant,
                               kept ? tenths(kept->theta.median) : "-");
            if (r.others.broken > 0) out += fmt::format(" (broke down in {})", r.others.broken);
        }
    if (!any) return "";
    return fmt::format("reordered, {}: {}", arithmetic, out.empty() ? "as in this" : out);
}

bool is_shown(Comparison const& c, std::string_view variant) {
    constexpr std::string_view to_use[] = {"conventional", "symmetric", "joseph_rank_two", "potter",
                                           "carlson",      "ud",        "ud_delta",        "inverse_qr",
                                           "qr",           "gentleman", "qr_block"};
    if (!c.options.variants.empty() || std::ranges::find(to_use, variant) != std::end(to_use)) return true;
    return std::ranges::any_of(c.results,
                               [&](Result const& r) { return r.entry->variant == variant && is_recommended(c, r); });
}

std::string recommended_in(Comparison const& c, std::string_view arithmetic) {
    if (c.digits) {
        KeptDigits const* const choice = c.digits->choice();
        return choice && choice->result->entry->arithmetic->name == arithmetic
                   ? std::string(choice->result->entry->variant)
                   : "";
    }
    auto const found = std::ranges::find(c.recommendations, arithmetic, &Recommendation::arithmetic);
    return found == c.recommendations.end() ? "" : found->variant;
}

bool is_recommended(Comparison const& c, Result const& result) {
    return result.entry->variant == recommended_in(c, result.entry->arithmetic->name);
}

std::string prior_text(Comparison const& c) {
    std::string out = "P0 = ";
    if (c.scaled_prior) {
        auto const [least, largest] = std::minmax_element(c.scaled_prior->s.begin(), c.scaled_prior->s.end());
        out += fmt::format("diag(({} / s_i)^2), s_i = {} to {}, the regressors' sizes; ", c.scaled_prior->c, *least,
                           *largest);
    } else {
        out += fmt::format("{} I; ", *c.options.p0);
    }
    out += fmt::format("moves theta{} by {:.1e} of itself, a component by {:.1e}",
                       c.options.composition.empty() ? "" : ", of all rows without the composition,", c.prior_bias,
                       c.component_bias);
    return out;
}

std::vector<std::string> warnings(Comparison const& c) {
    std::vector<std::string> out = composition_warnings(c);
    out.insert(out.end(), c.model.warnings.begin(), c.model.warnings.end());
    std::string const remedy = c.options.p0 ? "leave out --p0 for one that is scaled to the data"
                                            : "no prior in range will do; rescale the columns";
    if (!(c.prior_bias <= most_prior_bias))
        out.push_back(fmt::format("the prior moves theta by {:.2g} of itself: {}", c.prior_bias, remedy));
    else if (!(c.component_bias <= most_component_bias))
        out.push_back(
            fmt::format("the prior moves a component of theta by {:.2g} of itself: {}", c.component_bias, remedy));
    for (std::string const& cost : {prior_cost_text(c), start_cost_text(c)})
        if (!cost.empty()) out.push_back(cost);
    if (c.offset > most_offset)
        out.push_back(
            fmt::format("the mean of {} is {:.3g} times its standard deviation and the model has no constant, so that "
                        "the offset is fitted as dynamics: --detrend or --intercept",
                        c.model.output.empty() ? "y" : c.model.output, c.offset));
    return out;
}

}  // namespace rlslab::compare
