// A comparison as JSON, and as CSV, whose columns are places in that JSON: for programs.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/words.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab::compare {
using namespace report;
namespace {

using Json = nlohmann::ordered_json;

/// The number as the format prints it; null for what is absent, or not finite: JSON has none (-infinity: no answer).
Json number(std::optional<double> const& x, char const* format) {
    return x && std::isfinite(*x) ? Json::parse(fmt::format(fmt::runtime(format), *x + 0.0)) : Json();
}
/// A digit count is rounded to three decimals: more than its meaning, and few enough that every machine prints the
/// same.
Json digits_json(std::optional<double> const& digits) {
    return number(digits ? std::round(*digits / 1e-3) * 1e-3 : digits, "{:.3f}");
}
Json short_json(std::optional<double> const& x) { return number(x, "{:.5g}"); }
Json tenths_json(double x) { return number(x, "{:.1f}"); }
Json text_json(std::string const& text) { return text.empty() ? Json() : Json(text); }
Json breakdown_json(std::optional<Breakdown> const& at) {
    return at ? Json{{"step", at->step}, {"kind", name_of(at->kind)}} : Json();
}

constexpr char const* measured[] = {"theta", "worst", "covariance"};
Json spreads_json(std::optional<PerMeasure<Spread>> const& of) {
    Json out;
    for (size_t m = 0; m < 3; ++m) {
        Json& one = out[measured[m]] = nullptr;
        if (!of) continue;
        Spread const& s = (*of).*PerMeasure<Spread>::all()[m];
        one = {{"low", tenths_json(s.low)}, {"median", tenths_json(s.median)}, {"high", tenths_json(s.high)}};
    }
    return out;
}
/// An array of what made(item) is.
template <class Items, class Make>
Json array(Items const& items, Make made) {
    Json out = Json::array();
    for (auto const& item : items) out.push_back(made(item));
    return out;
}

Json composition_json(Comparison const& c) {
    Composition const& of = c.options.composition;
    Json numbers = Json::object();
    for (size_t i = 0; i < of.parameters.size(); ++i)
        numbers[std::string(control_named(of.control).parameters[i].name)] = of.parameters[i];
    return {{"control", text_json(of.control)},
            {"parameters", numbers},
            {"window", of.window > 0 ? Json(of.window) : Json()},
            {"guard", text_json(of.guard)},
            {"text", composition_text(of)},
            {"digits", against_text(c)}};
}

/// What a composition did, at each checkpoint.
constexpr std::pair<char const*, Index CompositionCounts::*> counted[] = {
    {"refactored", &CompositionCounts::refactored}, {"unusable", &CompositionCounts::unusable},
    {"outliers", &CompositionCounts::outliers},     {"changes", &CompositionCounts::changes},
    {"windups", &CompositionCounts::windups},       {"breakdowns", &CompositionCounts::breakdowns}};

Json result_json(Comparison const& c, Result const& r) {
    Json path;
    for (size_t m = 0; m < 3; ++m)
        path[measured[m]] = array(r.path, [&](Digits const& digits) { return digits_json(digits.*Digits::all()[m]); });
    OtherOrders const& others = r.others;
    Json out{{"variant", r.entry->variant},
             {"arithmetic", r.entry->arithmetic->name},
             {"theta_digits", digits_json(r.last.theta)},
             {"theta_digits_worst", digits_json(r.last.worst)},
             {"covariance_digits", digits_json(r.last.covariance)},
             {"spread", spreads_json(r.spread)},
             {"path", path},
             {"runs", r.runs},
             {"broken", r.broken},
             {"other_orders",
              others.runs > 0
                  ? Json{{"runs", others.runs}, {"broken", others.broken}, {"spread", spreads_json(others.spread)}}
                  : Json()},
             {"breakdown", breakdown_json(r.breakdown)},
             {"foretold", nullptr},
             {"asymmetry", short_json(r.asymmetry)},
             {"operations", r.operations ? Json(*r.operations) : Json()},
             {"ns_per_update", short_json(r.ns_per_update)}};
    if (r.foretold) out["foretold"] = breakdown_json(Breakdown{Index(rounded_row(*r.foretold)), Health::indefinite});
    if (c.options.certify)
        out["probes"] = r.probed ? Json{{"estimate", short_json(r.probed->estimate)},
                                        {"bound", short_json(r.probed->bound)},
                                        {"truth", short_json(r.probed->truth)}}
                                 : Json();
    if (c.options.composition.empty()) {
        out["predicted"] =
            r.predicted ? Json{{"covariance", tenths_json(r.predicted->digits)}, {"at_least", r.predicted->at_least}}
                        : Json();
        return out;
    }
    out["obstacle"] = text_json(r.obstacle);
    out["certified_to"] = r.certified_to;
    for (auto const& [name, count] : counted)
        out["happened"][name] = array(r.happened, [&, count = count](CompositionCounts const& h) { return h.*count; });
    return out;
}

Json recommendation_json(Recommendation const& r) {
    return {
        {"arithmetic", r.arithmetic},
        {"variant", text_json(r.variant)},
        {"why", r.why},
        {"cheapest", text_json(r.cheapest)},
        {"exact_rows", r.exact_rows > 0 ? Json(r.exact_rows) : Json()},
        {"too_short", r.too_short},
        {"losses", array(r.losses, [](Loss const& loss) {
             return Json{{"variant", loss.variant}, {"digits", tenths_json(loss.digits)}, {"of", text_json(loss.of)}};
         })}};
}

Json digits_answer_json(DigitsAnswer const& a) {
    Comparison const& last = a.trials.back().comparison;
    Json means = Json::object();
    for (auto const& [column, mean] : last.model.means) means[column] = mean;
    Json out{{"file", last.model.file},
             {"rows", last.rows},
             {"skipped", last.skipped},
             {"parameters", last.names},
             {"regressors", last.model.regressors},
             {"output", last.model.output},
             {"means", means},
             {"digits", a.wanted},
             {"forgetting", last.options.forgetting},
             {"warnings", warnings(last)},
             {"zero_parameters", a.trials.back().zeros()}};
    out["tried"] = array(a.trials, [](ArithmeticTrial const& t) {
        return Json{{"arithmetic", t.arithmetic},
                    {"in_range", t.in_range},
                    {"p0", diagonal_of(*t.comparison.scaled_prior)},
                    {"exponents", t.exponents},
                    {"output_exponent", t.output_exponent},
                    {"variants", array(t.sound, [&](KeptDigits const& k) {
                         return Json{{"variant", k.result->entry->variant},
                                     {"digits_along", tenths_json(tenth_below(k.along))},
                                     {"digits_at_end", tenths_json(tenth_below(k.at_end))},
                                     {"operations", *k.result->operations},
                                     {"enough", k.both() >= t.wanted}};
                     })}};
    });
    out["advice"] = nullptr;
    KeptDigits const* const k = a.choice();
    if (!k) return out;
    Json& advice = out["advice"] = {
        {"variant", k->result->entry->variant}, {"arithmetic", a.chosen()->arithmetic}, {"guarded", a.guarded()}};
    if (a.guard) {
        CompositionCounts const& n = a.guard->counts;
        advice["guard_met"] = {{"outliers", n.outliers},
                               {"changes", n.changes},
                               {"windups", n.windups},
                               {"breakdowns", n.breakdowns},
                               {"unusable", n.unusable}};
    }
    advice["code"] = code(a);
    return out;
}

}  // namespace

