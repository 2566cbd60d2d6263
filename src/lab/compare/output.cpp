// A comparison as JSON, and as CSV, whose columns are places in that JSON: for programs.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/report/json.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

/// The number as the format prints it; null for what is absent, or not finite: JSON has none (-infinity: no answer).
Json number(std::optional<double> const& x, char const* format) {
    return x && std::isfinite(*x) ? Json::parse(fmt::format(fmt::runtime(format), *x + 0.0)) : Json();
}
/// A digit count is rounded to three decimals: more than its meaning, yet few: every machine prints the same.
Json digits_json(std::optional<double> const& digits) {
    return number(digits ? std::round(*digits / 1e-3) * 1e-3 : digits, "{:.3f}");
}
Json short_json(std::optional<double> const& x) { return number(x, "{:.5g}"); }
Json tenths_json(double x) { return number(x, "{:.1f}"); }
Json text_json(std::string const& text) { return text.empty() ? Json() : Json(text); }
Json breakdown_json(std::optional<Breakdown> const& at) {
    return at ? object("step kind", {at->step, name_of(at->kind)}) : Json();
}

constexpr char const* measured[] = {"theta", "worst", "covariance"};
Json spreads_json(std::optional<PerMeasure<Spread>> const& of) {
    Json out;
    for (size_t m = 0; m < 3; ++m) {
        Json& one = out[measured[m]] = nullptr;
        if (!of) continue;
        Spread const& s = (*of).*PerMeasure<Spread>::all()[m];
        one = object("low median high", {tenths_json(s.low), tenths_json(s.median), tenths_json(s.high)});
    }
    return out;
}

Json composition_json(Comparison const& c) {
    Composition const& of = c.options.composition;
    Json numbers = Json::object();
    for (size_t i = 0; i < of.parameters.size(); ++i)
        numbers[std::string(control_named(of.control).parameters[i].name)] = of.parameters[i];
    return object("control parameters window guard text digits",
                  {text_json(of.control), numbers, of.window > 0 ? Json(of.window) : Json(), text_json(of.guard),
                   composition_text(of), against_text(c)});
}

/// What a composition did, at each checkpoint.
constexpr std::pair<char const*, Index CompositionCounts::*> counted[] = {
    {"refactored", &CompositionCounts::refactored}, {"unusable", &CompositionCounts::unusable},
    {"outliers", &CompositionCounts::outliers},     {"changes", &CompositionCounts::changes},
    {"windups", &CompositionCounts::windups},       {"breakdowns", &CompositionCounts::breakdowns}};

Json result_json(Comparison const& c, Result const& r) {
    Json path;
    for (size_t m = 0; m < 3; ++m)
        path[measured[m]] = each(r.path, [&](Digits const& digits) { return digits_json(digits.*Digits::all()[m]); });
    OtherOrders const& others = r.others;
    Json out =
        object("variant arithmetic theta_digits theta_digits_worst covariance_digits spread path runs broken",
               {r.entry->variant, r.entry->arithmetic->name, digits_json(r.last.theta), digits_json(r.last.worst),
                digits_json(r.last.covariance), spreads_json(r.spread), path, r.runs, r.broken});
    Json const reordered = others.runs > 0
                               ? object("runs broken spread", {others.runs, others.broken, spreads_json(others.spread)})
                               : Json(),
               foretold =
                   r.foretold ? breakdown_json(Breakdown{Index(rounded_row(*r.foretold)), Health::indefinite}) : Json();
    out.update(object("other_orders breakdown foretold asymmetry operations ns_per_update",
                      {reordered, breakdown_json(r.breakdown), foretold, short_json(r.asymmetry),
                       r.operations ? Json(*r.operations) : Json(), short_json(r.ns_per_update)}));
    if (c.options.certify)
        out["probes"] = r.probed
                            ? object("estimate bound truth", {short_json(r.probed->estimate),
                                                              short_json(r.probed->bound), short_json(r.probed->truth)})
                            : Json();
    if (c.options.composition.empty()) {
        out["predicted"] =
            r.predicted ? object("covariance at_least", {tenths_json(r.predicted->digits), r.predicted->at_least})
                        : Json();
        return out;
    }
    out["obstacle"] = text_json(r.obstacle);
    out["certified_to"] = r.certified_to;
    for (auto const& [name, count] : counted)
        out["happened"][name] = each(r.happened, [&, count = count](CompositionCounts const& h) { return h.*count; });
    return out;
}

