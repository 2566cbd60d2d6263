// A comparison as JSON and CSV, for programs.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/recommend.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab::compare {
using namespace report;
namespace {

using Json = nlohmann::ordered_json;

/// A digit count is rounded to three decimals: more than its meaning, and few enough that every machine prints the
/// same.
double rounded_to(double x, double unit) { return std::round(x / unit) * unit; }
Json digits_json(std::optional<double> const& digits) {
    if (!digits || !std::isfinite(*digits)) return nullptr;
    return Json::parse(fmt::format("{:.3f}", rounded_to(*digits, 1e-3) + 0.0));
}
Json short_json(double x) {
    if (!std::isfinite(x)) return nullptr;
    return Json::parse(fmt::format("{:.5g}", x));
}

/// null for minus infinity (no answer), which JSON does not have.
Json tenths_json(double x) { return std::isfinite(x) ? Json::parse(fmt::format("{:.1f}", x + 0.0)) : Json(nullptr); }
Json spread_json(Spread const& s) {
    return {{"low", tenths_json(s.low)}, {"median", tenths_json(s.median)}, {"high", tenths_json(s.high)}};
}

Json prior_costs_json(Comparison const& c) {
    Json out = Json::array();
    for (PriorCost const& cost : c.prior_costs)
        out.push_back({{"arithmetic", cost.arithmetic},
                       {"form", cost.form},
                       {"best_c2", short_json(cost.best_c2)},
                       {"digits", digits_json(cost.digits)},
                       {"loss", digits_json(cost.loss)}});
    return out;
}
constexpr char const* measured[] = {"theta", "worst", "covariance"};
Json spreads_json(std::optional<PerMeasure<Spread>> const& of) {
    Json out;
    for (size_t m = 0; m < 3; ++m)
        out[measured[m]] = of ? spread_json((*of).*PerMeasure<Spread>::all()[m]) : Json(nullptr);
    return out;
}
Json losses_json(Recommendation const& r) {
    Json out = Json::array();
    for (Loss const& loss : r.losses)
        out.push_back({{"variant", loss.variant},
                       {"digits", tenths_json(loss.digits)},
                       {"of", loss.of.empty() ? Json(nullptr) : Json(loss.of)}});
    return out;
}

Json composition_json(Comparison const& c) {
    Composition const& of = c.options.composition;
    if (of.empty()) return nullptr;
    Json numbers = Json::object();
    for (size_t i = 0; i < of.parameters.size(); ++i)
        numbers[std::string(control_named(of.control).parameters[i].name)] = of.parameters[i];
    return {{"control", of.control.empty() ? Json(nullptr) : Json(of.control)},
            {"parameters", numbers},
            {"window", of.window > 0 ? Json(of.window) : Json(nullptr)},
            {"guard", of.guard.empty() ? Json(nullptr) : Json(of.guard)},
            {"text", composition_text(of)},
            {"digits", against_text(c)}};
}

/// What a composition did, at each checkpoint.
constexpr std::pair<char const*, Index CompositionCounts::*> counted[] = {
    {"refactored", &CompositionCounts::refactored}, {"unusable", &CompositionCounts::unusable},
    {"outliers", &CompositionCounts::outliers},     {"changes", &CompositionCounts::changes},
    {"windups", &CompositionCounts::windups},       {"breakdowns", &CompositionCounts::breakdowns}};
Json happened_json(Result const& r) {
    Json out;
    for (auto const& [name, count] : counted) {
        out[name] = Json::array();
        for (CompositionCounts const& h : r.happened) out[name].push_back(h.*count);
    }
    return out;
}

}  // namespace

