// Panels: margins that fit their labels, axes, grid, and in them the curves or cells; a document of panels in a grid.
#include "report/svg.hpp"

#include "report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace rlslab {
namespace {

using namespace plot;

constexpr double tick_size = 12, label_size = 13, line_height = 16;
constexpr char const* ink = "#1a1a1a";
constexpr char const* font = "font-family=\"system-ui,'Segoe UI','DejaVu Sans',Helvetica,Arial,sans-serif\"";

/// Lines no wider than this, broken at spaces where that is possible.
std::vector<std::string> wrapped(std::string const& text, double size, double width) {
    std::vector<std::string> out;
    for (size_t from = 0; from < text.size();) {
        size_t const to = std::min(text.find(' ', from), text.size());
        std::string const word = text.substr(from, to - from);
        if (!out.empty() && size * text_width(out.back() + ' ' + word) <= width)
            out.back() += ' ' + word;
        else
            out.push_back(word);
        from = to + 1;
    }
    return out;
}

std::string text_at(double x, double y, std::string const& text, std::string const& attributes) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", fixed(x), fixed(y), attributes, escaped_xml(text));
}

double width_of(Tick const& tick) { return tick_size * (text_width(tick.text) + 0.75 * text_width(tick.power)); }
std::string tspans(Tick const& tick) {
    if (tick.power.empty()) return escaped_xml(tick.text);
    return fmt::format("{}<tspan dy=\"-.45em\" font-size=\"75%\">{}</tspan>", escaped_xml(tick.text), tick.power);
}

// --- ranges -----------------------------------------------------------------------------------------------------------

void add(Range& range, std::vector<double> const& values, bool logarithmic) {
    for (double const v : values)
        if (Axis::shows(v, logarithmic)) range.add(v);
}

Range x_range(Figure const& figure) {
    Range out;
    for (Panel const& panel : figure.panels) {
        for (auto const* curves : {&panel.curves, &panel.guides})
            for (Curve const& curve : *curves) add(out, curve.x, figure.log_x);
        for (Event const& event : panel.events) add(out, {event.x}, figure.log_x);
    }
    if (!figure.x_names.empty()) add(out, {-0.5, double(figure.x_names.size()) - 0.5}, false);
    return out;
}

/// Of the curves; of guides what is at most half as far beyond as the curves' range is long.
Range y_range(Figure const& figure, Panel const* only) {
    Range out, guides;
    add(out, figure.y_holds, figure.log_y);
    for (Panel const& panel : figure.panels) {
        if (only && &panel != only) continue;
        for (Curve const& curve : panel.curves)
            for (auto const* values : {&curve.y, &curve.low, &curve.high}) add(out, *values, figure.log_y);
        for (Event const& event : panel.events) add(out, {event.y}, figure.log_y);
    }
    Axis near(out, figure.log_y, 0.5);
    near.place(0, 1);
    for (Panel const& panel : figure.panels) {
        if (only && &panel != only) continue;
        for (Curve const& guide : panel.guides)
            for (double const y : guide.y)
                if (near.shows(y) && (out.empty() || figure.square || (near(y) >= 0 && near(y) <= 1))) guides.add(y);
    }
    if (!guides.empty()) out.add(guides.low), out.add(guides.high);
    return out;
}

// --- one panel --------------------------------------------------------------------------------------------------------

struct Names {
    double width = 0;                  ///< of the margin on the right that they stand in
    bool at_ends = false, beside = false;
};
Names names_of(Figure const& figure, Panel const& panel, bool named) {
    Names out;
    if (!named || !figure.names) return out;
    for (Curve const& curve : panel.curves) (curve.x.size() > 1 && curve.line ? out.at_ends : out.beside) = true;
    if (out.at_ends)
        for (auto const* curves : {&panel.curves, &panel.guides})
            for (Curve const& curve : *curves) out.width = std::max(out.width, tick_size * text_width(curve.name) + 42);
    return out;
}

/// Heights near those wished for, in their order, at least `gap` apart, none below `bottom`: halfway between only pushing
/// down and only pushing up, both of which keep the gap.
std::vector<double> spread(std::vector<double> wished, double gap, double bottom) {
    std::vector<size_t> order(wished.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](size_t i) { return wished[i]; });
    std::vector<double> down = wished, up = wished;
    double least = -1e300, most = 1e300;
    for (size_t const i : order) least = (down[i] = std::max(down[i], least)) + gap;
    for (size_t n = order.size(); n-- > 0;) most = (up[order[n]] = std::min(up[order[n]], most)) - gap;
    most = bottom;
    for (size_t n = order.size(); n-- > 0;) most = (wished[order[n]] = std::min((down[order[n]] + up[order[n]]) / 2, most)) - gap;
    return wished;
}