std::string as_json(Comparison const& c) {
    Json out;
    out["version"] = RLSLAB_VERSION;
    out["options"] = {{"forgetting", c.options.forgetting},
                      {"p0", c.options.p0 ? Json(*c.options.p0) : Json()},
                      {"seed", c.options.seed}};
    out["data"] = {{"rows", c.rows},
                   {"skipped", c.skipped},
                   {"size", c.size},
                   {"parameters", c.names},
                   {"regressors", c.model.regressors}};
    if (c.scaled_prior)
        out["prior"] = {{"c", c.scaled_prior->c},
                        {"s", std::vector<double>(c.scaled_prior->s.begin(), c.scaled_prior->s.end())},
                        {"P0", diagonal_of(*c.scaled_prior)},
                        {"formula", default_prior_formula}};
    out["reference"] = {{"theta", c.theta},
                        {"least_squares", c.least_squares},
                        {"agreement", array(c.agreement, digits_json)},
                        {"radius", short_json(c.radius)},
                        {"bits", c.bits},
                        {"condition", short_json(c.condition)},
                        {"prior_bias", short_json(c.prior_bias)},
                        {"component_bias", short_json(c.component_bias)}};
    out["prior_costs"] = array(c.prior_costs, [](PriorCost const& cost) {
        return Json{{"arithmetic", cost.arithmetic},
                    {"form", cost.form},
                    {"best_c2", short_json(cost.best_c2)},
                    {"digits", digits_json(cost.digits)},
                    {"loss", digits_json(cost.loss)}};
    });
    out["start_costs"] = array(c.start_costs, [](StartCost const& cost) {
        return Json{{"arithmetic", cost.arithmetic},
                    {"digits", digits_json(cost.digits)},
                    {"loss", digits_json(cost.loss)},
                    {"best_c2", short_json(cost.best_c2)}};
    });
    out["exact_sums"] = array(c.exact, [](ExactSums const& exact) {
        return Json{{"arithmetic", exact.arithmetic}, {"rows", exact.rows}};
    });
    if (!c.options.composition.empty()) out["composition"] = composition_json(c);
    out["warnings"] = warnings(c);
    out["checkpoints"] = c.checkpoints;
    out["storage"] = array(c.rounding, [](RoundingEffect const& s) {
        return Json{{"arithmetic", s.arithmetic},
                    {"forgetting", s.forgetting},
                    {"rank", s.rank},
                    {"in_range", s.in_range},
                    {"theta_digits", digits_json(s.theta_digits)},
                    {"prior_bias", short_json(s.prior_bias)},
                    {"component_bias", short_json(s.component_bias)}};
    });
    out["results"] = array(c.results, [&](Result const& r) { return result_json(c, r); });
    out["code"] = code(c);
    out["recommendation"] = array(c.recommendations, recommendation_json);
    for (FastResult const& r : c.fast)
        out["fast_forms"].push_back({{"form", r.form},
                                     {"arithmetic", r.arithmetic},
                                     {"prediction_digits", digits_json(r.digits)},
                                     {"breakdown", breakdown_json(r.breakdown)},
                                     {"operations", r.operations}});
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