std::string as_json(Comparison const& c) {
    Json out;
    out["version"] = RLSLAB_VERSION;
    out["options"] = {{"forgetting", c.options.forgetting},
                      {"p0", c.options.p0 ? Json(*c.options.p0) : Json(nullptr)},
                      {"seed", c.options.seed}};
    out["data"] = {{"rows", c.rows},
                   {"skipped", c.skipped},
                   {"size", c.size},
                   {"parameters", c.names},
                   {"regressors", c.model.regressors}};
    if (c.scaled_prior) {
        Matrix<double> const P0 = *c.scaled_prior->prior().covariance;
        out["prior"] = {{"c", c.scaled_prior->c},
                        {"s", std::vector<double>(c.scaled_prior->s.begin(), c.scaled_prior->s.end())},
                        {"P0", Json::array()},
                        {"formula", default_prior_formula}};
        for (Index i = 0; i < c.size; ++i) out["prior"]["P0"].push_back(P0(i, i));
    }
    Json agreement = Json::array();
    for (double const x : c.agreement) agreement.push_back(digits_json(x));
    out["reference"] = {{"theta", c.theta},
                        {"least_squares", c.least_squares},
                        {"agreement", agreement},
                        {"radius", short_json(c.radius)},
                        {"bits", c.bits},
                        {"condition", short_json(c.condition)},
                        {"prior_bias", short_json(c.prior_bias)},
                        {"component_bias", short_json(c.component_bias)}};
    out["prior_costs"] = prior_costs_json(c);
    out["start_costs"] = Json::array();
    for (StartCost const& cost : c.start_costs)
        out["start_costs"].push_back({{"arithmetic", cost.arithmetic},
                                      {"digits", digits_json(cost.digits)},
                                      {"loss", digits_json(cost.loss)},
                                      {"best_c2", cost.best_c2 ? short_json(*cost.best_c2) : Json(nullptr)}});
    out["exact_sums"] = Json::array();
    for (ExactSums const& exact : c.exact)
        out["exact_sums"].push_back({{"arithmetic", exact.arithmetic}, {"rows", exact.rows}});
    if (!c.options.composition.empty()) out["composition"] = composition_json(c);
    out["warnings"] = warnings(c);
    out["checkpoints"] = c.checkpoints;
    out["storage"] = Json::array();
    for (RoundingEffect const& s : c.rounding)
        out["storage"].push_back({{"arithmetic", s.arithmetic},
                                  {"forgetting", s.forgetting},
                                  {"rank", s.rank},
                                  {"in_range", s.in_range},
                                  {"theta_digits", digits_json(s.theta_digits)},
                                  {"prior_bias", short_json(s.prior_bias)},
                                  {"component_bias", short_json(s.component_bias)}});
    out["results"] = Json::array();
    for (Result const& r : c.results) {
        Json path;
        for (size_t m = 0; m < 3; ++m) {
            path[measured[m]] = Json::array();
            for (Digits const& digits : r.path) path[measured[m]].push_back(digits_json(digits.*Digits::all()[m]));
        }
        out["results"].push_back(
            {{"variant", r.entry->variant},
             {"arithmetic", r.entry->arithmetic->name},
             {"theta_digits", digits_json(r.last.theta)},
             {"theta_digits_worst", digits_json(r.last.worst)},
             {"covariance_digits", digits_json(r.last.covariance)},
             {"spread", spreads_json(r.spread)},
             {"path", path},
             {"runs", r.runs},
             {"broken", r.broken},
             {"other_orders", r.others.runs > 0 ? Json{{"runs", r.others.runs},
                                                       {"broken", r.others.broken},
                                                       {"spread", spreads_json(r.others.spread)}}
                                                : Json(nullptr)},
             {"breakdown",
              r.breakdown ? Json{{"step", r.breakdown->step}, {"kind", name_of(r.breakdown->kind)}} : Json(nullptr)},
             {"foretold", r.foretold
                              ? Json{{"step", Index(rounded_row(*r.foretold))}, {"kind", name_of(Health::indefinite)}}
                              : Json(nullptr)},
             {"asymmetry", r.asymmetry ? short_json(*r.asymmetry) : Json(nullptr)},
             {"operations", r.operations ? Json(*r.operations) : Json(nullptr)},
             {"ns_per_update", r.ns_per_update ? short_json(*r.ns_per_update) : Json(nullptr)}});
        if (c.options.certify)
            out["results"].back()["probes"] =
                r.probed ? Json{{"estimate", short_json(r.probed->estimate)},
                                {"bound", short_json(r.probed->bound)},
                                {"truth", r.probed->truth ? short_json(*r.probed->truth) : Json(nullptr)}}
                         : Json(nullptr);
        if (c.options.composition.empty()) {
            out["results"].back()["predicted"] = r.predicted ? Json{{"covariance", tenths_json(r.predicted->digits)},
                                                                    {"at_least", r.predicted->at_least}}
                                                             : Json(nullptr);
            continue;
        }
        Json& row = out["results"].back();
        row["obstacle"] = r.obstacle.empty() ? Json(nullptr) : Json(r.obstacle);
        row["certified_to"] = r.certified_to;
        row["happened"] = happened_json(r);
    }
    out["code"] = code(c);
    out["recommendation"] = Json::array();
    for (Recommendation const& r : c.recommendations)
        out["recommendation"].push_back({{"arithmetic", r.arithmetic},
                                         {"variant", r.variant.empty() ? Json(nullptr) : Json(r.variant)},
                                         {"why", r.why},
                                         {"cheapest", r.cheapest.empty() ? Json(nullptr) : Json(r.cheapest)},
                                         {"exact_rows", r.exact_rows > 0 ? Json(r.exact_rows) : Json(nullptr)},
                                         {"too_short", r.too_short},
                                         {"losses", losses_json(r)}});
    for (FastResult const& r : c.fast)
        out["fast_forms"].push_back(
            {{"form", r.form},
             {"arithmetic", r.arithmetic},
             {"prediction_digits", digits_json(r.digits)},
             {"breakdown",
              r.breakdown ? Json{{"step", r.breakdown->step}, {"kind", name_of(r.breakdown->kind)}} : Json(nullptr)},
             {"operations", r.operations}});
    if (c.digits) out["digits"] = Json::parse(answer_json(*c.digits));
    if (c.run) out["run"] = Json::parse(as_json(*c.run));
    return out.dump(2) + '\n';
}