size_t series_number(std::vector<Curve const*> const& legend, std::string const& name) {
    return size_t(std::ranges::find_if(legend, [&](Curve const* c) { return c->name == name; }) - legend.begin());
}

std::optional<std::pair<double, double>> last_place(Curve const& curve, Axes const& axes) {
    for (size_t i = std::min(curve.x.size(), curve.y.size()); i-- > 0;)
        if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i])) {
            std::pair const at{axes.x(curve.x[i]), axes.y(curve.y[i])};
            if (axes.box.holds(at.first, at.second)) return at;
        }
    return {};
}

std::string names_at_ends(Panel const& panel, std::vector<Curve const*> const& legend, Axes const& axes) {
    struct End {
        Curve const* curve;
        double x, y;
    };
    std::vector<End> ends;
    std::vector<double> wished;
    for (auto const* curves : {&panel.curves, &panel.guides})
        for (Curve const& curve : *curves)
            if (auto const at = last_place(curve, axes)) ends.push_back({&curve, at->first, at->second}), wished.push_back(at->second);
    std::vector<double> const heights = spread(wished, 15, axes.box.bottom);
    std::string out;
    for (size_t i = 0; i < ends.size(); ++i) {
        auto const& [curve, x, y] = ends[i];
        out += fmt::format("<g class=\"s name\" data-s=\"{}\"><path d=\"M{} {}L{} {}L{} {}\" fill=\"none\" stroke=\"{}\" stroke-width=\".8\" stroke-opacity=\".6\"/>",
                           series_number(legend, curve->name), fixed(x + 6), fixed(y), fixed(axes.box.right + 8), fixed(y), fixed(axes.box.right + 24),
                           fixed(heights[i]), curve->look.colour);
        out += text_at(axes.box.right + 28, heights[i] + 4.3, curve->name, fmt::format("font-size=\"{}\" fill=\"{}\"", tick_size, curve->look.colour)) + "</g>";
    }
    return out;
}

/// Each name beside its last point, in the first of eight places that is free; none where there is no room.
std::string names_beside(Panel const& panel, std::vector<Curve const*> const& legend, Axes const& axes) {
    std::vector<Box> taken;
    for (Curve const& curve : panel.curves)
        for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
            if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i])) {
                double const x = axes.x(curve.x[i]), y = axes.y(curve.y[i]);
                taken.push_back({x - 5, y - 5, x + 5, y + 5});
            }
    auto const free = [&](Box const& b) {
        return b.left >= axes.box.left && b.right <= axes.box.right && b.top >= axes.box.top && b.bottom <= axes.box.bottom &&
               std::ranges::none_of(taken, [&](Box const& o) { return b.left < o.right && o.left < b.right && b.top < o.bottom && o.top < b.bottom; });
    };
    std::string out;
    for (Curve const& curve : panel.curves) {
        auto const at = last_place(curve, axes);
        if (!at) continue;
        auto const [x, y] = *at;
        double const width = tick_size * text_width(curve.name), height = 13;
        struct Side {
            double dx, dy;    // of the left end and the middle
        };
        for (auto const& [dx, dy] : {Side{8, 0}, {-8 - width, 0}, {-width / 2, -13}, {-width / 2, 14}, {6, -12}, {6, 12}, {-6 - width, -12}, {-6 - width, 12}}) {
            Box const box{x + dx, y + dy - height / 2, x + dx + width, y + dy + height / 2};
            if (!free(box)) continue;
            taken.push_back(box);
            out += fmt::format("<g class=\"s name\" data-s=\"{}\">{}</g>", series_number(legend, curve.name),
                               text_at(box.left, y + dy + 4.3, curve.name, fmt::format("font-size=\"{}\" fill=\"{}\"", tick_size, curve.look.colour)));
            break;
        }
    }
    return out;
}

