// What the report says. Its page, figures and formulas are report/'s.
#include "studies/engine/report.hpp"

#include "report/page.hpp"
#include "studies/engine/revision.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab {
namespace {

/// The most rows of a table that a page shows; the CSV file has all.
std::string beginning(Table const& table) {
    constexpr size_t most = 200;
    std::vector<std::vector<std::string>> rows;
    for (size_t i = 0; i < std::min(most, table.rows().size()); ++i) {
        rows.emplace_back();
        for (Cell const& cell : table.rows()[i]) rows.back().push_back(as_text(cell));
    }
    std::string const out = table_html(table.columns(), rows);
    return table.rows().size() > most ? out + fmt::format("<p class=\"soft\">the first {} rows</p>\n", most) : out;
}

std::string section(Outcome const& outcome, std::vector<Figure> const& drawn) {
    Study const& study = *outcome.study;
    std::string out = fmt::format("<section id=\"{0}\"><h2>{0}</h2>\n<p class=\"question\">{1}</p>\n", study.name, escaped(study.question));
    if (!study.formula.empty()) out += formula_html(study.formula);
    out += fmt::format("<p>{}</p>\n<ul class=\"claims\">\n", escaped(study.interpretation));
    for (size_t i = 0; i < outcome.findings.size(); ++i) {
        Claim const& claim = study.claims[i];
        Finding const& finding = outcome.findings[i];
        out += fmt::format("<li class=\"{}\"><b>{}</b> {}<span class=\"measured\">{}</span>{}</li>\n", finding.holds ? "holds" : "fails",
                           finding.holds ? "holds" : "fails", escaped(claim.text), escaped(finding.measured),
                           claim.source.empty() ? "" : fmt::format("<span class=\"soft\">{}</span>", escaped(claim.source)));
    }
    out += "</ul>\n";
    for (Figure const& figure : drawn) out += figure_html(figure);
    out += fmt::format("<details><summary>The table: {1} rows, all in <a href=\"{0}.csv\">{0}.csv</a></summary>{2}</details>\n", study.name,
                       outcome.table.rows().size(), beginning(outcome.table));
    out += "<details><summary>Provenance, and how to run it again</summary><pre>";
    for (std::string const& line : outcome.provenance) out += escaped(line) + '\n';
    return out + "</pre></details></section>\n";
}

}  // namespace

std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    std::string sections, contents;
    size_t claims = 0, held = 0;
    for (Outcome const& outcome : outcomes) {
        sections += section(outcome, figures(*outcome.study, outcome.table));
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
                            options.budget == Budget::quick ? "quick" : "full", options.seed, contents, sections));
}

}  // namespace rlslab