Json recommendation_json(Recommendation const& r) {
    Json const losses = each(r.losses, [](Loss const& loss) {
        return object("variant digits of", {loss.variant, tenths_json(loss.digits), text_json(loss.of)});
    });
    return object("arithmetic variant why cheapest exact_rows too_short losses",
                  {r.arithmetic, text_json(r.variant), r.why, text_json(r.cheapest),
                   r.exact_rows > 0 ? Json(r.exact_rows) : Json(), r.too_short, losses});
}

Json digits_answer_json(DigitsAnswer const& a) {
    Comparison const& last = a.trials.back().comparison;
    Json means = Json::object();
    for (auto const& [column, mean] : last.model.means) means[column] = mean;
    Json out = object("file rows skipped parameters regressors output means digits forgetting",
                      {last.model.file, last.rows, last.skipped, last.names, last.model.regressors, last.model.output,
                       means, a.wanted, last.options.forgetting});
    out.update(object("warnings zero_parameters", {warnings(last), a.trials.back().zeros()}));
    out["tried"] = each(a.trials, [](ArithmeticTrial const& t) {
        Json const variants = each(t.sound, [&](KeptDigits const& k) {
            return object("variant digits_along digits_at_end operations enough",
                          {k.result->entry->variant, tenths_json(tenth_below(k.along)),
                           tenths_json(tenth_below(k.at_end)), *k.result->operations, k.both() >= t.wanted});
        });
        return object("arithmetic in_range p0 exponents output_exponent variants",
                      {t.arithmetic, t.in_range, diagonal_of(*t.comparison.scaled_prior), t.exponents,
                       t.output_exponent, variants});
    });
    out["advice"] = nullptr;
    KeptDigits const* const k = a.choice();
    if (!k) return out;
    Json& advice = out["advice"] =
        object("variant arithmetic guarded", {k->result->entry->variant, a.chosen()->arithmetic, a.guarded()});
    if (a.guard) {
        CompositionCounts const& n = a.guard->counts;
        advice["guard_met"] = object("outliers changes windups breakdowns unusable",
                                     {n.outliers, n.changes, n.windups, n.breakdowns, n.unusable});
    }
    advice["code"] = code(a);
    return out;
}

}  // namespace