/// Axis, grid lines, labels along the bottom.
struct Bottom {
    std::vector<Tick> ticks;
    int left_out = 0;
    bool slanted = false;
    double height = 0;
};
Bottom bottom_of(Figure const& figure, Axis const& axis, double width, std::vector<std::string> const& label) {
    Bottom out;
    if (!figure.x_names.empty()) {
        double widest = 0;
        for (size_t i = 0; i < figure.x_names.size(); ++i) out.ticks.push_back({double(i), figure.x_names[i]}), widest = std::max(widest, width_of(out.ticks.back()));
        out.slanted = (widest + 8) * double(figure.x_names.size()) > width;
        out.height = out.slanted ? 0.6 * widest + 16 : 20;
    } else if (!figure.x_ticks.empty()) {
        for (double const x : figure.x_ticks)
            if (axis.shows(x)) out.ticks.push_back({x, tick_text(fmt::format("{:.6g}", x))});
        out.height = 20;
    } else {
        int about = int(width / 62);
        for (Ticks found = axis.ticks(about);; found = axis.ticks(--about)) {    // fewer until their labels do not touch
            out.ticks = found.all, out.left_out = found.left_out;
            double sum = 0;
            for (Tick const& tick : out.ticks) sum += tick.text.empty() ? 0 : width_of(tick) + 10;
            if (sum <= width || about <= 2) break;
        }
        out.height = 20;
    }
    out.height += line_height * double(label.size()) + (label.empty() ? 2 : 6);
    return out;
}

std::string power_note(int power) { return power == 0 ? "" : fmt::format("×10<tspan dy=\"-.45em\" font-size=\"75%\">{}</tspan>", tick_text(fmt::format("{}", power))); }

