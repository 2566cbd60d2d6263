// Writes the page of a run: rlslab_bench_page RUN.json PAGE.html. Plots and tables in one file that loads nothing.
#include "measured.hpp"
#include "plot.hpp"

#include <rlslab/core/files.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <functional>

namespace {

using namespace rlslab::bench;

// Colours of Okabe & Ito: told apart with any kind of colour vision.
constexpr char const* style = R"(
:root { --text: #1a1a1a; --soft: #5c5c5c; --rule: #e3e3e3; --page: #fff; --floor: #000 }
body { margin: 0 auto; max-width: 1160px; padding: 1.2rem 1rem 3rem; color: var(--text); background: var(--page);
  font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif }
h1 { font-size: 1.7rem; line-height: 1.2; margin: .3rem 0 }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .2rem }
p { margin: .3rem 0 .8rem; max-width: 52rem }
.soft { color: var(--soft); font-size: .9rem }
svg { width: 100%; height: auto; display: block }
svg text { font-size: 13px; fill: var(--text) }
.grid { stroke: var(--rule) }
.line { stroke: currentColor; fill: currentColor }
.line polyline { fill: none; stroke-width: 1.8; stroke-linejoin: round }
.line .leader { stroke-width: .8; opacity: .6 }
.line .hollow { fill: var(--page); stroke-width: 1.5 }
.line text { fill: currentColor; stroke: none }
svg:hover .line:not(:hover) { opacity: .25 }
.line:hover polyline { stroke-width: 3 }
.covariance { color: #0072b2 } .factored-covariance { color: #00805e } .information, .batch, .sparse { color: #a8437f }
.peer { color: #d55e00 } .limit { color: var(--floor) }
.limit polyline, .peer polyline { stroke-dasharray: 6 4 }
.limit polyline { stroke-dasharray: 2 3 }
.legend { max-width: none; font-size: .88rem; color: var(--soft) }
.legend span { display: inline-block; margin-right: 1rem; white-space: nowrap }
.key { display: inline-block; width: 28px; vertical-align: -2px; margin-right: .35rem }
.swatch { display: inline-block; width: .8em; height: .8em; background: currentColor; border-radius: 2px; margin: 0 .3em 0 1em }
.narrow { display: none }
.scroll { overflow-x: auto }
table { border-collapse: separate; border-spacing: 0; font-size: .84rem; font-variant-numeric: tabular-nums; margin: .4rem 0 }
th, td { padding: .28rem .7rem; text-align: right; border-bottom: 1px solid var(--rule); white-space: nowrap; vertical-align: top }
th:first-child { text-align: left; position: sticky; left: 0; background: var(--page) }
td b { font-weight: 600 } td small { display: block; color: var(--soft); line-height: 1.3 }
td.least { background: #e8f1f8 } td .bad { color: #b00020; font-weight: 600 }
@media (max-width: 760px) { th:first-child { white-space: normal; padding-left: 0 } table { font-size: .76rem }
  .wide { display: none } .narrow { display: block } body { padding: .6rem .6rem 2rem } }
)";

using Rows = std::vector<Measured>;

template <class Keep>
Rows kept(Rows const& rows, Keep keep) {
    Rows out;
    std::ranges::copy_if(rows, std::back_inserter(out), keep);
    return out;
}

/// The distinct values of part(row), in order of appearance.
template <class Part>
std::vector<std::string> distinct(Rows const& rows, Part part) {
    std::vector<std::string> out;
    for (Measured const& row : rows)
        if (std::ranges::find(out, part(row)) == out.end()) out.push_back(part(row));
    return out;
}

Measured const* find(Rows const& rows, std::string const& name, std::string const& what) {
    auto const found = std::ranges::find_if(rows, [&](Measured const& r) { return r.name == name && r.what == what; });
    return found == rows.end() ? nullptr : &*found;
}

/// The row as a tooltip.
std::string sentence(Measured const& row) {
    std::string out = fmt::format("{}, {}: {} per row, ", row.name, row.what, time_for_people(row.nanoseconds));
    out += row.finite ? fmt::format("{:.1f} digits", row.digits) : "not finite";
    if (row.theta_nanoseconds && *row.theta_nanoseconds > 5)
        out += fmt::format(", theta() {}", time_for_people(*row.theta_nanoseconds));
    return out;
}

std::vector<Series> series_of(Rows const& rows) {
    std::vector<Series> out;
    for (std::string const& name : distinct(rows, std::mem_fn(&Measured::name))) {
        Rows mine = kept(rows, [&](Measured const& r) { return r.name == name; });
        std::ranges::sort(mine, {}, &Measured::size);
        Series s{name, mine.front().family, {}};
        for (Measured const& row : mine) s.points.push_back({row.size, row.nanoseconds, sentence(row)});
        out.push_back(std::move(s));
    }
    return out;
}

std::string plots(Rows const& rows) {
    std::vector<Series> const series = series_of(rows);
    std::string const wide = plot(series, 1120, series.size() > 8 ? 660 : 360, true);
    if (wide.empty()) return "";
    return fmt::format("<div class='wide'>{}</div>\n<div class='narrow'>{}{}</div>\n", wide,
                       plot(series, 400, series.size() > 8 ? 470 : 340, false), legend(series));
}

std::string cell(Measured const* row, Measured const* yardstick, bool least) {
    if (!row) return "<td></td>";
    std::string out = fmt::format("<td{}><b>{}</b>", least ? " class='least'" : "", time_for_people(row->nanoseconds));
    out += row->finite ? fmt::format("<small>{:.1f} digits</small>", row->digits) : "<small class='bad'>not finite</small>";
    if (row->theta_nanoseconds && *row->theta_nanoseconds > 5)
        out += fmt::format("<small>+ {} theta</small>", time_for_people(*row->theta_nanoseconds));
    if (yardstick) {
        double const ratio = row->answered() / yardstick->answered();
        out += fmt::format("<small>{:.{}f} ×</small>", ratio, ratio < 10 ? 2 : 0);
    }
    return out + "</td>";
}

/// A name that may go on in the next line after an underscore.
std::string breakable(std::string name) {
    for (size_t at = 0; (at = name.find('_', at)) != std::string::npos; at += 6) name.insert(at + 1, "<wbr>");
    return name;
}

/// Names down, cases across; the variant with the least time to an answer in each column is shaded.
std::string table(Rows const& rows, std::string const& yardstick) {
    auto const names = distinct(rows, std::mem_fn(&Measured::name)), cases = distinct(rows, std::mem_fn(&Measured::what));
    std::string out = "<div class='scroll'><table>\n<tr><th></th>";
    for (std::string const& what : cases) out += fmt::format("<th>{}</th>", what);
    std::vector<Measured const*> least;
    for (std::string const& what : cases) {
        Measured const* best = nullptr;
        for (Measured const& row : rows)
            if (row.what == what && row.finite && row.group != "peer" && (!best || row.answered() < best->answered()))
                best = &row;
        least.push_back(best);
    }
    for (std::string const& name : names) {
        out += fmt::format("</tr>\n<tr><th>{}</th>", breakable(name));
        for (size_t j = 0; j < cases.size(); ++j) {
            Measured const* const row = find(rows, name, cases[j]);
            out += cell(row, find(rows, yardstick, cases[j]), names.size() > 1 && row && row == least[j]);
        }
    }
    return out + "</tr>\n</table></div>\n";
}

std::string title_of(std::string const& group, std::string const& arithmetic) {
    if (group == "update") return fmt::format("One filter, one row at a time, {}", arithmetic);
    if (group == "fixed") return fmt::format("The same with the size known to the compiler, {}", arithmetic);
    if (group == "lockstep") return fmt::format("Many filters in lockstep, {}, time of one of them", arithmetic);
    return group + ", " + arithmetic;
}

/// Filters: one panel for each group and arithmetic, with the peers and, where it has its sizes, the machine's limit.
std::string filters(Rows const& rows) {
    std::string out;
    Rows const single = kept(rows, [](Measured const& r) { return !r.arithmetic.empty() && r.group != "peer"; });
    auto const panel_of = [](Measured const& r) { return title_of(r.group, r.arithmetic); };
    for (std::string const& title : distinct(single, panel_of)) {
        Rows panel = kept(single, [&](Measured const& r) { return panel_of(r) == title; });
        std::string const group = panel.front().group, arithmetic = panel.front().arithmetic;
        auto const cases = distinct(panel, std::mem_fn(&Measured::what));
        for (Measured peer : kept(rows, [](Measured const& r) { return r.group == "peer" && !r.arithmetic.empty(); })) {
            if (std::ranges::find(cases, peer.what) == cases.end()) continue;
            if (peer.arithmetic != arithmetic) peer.name += " (" + peer.arithmetic + ")";
            panel.push_back(peer);
        }
        Rows drawn = panel;
        if (arithmetic == "double" && group == "update")
            for (Measured limit : kept(rows, [](Measured const& r) { return r.group == "limit"; })) {
                limit.name = "limit: " + limit.name;
                drawn.push_back(limit);
            }
        out += fmt::format("<h2>{}</h2>\n{}{}", title, plots(drawn),
                           table(panel, arithmetic == "double" ? "dlib" : "dlib (double)"));
    }
    return out;
}

/// The groups without arithmetic: peers of a batch stand beside it.
std::string others(Rows const& rows) {
    struct Section {
        char const *title, *text, *yardstick;
        std::vector<std::string> groups;
        bool drawn;
    };
    std::string out;
    for (Section const& section :
         {Section{"Batches: all rows at hand, double, one thread",
                  "Time per row, the solution included; × is against the normal equations, which square the condition number.",
                  "normal_equations", {"batch", "peer"}, true},
          Section{"The same in parts, merged: qr_block on several cores", "Time per row; × is against one thread.", "1_thread",
                  {"fold_all"}, false},
          Section{"Sparse rows: two numbers in each that are not zero", "Time per row.", "", {"sparse"}, true},
          Section{"The certified reference", "Time per row, with the proven digits.", "", {"reference"}, false},
          Section{"The machine's limit",
                  "One pass over so many bytes, the d x d doubles of P for d = 32, 64, 128, 256.", "", {"limit"}, false}}) {
        Rows const mine = kept(rows, [&](Measured const& r) {
            return r.arithmetic.empty() && std::ranges::find(section.groups, r.group) != section.groups.end();
        });
        if (mine.empty()) continue;
        out += fmt::format("<h2>{}</h2>\n<p class='soft'>{}</p>\n{}{}", section.title, section.text,
                           section.drawn ? plots(mine) : "", table(mine, section.yardstick));
    }
    return out;
}

std::string page(Run const& run) {
    std::string out = fmt::format("<!doctype html>\n<html lang='en'>\n<meta charset='utf-8'>\n"
                                  "<meta name='viewport' content='width=device-width, initial-scale=1'>\n"
                                  "<title>rlslab: the time of an update</title>\n<style>{}</style>\n", style);
    out +=
        "<h1>The time of an update</h1>\n"
        "<p>What one row of data costs a filter of d parameters: the same data, prior and forgetting for all. Every time "
        "stands with the digits of theta, measured against the certified reference: a fast wrong answer is worth nothing.</p>\n";
    out += fmt::format("<p class='soft'>{}</p>\n", run.machine);
    out += "<p class='legend'>";
    for (char const* family : {"covariance", "factored covariance", "information", "peer", "limit"})
        out += fmt::format("<span><i class='swatch {}'></i>{}</span>", style_of(family), family);
    out +=
        "</p>\n<p class='soft'>The plots show the update alone. In the tables what theta() takes on top is said where it has "
        "to be solved for, and counts in ×, the time over dlib's (less than 1 is faster), and in which variant is shaded as "
        "the fastest. information takes its rows without a report, whose innovation would have to solve for theta.</p>\n";
    return out + filters(run.rows) + others(run.rows) + "</html>\n";
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) throw std::runtime_error("usage: rlslab_bench_page RUN.json PAGE.html");
    std::signal(SIGXFSZ, SIG_IGN);    // a file beyond the limit is an error like any other
    rlslab::replace_file(argv[2], page(read_run(argv[1])));
} catch (std::exception const& error) {
    fmt::print(stderr, "rlslab_bench_page: {}\n", error.what());
    return 1;
}
