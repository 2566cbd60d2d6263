// The text of the report, and curves from rows. src/lab/report/ makes pages, drawings and formulas.
#include <rlslab/studies/report.hpp>
#include "src/lab/report/axis.hpp"
#include "src/lab/report/page.hpp"

#include <rlslab/studies/interval.hpp>
#include <rlslab/studies/verdicts.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace rlslab::studies {
using namespace report;
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

/// With its kind, where its band is from, and the data. The class colours it.
std::string claim_html(Study const& study, size_t i, Judgement const& judgement, bool named) {
    Claim const& claim = study.claims[i];
    std::string const& data = data_of(study, claim);
    std::string out = fmt::format("<li class=\"{0}\"><b>{0}</b> ", name_of(judgement.verdict));
    if (named) out += fmt::format("<a href=\"#{0}\">{0}</a>: ", study.name);
    out += fmt::format("{}<span class=\"measured\">{}</span>", escaped(claim.text), escaped(judgement.measured));
    out += fmt::format("<span class=\"soft\">{}; band: {}{}{}</span></li>\n", name_of(claim.basis.kind),
                       escaped(claim.basis.band),
                       claim.basis.proof.empty() ? "" : "; proof: " + escaped(claim.basis.proof),
                       data.empty() ? "" : "; data: " + escaped(data));
    return out;
}

/// All claims with this verdict, of every study.
std::string list_of(std::vector<Outcome> const& outcomes, Verdict verdict) {
    std::string out;
    for (Outcome const& outcome : outcomes)
        for (size_t i = 0; i < outcome.judgements.size(); ++i)
            if (outcome.judgements[i].verdict == verdict)
                out += claim_html(*outcome.study, i, outcome.judgements[i], true);
    return out.empty() ? "<p>None.</p>\n" : "<ul class=\"claims\">\n" + out + "</ul>\n";
}

/// What fails first, what is undecided next, and how far to believe the rest.
std::string summary(std::vector<Outcome> const& outcomes) {
    std::string rows;
    auto const counts = counted(outcomes);
    for (Kind const kind : {Kind::verification, Kind::reproduction, Kind::own_result}) {
        Count const& c = counts[size_t(kind)];
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", name_of(kind), c.holds, c.fails,
                            c.undecided);
    }
    size_t before = 0, after = 0, unsaid = 0;
    for (Outcome const& outcome : outcomes)
        for (size_t i = 0; i < outcome.judgements.size(); ++i) {
            Basis const& basis = outcome.study->claims[i].basis;
            auto const says = [&](char const* word) { return basis.band.find(word) != std::string::npos; };
            if (basis.kind == Kind::own_result) ++(says("after") ? after : says("before") ? before : unsaid);
        }
    return fmt::format(
        "<section id=\"fails\"><h2>What fails</h2>\n{}<h2>What is undecided</h2>\n<details><summary>Claims whose "
        "interval reaches over an end of the band, or that have fewer than {} seeds</summary>{}</details>\n<h2>How "
        "many claims</h2>\n"
        "<table><thead><tr><th>kind</th><th>hold</th><th>fail</th><th>undecided</th></tr></thead><tbody>\n{}</tbody></"
        "table>\n"
        "<p>A verification asks whether the code does what the formula says; it is no finding. A reproduction repeats "
        "an earlier number: published, a textbook's, or the project's own earlier experiment's, as its band says. Of "
        "the findings {} say that the band was set before the run, {} that a result had been seen by then, and {} name "
        "a formula and no time. A claim that is estimated from seeds holds when its interval lies inside the band, "
        "fails when it lies outside, and is undecided otherwise. Each interval misses its number with probability {} "
        "at most, so that at most {:.2f} of the verdicts that rest on an interval are expected to be wrong, as far as "
        "their bands were set beforehand. Where a line shows several groups, each interval is its own. A claim about "
        "most runs holds when, but for that risk, fewer than half of all seeds are outside (of n seeds none: fewer "
        "than 6.9/n of all); one about every run holds by a proof that it names, and fails by one counterexample. "
        "Intervals: order statistics of a median; Student's t of a mean of normal numbers or averages, on logarithms "
        "where it is a size; chi-squared with Satterthwaite's freedom of a root mean square; Clopper and Pearson's of "
        "a share. Runs that broke down leave a slope between bounds, and count. Fewer than {} seeds have "
        "none.</p></section>\n",
        list_of(outcomes, Verdict::fails), fewest_seeds, list_of(outcomes, Verdict::undecided), rows, before, after,
        unsaid, claim_risk, expected_errors(outcomes), fewest_seeds);
}

