// A panel's axes: their ranges, margins that fit the labels, the grid; texts that stand in the drawing.
#include "src/lab/report/plot.hpp"
#include "src/lab/report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::report::plot {
namespace {

constexpr double label_size = 13, line_height = 16;

double width_of(Tick const& tick) { return tick_size * (text_width(tick.text) + 0.75 * text_width(tick.power)); }
std::string tspans(Tick const& tick) {
    if (tick.power.empty()) return escaped_xml(tick.text);
    return fmt::format("{}<tspan dy=\"-.45em\" font-size=\"75%\">{}</tspan>", escaped_xml(tick.text), tick.power);
}
std::string power_note(int power) { return tspans({0, "×10", tick_text(fmt::format("{}", power))}); }

// --- ranges ----------------------------------------------------------------------------------------------------------

void add(Range& range, std::vector<double> const& values, bool logarithmic, double least = -INFINITY) {
    for (double const v : values)
        if (double const at = v < least ? least : v; Axis::shows(at, logarithmic)) range.add(at);
}

Range x_range(Figure const& figure, Panel const* only) {
    Range out;
    for (Panel const& panel : figure.panels) {
        if (only && &panel != only) continue;
        for (auto const* curves : {&panel.curves, &panel.guides})
            for (Curve const& curve : *curves) add(out, curve.x, figure.log_x);
        for (Event const& event : panel.events) add(out, {event.x}, figure.log_x);
    }
    if (!figure.x_names.empty()) add(out, {-0.5, double(figure.x_names.size()) - 0.5}, false);
    return out;
}

/// Of the curves; of guides what is at most half as far beyond as the curves' range is long.
Range y_range(Figure const& figure, Panel const* only, bool logarithmic) {
    Range out, guides;
    add(out, figure.y_holds, logarithmic);
    for (Panel const& panel : figure.panels) {
        if (only && &panel != only) continue;
        add(out, panel.y_holds, logarithmic);
        for (Curve const& curve : panel.curves)
            for (auto const* values : {&curve.y, &curve.lower, &curve.upper})
                add(out, *values, logarithmic, panel.y_least);
        for (Event const& event : panel.events) add(out, {event.y}, logarithmic, panel.y_least);
    }
    Axis near(out, logarithmic, 0.5);
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

Bottom bottom_of(Figure const& figure, Axis const& axis, double width, std::vector<std::string> const& label) {
    Bottom out;
    if (!figure.x_names.empty()) {
        double widest = 0;
        for (size_t i = 0; i < figure.x_names.size(); ++i)
            out.ticks.push_back({double(i), shortened(figure.x_names[i], tick_size, 180), "",
                                 std::ranges::find(figure.strong_x, i) != figure.strong_x.end()}),
                widest = std::max(widest, width_of(out.ticks.back()));
        out.slanted = (widest + 8) * double(figure.x_names.size()) > width;
        out.height = out.slanted ? 0.6 * widest + 16 : 20;
    } else if (!figure.x_ticks.empty()) {
        for (double const x : figure.x_ticks)
            if (axis.shows(x)) out.ticks.push_back({x, tick_text(fmt::format("{:.6g}", x))});
        out.height = 20;
    } else {
        int about = int(width / 62);
        for (Ticks found = axis.ticks(about);; found = axis.ticks(--about)) {  // fewer until their labels do not touch
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

}  // namespace

Frame frame_of(Figure const& figure, Panel const& panel, Cells const& cells, double width, double height) {
    double const columns = double(std::max<size_t>(1, cells.places.size()));
    Range const along = figure.cells || figure.square ? x_range(figure, &panel) : x_range(figure, nullptr);
    Axis x(along, figure.log_x, figure.cells ? 0.5 / columns : figure.x_names.empty() ? 0.03 : 0);
    bool const logarithmic = logarithmic_y(figure, panel) && !figure.cells;
    Axis y(figure.cells ? Range{-0.5, double(cells.rows.size()) - 0.5}
                        : y_range(figure, figure.own_y || figure.square ? &panel : nullptr, logarithmic),
           logarithmic,
           figure.cells   ? 0
           : figure.names ? 0.1
                          : 0.05);
    bool const square = figure.square && !figure.log_x && !logarithmic;
    int const about = std::max(2, int((height - 60) / 42));

    // Labels decide the margins; where both axes have one unit, margins decide the ranges, and ranges the labels.
    Frame out{.axes = {x, y, {}},
              .left = {},
              .bottom = {},
              .x_lines = wrapped(figure.x, label_size, width - 90, 3),
              .y_lines = {}};
    double widest = 0;                                 // of the labels on the left
    Box& box = out.axes.box = {0, 18, width - 20, 0};  // half a label of x stands beyond either side
    for (int pass = 0; pass < (square ? 3 : 1); ++pass) {
        out.left = figure.cells ? Ticks{} : y.ticks(about);
        for (size_t r = 0; r < cells.rows.size(); ++r)
            out.left.all.push_back({double(r), shortened(cells.rows[r], tick_size, 0.35 * width)});
        for (Tick const& tick : out.left.all) widest = std::max(widest, width_of(tick));
        Bottom const guess = bottom_of(figure, x, width - 90, out.x_lines);
        out.y_lines = wrapped(figure.cells ? figure.series : figure.y, label_size, height - box.top - guess.height, 3);
        box.left =
            std::max(24.0, widest + 10 + line_height * double(out.y_lines.size()) + (out.y_lines.empty() ? 2 : 6));
        out.x_lines = wrapped(figure.x, label_size, box.right - box.left, 3);
        out.bottom = bottom_of(figure, x, box.right - box.left, out.x_lines);
        box.bottom = std::max(box.top + 20, height - out.bottom.height);
        if (!square) break;
        double const per_x = std::ldexp(x.length() / (box.right - box.left), x.exponent() - y.exponent()),
                     per_y = y.length() / (box.bottom - box.top);
        per_x > per_y ? y.lengthen(per_x / per_y) : x.lengthen(per_y / per_x);
    }
    if (square)
        out.left = y.ticks(about), out.bottom.ticks = bottom_of(figure, x, box.right - box.left, out.x_lines).ticks;
    x.place(box.left, box.right), y.place(box.bottom, box.top);
    out.axes.x = x, out.axes.y = y;
    return out;
}

std::string grid_group(Figure const& figure, Frame const& frame) {
    auto const& [x, y, box] = frame.axes;
    std::string labelled, fine, out;
    for (size_t const i : figure.strong_x) {
        double const left = std::max(box.left, x(double(i) - 0.5)), right = std::min(box.right, x(double(i) + 0.5));
        if (left < right)
            out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#f3ead0\"/>\n", fixed(left),
                               fixed(box.top), fixed(right - left), fixed(box.bottom - box.top));
    }
    if (!figure.cells) {
        for (Tick const& tick : frame.bottom.ticks)
            if (double const at = x(tick.value);
                figure.x_names.empty() && at > box.left - 0.05 && at < box.right + 0.05)
                (tick.text.empty() ? fine : labelled) +=
                    fmt::format("M{} {}V{}", fixed(at), fixed(box.top), fixed(box.bottom));
        for (Tick const& tick : frame.left.all)
            (tick.text.empty() ? fine : labelled) +=
                fmt::format("M{} {}H{}", fixed(box.left), fixed(y(tick.value)), fixed(box.right));
    }
    if (!fine.empty()) out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#f0f0f0\"/>\n", fine);
    if (!labelled.empty()) out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#dedede\"/>\n", labelled);
    if (!figure.cells && y.shows(0) && y(0) > box.top && y(0) < box.bottom)
        out +=
            fmt::format("<path d=\"M{} {}H{}\" stroke=\"#b5b5b5\"/>\n", fixed(box.left), fixed(y(0)), fixed(box.right));
    return out;
}

std::string labels_group(Frame const& frame, double height) {
    auto const& [x, y, box] = frame.axes;
    std::string out =
        fmt::format("<path d=\"M{0} {1}H{2}V{3}H{0}Z\" fill=\"none\" stroke=\"#888\"/>\n<g font-size=\"{4}\">",
                    fixed(box.left), fixed(box.top), fixed(box.right), fixed(box.bottom), tick_size);
    for (Tick tick : frame.bottom.ticks) {
        double const at = x(tick.value);
        if (tick.text.empty() || at < box.left - 0.05 || at > box.right + 0.05) continue;
        char const* const weight = tick.strong ? " font-weight=\"700\"" : "";
        if (frame.bottom.slanted) {
            tick.text = shortened(tick.text, tick_size, (at + 4) / 0.82);  // cos 35 degrees
            out += fmt::format("<text transform=\"translate({} {}) rotate(-35)\" text-anchor=\"end\"{}>{}</text>",
                               fixed(at + 4), fixed(box.bottom + 14), weight, tspans(tick));
        } else
            out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\"{}>{}</text>", fixed(at),
                               fixed(box.bottom + 16), weight, tspans(tick));
    }
    for (Tick const& tick : frame.left.all)
        if (!tick.text.empty())
            out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", fixed(box.left - 7),
                               fixed(y(tick.value) + 4.2), tspans(tick));
    if (frame.bottom.left_out)
        out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", fixed(box.right),
                           fixed(box.bottom + 32), power_note(frame.bottom.left_out));
    if (frame.left.left_out)
        out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>", fixed(box.left), fixed(box.top - 5),
                           power_note(frame.left.left_out));
    out += "</g>\n";
    for (size_t i = 0; i < frame.x_lines.size(); ++i)
        out += text_at((box.left + box.right) / 2, height - 5 - line_height * double(frame.x_lines.size() - 1 - i),
                       frame.x_lines[i], fmt::format("font-size=\"{}\" text-anchor=\"middle\"", label_size));
    for (size_t i = 0; i < frame.y_lines.size(); ++i)
        out += fmt::format(
            "<text transform=\"translate({} {}) rotate(-90)\" font-size=\"{}\" text-anchor=\"middle\">{}</text>\n",
            fixed(13 + line_height * double(i)), fixed((box.top + box.bottom) / 2), label_size,
            escaped_xml(frame.y_lines[i]));
    return out;
}

