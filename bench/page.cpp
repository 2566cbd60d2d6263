// The page of a run: plots and tables in one file that loads nothing.
#include "bench/measured.hpp"
#include "bench/verbs.hpp"
#include "src/lab/report/page.hpp"

#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace rlslab::bench {
namespace {

using namespace rlslab::report;

using Rows = std::vector<BenchRow>;

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
    for (BenchRow const& row : rows)
        if (std::ranges::find(out, part(row)) == out.end()) out.push_back(part(row));
    return out;
}

BenchRow const* find(Rows const& rows, std::string const& name, std::string const& what) {
    auto const found = std::ranges::find_if(rows, [&](BenchRow const& r) { return r.name == name && r.what == what; });
    return found == rows.end() ? nullptr : &*found;
}

/// The row as a tooltip.
std::string sentence(BenchRow const& row) {
    std::string out = fmt::format("{}, {}: {} per row, ", row.name, row.what, time_for_people(row.nanoseconds));
    out += row.finite ? fmt::format("{:.1f} digits", row.digits) : "not finite";
    if (row.solves_for_theta()) out += fmt::format(", theta() {}", time_for_people(*row.theta_nanoseconds));
    return out;
}

std::optional<Family> family_of_variant(std::string_view name) {
    std::optional<Family> out;
    for_each(Variants<double>{}, [&]<class F>() {
        if (F::name == name) out = F::family;
    });
    return out;
}

/// A variant has its own look in every page; peers share a colour, and limits another.
Look look_in_bench(BenchRow const& row, size_t place) {
    constexpr std::array marks{"circle", "square", "diamond", "triangle-up", "triangle-down", "star", "cross", "x"};
    if (row.family == "limit") return {"#555555", true};
    if (row.family == "peer") return {"#8c510a", true, marks[place % marks.size()]};
    return look_of(family_of_variant(row.name), place);
}

/// Times against sizes; "" for a single size.
std::string drawn(Rows const& rows, std::string const& title) {
    Figure figure{.name = title,
                  .title = "Time of a row against the number of parameters",
                  .x = "parameters d",
                  .y = "nanoseconds per row",
                  .log_x = true,
                  .log_y = true,
                  .panels = {{"", {}, {}}}};
    std::ranges::replace_if(
        figure.name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '-');
    std::set<double> sizes;
    size_t place = 0, peers = 0;
    for (std::string const& name : distinct(rows, std::mem_fn(&BenchRow::name))) {
        Rows mine = kept(rows, [&](BenchRow const& r) { return r.name == name; });
        std::ranges::sort(mine, {}, &BenchRow::size);
        Curve curve{.name = name,
                    .look = look_in_bench(mine.front(), mine.front().family == "peer" ? peers++ : place++),
                    .x = {},
                    .y = {}};
        for (BenchRow const& row : mine) {
            sizes.insert(row.size);
            curve.x.push_back(row.size), curve.y.push_back(row.nanoseconds), curve.says.push_back(sentence(row));
        }
        (mine.front().family == "limit" ? figure.panels[0].guides : figure.panels[0].curves)
            .push_back(std::move(curve));
    }
    if (sizes.size() < 2) return "";
    figure.x_ticks.assign(sizes.begin(), sizes.end());
    return figure_html(figure);
}

std::string cell(BenchRow const* row, BenchRow const* base, bool least) {
    if (!row) return "<td></td>";
    std::string out = fmt::format("<td{}><b>{}</b>", least ? " class=\"best\"" : "", time_for_people(row->nanoseconds));
    out += row->finite ? fmt::format("<small>{:.1f} digits</small>", row->digits)
                       : "<small class=\"bad\">not finite</small>";
    if (row->solves_for_theta())
        out += fmt::format("<small>+ {} theta</small>", time_for_people(*row->theta_nanoseconds));
    if (row->longest_nanoseconds)
        out += fmt::format("<small>longest {}</small>", time_for_people(*row->longest_nanoseconds));
    if (base) {
        bool const alike = row->theta_nanoseconds.has_value() == base->theta_nanoseconds.has_value();
        double const ratio = alike ? row->answered() / base->answered() : row->nanoseconds / base->nanoseconds;
        out += fmt::format("<small>{:.{}f} ×</small>", ratio, ratio < 10 ? 2 : 0);
    }
    return out + "</td>";
}

