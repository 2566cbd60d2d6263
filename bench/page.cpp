// The page of a run: plots and tables in one file that loads nothing.
#include "bench/results.hpp"
#include "src/lab/report/page.hpp"

#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <functional>

namespace rlslab::bench {
namespace {

using namespace rlslab::report;

using Rows = std::vector<BenchRow>;

/// The distinct values of this part, in order of appearance.
std::vector<std::string> distinct(Rows const& rows, std::string BenchRow::*part) {
    std::vector<std::string> out;
    for (BenchRow const& row : rows)
        if (std::ranges::find(out, row.*part) == out.end()) out.push_back(row.*part);
    return out;
}

BenchRow const* find(Rows const& rows, std::string const& name, std::string const& what) {
    auto const found = std::ranges::find_if(rows, [&](BenchRow const& r) { return r.name == name && r.what == what; });
    return found == rows.end() ? nullptr : &*found;
}

/// "24 ns", "1.6 µs": three digits.
std::string time_for_people(double nanoseconds) {
    static constexpr char const* units[] = {"ns", "µs", "ms", "s"};
    int unit = 0;
    for (; unit < 3 && nanoseconds >= 999.5; ++unit) nanoseconds /= 1000;
    int const decimals = nanoseconds < 9.995 ? 2 : nanoseconds < 99.95 ? 1 : 0;
    std::string number = fmt::format("{:.{}f}", nanoseconds, decimals);
    if (number.find('.') != std::string::npos) number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
    return number + " " + units[unit];
}

/// Time, digits, theta()'s time where it is solved for, and the time over `base`'s, with theta where both have it.
std::string cell(BenchRow const& row, BenchRow const* base) {
    std::string out = time_for_people(row.nanoseconds);
    out += row.finite ? fmt::format(", {:.1f} digits", row.digits) : ", not finite";
    if (row.solves_for_theta()) out += fmt::format(", + {} theta", time_for_people(*row.theta_nanoseconds));
    if (!base) return out;
    double ratio = row.nanoseconds / base->nanoseconds;
    if (row.theta_nanoseconds && base->theta_nanoseconds)
        ratio = (row.nanoseconds + *row.theta_nanoseconds) / (base->nanoseconds + *base->theta_nanoseconds);
    return out + fmt::format(", {:.{}f} ×", ratio, ratio < 10 ? 2 : 0);
}

/// A variant has its own look in every page; peers share a colour, and limits another.
Look look_in_bench(BenchRow const& row, size_t place) {
    constexpr std::array marks{"circle", "square", "diamond", "triangle-up", "triangle-down", "star", "cross", "x"};
    if (row.family == "limit") return {"#555555", true};
    if (row.family == "peer") return {"#8c510a", true, marks[place % marks.size()]};
    std::optional<Family> family;
    for_each(Variants<double>{}, [&]<class F>() {
        if (F::name == row.name) family = F::family;
    });
    return look_of(family, place);
}

/// Times against sizes, of names with more than one; "" where there is none.
std::string drawn(Rows const& rows, std::string const& name) {
    Figure figure{.name = name,
                  .title = "Time of a row against the number of parameters",
                  .x = "parameters d",
                  .y = "nanoseconds per row",
                  .log_x = true,
                  .log_y = true,
                  .panels = {{"", {}, {}}}};
    for (std::string const& one : distinct(rows, &BenchRow::name)) {
        Curve curve{.name = one};
        BenchRow const* last = nullptr;
        for (BenchRow const& row : rows)
            if (row.name == one) {
                last = &row;
                curve.x.push_back(row.size), curve.y.push_back(row.nanoseconds);
                curve.says.push_back(fmt::format("{}, {}: {}", one, row.what, cell(row, nullptr)));
            }
        std::vector<Curve>& all = last->family == "limit" ? figure.panels[0].guides : figure.panels[0].curves;
        curve.look = look_in_bench(*last, all.size());
        if (curve.x.size() > 1) all.push_back(std::move(curve));
    }
    return figure.panels[0].curves.empty() ? "" : figure_html(figure);
}

/// Names down, cases across. base(row): what its time is compared with, or null.
std::string table(Rows const& rows, std::function<BenchRow const*(BenchRow const&)> const& base) {
    std::vector<std::string> head = distinct(rows, &BenchRow::what);
    std::vector<std::vector<std::string>> cells;
    for (std::string const& name : distinct(rows, &BenchRow::name)) {
        cells.push_back({name});
        for (std::string const& what : head) {
            BenchRow const* const row = find(rows, name, what);
            cells.back().push_back(row ? cell(*row, base(*row)) : "");
        }
    }
    head.insert(head.begin(), "");
    return table_html(head, cells);
}

struct Section {
    char const *group, *title, *base;  // base: a name; "alone": the same filter in update/; "": none
};
constexpr Section sections[] = {
    {"update", "One filter, one row at a time", "dlib"},
    {"fixed", "The same with the size known to the compiler", "dlib"},
    {"fast", "One sample in, the prediction error out", ""},
    {"block", "One filter, rows known in advance", "dlib"},
    {"large", "One filter of many parameters; digits against a solution in 257 bits", "dlib"},
    {"lockstep", "Many filters in lockstep, time of one of them", ""},
    {"fleet", "A million filters in the order of memory, time of one of them", ""},
    {"guard", "A guard around a filter", "alone"},
    {"window", "A filter over a sliding window: each row takes another one back", "alone"},
    {"refactor", "A window factored anew, time of one of its rows", "alone"},
    {"state", "The state of a filter, saved and loaded again: bytes with a checksum", "alone"},
    {"certified", "Probes in a filter", "alone"},
    {"certified_pairs", "Probes in pairs of doubles", "alone"},
    {"batch", "Batches: all rows at hand, one thread, time of a row, the solution included", "normal_equations"},
    {"fold_all", "The same in parts, merged: qr_block on several cores", "1_thread"},
    {"limit", "One pass over so many bytes, the d x d doubles of P", ""}};

}  // namespace

std::string page_of(Run const& run) {
    std::string body = fmt::format(
        "<h1>The time of an update</h1>\n"
        "<p>What one row of data costs a filter of d parameters: the same data, prior and forgetting for all. Every "
        "time stands with the digits of theta, measured against the certified reference: a fast wrong answer is worth "
        "nothing.</p>\n<p class=\"soft\">{}</p>\n"
        "<p class=\"soft\">The plots show the update alone; peers are brown, the machine's limit is grey. In the "
        "tables what theta() takes on top is said where it has to be solved for, and counts in ×, the time over "
        "dlib's, of batches over the normal equations', of what is around a filter over the filter's alone. "
        "information takes its rows without a report, whose innovation would have to solve for theta.</p>\n",
        escaped(run.machine));
    for (Section const& section : sections) {
        Rows group;
        std::ranges::copy_if(run.rows, std::back_inserter(group),
                             [&](BenchRow const& r) { return r.group == section.group; });
        for (std::string const& arithmetic : distinct(group, &BenchRow::arithmetic)) {
            Rows rows, shown;
            std::ranges::copy_if(group, std::back_inserter(rows),
                                 [&](BenchRow const& r) { return r.arithmetic == arithmetic; });
            auto const cases = distinct(rows, &BenchRow::what);
            for (BenchRow peer : run.rows) {
                if (peer.group != "peer" || peer.arithmetic.empty() != arithmetic.empty() ||
                    std::ranges::find(cases, peer.what) == cases.end())
                    continue;
                if (peer.arithmetic != arithmetic) peer.name += " (" + peer.arithmetic + ")";
                rows.push_back(peer);
            }
            shown = rows;
            if (arithmetic == "double" && (rows[0].group == "update" || rows[0].group == "large"))
                std::ranges::copy_if(run.rows, std::back_inserter(shown), [&](BenchRow const& r) {
                    return r.group == "limit" && (r.size >= 512) == (rows[0].group == "large");
                });
            std::string const base = section.base;
            body +=
                fmt::format("<section><h2>{}{}</h2>\n{}{}</section>\n", section.title,
                            arithmetic.empty() ? "" : ", " + arithmetic, drawn(shown, rows[0].group + "-" + arithmetic),
                            table(rows, [&](BenchRow const& row) -> BenchRow const* {
                                if (base != "alone") {
                                    BenchRow const* const same = find(rows, base, row.what);
                                    return same || base.empty() ? same : find(rows, base + " (double)", row.what);
                                }
                                auto const alone = std::ranges::find_if(run.rows, [&](BenchRow const& r) {
                                    return r.group == "update" && r.arithmetic == row.arithmetic &&
                                           r.name == row.name && r.what == row.what;
                                });
                                return alone == run.rows.end() ? nullptr : &*alone;
                            }));
        }
    }
    return page("rlslab: the time of an update", body);
}

}  // namespace rlslab::bench