// --- texts in the drawing: wrapped, and names beside single points ---------------------------------------------------

size_t series_number(std::vector<Curve const*> const& legend, std::string const& name) {
    return size_t(std::ranges::find_if(legend, [&](Curve const* c) { return c->name == name; }) - legend.begin());
}

std::string shortened(std::string const& text, double size, double width) {
    if (size * text_width(text) <= width) return text;
    std::string out;
    for (char const c : text) {
        bool const begins = (static_cast<unsigned char>(c) & 0xc0) != 0x80;  // a character of UTF-8
        if (begins && size * text_width(out + "m…") > width) break;
        out += c;
    }
    return out + "…";
}

std::vector<std::string> wrapped(std::string const& text, double size, double width, size_t most) {
    std::vector<std::string> out;
    for (size_t from = 0; from < text.size();) {
        size_t const to = std::min(text.find(' ', from), text.size());
        std::string const word = text.substr(from, to - from);
        if (!out.empty() && (size * text_width(out.back() + ' ' + word) <= width || out.size() == most))
            out.back() += ' ' + word;
        else out.push_back(word);
        from = to + 1;
    }
    for (std::string& line : out) line = shortened(line, size, width);
    return out;
}

std::string text_at(double x, double y, std::string const& text, std::string const& attributes) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", fixed(x), fixed(y), attributes, escaped_xml(text));
}

