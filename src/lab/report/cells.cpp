// Heat maps: a rectangle for each cell, its number as a tooltip, and printed in it where there is room, or its word;
// lines between cells whose words in a guide differ.
#include "src/lab/report/plot.hpp"
#include "src/lab/report/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::report::plot {

Cells cells_of(Figure const& figure, Panel const& panel) {
    Cells out;
    if (panel.curves.empty()) return out;
    Curve const& curve = panel.curves.front();
    for (size_t i = 0; i < curve.x.size(); ++i) {
        if (i < curve.row.size() && std::ranges::find(out.rows, curve.row[i]) == out.rows.end())
            out.rows.push_back(curve.row[i]);
        if (Axis::shows(curve.x[i], figure.log_x)) out.places.push_back(curve.x[i]);
    }
    std::ranges::sort(out.places);
    out.places.erase(std::unique(out.places.begin(), out.places.end()), out.places.end());
    return out;
}

Range shades_of(Figure const& figure) {
    Range out;
    for (Panel const& panel : figure.panels)
        for (Curve const& curve : panel.curves)
            for (double const y : curve.y)
                if (Axis::shows(y, figure.log_y)) out.add(y);
    return out.empty() || (out.low >= 0 && out.high <= 1 && !figure.log_y) ? Range{0, 1} : out;
}

std::string shade(double part) {
    if (!(part == part)) return "none";
    constexpr std::array<std::array<double, 3>, 3> stops{{{247, 247, 247}, {146, 197, 222}, {5, 48, 97}}};
    double const v = 2 * std::clamp(part, 0.0, 1.0);
    size_t const i = v < 1 ? 0 : 1;
    std::array<int, 3> rgb;
    for (size_t k = 0; k < 3; ++k) rgb[k] = int(stops[i][k] + (stops[i + 1][k] - stops[i][k]) * (v - double(i)) + 0.5);
    return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string cells_group(Figure const& figure, Panel const& panel, Cells const& cells, Axis const& x, Box const& box,
                        Range shades) {
    std::string rectangles, texts, borders;
    if (cells.rows.empty() || cells.places.empty()) return "";
    double const height = (box.bottom - box.top) / double(cells.rows.size());
    Axis const scale(shades, figure.log_y, 0);
    Curve const& curve = panel.curves.front();
    auto const edge = [&](size_t i) {  // between places i - 1 and i
        if (i == 0) return box.left;
        if (i == cells.places.size()) return box.right;
        return (x(cells.places[i - 1]) + x(cells.places[i])) / 2;
    };
    for (size_t i = 0; i < std::min({curve.x.size(), curve.y.size(), curve.row.size()}); ++i) {
        if (!x.shows(curve.x[i])) continue;
        size_t const column = size_t(std::ranges::lower_bound(cells.places, curve.x[i]) - cells.places.begin());
        size_t const row = size_t(std::ranges::find(cells.rows, curve.row[i]) - cells.rows.begin());
        double const left = edge(column), right = edge(column + 1), bottom = box.bottom - height * double(row);
        double const part = scale.shows(curve.y[i]) ? scale(curve.y[i]) : NAN;
        rectangles += fmt::format(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"><title>{}</title></rect>", fixed(left),
            fixed(bottom - height), fixed(right - left), fixed(height), part == part ? shade(part) : "#ddd",
            escaped_xml(fmt::format("{} {}: {} {}, {} {}", figure.series, curve.row[i], figure.x,
                                    number_text(curve.x[i]), figure.y,
                                    part == part ? number_text(curve.y[i]) : "no number")));
        std::string const text = i < curve.says.size() ? curve.says[i] : fmt::format("{:.2g}", curve.y[i]);
        if (part == part && right - left > (curve.says.empty() ? 11 : 15) * text_width(text) + 6 && height > 17)
            texts += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>", fixed((left + right) / 2),
                                 fixed(bottom - height / 2 + 4), part > 0.55 ? "#fff" : "#1a1a1a",
                                 i < curve.says.size() ? escaped_xml(text) : tick_text(text));
    }
    for (Curve const& region : panel.guides) {
        auto const word = [&](size_t column, size_t row) -> std::string const* {
            for (size_t i = 0; i < std::min({region.says.size(), region.x.size(), region.row.size()}); ++i)
                if (column < cells.places.size() && row < cells.rows.size() && region.x[i] == cells.places[column] &&
                    region.row[i] == cells.rows[row])
                    return &region.says[i];
            return nullptr;
        };
        auto const differ = [](std::string const* a, std::string const* b) { return a && b && *a != *b; };
        for (size_t c = 0; c < cells.places.size(); ++c)
            for (size_t r = 0; r < cells.rows.size(); ++r) {
                double const right = edge(c + 1), top = box.bottom - height * double(r + 1);
                if (differ(word(c, r), word(c + 1, r)))
                    borders += fmt::format("M{} {}v{}", fixed(right), fixed(top), fixed(height));
                if (differ(word(c, r), word(c, r + 1)))
                    borders += fmt::format("M{} {}H{}", fixed(edge(c)), fixed(top), fixed(right));
            }
    }
    if (!borders.empty())
        rectangles += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#d55e00\" stroke-width=\"3\"/>", borders);
    return fmt::format(
        "<g stroke=\"#fff\" stroke-width=\".6\">{}</g>\n<g font-size=\"{}\" text-anchor=\"middle\" "
        "pointer-events=\"none\">{}</g>\n",
        rectangles, curve.says.empty() ? 11 : 15, texts);
}

}  // namespace rlslab::report::plot
