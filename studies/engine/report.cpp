// The report's HTML: what it says is written here, what it draws goes along as JSON.
#include "report.hpp"

#include "assets.hpp"

#include <rlslab/revision.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {

using Json = nlohmann::ordered_json;

std::string escaped(std::string_view text) {
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        char const c = text[i];
        if (text.substr(i, 3) == "+- ") out += "±", ++i;
        else if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else out += c;
    }
    return out;
}

namespace {

/// JSON inside a script element: nothing in it may end the element.
std::string in_script(std::string text) {
    for (size_t at = 0; (at = text.find("</", at)) != std::string::npos;) text.replace(at, 2, "<\\/");
    return text;
}

Json json(Curve const& curve) {
    Json out = {{"name", curve.name}, {"colour", curve.look.colour}, {"dashed", curve.look.dashed}, {"mark", curve.look.mark},
                {"x", curve.x}, {"y", curve.y}};
    auto const other = [&](std::vector<double> const& bound) { return !std::ranges::equal(bound, curve.y, [](double a, double b) { return a == b || (a != a && b != b); }); };
    if (other(curve.low) || other(curve.high)) out["low"] = curve.low, out["high"] = curve.high;
    if (!curve.row.empty()) out["row"] = curve.row;
    if (!curve.marks) out["marks"] = false;
    if (!curve.line) out["line"] = false;
    return out;
}

Json json(Figure const& figure) {
    Json panels = Json::array();
    for (Panel const& panel : figure.panels) {
        Json one = {{"name", panel.name}, {"curves", Json::array()}, {"guides", Json::array()}};
        for (Curve const& curve : panel.curves) one["curves"].push_back(json(curve));
        for (Curve const& curve : panel.guides) one["guides"].push_back(json(curve));
        panels.push_back(std::move(one));
    }
    return {{"name", figure.name}, {"title", figure.title}, {"x", figure.x}, {"y", figure.y}, {"logX", figure.log_x},
            {"logY", figure.log_y}, {"cells", figure.cells}, {"series", figure.series}, {"square", figure.square}, {"ownY", figure.own_y}, {"panels", panels}};
}

/// As much of a table as anybody reads in a page; all of it is in the CSV file.
std::string table_text(Table const& table) {
    constexpr size_t most = 1000;
    std::string out = fmt::format("{}\n", fmt::join(table.columns(), ","));
    for (size_t i = 0; i < std::min(most, table.rows().size()); ++i) out += csv_line(table.rows()[i]) + '\n';
    return out;
}

}  // namespace

std::string figure_html(Figure const& figure) {
    return fmt::format("<figure id=\"{0}\"><figcaption>{1}</figcaption><div class=\"plot\" data-figure=\"{0}\">"
                       "<img src=\"figures/{0}.svg\" alt=\"{1}\"></div></figure>\n", figure.name, escaped(figure.title));
}

std::string page(std::string const& title, std::string const& body, std::vector<Figure> const& drawn, Tables const& tables) {
    Json data = {{"figures", Json::object()}, {"tables", Json::object()}};
    for (Figure const& figure : drawn) data["figures"][figure.name] = json(figure);
    for (auto const& [name, text] : tables) data["tables"][name] = text;
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>{}</title>\n<style>{}</style></head><body>\n{}"
        "<script>{}</script>\n<script>{}</script>\n<script type=\"application/json\" id=\"data\">{}</script>\n<script>{}</script>\n</body></html>\n",
        escaped(title), assets::style(), body, in_script(std::string(assets::plotly())), in_script(std::string(assets::temml())),
        in_script(data.dump()), assets::script());
}

namespace {

std::string section(Outcome const& outcome, std::vector<Figure> const& drawn) {
    Study const& study = *outcome.study;
    std::string out = fmt::format("<section id=\"{0}\"><h2>{0}</h2>\n<p class=\"question\">{1}</p>\n", study.name, escaped(study.question));
    if (!study.formula.empty()) out += fmt::format("<div class=\"formula\" data-tex=\"{0}\">{0}</div>\n", escaped(study.formula));
    out += fmt::format("<p>{}</p>\n<ul class=\"claims\">\n", escaped(study.reading));
    for (size_t i = 0; i < outcome.findings.size(); ++i) {
        Claim const& claim = study.claims[i];
        Finding const& finding = outcome.findings[i];
        out += fmt::format("<li class=\"{}\"><b>{}</b> {}<span class=\"measured\">{}</span>{}</li>\n", finding.holds ? "holds" : "fails",
                           finding.holds ? "holds" : "fails", escaped(claim.text), escaped(finding.measured),
                           claim.source.empty() ? "" : fmt::format("<span class=\"soft\">{}</span>", escaped(claim.source)));
    }
    out += "</ul>\n";
    for (Figure const& figure : drawn) out += figure_html(figure);
    out += fmt::format("<details class=\"table\" data-table=\"{0}\"><summary>The table: {1} rows, all in <a href=\"{0}.csv\">{0}.csv</a></summary>"
                       "<div class=\"scroll\" data-rows=\"{1}\"></div></details>\n", study.name, outcome.table.rows().size());
    out += "<details><summary>Provenance, and how to run it again</summary><pre>";
    for (std::string const& line : outcome.provenance) out += escaped(line) + '\n';
    return out + "</pre></details></section>\n";
}

}  // namespace

std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    std::vector<Figure> all;
    Tables tables;
    std::string sections, contents;
    size_t claims = 0, held = 0;
    for (Outcome const& outcome : outcomes) {
        std::vector<Figure> const drawn = figures(*outcome.study, outcome.table);
        all.insert(all.end(), drawn.begin(), drawn.end());
        tables.emplace_back(outcome.study->name, table_text(outcome.table));
        sections += section(outcome, drawn);
        claims += outcome.findings.size();
        for (Finding const& finding : outcome.findings) held += finding.holds;
        contents += fmt::format("<li class=\"{0}\"><a href=\"#{1}\">{1}</a> {2}</li>\n", outcome.holds() ? "holds" : "fails",
                                outcome.study->name, escaped(outcome.study->question));
    }
    return page("rlslab: studies",
                fmt::format("<header><h1>Which variant of recursive least squares can be trusted?</h1>\n<p>{} of {} claims hold, in {} {}. "
                            "Every error is measured against the exact minimiser for the bits the variant was given, with a proven bound. "
                            "<span class=\"soft\">rlslab {} {}, {} budget, seed {}.</span></p></header>\n<nav><ol>\n{}</ol></nav>\n{}",
                            held, claims, outcomes.size(), outcomes.size() == 1 ? "study" : "studies", RLSLAB_VERSION, revision,
                            options.budget == Budget::quick ? "quick" : "full", options.seed, contents, sections),
                all, tables);
}

}  // namespace rlslab