std::string names_group(Panel const& panel, std::vector<Curve const*> const& legend, Axes const& axes) {
    struct Named {
        Curve const* curve;
        Point at;
        Box mark, bar;
    };
    std::vector<Named> points;
    for (bool const strong : {true, false})
        for (Curve const& curve : panel.curves)
            for (size_t i = 0; curve.strong == strong && i < std::min(curve.x.size(), curve.y.size()); ++i) {
                auto const at = mark_place(panel, curve, i, axes);
                if (!at) continue;
                auto const height = [&](std::vector<double> const& ends) {
                    if (!curve.bars || i >= ends.size()) return at->y;
                    return axes.y.shows(ends[i]) ? std::clamp(axes.y(ends[i]), axes.box.top, axes.box.bottom)
                                                 : axes.box.bottom;
                };
                double const half = strong ? 9 : 6, top = height(curve.upper), bottom = height(curve.lower);
                points.push_back({&curve,
                                  *at,
                                  {at->x - half, at->y - half, at->x + half, at->y + half},
                                  {at->x - 3, top, at->x + 3, bottom}});
            }
    auto const disjoint = [](Box const& a, Box const& b) {
        return a.left >= b.right || b.left >= a.right || a.top >= b.bottom || b.top >= a.bottom;
    };
    std::string out;
    std::vector<Box> taken;
    for (Named const& own : points) {
        double const width = tick_size * text_width(own.curve->name) * (own.curve->strong ? 1.1 : 1);
        auto const box_at = [&](double dx, double dy) {
            double const left = dx > 0 ? own.mark.right + 2 : dx < 0 ? own.mark.left - 2 - width : own.at.x - width / 2;
            double const top = dx != 0  ? own.at.y + 10 * dy - name_height / 2
                               : dy < 0 ? std::min(own.bar.top, own.mark.top) - 2 - name_height
                                        : std::max(own.bar.bottom, own.mark.bottom) + 2;
            return Box{left, top, left + width, top + name_height};
        };
        auto const free = [&](Box const& box) {
            double const distance = distance2(box, own.at.x, own.at.y);
            return box.left > axes.box.left && box.right < axes.box.right && box.top > axes.box.top &&
                   box.bottom < axes.box.bottom &&
                   std::ranges::all_of(taken, [&](Box const& name) { return disjoint(box, name); }) &&
                   std::ranges::all_of(points, [&](Named const& p) {
                       return disjoint(box, p.mark) && disjoint(box, p.bar) &&
                              (p.curve == own.curve || distance < distance2(box, p.at.x, p.at.y));
                   });
        };
        for (auto const& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}, {0, -1}, {0, 1}}) {
            Box const box = box_at(dx, dy);
            if (!free(box)) continue;
            taken.push_back(box);
            out += fmt::format(
                "<g class=\"s name\" data-s=\"{}\">{}</g>\n", series_number(legend, own.curve->name),
                text_at(box.left, box.bottom - 2.6, own.curve->name,
                        fmt::format("font-size=\"{}\"{}", tick_size, own.curve->strong ? " font-weight=\"700\"" : "")));
            break;
        }
    }
    return out;
}

double distance2(Box const& box, double x, double y) {
    double const dx = std::max({box.left - x, 0.0, x - box.right}), dy = std::max({box.top - y, 0.0, y - box.bottom});
    return dx * dx + dy * dy;
}

}  // namespace rlslab::report::plot