/// A name that may go on in the next line after an underscore.
std::string breakable(std::string name) {
    for (size_t at = 0; (at = name.find('_', at)) != std::string::npos; at += 6) name.insert(at + 1, "<wbr>");
    return name;
}

/// Names down, cases across; the variant with the least time to an answer in each column is shaded. base(name, case):
/// the row that times are compared with, or null.
template <class Base>
std::string table_against(Rows const& rows, Base base) {
    auto const names = distinct(rows, std::mem_fn(&BenchRow::name)),
               cases = distinct(rows, std::mem_fn(&BenchRow::what));
    std::string out = "<div class=\"scroll\"><table><thead>\n<tr><th></th>";
    for (std::string const& what : cases) out += fmt::format("<th>{}</th>", what);
    std::vector<BenchRow const*> least;
    for (std::string const& what : cases) {
        BenchRow const* best = nullptr;
        for (BenchRow const& row : rows)
            if (row.what == what && row.finite && row.family != "peer" && (!best || row.answered() < best->answered()))
                best = &row;
        least.push_back(best);
    }
    out += "</tr></thead><tbody>";
    for (std::string const& name : names) {
        out += fmt::format("\n<tr><th>{}</th>", breakable(name));
        for (size_t j = 0; j < cases.size(); ++j) {
            BenchRow const* const row = find(rows, name, cases[j]);
            out += cell(row, base(name, cases[j]), names.size() > 1 && row && row == least[j]);
        }
        out += "</tr>";
    }
    return out + "\n</tbody></table></div>\n";
}
std::string table(Rows const& rows, std::string const& base) {
    return table_against(rows, [&](std::string const&, std::string const& what) { return find(rows, base, what); });
}

std::string title_of(std::string const& group, std::string const& arithmetic) {
    if (group == "update") return fmt::format("One filter, one row at a time, {}", arithmetic);
    if (group == "fixed") return fmt::format("The same with the size known to the compiler, {}", arithmetic);
    if (group == "fast") return fmt::format("One sample in, the prediction error out, {}", arithmetic);
    if (group == "block") return fmt::format("One filter, rows known in advance, {}", arithmetic);
    if (group == "large")
        return fmt::format("One filter of many parameters, {}; digits against a solution in 257 bits", arithmetic);
    if (group == "lockstep") return fmt::format("Many filters in lockstep, {}, time of one of them", arithmetic);
    if (group == "fleet")
        return fmt::format("A million filters in the order of memory, {}, time of one of them", arithmetic);
    return group + ", " + arithmetic;
}

struct AroundOne {
    char const *group, *title, *text;
};
constexpr std::array around_one{
    AroundOne{"guard", "A guard around a filter, double", "Each row is looked at before and after it."},
    AroundOne{"window", "A filter over a sliding window, double", "Each row takes another one back."},
    AroundOne{"refactor", "A window factored anew, double, time of one of its rows",
              "What a window does in one step on alarm or schedule: as many rows as it holds."},
    AroundOne{"state", "The state of a filter, double, saved and loaded again", "Bytes with a checksum."}};

/// What is around a filter, against the filter alone.
std::string around_filters(Rows const& rows) {
    std::string out;
    for (AroundOne const& around : around_one) {
        Rows const mine = kept(rows, [&](BenchRow const& r) { return r.group == around.group; });
        if (mine.empty()) continue;
        Rows const alone =
            kept(rows, [](BenchRow const& r) { return r.group == "update" && r.arithmetic == "double"; });
        out += fmt::format(
            "<section><h2>{}</h2>\n<p class=\"soft\">{} × is against the filter alone.</p>\n{}</section>\n",
            around.title, around.text, table_against(mine, [&](std::string const& name, std::string const& what) {
                return find(alone, name, what);
            }));
    }
    return out;
}

