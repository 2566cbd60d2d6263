// A comparison as a table for people, as JSON and CSV for programs.
#include "compare/answer.hpp"
#include "compare/compare.hpp"
#include "compare/composed_words.hpp"
#include "compare/words.hpp"

#include <rlslab/core/text.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

using Json = nlohmann::ordered_json;

/// A digit count is rounded to three decimals: more than its meaning, and few enough that every machine prints the same.
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

std::string spread_text(std::optional<PerMeasure<Spread>> const& spread) {
    std::string out;
    for (auto const m : PerMeasure<Spread>::all())
        out += spread ? fmt::format(" {:>5} {:>4} {:>4} ", tenths(((*spread).*m).low), tenths(((*spread).*m).median),
                                    tenths(((*spread).*m).high))
                      : fmt::format(" {:>5} {:>4} {:>4} ", "-", "-", "-");
    return out;
}
std::string plain_exponent(std::string const& x) { return x.ends_with("e0") ? x.substr(0, x.size() - 2) + "  " : x; }

/// Both exact solutions, and in how many digits they agree.
std::string theta_text(Comparison const& c) {
    size_t width = 11;
    for (std::string const& name : c.names) width = std::max(width, name.size());
    std::string out =
        fmt::format("{:<{}} {:>37} {:>37}  {}\n", "exact theta", width, "least squares, without prior",
                    c.options.composition.empty() ? "with the prior: what filters are after" : "with the prior, of all rows", "agree");
    for (size_t i = 0; i < c.names.size(); ++i)
        out += fmt::format("{:<{}} {:>37} {:>37}  {:>5}\n", c.names[i], width, plain_exponent(c.least_squares[i]),
                           plain_exponent(c.theta[i]), tenths(c.agreement[i]));
    return out;
}

std::string indented(std::string const& text) {
    std::string out;
    for (size_t begin = 0, end; begin < text.size(); begin = end + 1) {
        end = text.find('\n', begin);
        out += (end > begin ? "    " : "") + text.substr(begin, end + 1 - begin);
    }
    return out;
}

/// Colours as in a terminal, or nothing.
struct Paint {
    bool on;
    std::string operator()(char const* code, std::string const& text) const {
        return on ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
    }
};

}  // namespace

std::string as_table(Comparison const& c, bool colour) {
    Paint const paint{colour};
    std::string out = fmt::format("record      {}{} rows, {} skipped; {} parameter{}, condition {}, forgetting {}\n",
                                  c.model.file.empty() ? "" : c.model.file + ": ", c.rows, c.skipped, c.size, c.size == 1 ? "" : "s",
                                  std::isinf(c.condition) ? "beyond 1e308" : fmt::format("{:.2g}", c.condition), c.options.forgetting);
    out += "prior       " + wrapped(prior_text(c), 12, 12, text_width) + '\n';
    bool const plain = c.options.composition.empty();
    if (!plain) {
        out += "composition " + wrapped(composition_text(c.options.composition), 12, 12, text_width) + '\n';
        out += "digits      " + wrapped(against_text(c), 12, 12, text_width) + '\n';
    }
    for (std::string const& warning : warnings(c)) out += paint("31", "warning     " + wrapped(warning, 12, 12, text_width) + '\n');
    out += '\n' + paint("32", verdict(c));
    if (std::string const paste = code(c); !paste.empty()) out += '\n' + indented(paste);
    out += '\n' + theta_text(c);
    out += fmt::format("proven to {:.0e} relative, for the data as binary64, at {} bits\n", c.radius, c.bits);

    std::string_view arithmetic;
    for (Result const& r : c.results) {
        Arithmetic const& a = *r.entry->arithmetic;
        if (a.name != arithmetic) {
            arithmetic = a.name;
            std::string const title = fmt::format("{} ({} bits, {:.1f} digits)", a.name, a.digits, a.decimal_digits());
            out += '\n' + paint("1", title) +
                   paint("2", fmt::format("{:>{}}{:>17}{:>17}", "theta", 40 - std::min<size_t>(34, title.size()), "worst component", "P")) +
                   '\n';
            for (Storage const& s : c.storage)
                if (s.arithmetic == a.name) out += paint("2", "  " + storage_text(s, c)) + '\n';
            out += paint("2", fmt::format("{:<24} {:>5}{:>5}{:>5}  {:>5}{:>5}{:>5}  {:>5}{:>5}{:>5}  {:<19}{:>6}{:>6}{:>7}", "", "low",
                                          "mid", "high", "low", "mid", "high", "low", "mid", "high", "breakdown", "asym", "ops", "ns")) +
                   '\n';
        }
        bool const best = is_recommended(c, r);
        std::string const line =
            fmt::format("{} {:<22}{} {:<19}{:>6}{:>6}{:>7}", best ? '*' : ' ', r.entry->variant, spread_text(r.spread), breakdown_text(r),
                        asymmetry_text(r.asymmetry), operations_text(r.operations), nanoseconds_text(r.ns_per_update));
        std::string const what = plain ? "" : happened_text(c, r);
        out += paint(best ? "32" : r.broken ? "31" : "0", line + (what.empty() ? "" : "  " + what)) + '\n';
    }
    out += "\nlow, mid, high: digits kept that nine tenths, a half and a tenth of the checkpoints reach, along the record";
    out += plain && c.options.forgetting == 1 ? " and three other\norders of its rows; " : ";\n";
    out += plain ? "against the exact answer for the data as stored, at most the arithmetic's own.\n"
                 : "for the data as stored, at most the arithmetic's own. A row's end says what the composition did, or why it cannot be.\n"
                   "ops: of the variant alone. ns is not measured.\n";
    out +=
        "breakdown: first step at which the stored P was not positive definite (decided exactly) or not finite.\n"
        "ops, ns: operations and nanoseconds a row, theta included. qr_block and the sparse forms take blocks of rows: not recommended.\n"
        "The recommendation never broke down and is as accurate as the best: in theta, worst component and P its spread reaches the\n"
        "best's. Of several: a factor before P or its inverse, covariance before information, then the fewest operations.\n";
    return out;
}