/// Everything of a panel in width x height units.
std::string panel_body(Figure const& figure, Panel const& panel, double width, double height, bool named) {
    std::vector<Curve const*> const legend = legend_of(figure);
    Cells const cells = figure.cells ? cells_of(figure, panel) : Cells{};
    Axis x(figure.cells || figure.square ? x_range(Figure{.name = {}, .title = {}, .x = {}, .y = {}, .log_x = figure.log_x, .panels = {panel}}) : x_range(figure),
           figure.log_x, figure.cells ? 0.5 / double(std::max<size_t>(1, cells.places.size())) : figure.x_names.empty() ? 0.03 : 0);
    Axis y(figure.cells ? Range{-0.5, double(cells.rows.size()) - 0.5} : y_range(figure, figure.own_y || figure.square ? &panel : nullptr),
           figure.log_y && !figure.cells, figure.cells ? 0 : 0.05);
    Names const names = names_of(figure, panel, named);
    std::string const& y_label = figure.cells ? figure.series : figure.y;

    // Margins: the labels decide.
    double const top = 18;
    int const about = std::max(2, int((height - 60) / 42));
    Ticks left = figure.cells ? Ticks{} : y.ticks(about);
    for (size_t r = 0; r < cells.rows.size(); ++r) left.all.push_back({double(r), cells.rows[r]});
    double widest = 0;
    for (Tick const& tick : left.all) widest = std::max(widest, width_of(tick));
    widest = std::min(widest, 0.45 * width);
    std::vector<std::string> const y_lines = wrapped(y_label, label_size, height - 70), x_lines = wrapped(figure.x, label_size, width - 90);
    double const margin = widest + 10 + line_height * double(y_lines.size()) + (y_lines.empty() ? 2 : 6);
    Box box{margin, top, width - std::max(names.width, 14.0), 0};
    Bottom const bottom = bottom_of(figure, x, box.right - box.left, x_lines);
    box.bottom = std::max(box.top + 20, height - bottom.height);
    if (figure.square && !figure.log_x && !figure.log_y) {    // a unit of y as long as one of x
        double const per_x = std::ldexp(x.length(), x.exponent()) / (box.right - box.left), per_y = std::ldexp(y.length(), y.exponent()) / (box.bottom - box.top);
        per_x > per_y ? y.lengthen(per_x / per_y) : x.lengthen(per_y / per_x);
        left = y.ticks(about);
    }
    x.place(box.left, box.right), y.place(box.bottom, box.top);
    Axes const axes{x, y, box};
    Bottom const along = figure.square ? bottom_of(figure, x, box.right - box.left, x_lines) : bottom;

    std::string grid, labels;
    for (Tick const& tick : along.ticks) {
        double const at = x(tick.value);
        if (at < box.left - 0.05 || at > box.right + 0.05) continue;
        if (!figure.cells && figure.x_names.empty()) grid += fmt::format("M{} {}V{}", fixed(at), fixed(box.top), fixed(box.bottom));
        if (tick.text.empty()) continue;
        labels += along.slanted ? fmt::format("<text transform=\"translate({} {}) rotate(-35)\" text-anchor=\"end\">{}</text>", fixed(at + 4), fixed(box.bottom + 14), tspans(tick))
                                : fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", fixed(at), fixed(box.bottom + 16), tspans(tick));
    }
    for (Tick const& tick : left.all) {
        double const at = y(tick.value);
        if (!figure.cells) grid += fmt::format("M{} {}H{}", fixed(box.left), fixed(at), fixed(box.right));
        if (!tick.text.empty()) labels += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", fixed(box.left - 7), fixed(at + 4.2), tspans(tick));
    }
    if (along.left_out) labels += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", fixed(box.right), fixed(box.bottom + 32), power_note(along.left_out));
    if (left.left_out) labels += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>", fixed(box.left - widest), fixed(box.top - 5), power_note(left.left_out));

    std::string out = fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#e3e3e3\"/>\n", grid);
    if (!figure.log_y && !figure.cells && y(0) > box.top && y(0) < box.bottom)
        out += fmt::format("<path d=\"M{} {}H{}\" stroke=\"#b5b5b5\"/>\n", fixed(box.left), fixed(y(0)), fixed(box.right));
    if (figure.cells)
        out += cells_group(figure, panel, cells, x, box, shades_of(figure));
    else {
        for (Curve const& guide : panel.guides) out += curve_group(figure, guide, series_number(legend, guide.name), true, axes);
        for (Curve const& curve : panel.curves) out += curve_group(figure, curve, series_number(legend, curve.name), false, axes);
        for (Event const& event : panel.events) {
            size_t const series = series_number(legend, event.series);
            out += event_group(event, series < legend.size() ? legend[series]->look : Look{"#555555"}, series, axes);
        }
        if (names.at_ends) out += names_at_ends(panel, legend, axes);
        else if (names.beside) out += names_beside(panel, legend, axes);
    }
    out += fmt::format("<path d=\"M{0} {1}H{2}V{3}H{0}Z\" fill=\"none\" stroke=\"#888\"/>\n<g font-size=\"{4}\">{5}</g>\n", fixed(box.left), fixed(box.top),
                       fixed(box.right), fixed(box.bottom), tick_size, labels);
    for (size_t i = 0; i < x_lines.size(); ++i)
        out += text_at((box.left + box.right) / 2, height - 5 - line_height * double(x_lines.size() - 1 - i), x_lines[i], fmt::format("font-size=\"{}\" text-anchor=\"middle\"", label_size));
    for (size_t i = 0; i < y_lines.size(); ++i)
        out += fmt::format("<text transform=\"translate({} {}) rotate(-90)\" font-size=\"{}\" text-anchor=\"middle\">{}</text>\n", fixed(13 + line_height * double(i)),
                           fixed((box.top + box.bottom) / 2), label_size, escaped_xml(y_lines[i]));
    bool any = false;
    for (Curve const& curve : panel.curves)
        for (double const v : curve.y) any |= Axis::shows(v, figure.log_y);
    if (!any) out += text_at((box.left + box.right) / 2, (box.top + box.bottom) / 2, "no number to draw", "text-anchor=\"middle\" font-size=\"13\" fill=\"#5c5c5c\"");
    return out;
}

/// What a screen reader says of it.
std::string description(Figure const& figure, Panel const& panel) {
    std::string out = fmt::format("{} against {}", figure.cells ? figure.y + " by " + figure.series : figure.y, figure.x);
    if (figure.log_x || figure.log_y) out += fmt::format(" ({} logarithmic)", figure.log_x && figure.log_y ? "both" : figure.log_x ? "x" : "y");
    out += ":";
    for (Curve const& curve : panel.curves) {
        Range y;
        add(y, curve.y, figure.log_y);
        if (!y.empty()) out += fmt::format(" {} {} to {};", curve.name, number_text(y.low), number_text(y.high));
    }
    for (Event const& event : panel.events) out += ' ' + event.text + ';';
    out.back() = '.';
    return out;
}

}  // namespace

std::string escaped_xml(std::string_view text) {
    std::string out;
    for (char const c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else if (c == '\'') out += "&#39;";
        else if (static_cast<unsigned char>(c) < 0x20) out += c == '\n' || c == '\t' ? ' ' : '?';
        else out += c;
    }
    return out;
}