/// Filters: one panel for each group and arithmetic, with the peers and, where it has its sizes, the machine's limit.
std::string filters(Rows const& rows) {
    std::string out;
    Rows const single = kept(rows, [](BenchRow const& r) {
        return !r.arithmetic.empty() && r.group != "peer" &&
               std::ranges::find(around_one, r.group, &AroundOne::group) == around_one.end();
    });
    auto const panel_of = [](BenchRow const& r) { return title_of(r.group, r.arithmetic); };
    for (std::string const& title : distinct(single, panel_of)) {
        Rows panel = kept(single, [&](BenchRow const& r) { return panel_of(r) == title; });
        std::string const group = panel.front().group, arithmetic = panel.front().arithmetic;
        auto const cases = distinct(panel, std::mem_fn(&BenchRow::what));
        for (BenchRow peer : kept(rows, [](BenchRow const& r) { return r.group == "peer" && !r.arithmetic.empty(); })) {
            if (std::ranges::find(cases, peer.what) == cases.end()) continue;
            if (peer.arithmetic != arithmetic) peer.name += " (" + peer.arithmetic + ")";
            panel.push_back(peer);
        }
        Rows with_limit = panel;
        if (arithmetic == "double" && (group == "update" || group == "large"))
            for (BenchRow limit : kept(rows, [&](BenchRow const& r) {
                     return r.group == "limit" && (r.size >= 512) == (group == "large");
                 })) {
                limit.name = "limit: " + limit.name;
                with_limit.push_back(limit);
            }
        out += fmt::format("<section><h2>{}</h2>\n{}{}</section>\n", title, drawn(with_limit, title),
                           table(panel, arithmetic == "double" ? "dlib" : "dlib (double)"));
    }
    return out;
}

/// The groups without arithmetic: peers of a batch stand beside it.
std::string others(Rows const& rows) {
    struct Section {
        char const *title, *text, *base;
        std::vector<std::string> groups;
        bool plotted;
    };
    std::string out;
    for (Section const& section :
         {Section{"Batches: all rows at hand, double, one thread",
                  "Time per row, the solution included; × is against the normal equations, which square the condition "
                  "number.",
                  "normal_equations",
                  {"batch", "peer"},
                  true},
          Section{"The same in parts, merged: qr_block on several cores",
                  "Time per row; × is against one thread.",
                  "1_thread",
                  {"fold_all"},
                  false},
          Section{"Sparse rows: two numbers in each that are not zero", "Time per row.", "", {"sparse"}, true},
          Section{"The certified reference", "Time per row, with the proven digits.", "", {"reference"}, false},
          Section{"The machine's limit",
                  "One pass over so many bytes, the d x d doubles of P for d = 32, 64, 128, 256.",
                  "",
                  {"limit"},
                  false}}) {
        Rows const mine = kept(rows, [&](BenchRow const& r) {
            return r.arithmetic.empty() && std::ranges::find(section.groups, r.group) != section.groups.end();
        });
        if (mine.empty()) continue;
        out += fmt::format("<section><h2>{}</h2>\n<p class=\"soft\">{}</p>\n{}{}</section>\n", section.title,
                           section.text, section.plotted ? drawn(mine, section.title) : "", table(mine, section.base));
    }
    return out;
}

}  // namespace

std::string page_of(Run const& run) {
    std::string const head = fmt::format(
        "<h1>The time of an update</h1>\n"
        "<p>What one row of data costs a filter of d parameters: the same data, prior and forgetting for all. Every "
        "time "
        "stands with the digits of theta, measured against the certified reference: a fast wrong answer is worth "
        "nothing.</p>\n"
        "<p class=\"soft\">{}</p>\n"
        "<p class=\"soft\">The plots show the update alone; peers are brown, the machine's limit is grey. In the "
        "tables what "
        "theta() takes on top is said where it has to be solved for, and counts in ×, the time over dlib's (less than "
        "1 is "
        "faster), and in which variant is shaded as the fastest. information takes its rows without a report, whose "
        "innovation "
        "would have to solve for theta.</p>\n",
        escaped(run.machine));
    return page("rlslab: the time of an update",
                head + filters(run.rows) + around_filters(run.rows) + others(run.rows));
}

}  // namespace rlslab::bench