std::string as_json(Comparison const& c) {
    Json out;
    out["version"] = RLSLAB_VERSION;
    out["options"] = object("forgetting p0 seed",
                            {c.options.forgetting, c.options.p0 ? Json(*c.options.p0) : Json(), c.options.seed});
    out["data"] =
        object("rows skipped size parameters regressors", {c.rows, c.skipped, c.size, c.names, c.model.regressors});
    if (c.scaled_prior)
        out["prior"] =
            object("c s P0 formula",
                   {c.scaled_prior->c, std::vector<double>(c.scaled_prior->s.begin(), c.scaled_prior->s.end()),
                    diagonal_of(*c.scaled_prior), default_prior_formula});
    out["reference"] = object("theta least_squares agreement radius bits condition prior_bias component_bias",
                              {c.theta, c.least_squares, each(c.agreement, digits_json), short_json(c.radius), c.bits,
                               short_json(c.condition), short_json(c.prior_bias), short_json(c.component_bias)});
    out["prior_costs"] = each(c.prior_costs, [](PriorCost const& cost) {
        return object("arithmetic form best_c2 digits loss", {cost.arithmetic, cost.form, short_json(cost.best_c2),
                                                              digits_json(cost.digits), digits_json(cost.loss)});
    });
    out["start_costs"] = each(c.start_costs, [](StartCost const& cost) {
        return object("arithmetic digits loss best_c2",
                      {cost.arithmetic, digits_json(cost.digits), digits_json(cost.loss), short_json(cost.best_c2)});
    });
    out["exact_sums"] = each(c.exact, [](ExactSums const& exact) {
        return object("arithmetic rows", {exact.arithmetic, exact.rows});
    });
    if (!c.options.composition.empty()) out["composition"] = composition_json(c);
    out["warnings"] = warnings(c);
    out["checkpoints"] = c.checkpoints;
    out["storage"] = each(c.rounding, [](RoundingEffect const& s) {
        return object("arithmetic forgetting rank in_range theta_digits prior_bias component_bias",
                      {s.arithmetic, s.forgetting, s.rank, s.in_range, digits_json(s.theta_digits),
                       short_json(s.prior_bias), short_json(s.component_bias)});
    });
    out["results"] = each(c.results, [&](Result const& r) { return result_json(c, r); });
    out["code"] = code(c);
    out["recommendation"] = each(c.recommendations, recommendation_json);
    for (FastResult const& r : c.fast)
        out["fast_forms"].push_back(
            object("form arithmetic prediction_digits breakdown operations",
                   {r.form, r.arithmetic, digits_json(r.digits), breakdown_json(r.breakdown), r.operations}));
    if (c.digits) out["digits"] = digits_answer_json(*c.digits);
    if (c.run) out["run"] = Json::parse(as_json(*c.run));
    return out.dump(2) + '\n';
}

std::string as_csv(Comparison const& c) {
    bool const plain = c.options.composition.empty();
    std::vector<std::string> places{
        // of a result's JSON
        "variant",        "arithmetic",     "theta_digits",  "theta_digits_worst", "covariance_digits",
        "breakdown/step", "breakdown/kind", "foretold/step", "asymmetry",          "operations",
        "ns_per_update",  "runs",           "broken"};
    for (std::string const of : {"", "other_orders/"}) {
        if (!of.empty()) places.insert(places.end(), {of + "runs", of + "broken"});
        for (std::string const name : measured)
            for (char const* const point : {"low", "median", "high"})
                places.push_back(of + "spread/" + name + "/" + point);
    }
    if (plain) places.insert(places.end(), {"predicted/covariance", "predicted/at_least"});
    if (c.options.certify) places.insert(places.end(), {"probes/estimate", "probes/bound", "probes/truth"});
    if (!plain) places.insert(places.end(), {"obstacle", "certified_to"});
    for (auto const& [name, count] : counted)
        if (!plain) places.push_back(std::string("happened/") + name);

    std::string out = c.run ? as_comments(*c.run) : "";
    for (std::string const& place : places) {
        std::string name = place == "other_orders/runs" ? "other_orders" : place;
        for (std::string const left_out : {"orders/", "spread/", "happened/"})
            if (size_t const at = name.find(left_out); at != name.npos) name.erase(at, left_out.size());
        std::ranges::replace(name, '/', '_');
        out += (&place == &places.front() ? "" : ",") + name;
    }
    out += '\n';
    for (Result const& r : c.results) {
        Json const result = result_json(c, r);
        for (std::string const& place : places) {
            Json value = result.value(Json::json_pointer("/" + place), Json());
            if (value.is_array()) value = value.empty() ? Json(0) : Json(value.back());  // after the last row
            if (value.is_null() && (place == "other_orders/runs" || place == "other_orders/broken")) value = 0;
            out += &place == &places.front() ? "" : ",";
            if (value.is_boolean()) value = int(value.get<bool>());
            if (value.is_string() && place != "obstacle") out += value.get<std::string>();
            else if (!value.is_null()) out += value.dump();
        }
        out += '\n';
    }
    return out;
}

}  // namespace rlslab::compare
