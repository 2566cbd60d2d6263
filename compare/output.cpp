// A comparison as a table for people, as JSON and CSV for programs. Long: three writings of the same numbers.
#include "compare/answer.hpp"
#include "compare/compare.hpp"
#include "compare/composed_words.hpp"
#include "compare/digits_answer.hpp"
#include "compare/foretold.hpp"
#include "compare/recommend.hpp"
#include "compare/words.hpp"

#include <rlslab/input/text.hpp>

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

/// The columns of the table for which a terminal has room; 0: all.
struct Layout {
    bool low = true, high = true, asymmetry = true;
    explicit Layout(size_t columns) {
        for (bool* drop : {&asymmetry, &high, &low})
            if (columns > 0 && width() > columns) *drop = false;
    }
    /// Of one measure: "  4.2  5.3  5.7 ".
    size_t group() const { return 7 + (low ? 5u : 0u) + (high ? 5u : 0u); }
    size_t width() const { return 24 + 3 * group() + 20 + (asymmetry ? 6u : 0u) + 13; }
    std::string left_out() const {
        return fmt::format("{}{}{}", low ? "" : "low, ", high ? "" : "high, ", asymmetry ? "" : "asym");
    }
    std::string cells(std::string_view l, std::string_view m, std::string_view h) const {
        return (low ? fmt::format(" {:>5} {:>4}", l, m) : fmt::format(" {:>5}", m)) +
               (high ? fmt::format(" {:>4} ", h) : " ");
    }
};

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

std::string spread_text(std::optional<PerMeasure<Spread>> const& spread, Layout const& layout) {
    std::string out;
    for (auto const m : PerMeasure<Spread>::all())
        out += spread ? layout.cells(tenths(((*spread).*m).low), tenths(((*spread).*m).median),
                                     tenths(((*spread).*m).high))
                      : layout.cells("-", "-", "-");
    return out;
}
std::string plain_exponent(std::string const& x) { return x.ends_with("e0") ? x.substr(0, x.size() - 2) + "  " : x; }

/// A number's first digits: as many as go into `width` columns beside its exponent.
std::string cut(std::string const& number, size_t width) {
    size_t const exponent = std::min(number.rfind('e'), number.size()), tail = number.size() - exponent;
    return number.size() <= width ? number : number.substr(0, width - std::min(tail, width)) + number.substr(exponent);
}

/// Both exact solutions, and in how many digits they agree.
std::string theta_text(Comparison const& c, size_t width) {
    constexpr size_t whole = 37, least = 14;
    bool const plain = c.options.composition.empty();
    size_t name = 11;
    for (std::string const& one : c.names) name = std::max(name, one.size());
    size_t const number = std::clamp((width - std::min(width, name + 9)) / 2, least, whole);
    bool const wide = number == whole;
    std::string out = fmt::format("{:<{}} {:>{}} {:>{}}  {}\n", "exact theta", name,
                                  wide ? "least squares, without prior" : "least squares", number,
                                  !wide   ? "with the prior"
                                  : plain ? "with the prior: what filters are after"
                                          : "with the prior, of all rows",
                                  number, "agree");
    for (size_t i = 0; i < c.names.size(); ++i)
        out += fmt::format("{:<{}} {:>{}} {:>{}}  {:>5}\n", c.names[i], name,
                           cut(plain_exponent(c.least_squares[i]), number), number,
                           cut(plain_exponent(c.theta[i]), number), number, tenths(c.agreement[i]));
    return out + (wide ? "" : "digits cut off, not rounded: --json has 30\n");
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

/// The regressors are a delay line: the fast forms, apart.
std::string fast_text(Comparison const& c, Paint const& paint) {
    std::string out;
    std::string_view arithmetic;
    for (FastResult const& r : c.fast) {
        if (r.arithmetic != arithmetic) {
            arithmetic = r.arithmetic;
            out += '\n' + paint("1", fmt::format("fast forms in {}", arithmetic)) +
                   paint("2", fmt::format("{:>{}}  {:<19}{:>6}", "prediction error", 47 - 14 - arithmetic.size(),
                                          "breakdown", "ops")) +
                   '\n';
        }
        std::string const broke =
            r.breakdown ? fmt::format("{} at {}", name_of(r.breakdown->kind), r.breakdown->step) : "none";
        out += paint(r.breakdown ? "31" : "0",
                     fmt::format("  {:<28}{:>17}  {:<19}{:>6}", r.form,
                                 r.digits ? fmt::format("{:.1f}", *r.digits) : "-", broke, r.operations)) +
               '\n';
    }
    return out;
}

}  // namespace