std::vector<Curve const*> legend_of(Figure const& figure) {
    std::vector<Curve const*> out;
    for (bool const guides : {false, true})
        for (Panel const& panel : figure.panels)
            for (Curve const& curve : guides ? panel.guides : panel.curves)
                if (std::ranges::none_of(out, [&](Curve const* c) { return c->name == curve.name; })) out.push_back(&curve);
    return out;
}

std::string key_svg(Curve const& curve) {
    std::string out = "<svg class=\"key\" viewBox=\"0 0 34 12\" width=\"34\" height=\"12\" aria-hidden=\"true\">";
    if (curve.line) out += fmt::format("<path d=\"M1 6H33\" {}/>", line_style(curve.look, 1.8));
    if (curve.marks && !curve.look.mark.empty()) out += fmt::format("<path d=\"{}\" {}/>", mark_path(curve.look.mark, 17, 6), mark_style(curve.look));
    return out + "</svg>";
}

std::string panel_svg(Figure const& figure, size_t panel, double width, double height, bool named) {
    Panel const& drawn = figure.panels.at(panel);
    return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\" {} fill=\"{}\">\n<title>{}</title>\n<desc>{}</desc>\n{}</svg>\n",
                       fixed(width), fixed(height), font, ink, escaped_xml(figure.title + (drawn.name.empty() ? "" : ": " + drawn.name)),
                       escaped_xml(description(figure, drawn)), panel_body(figure, drawn, width, height, named));
}

std::string svg(Figure const& figure) {
    size_t const panels = figure.panels.size(), columns = panels <= 1 ? 1 : figure.cells && panels > 4 ? 3 : 2;
    constexpr double width = 960, gap = 16;
    double const cell = (width - gap * double(columns - 1)) / double(columns);
    double const panel_height = columns == 1 ? (figure.square ? 620 : 470) : columns == 2 ? 340 : 280;
    std::string out;
    double y = 24;
    for (std::string const& line : wrapped(figure.title, 16, width - 20)) {
        out += text_at(width / 2, y, line, "font-size=\"16\" font-weight=\"600\" text-anchor=\"middle\"");
        y += 20;
    }
    for (size_t i = 0; i < panels; ++i) {
        Panel const& panel = figure.panels[i];
        double const x = double(i % columns) * (cell + gap);
        if (!panel.name.empty()) out += text_at(x + cell / 2, y + 8, panel.name, "font-size=\"13\" font-weight=\"600\" text-anchor=\"middle\"");
        out += fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n", fixed(x), fixed(y + 8), panel_body(figure, panel, cell, panel_height, true));
        if (i % columns == columns - 1 || i + 1 == panels) y += panel_height + 22;
    }
    if (figure.cells) {
        Range const shades = shades_of(figure);
        std::string bar;
        for (int i = 0; i < 40; ++i) bar += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"4.2\" height=\"12\" fill=\"{}\"/>", fixed(120 + 4 * i), fixed(y), shade((i + 0.5) / 40));
        out += text_at(112, y + 11, number_text(shades.low), "font-size=\"12\" text-anchor=\"end\"") + bar +
               text_at(288, y + 11, number_text(shades.high) + "  " + figure.y, "font-size=\"12\"");
        y += 24;
    } else if (auto const legend = legend_of(figure); legend.size() > 1 || (legend.size() == 1 && !legend[0]->name.empty())) {
        double x = 20;
        for (Curve const* curve : legend) {
            double const room = 44 + tick_size * text_width(curve->name) + 14;
            if (x > 20 && x + room > width) x = 20, y += 20;
            if (curve->line) out += fmt::format("<path d=\"M{} {}h32\" {}/>", fixed(x), fixed(y + 6), line_style(curve->look, 1.8));
            if (curve->marks && !curve->look.mark.empty()) out += fmt::format("<path d=\"{}\" {}/>", mark_path(curve->look.mark, x + 16, y + 6), mark_style(curve->look));
            out += text_at(x + 39, y + 10.3, curve->name, fmt::format("font-size=\"{}\"", tick_size));
            x += room;
        }
        y += 24;
    }
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" {2} fill=\"{3}\">\n"
                       "<title>{4}</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n{5}</svg>\n",
                       fixed(width), fixed(y), font, ink, escaped_xml(figure.title), out);
}

}  // namespace rlslab