namespace {

Json composition_json(Comparison const& c) {
    Composition const& of = c.options.composition;
    if (of.empty()) return nullptr;
    Json numbers = Json::object();
    for (size_t i = 0; i < of.parameters.size(); ++i)
        numbers[std::string(std::ranges::find(controls(), of.control, &Control::name)->parameters[i].name)] = of.parameters[i];
    return {{"control", of.control.empty() ? Json(nullptr) : Json(of.control)},
            {"parameters", numbers},
            {"window", of.window > 0 ? Json(of.window) : Json(nullptr)},
            {"guard", of.guard.empty() ? Json(nullptr) : Json(of.guard)},
            {"text", composition_text(of)},
            {"digits", against_text(c)}};
}

/// What a composition did, at each checkpoint.
constexpr std::pair<char const*, Index Happened::*> counted[] = {
    {"refactored", &Happened::refactored}, {"unusable", &Happened::unusable}, {"outliers", &Happened::outliers},
    {"changes", &Happened::changes},       {"windups", &Happened::windups},   {"breakdowns", &Happened::breakdowns}};
Json happened_json(Result const& r) {
    Json out;
    for (auto const& [name, count] : counted) {
        out[name] = Json::array();
        for (Happened const& h : r.happened) out[name].push_back(h.*count);
    }
    out["handed_over"] = Json::array();
    for (Happened const& h : r.happened) out["handed_over"].push_back(h.handed_over);
    return out;
}

}  // namespace

