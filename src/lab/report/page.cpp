// The skeleton of a page and what stands in it; its provenance (provenance.hpp).
#include "src/lab/report/page.hpp"
#include "src/lab/report/plot.hpp"
#include "src/lab/report/svg.hpp"
#include "src/lab/report/provenance.hpp"

#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

namespace rlslab::report {

std::string escaped(std::string_view text) {
    std::string out;
    for (size_t at = 0; at < text.size();) {
        size_t const to = std::min(text.find("+- ", at), text.size());
        out += escaped_xml(text.substr(at, to - at));
        if (to < text.size()) out += "± ";
        at = to + 3;
    }
    return out;
}

namespace {
/// Whether a series of this name has anything that can be drawn.
bool drawn(Figure const& figure, std::string const& name) {
    for (Panel const& panel : figure.panels)
        for (auto const* curves : {&panel.curves, &panel.guides})
            for (Curve const& curve : *curves)
                for (size_t i = 0; curve.name == name && i < std::min(curve.x.size(), curve.y.size()); ++i)
                    if (Axis::shows(curve.x[i], figure.log_x) &&
                        (curve.y[i] < panel.y_least || Axis::shows(curve.y[i], plot::logarithmic_y(figure, panel))))
                        return true;
    return false;
}

/// The series' numbers as a legend beside a single panel lists them: from the top down as their lines end.
std::vector<size_t> from_the_top(std::vector<Curve const*> const& legend) {
    std::vector<size_t> out(legend.size());
    std::iota(out.begin(), out.end(), 0);
    if (std::ranges::all_of(legend, &Curve::line))
        std::ranges::stable_sort(out, std::greater(), [&](size_t i) {
            auto const& y = legend[i]->y;
            auto const last = std::ranges::find_if(y.rbegin(), y.rend(), [](double v) { return std::isfinite(v); });
            return last == y.rend() ? -std::numeric_limits<double>::infinity() : *last;
        });
    return out;
}

/// Stands out in some panel.
bool strong(Figure const& figure, std::string const& name) {
    return std::ranges::any_of(figure.panels, [&](Panel const& panel) {
        return std::ranges::any_of(panel.curves,
                                   [&](Curve const& curve) { return curve.strong && curve.name == name; });
    });
}

/// White space in LaTeX is one space, however long.
bool same_formula(std::string_view a, std::string_view b) {
    auto const white = [](char c) { return c == ' ' || c == '\n' || c == '\t'; };
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (white(a[i]) != white(b[j]) || (!white(a[i]) && a[i] != b[j])) return false;
        if (!white(a[i])) ++i, ++j;
        else {
            while (i < a.size() && white(a[i])) ++i;
            while (j < b.size() && white(b[j])) ++j;
        }
    }
    return i == a.size() && j == b.size();
}
}  // namespace

std::string figure_html(Figure const& figure) {
    size_t const panels = figure.panels.size();
    std::vector<Curve const*> const legend = legend_of(figure);
    // Names beside points need room: such panels stand one below the other, as wide as the page.
    bool const alone = panels == 1 || figure.names,
               three = (figure.cells && panels > 4) || (figure.own_y && panels == 3);
    bool const beside = panels == 1 && !figure.cells && legend.size() > 6;  // the legend
    std::string out = fmt::format("<figure id=\"{}\"{}><figcaption>{}</figcaption>\n", escaped(figure.name),
                                  beside ? " class=\"beside\"" : "", escaped(figure.title));
    if (!figure.note.empty()) out += fmt::format("<p class=\"soft\">{}</p>\n", escaped(figure.note));
    if (figure.cells) {
        Range const shades = plot::shades_of(figure);
        out += fmt::format("<p class=\"legend\">{}<span class=\"scale\"></span>{}&ensp;{}</p>\n",
                           plot::number_text(shades.low), plot::number_text(shades.high), escaped(figure.y));
    } else if (legend.size() > 1 || (legend.size() == 1 && !legend[0]->name.empty())) {
        out += fmt::format("<p class=\"legend{}\">", panels > 2 ? " stays" : "");
        std::vector<size_t> order = from_the_top(legend);
        if (!beside) std::ranges::sort(order);
        auto const later = [&](std::string const& name) {
            return !figure.first.empty() && std::ranges::find(figure.first, name) == figure.first.end();
        };
        for (size_t const i : order)
            out += fmt::format(
                "<span data-s=\"{}\"{}{}>{}{}{}</span> ", i, strong(figure, legend[i]->name) ? " class=\"strong\"" : "",
                later(legend[i]->name) ? " data-later" : "", key_svg(*legend[i]), escaped(legend[i]->name),
                drawn(figure, legend[i]->name) ? "" : " <small>(no number)</small>");
        out += "</p>\n";
    }
    out += fmt::format("<div class=\"panels {}\">\n", alone || panels == 0 ? "one" : three ? "three" : "two");
    for (size_t i = 0; i < panels; ++i) {
        std::string const& name = figure.panels[i].name;
        out += "<div class=\"panel\">";
        if (!name.empty()) out += fmt::format("<h3>{}</h3>", escaped(name));
        double const tall = figure.square ? 620 : panels > 1 ? 380 : 440;
        if (alone)
            out += fmt::format("<div class=\"wide\">{}</div><div class=\"narrow\">{}</div>",
                               panel_svg(figure, i, beside ? 900 : 1040, tall),
                               panel_svg(figure, i, 400, figure.square ? 400 : 330));
        else out += three ? panel_svg(figure, i, 400, 300) : panel_svg(figure, i, 520, 350);
        out += "</div>\n";
    }
    return out + "</div></figure>\n";
}