/// What mark and band of its figures are.
std::string key_of(Study const& study, Outcome const& outcome) {
    bool const curves = std::ranges::any_of(study.plots, [](Plot const& plot) { return !plot.cells; });
    bool const guided =
        std::ranges::any_of(study.plots, [](Plot const& plot) { return !plot.cells && !plot.guides.empty(); });
    std::string const replicates = [&]() -> std::string {
        for (std::string const& column : outcome.table.columns())
            if (column == "replicate") return fmt::format("{} seeds", outcome.table.distinct(column).size());
        return "rows";
    }();
    if (!curves) return {};
    return fmt::format(
        "<p class=\"soft\">A mark is the median over the {} of a group, a band reaches from the least to "
        "the greatest{}.</p>\n",
        replicates, guided ? "; grey dashes are guides, no data" : "");
}

std::string section(Outcome const& outcome, std::vector<Figure> const& drawn) {
    Study const& study = *outcome.study;
    std::string out = fmt::format("<section id=\"{0}\"><h2>{0}</h2>\n<p class=\"question\">{1}</p>\n", study.name,
                                  escaped(study.question));
    if (auto const counts = counted({&outcome, 1}); !outcome.judgements.empty()) {
        Count all;
        for (Count const& c : counts) all.holds += c.holds, all.fails += c.fails, all.undecided += c.undecided;
        out += fmt::format("<p>{} of {} claims hold, {} fail, {} are undecided.</p>\n", all.holds, all.claims(),
                           all.fails, all.undecided);
    }
    if (!drawn.empty()) out += figure_html(drawn.front()) + key_of(study, outcome);
    out += fmt::format("<p>{}</p>\n", escaped(study.interpretation));
    if (!study.formula.empty()) out += formula_html(study.formula);
    if (!study.claims.empty()) out += "<ul class=\"claims\">\n";
    if (!outcome.changed.empty())
        out += fmt::format("<li class=\"undecided\"><b>not judged</b> factors changed: {}</li>\n",
                           escaped(outcome.changed));
    for (size_t i = 0; i < outcome.numbers.size(); ++i)
        out += fmt::format("<li class=\"undecided\"><b>not judged</b> {}<span class=\"measured\">{}</span></li>\n",
                           escaped(study.claims[i].text), escaped(outcome.numbers[i]));
    for (Verdict const verdict : {Verdict::fails, Verdict::undecided, Verdict::holds})
        for (size_t i = 0; i < outcome.judgements.size(); ++i)
            if (outcome.judgements[i].verdict == verdict) out += claim_html(study, i, outcome.judgements[i], false);
    if (!study.claims.empty()) out += "</ul>\n";
    for (size_t i = 1; i < drawn.size(); ++i) out += figure_html(drawn[i]);
    out += fmt::format(
        "<details><summary>The table: {1} rows, all in <a href=\"{0}.csv\">{0}.csv</a></summary>{2}</details>\n",
        study.name, outcome.table.rows().size(), beginning(outcome.table));
    out += "<details><summary>Provenance, and how to run it again</summary><pre>";
    for (std::string const& line : outcome.provenance) out += escaped(line) + '\n';
    return out + "</pre></details></section>\n";
}

// --- curves from rows: one for each series and panel, through the median of the rows at one place --------------------

Curve curve(std::string name, Look look, Table const& rows, Plot const& plot, bool log_x, bool log_y) {
    Curve out{.name = std::move(name), .look = std::move(look)};
    std::map<double, std::vector<double>> at;
    std::vector<double> const x = rows.numbers(plot.x), y = rows.numbers(plot.y);
    for (size_t i = 0; i < x.size(); ++i)
        if (Axis::shows(x[i], log_x) && Axis::shows(y[i], log_y) && !(y[i] < plot.floor && plot.floor > 0))
            at[x[i]].push_back(y[i]);
    for (auto const& [place, values] : at) {
        out.x.push_back(place);
        out.y.push_back(median(values));
        out.lower.push_back(*std::ranges::min_element(values));
        out.upper.push_back(*std::ranges::max_element(values));
    }
    return out;
}

/// The word that most of the cells hold, the first of equals; and how many hold it.
std::pair<std::string, size_t> most_frequent(std::vector<std::vector<Cell>> const& rows, size_t column) {
    std::pair<std::string, size_t> out;
    for (std::vector<Cell> const& row : rows) {
        auto const same = [&](std::vector<Cell> const& other) { return other[column] == row[column]; };
        if (size_t const count = size_t(std::ranges::count_if(rows, same)); count > out.second)
            out = {as_text(row[column]), count};
    }
    return out;
}

/// A cell for each (x, series): the median of its numbers, or its most frequent word with the word's share.
Curve cells(Table const& rows, Plot const& plot, std::string const& column) {
    Curve out{.name = column};
    for (Cell const& line : rows.distinct(plot.series)) {
        Table const along = rows.where(plot.series, line);
        for (Cell const& place : along.distinct(plot.x)) {
            Table const here = along.where(plot.x, place);
            bool const words = std::holds_alternative<std::string>(here.rows().front()[here.index(column)]);
            double value = 0;
            if (words) {
                auto const [word, count] = most_frequent(here.rows(), here.index(column));
                out.says.push_back(word);
                value = double(count) / double(here.rows().size());
            } else value = median(here.numbers(column));
            out.x.push_back(std::get<double>(place));
            out.y.push_back(value);
            out.lower.push_back(value);
            out.upper.push_back(value);
            out.row.push_back(as_text(line));
        }
    }
    return out;
}