std::string as_csv(Comparison const& c) {
    std::string out = c.run ? as_comments(*c.run) : "";
    out +=
        "variant,arithmetic,theta_digits,theta_digits_worst,covariance_digits,breakdown_step,breakdown_kind,"
        "foretold_step,asymmetry,operations,ns_per_update,runs,broken";
    for (char const* of : measured)
        for (char const* point : {"low", "median", "high"}) out += fmt::format(",{}_{}", of, point);
    out += ",other_orders,other_broken";
    for (char const* of : measured)
        for (char const* point : {"low", "median", "high"}) out += fmt::format(",other_{}_{}", of, point);
    bool const plain = c.options.composition.empty();
    if (plain) out += ",predicted_covariance,predicted_at_least";
    if (c.options.certify) out += ",probes_estimate,probes_bound,probes_truth";
    if (!plain) {
        out += ",obstacle,certified_to";
        for (auto const& [name, count] : counted) out += fmt::format(",{}", name);
    }
    out += '\n';
    auto const cell = [](Json const& value) { return value.is_null() ? std::string() : value.dump(); };
    for (Result const& r : c.results) {
        out += fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{},{},{}", r.entry->variant, r.entry->arithmetic->name,
            cell(digits_json(r.last.theta)), cell(digits_json(r.last.worst)), cell(digits_json(r.last.covariance)),
            r.breakdown ? fmt::format("{}", r.breakdown->step) : "", r.breakdown ? name_of(r.breakdown->kind) : "",
            r.foretold ? fmt::format("{:.0f}", rounded_row(*r.foretold)) : "",
            r.asymmetry ? cell(short_json(*r.asymmetry)) : "", r.operations ? fmt::format("{}", *r.operations) : "",
            r.ns_per_update ? cell(short_json(*r.ns_per_update)) : "", r.runs, r.broken);
        auto const spreads = [&](std::optional<PerMeasure<Spread>> const& of) {
            for (auto const m : PerMeasure<Spread>::all())
                out += of ? fmt::format(",{},{},{}", cell(tenths_json(((*of).*m).low)),
                                        cell(tenths_json(((*of).*m).median)), cell(tenths_json(((*of).*m).high)))
                          : ",,,";
        };
        spreads(r.spread);
        out += fmt::format(",{},{}", r.others.runs, r.others.broken);
        spreads(r.others.spread);
        if (plain)
            out += r.predicted ? fmt::format(",{:.1f},{}", r.predicted->digits, int(r.predicted->at_least)) : ",,";
        if (c.options.certify)
            out += r.probed ? fmt::format(",{},{},{}", cell(short_json(r.probed->estimate)),
                                          cell(short_json(r.probed->bound)),
                                          r.probed->truth ? cell(short_json(*r.probed->truth)) : "")
                            : ",,,";
        if (!plain) {
            CompositionCounts const last = r.happened.empty() ? CompositionCounts{} : r.happened.back();
            out += fmt::format(",{},{}", r.obstacle.empty() ? "" : fmt::format("\"{}\"", r.obstacle), r.certified_to);
            for (auto const& [name, count] : counted) out += fmt::format(",{}", last.*count);
        }
        out += '\n';
    }
    return out;
}

}  // namespace rlslab::compare