/// LaTeX and MathML of each formula that the program's sources mark as R"tex(...)tex"; the last row is null. Written by
/// src/lab/report/formulas.lua, or src/lab/report/no_formulas.cpp.
extern char const* const formulas[][2];

bool has_mathml() { return formulas[0][0] != nullptr; }

std::string_view mathml(std::string_view tex) {
    for (auto const* formula = formulas; (*formula)[0] != nullptr; ++formula)
        if (same_formula((*formula)[0], tex)) return (*formula)[1];
    return {};
}

std::string formula_html(std::string_view tex) {
    std::string_view const math = mathml(tex);
    return math.empty() ? fmt::format("<div class=\"formula\"><code>{}</code></div>\n", escaped_xml(readable(tex)))
                        : fmt::format("<div class=\"formula\">{}</div>\n", math);
}

std::string table_html(std::vector<std::string> const& head, std::vector<std::vector<std::string>> const& rows,
                       std::vector<size_t> const& strong) {
    std::string out = "<div class=\"scroll\"><table><thead><tr>";
    for (std::string const& cell : head) out += fmt::format("<th>{}</th>", escaped(cell));
    out += "</tr></thead><tbody>\n";
    for (size_t i = 0; i < rows.size(); ++i) {
        out += std::ranges::find(strong, i) == strong.end() ? "<tr>" : "<tr class=\"strong\">";
        for (std::string const& cell : rows[i]) out += fmt::format("<td>{}</td>", escaped(cell));
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n";
}

/// page.css and page.js as text: src/lab/report/CMakeLists.txt writes the file that defines both.
extern char const* const page_style;
extern char const* const page_script;

std::string page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n"
        "<title>{}</title>\n<style>\n{}</style></head><body>\n{}<script>\n{}</script>\n</body></html>\n",
        escaped(title), page_style, body, page_script);
}

// --- provenance: one list of keys and values, in three notations -----------------------------------------------------

std::vector<std::pair<std::string, std::string>> items(Provenance const& of) {
    std::vector<std::pair<std::string, std::string>> all{
        {"command", of.command}, {"file", of.file},
        {"sha256", of.sha256},   {"rows", of.rows > 0 ? fmt::format("{}", of.rows) : ""},
        {"version", version},    {"revision", revision},
        {"compiler", compiler},  {"instruction_set", of.instruction_set},
        {"date", of.date}};
    std::erase_if(all, [](auto const& item) { return item.second.empty(); });
    return all;
}

std::string as_json(Provenance const& of) {
    nlohmann::ordered_json out;
    for (auto const& [key, value] : items(of)) out[key] = value;
    if (of.rows > 0) out["rows"] = of.rows;
    // A file's name need not be UTF-8.
    return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string as_comments(Provenance const& of) {
    std::string out;
    for (auto const& [key, value] : items(of)) out += fmt::format("# {}: {}\n", key, printable(value, value.npos));
    return out;
}

std::string as_html(Provenance const& of) {
    std::string out = "<footer class=\"soft\"><p>";
    for (auto const& [key, value] : items(of))
        out += fmt::format(
            "{}{}: {}", out.ends_with("<p>") ? "" : "<br>\n", key == "instruction_set" ? "instruction set" : key,
            key == "command" || key == "sha256" ? "<code>" + escaped(value) + "</code>" : escaped(value));
    return out + "</p></footer>\n";
}

std::string in_quotes(std::string const& text) {
    bool const plain = printable(text, text.npos) == text;  // else by bash's $'...': "\xNN" for other bytes
    std::string out = plain ? "'" : "$'";
    for (std::string_view rest = text; !rest.empty();) {
        size_t const length = std::max<size_t>(1, printable_character(rest));
        std::string const letter = printable(rest.substr(0, length));
        out += letter == "'" ? (plain ? "'\\''" : "\\'") : letter == "\\" && !plain ? "\\\\" : letter;
        rest.remove_prefix(length);
    }
    return out + '\'';
}

std::string shell_text(std::vector<std::string> const& words) {
    std::string out;
    for (std::string const& word : words) {
        bool const plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=./,:@%") == word.npos;
        out += (out.empty() ? "" : " ") + (plain ? word : in_quotes(word));
    }
    return out;
}

std::string date_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace rlslab::report