/// Over the panel's x, which is where the curves are.
Curve guide(Guide const& of, std::vector<Curve> const& curves, size_t place, bool log_x, bool log_y, double floor) {
    constexpr std::array dashes{"#555555", "#999999", "#bbbbbb"};
    Curve out{.name = of.label, .look = {dashes[place % dashes.size()], true, ""}};
    double from = INFINITY, to = -INFINITY;
    for (Curve const& c : curves)
        for (double const x : c.x) from = std::min(from, x), to = std::max(to, x);
    constexpr int points = 60;
    for (int i = 0; i <= points && from <= to; ++i) {
        double const part = double(i) / points;
        double const x = log_x ? from * correctly::pow(to / from, part) : from + (to - from) * part, y = of.y(x);
        if (!Axis::shows(y, log_y) || (floor > 0 && y < floor)) continue;
        out.x.push_back(x);
        out.y.push_back(y);
    }
    return out;
}

}  // namespace

std::vector<Figure> figures(Study const& study, Table const& table) {
    std::vector<Figure> out;
    for (Plot const& plot : study.plots) {
        bool const log_x = plot.log.find('x') != std::string::npos, log_y = plot.log.find('y') != std::string::npos;
        Figure figure{fmt::format("{}-{}", study.name, out.size() + 1),
                      plot.title,
                      plot.x_label.empty() ? plot.x : plot.x_label,
                      plot.y_label.empty() ? plot.y : plot.y_label,
                      log_x,
                      log_y,
                      plot.cells,
                      {},
                      plot.series_label.empty() ? plot.series : plot.series_label};
        Table rows = table;
        for (auto const& [column, values] : plot.where) rows = rows.where(column, values);
        // The same mark for the same series in every panel.
        std::vector<Cell> const all_series = rows.distinct(plot.series);
        std::vector<std::string> const by = plot.panel.empty() ? std::vector<std::string>{} : std::vector{plot.panel};
        for (auto const& [name, here] : rows.groups(by)) {
            Panel panel{name};
            if (plot.cells) {
                panel.curves.push_back(cells(here, plot, plot.y));
                for (Guide const& border : plot.guides) panel.guides.push_back(cells(here, plot, border.label));
            } else
                for (size_t place = 0; place < all_series.size(); ++place) {
                    Table const one = here.where(plot.series, all_series[place]);
                    if (one.empty()) continue;
                    bool const word = std::holds_alternative<std::string>(all_series[place]);
                    std::string const series = as_text(all_series[place]);
                    panel.curves.push_back(curve(word ? series : plot.series + " " + series,
                                                 look_of(family_of_variant(series), place), one, plot, log_x, log_y));
                }
            for (size_t place = 0; place < plot.guides.size() && !plot.cells; ++place)
                panel.guides.push_back(guide(plot.guides[place], panel.curves, place, log_x, log_y, plot.floor));
            figure.panels.push_back(std::move(panel));
        }
        out.push_back(std::move(figure));
    }
    return out;
}

std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    std::string sections, contents;
    size_t claims = 0, held = 0;
    for (Count const& c : counted(outcomes)) claims += c.claims(), held += c.holds;
    for (Outcome const& outcome : outcomes) {
        sections += section(outcome, figures(*outcome.study, outcome.table));
        auto const worst = std::ranges::min_element(outcome.judgements, {}, &Judgement::verdict);
        contents += fmt::format("<li class=\"{0}\"><a href=\"#{1}\">{1}</a> {2}</li>\n",
                                name_of(!outcome.changed.empty()            ? Verdict::undecided
                                        : worst == outcome.judgements.end() ? Verdict::holds
                                                                            : worst->verdict),
                                outcome.study->name, escaped(outcome.study->question));
    }
    // A sweep has no claims and one budget.
    std::string const held_of = options.run ? ""
                                            : fmt::format("{} of {} claims hold, in {} {}. ", held, claims,
                                                          outcomes.size(), outcomes.size() == 1 ? "study" : "studies");
    bool const own = options.program != "rlslab";  // of studies that may measure anything
    return page(
        options.program + (options.run ? ": a sweep" : ": studies"),
        fmt::format(
            "<header><h1>{}</h1>\n<p>{}{}<span "
            "class=\"soft\">rlslab {} {}, {}seed {}.</span></p></header>\n<nav><ol>\n{}</ol></nav>\n{}",
            own ? escaped(options.program) : "Which variant of recursive least squares can be trusted?", held_of,
            own ? ""
                : "Every error is measured against the exact minimiser for the bits the variant was given, with a "
                  "proven bound. ",
            RLSLAB_VERSION, revision, options.run ? "" : fmt::format("{} budget, ", name_of(options.budget)),
            options.seed, contents,
            (options.run ? "" : summary(outcomes)) + sections + as_html(run_of(outcomes, options))));
}

}  // namespace rlslab::studies