std::string as_table(Comparison const& c, bool colour, size_t columns) {
    Paint const paint{colour};
    Layout const layout(columns);
    size_t const width = line_width(columns, text_width);
    bool const plain = c.options.composition.empty(), whole = layout.left_out().empty();
    auto const head = [&](std::string const& name, std::string const& text) {
        return fmt::format("{:<12}", name) + wrapped(text, 12, 12, width) + '\n';
    };
    std::string const condition = std::isinf(c.condition) ? "beyond 1e308" : fmt::format("{:.2g}", c.condition);
    std::string record = c.model.file.empty() ? "" : c.model.file + ": ";
    record += fmt::format("{} rows, {} skipped", c.rows, c.skipped);
    if (c.run && c.run->rows > 0 && c.run->rows < c.rows + c.skipped)
        record += fmt::format(" (with those that --time put between the {} of the file)", c.run->rows);
    std::string out = head("record", record + fmt::format("; {} parameter{}, condition {}, forgetting {}", c.size,
                                                          c.size == 1 ? "" : "s", condition, c.options.forgetting));
    out += head("prior", prior_text(c));
    if (!plain) out += head("composition", composition_text(c.options.composition)) + head("digits", against_text(c));
    for (std::string const& warning : warnings(c)) out += paint("31", head("warning", warning));
    out += '\n';
    if (c.digits) out += answer_text(*c.digits, colour, columns);
    else out += paint("32", verdict(c, columns > 0 ? width : std::string::npos));
    if (std::string const paste = code(c); !paste.empty() && !c.digits)
        out += '\n' + indented(columns > 0 ? folded(paste, columns - 4) : paste);
    out += '\n' + theta_text(c, columns > 0 ? columns : text_width);
    out += fmt::format("proven to {:.0e} relative, for the data as binary64, at {} bits\n", c.radius, c.bits);

    std::string_view arithmetic;
    for (Result const& r : c.results) {
        Arithmetic const& a = *r.entry->arithmetic;
        if (a.name != arithmetic) {
            arithmetic = a.name;
            std::string const title = fmt::format("{} ({} bits, {:.1f} digits)", a.name, a.digits, a.decimal_digits());
            size_t const group = layout.group(), at = 23 + group;  // where the first measure's name ends
            out += '\n' + paint("1", title) + (whole ? "" : "\n") +
                   paint("2", fmt::format("{:>{}}{:>{}}{:>{}}", "theta",
                                          whole ? at - std::min<size_t>(at - 6, title.size()) : at,
                                          whole ? "worst component" : "worst", group, "P", group)) +
                   '\n';
            for (RoundingEffect const& s : c.rounding)
                if (s.arithmetic == a.name) out += paint("2", "  " + wrapped(rounding_text(s, c), 2, 4, width)) + '\n';
            std::string labels;
            for (int m = 0; m < 3; ++m) labels += layout.cells("low", "mid", "high");
            out += paint("2", fmt::format("{:<24}{} {:<19}{}{:>6}{:>7}", "", labels, "breakdown",
                                          layout.asymmetry ? "  asym" : "", "ops", "ns")) +
                   '\n';
        }
        bool const best = is_recommended(c, r);
        std::string const line = fmt::format("{} {:<22}{} {:<19}{}{:>6}{:>7}", best ? '*' : ' ', r.entry->variant,
                                             spread_text(r.spread, layout), breakdown_text(r),
                                             layout.asymmetry ? fmt::format("{:>6}", asymmetry_text(r.asymmetry)) : "",
                                             operations_text(r.operations), nanoseconds_text(r.ns_per_update));
        std::string what = plain ? "" : counts_text(c, r);
        if (!what.empty())
            what = columns > 0 && line.size() + 2 + what.size() > columns ? "\n    " + wrapped(what, 4, 4, width)
                                                                          : "  " + what;
        out += paint(best ? "32" : r.broken + r.others.broken ? "31" : "0", line + what) + '\n';
        if (&r != &c.results.back() && (&r + 1)->entry->arithmetic == &a) continue;
        std::vector<std::string> const others = other_orders_text(c, a.name);
        for (size_t i = 0; i < others.size(); ++i)
            out += paint(i == 0                       ? "1"
                         : others[i].starts_with('*') ? "32"
                                                      : "0",
                         wrapped(others[i], 0, 4, width)) +
                   '\n';
    }
    auto const note = [&](std::string const& text) { out += wrapped(text, 0, 0, width) + '\n'; };
    out += fast_text(c, paint);
    out += '\n';
    if (!whole)
        note(
            fmt::format("Left out, for {} columns: {}. A terminal of {} columns shows them, so do | cat, --out DIR, "
                        "--csv and --json.",
                        columns, layout.left_out(), Layout(0).width()));
    note(fmt::format(
        "low, mid, high: digits kept that nine tenths, a half and a tenth of the checkpoints reach, along "
        "the record{}; {}",
        plain ? ", over four draws of the roundings or more" : "",
        plain ? "against the exact answer for the data as stored, at most the arithmetic's own."
              : "for the data as stored, at most the arithmetic's own. A row ends with what "
                "the composition did, or why it cannot be. ops: of the variant alone. ns is not measured."));
    note("breakdown: first step at which the stored P was not positive definite (decided exactly) or not finite." +
         foretold_text(c));
    note("ops, ns: operations and nanoseconds a row, with theta. qr_block and the sparse forms take blocks of rows.");
    if (!c.fast.empty())
        note(
            "Fast forms (docs/fast.md) hold neither P nor R. Digits of the prediction error against the certified "
            "theta of the rows before it; their line starts with zeros.");
    if (c.digits) note("The table is for the prior in the head. The answer (*) has a prior and a scaling of its own.");
    note(
        fmt::format("The recommendation is for the record's order. It never broke down and keeps {} digits of the "
                    "worst component at nine tenths of the checkpoints. Of such whose low is within half a digit of "
                    "all others', its largest loss is the least: in mid, to the best of each column that never broke "
                    "down. Of equals: a factor before P or its inverse, covariance before information, then the fewest "
                    "operations.",
                    wanted_digits(c.options)));
    return out;
}

namespace {

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
        if (c.options.composition.empty()) continue;
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