std::string as_json(Comparison const& c) {
    Json out;
    out["version"] = RLSLAB_VERSION;
    out["options"] = {
        {"forgetting", c.options.forgetting}, {"p0", c.options.p0 ? Json(*c.options.p0) : Json(nullptr)}, {"seed", c.options.seed}};
    out["data"] = {{"rows", c.rows}, {"skipped", c.skipped}, {"size", c.size}, {"parameters", c.names}, {"regressors", c.model.regressors}};
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
    if (!c.options.composition.empty()) out["composition"] = composition_json(c);
    out["warnings"] = warnings(c);
    out["checkpoints"] = c.checkpoints;
    out["storage"] = Json::array();
    for (Storage const& s : c.storage)
        out["storage"].push_back({{"arithmetic", s.arithmetic},
                                  {"forgetting", s.forgetting},
                                  {"rank", s.rank},
                                  {"in_range", s.in_range},
                                  {"theta_digits", digits_json(s.theta_digits)},
                                  {"prior_bias", short_json(s.prior_bias)},
                                  {"component_bias", short_json(s.component_bias)}});
    out["results"] = Json::array();
    for (Result const& r : c.results) {
        Json spread, path;
        for (size_t m = 0; m < 3; ++m) {
            static constexpr char const* names[] = {"theta", "worst", "covariance"};
            spread[names[m]] = r.spread ? spread_json((*r.spread).*PerMeasure<Spread>::all()[m]) : Json(nullptr);
            path[names[m]] = Json::array();
            for (Digits const& digits : r.path) path[names[m]].push_back(digits_json(digits.*Digits::all()[m]));
        }
        out["results"].push_back(
            {{"variant", r.entry->variant},
             {"arithmetic", r.entry->arithmetic->name},
             {"theta_digits", digits_json(r.last.theta)},
             {"theta_digits_worst", digits_json(r.last.worst)},
             {"covariance_digits", digits_json(r.last.covariance)},
             {"spread", spread},
             {"path", path},
             {"runs", r.runs},
             {"broken", r.broken},
             {"breakdown", r.breakdown ? Json{{"step", r.breakdown->step}, {"kind", r.breakdown->kind}} : Json(nullptr)},
             {"asymmetry", r.asymmetry ? short_json(*r.asymmetry) : Json(nullptr)},
             {"operations", r.operations ? Json(*r.operations) : Json(nullptr)},
             {"ns_per_update", r.ns_per_update ? short_json(*r.ns_per_update) : Json(nullptr)}});
        if (c.options.composition.empty()) continue;
        Json& row = out["results"].back();
        row["obstacle"] = r.obstacle.empty() ? Json(nullptr) : Json(r.obstacle);
        row["certified_to"] = r.certified_to;
        row["happened"] = happened_json(r);
    }
    out["code"] = code(c);
    out["recommendation"] = Json::array();
    for (Recommendation const& r : c.recommendations)
        out["recommendation"].push_back(
            {{"arithmetic", r.arithmetic}, {"variant", r.variant.empty() ? Json(nullptr) : Json(r.variant)}, {"why", r.why}});
    return out.dump(2) + '\n';
}

std::string as_csv(Comparison const& c) {
    std::string out =
        "variant,arithmetic,theta_digits,theta_digits_worst,covariance_digits,breakdown_step,breakdown_kind,"
        "asymmetry,operations,ns_per_update,runs,broken";
    for (char const* of : {"theta", "worst", "covariance"})
        for (char const* point : {"low", "median", "high"}) out += fmt::format(",{}_{}", of, point);
    bool const plain = c.options.composition.empty();
    if (!plain) {
        out += ",obstacle,certified_to";
        for (auto const& [name, count] : counted) out += fmt::format(",{}", name);
        out += ",handed_over";
    }
    out += '\n';
    auto const cell = [](Json const& value) { return value.is_null() ? std::string() : value.dump(); };
    for (Result const& r : c.results) {
        out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}", r.entry->variant, r.entry->arithmetic->name,
                           cell(digits_json(r.last.theta)), cell(digits_json(r.last.worst)), cell(digits_json(r.last.covariance)),
                           r.breakdown ? fmt::format("{}", r.breakdown->step) : "", r.breakdown ? r.breakdown->kind : "",
                           r.asymmetry ? cell(short_json(*r.asymmetry)) : "", r.operations ? fmt::format("{}", *r.operations) : "",
                           r.ns_per_update ? cell(short_json(*r.ns_per_update)) : "", r.runs, r.broken);
        for (auto const m : PerMeasure<Spread>::all())
            out += r.spread ? fmt::format(",{},{},{}", cell(tenths_json(((*r.spread).*m).low)), cell(tenths_json(((*r.spread).*m).median)),
                                          cell(tenths_json(((*r.spread).*m).high)))
                            : ",,,";
        if (!plain) {
            Happened const last = r.happened.empty() ? Happened{} : r.happened.back();
            out += fmt::format(",{},{}", r.obstacle.empty() ? "" : fmt::format("\"{}\"", r.obstacle), r.certified_to);
            for (auto const& [name, count] : counted) out += fmt::format(",{}", last.*count);
            out += fmt::format(",{}", last.handed_over ? 1 : 0);
        }
        out += '\n';
    }
    return out;
}

}  // namespace rlslab
