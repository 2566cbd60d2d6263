// Lines, bands, bars, marks. What lies outside the panel is cut off here, not by the viewer: a file has what it shows.
#include "src/lab/report/plot.hpp"
#include "src/lab/report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace rlslab::report::plot {
namespace {

using Run = std::vector<Point>;
constexpr double far = 1e9;  // so far outside, a place and its difference from another are still finite

/// The curve's points in the drawing, broken where one cannot be shown.
std::vector<Run> runs(Curve const& curve, Axes const& axes) {
    std::vector<Run> out(1);
    for (size_t i = 0; i < curve.x.size(); ++i) {
        double const y = i < curve.y.size() ? curve.y[i] : NAN;
        if (axes.x.shows(curve.x[i]) && axes.y.shows(y))
            out.back().push_back({std::clamp(axes.x(curve.x[i]), -far, far), std::clamp(axes.y(y), -far, far)});
        else if (!out.back().empty()) out.emplace_back();
    }
    if (out.back().empty()) out.pop_back();
    return out;
}

/// Of many points in a column one unit wide, the first, the highest, the lowest and the last: they draw the same line.
Run thinned(Run const& run) {
    constexpr size_t few = 2000;
    if (run.size() <= few) return run;
    Run out;
    for (size_t from = 0; from < run.size();) {
        size_t to = from, least = from, most = from;
        for (; to < run.size() && std::floor(run[to].x) == std::floor(run[from].x); ++to) {
            if (run[to].y < run[least].y) least = to;
            if (run[to].y > run[most].y) most = to;
        }
        std::set<size_t> const kept{from, least, most, to - 1};
        for (size_t const i : kept) out.push_back(run[i]);
        from = to;
    }
    return out;
}

/// The part of the segment inside the box (Liang and Barsky); false if there is none.
bool clip(Point& a, Point& b, Box const& box) {
    double from = 0, to = 1;
    double const dx = b.x - a.x, dy = b.y - a.y;
    for (auto const& [step, room] :
         {std::pair{-dx, a.x - box.left}, {dx, box.right - a.x}, {-dy, a.y - box.top}, {dy, box.bottom - a.y}}) {
        if (step == 0 && room < 0) return false;
        if (step < 0) from = std::max(from, room / step);
        if (step > 0) to = std::min(to, room / step);
    }
    if (!(from <= to)) return false;
    Point const start = a;
    a = {start.x + from * dx, start.y + from * dy}, b = {start.x + to * dx, start.y + to * dy};
    return true;
}

std::string path_of(Run const& run, Box const& box) {
    std::string out, at;
    for (size_t i = 0; i + 1 < run.size(); ++i) {
        Point a = run[i], b = run[i + 1];
        if (!clip(a, b, box)) continue;
        std::string const from = fixed(a.x) + ' ' + fixed(a.y), to = fixed(b.x) + ' ' + fixed(b.y);
        if (from != at) out += 'M' + from;
        if (to != from) out += 'L' + to;
        at = to;
    }
    return out;
}

bool has_interval(Curve const& curve, size_t i) {
    return i < curve.lower.size() && i < curve.upper.size() &&
           (curve.lower[i] != curve.y[i] || curve.upper[i] != curve.y[i]) && !std::isnan(curve.lower[i]) &&
           !std::isnan(curve.upper[i]);
}

/// An end of an interval, moved into the panel: it may be infinite, or 0 where the axis is logarithmic.
double inside(double value, Axes const& axes) {
    if (value == INFINITY) return axes.box.top;
    if (!axes.y.shows(value)) return axes.box.bottom;
    return std::clamp(axes.y(value), axes.box.top, axes.box.bottom);
}

std::string band(Curve const& curve, Axes const& axes) {
    std::string out;
    for (size_t from = 0; from < curve.x.size();) {
        size_t to = from;
        bool wide = false;
        for (; to < curve.x.size() && to < curve.lower.size() && to < curve.upper.size() && axes.x.shows(curve.x[to]) &&
               !std::isnan(curve.lower[to]) && !std::isnan(curve.upper[to]);
             ++to)
            wide |= has_interval(curve, to);
        if (wide && to - from > 1) {
            Run upper, lower;
            for (size_t i = from; i < to; ++i) {
                double const x = axes.x(curve.x[i]);
                upper.push_back({x, inside(curve.upper[i], axes)}), lower.push_back({x, inside(curve.lower[i], axes)});
            }
            upper = thinned(upper), lower = thinned(lower);
            std::string path;
            for (Point const& p : upper) path += (path.empty() ? 'M' : 'L') + fixed(p.x) + ' ' + fixed(p.y);
            for (size_t i = lower.size(); i-- > 0;) path += 'L' + fixed(lower[i].x) + ' ' + fixed(lower[i].y);
            out += fmt::format("<path d=\"{}Z\" fill=\"{}\" fill-opacity=\".14\"/>", path, curve.look.colour);
        }
        from = std::max(to, from + 1);
    }
    return out;
}

std::string says(Figure const& figure, Curve const& curve, size_t i) {
    if (i < curve.says.size()) return curve.says[i];
    size_t const place = static_cast<size_t>(std::clamp(curve.x[i], 0.0, 1e6));
    std::string const x = place < figure.x_names.size()
                              ? figure.x_names[place]
                              : (figure.x.empty() ? "" : figure.x + " ") + number_text(curve.x[i]);
    std::string out =
        fmt::format("{}: {}, {}{}", curve.name, x, figure.y.empty() ? "" : figure.y + " ", number_text(curve.y[i]));
    if (has_interval(curve, i))
        out += fmt::format(" ({} to {})", number_text(curve.lower[i]), number_text(curve.upper[i]));
    return out;
}

/// For what is less than the axis shows: at its lower edge.
constexpr double edge_height = 5.4;
std::string edge_mark(double x, Axes const& axes) {
    return mark_path("triangle-down", x, axes.box.bottom - edge_height);
}

std::string bars(Panel const& panel, Curve const& curve, Axes const& axes) {
    std::string path, edges;
    for (size_t i = 0; i < curve.x.size(); ++i) {
        if (!axes.x.shows(curve.x[i]) || !has_interval(curve, i) || curve.upper[i] < panel.y_least) continue;
        double const x = axes.x(curve.x[i]), top = inside(curve.upper[i], axes),
                     bottom = curve.lower[i] < panel.y_least ? axes.box.bottom : inside(curve.lower[i], axes);
        path += fmt::format("M{0} {1}h6M{2} {1}V{3}", fixed(x - 3), fixed(top), fixed(x), fixed(bottom));
        if (curve.lower[i] < panel.y_least) edges += edge_mark(x, axes);
        else path += fmt::format("M{} {}h6", fixed(x - 3), fixed(bottom));
    }
    if (path.empty()) return "";
    std::string out = fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>", path,
                                  curve.look.colour, curve.strong ? 2.4 : 1.2);
    if (!edges.empty()) out += fmt::format("<path d=\"{}\" fill=\"#fff\" stroke=\"{}\"/>", edges, curve.look.colour);
    return out;
}

/// Points below the axis: triangles at its lower edge, with the numbers in their tooltips.
std::string below(Figure const& figure, Panel const& panel, Curve const& curve, Axes const& axes) {
    std::string out;
    double last = -far;
    for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
        auto const at = curve.y[i] < panel.y_least ? mark_place(panel, curve, i, axes) : std::nullopt;
        if (!at || (curve.line && std::abs(at->x - last) < 14)) continue;
        last = at->x;
        out += fmt::format("<path d=\"{}\"><title>{}, below the axis</title></path>", edge_mark(at->x, axes),
                           escaped_xml(says(figure, curve, i)));
    }
    return out.empty() ? ""
                       : fmt::format("<g class=\"below\" fill=\"{0}\" stroke=\"{0}\">{1}</g>", curve.look.colour, out);
}

std::string stems(Curve const& curve, Axes const& axes) {
    std::string path;
    double const foot = inside(0, axes);
    for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
        if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i]))
            path += fmt::format("M{} {}V{}", fixed(axes.x(curve.x[i])), fixed(foot), fixed(inside(curve.y[i], axes)));
    return path.empty() ? "" : fmt::format("<path d=\"{}\" {}/>", path, line_style({curve.look.colour}, 1.6));
}

/// Marks with tooltips. Along a line they keep a distance, and of very many only some are drawn; of the points of a
/// cloud each place is drawn once.
std::string marks(Figure const& figure, Panel const& panel, Curve const& curve, Axes const& axes) {
    constexpr double spacing = 9;
    constexpr size_t many = 120, enough = 40, cloud = 2000;
    std::vector<std::pair<size_t, Point>> all;
    for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
        if (auto const p = mark_place(panel, curve, i, axes); p && !(curve.y[i] < panel.y_least))
            all.emplace_back(i, *p);
    std::string out;
    if (curve.line) {
        size_t const stride = all.size() > many ? all.size() / enough : 1;
        Point last{-far, -far};
        for (size_t k = 0; k < all.size(); ++k) {
            auto const& [i, p] = all[k];
            bool const end = k == 0 || k + 1 == all.size();
            if (!end && (k % stride || (std::abs(p.x - last.x) < spacing && std::abs(p.y - last.y) < spacing)))
                continue;
            last = p;
            out += fmt::format("<path d=\"{}\"><title>{}</title></path>", mark_path(curve.look.mark, p.x, p.y),
                               escaped_xml(says(figure, curve, i)));
        }
    } else {
        std::set<std::pair<long, long>> taken;
        std::string path;
        double const grid = all.size() > cloud ? 2 : 0.5;
        for (auto const& [i, p] : all) {
            if (!taken.emplace(std::lround(p.x / grid), std::lround(p.y / grid)).second) continue;
            std::string const mark = mark_path(curve.look.mark, p.x, p.y);
            if (all.size() > cloud) path += mark;
            else
                out +=
                    fmt::format("<path d=\"{}\"><title>{}</title></path>", mark, escaped_xml(says(figure, curve, i)));
        }
        if (!path.empty()) out = fmt::format("<path d=\"{}\"><title>{}</title></path>", path, escaped_xml(curve.name));
    }
    if (curve.strong && !curve.line)
        for (auto const& [i, p] : all)
            out += fmt::format(
                "<circle cx=\"{}\" cy=\"{}\" r=\"8.5\" fill=\"none\" stroke=\"#1a1a1a\" stroke-width=\"1.6\"/>",
                fixed(p.x), fixed(p.y));
    return out.empty() ? "" : fmt::format("<g {}>{}</g>", mark_style(curve.look, curve.strong ? 1.8 : 1.3), out);
}

/// Whether a line or a mark of a curve is in this box.
bool covered(Panel const& panel, Axes const& axes, Box const& box) {
    for (Curve const& curve : panel.curves) {
        std::optional<Point> before;
        for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
            auto const at = mark_place(panel, curve, i, axes);
            if (at && box.holds(at->x, at->y)) return true;
            if (Point a = before.value_or(Point{}), b = at.value_or(Point{});
                at && before && curve.line && clip(a, b, box))
                return true;
            before = at;
        }
    }
    return false;
}

}  // namespace

std::optional<Point> mark_place(Panel const& panel, Curve const& curve, size_t i, Axes const& axes) {
    if (i >= std::min(curve.x.size(), curve.y.size()) || !axes.x.shows(curve.x[i])) return {};
    bool const less = curve.y[i] < panel.y_least;
    if (!less && !axes.y.shows(curve.y[i])) return {};
    Point const out{axes.x(curve.x[i]), less ? axes.box.bottom - edge_height : axes.y(curve.y[i])};
    return axes.box.holds(out.x, out.y) ? std::optional(out) : std::nullopt;
}

std::string fixed(double x) {
    std::string out = fmt::format("{:.1f}", x);
    if (out.ends_with(".0")) out.resize(out.size() - 2);
    return out == "-0" ? "0" : out;
}

std::string number_text(double x) { return fmt::format("{:.4g}", x); }

std::string mark_path(std::string const& mark, double x, double y) {
    static std::map<std::string, char const*, std::less<>> const outlines{
        {"circle", "m-3.6 0a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0-7.2 0z"},
        {"square", "m-3.3-3.3h6.6v6.6h-6.6z"},
        {"diamond", "m0-4.7l4.7 4.7-4.7 4.7-4.7-4.7z"},
        {"triangle-up", "m0-4.8l4.4 7.6h-8.8z"},
        {"triangle-down", "m0 4.8l4.4-7.6h-8.8z"},
        {"star", "m0-5.2l1.3 3.5 3.6.1-2.8 2.3.9 3.6-3-2.1-3 2.1.9-3.6-2.8-2.3 3.6-.1z"},
        {"cross", "m-1.3-4.4h2.6v3.1h3.1v2.6h-3.1v3.1h-2.6v-3.1h-3.1v-2.6h3.1z"},
        {"x", "m-3.9-2.1l1.8-1.8 2.1 2.1 2.1-2.1 1.8 1.8-2.1 2.1 2.1 2.1-1.8 1.8-2.1-2.1-2.1 2.1-1.8-1.8 2.1-2.1z"}};
    if (mark.empty()) return "";
    auto const found = outlines.find(mark.substr(0, mark.find("-open")));
    return 'M' + fixed(x) + ' ' + fixed(y) + (found == outlines.end() ? outlines.find("circle") : found)->second;
}

std::string mark_style(Look const& look, double width) {
    return fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"",
                       look.mark.ends_with("-open") ? "#fff" : look.colour, look.colour, width);
}
std::string line_style(Look const& look, double width) {
    return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}", look.colour,
                       width, look.dashed ? " stroke-dasharray=\"6 4\"" : "");
}

std::string curve_group(Figure const& figure, Panel const& panel, Curve const& curve, size_t series, bool guide,
                        Axes const& axes) {
    bool const faint = !guide && !curve.strong && std::ranges::any_of(panel.curves, &Curve::strong);
    std::string out;
    if (!guide) out += curve.bars ? bars(panel, curve, axes) : band(curve, axes);
    if (!guide && curve.stems) out += stems(curve, axes);
    std::string path;
    if (curve.line)
        for (Run const& run : runs(curve, axes)) path += path_of(thinned(run), axes.box);
    if (!path.empty())
        out += fmt::format("<path d=\"{}\" {}><title>{}</title></path>", path,
                           line_style(curve.look, curve.strong     ? 3.4
                                                  : guide || faint ? 1.4
                                                                   : 1.8),
                           escaped_xml(curve.name));
    if (curve.marks && !guide && !curve.look.mark.empty()) out += marks(figure, panel, curve, axes);
    if (!guide) out += below(figure, panel, curve, axes);
    return fmt::format("<g class=\"s\" data-s=\"{}\"{}>{}</g>\n", series,
                       !faint       ? ""
                       : curve.line ? " opacity=\".5\""
                                    : " opacity=\".75\"",
                       out);
}

std::string event_group(Event const& event, Panel const& panel, Look const& look, size_t series, Axes const& axes) {
    if (!axes.x.shows(event.x)) return "";
    double const x = axes.x(event.x);
    Box const& box = axes.box;
    if (x < box.left - 0.05 || x > box.right + 0.05) return "";
    std::string out;
    if (std::isnan(event.y) || !axes.y.shows(event.y)) {
        struct Side {
            bool left;
            double base;
            std::string text;
        };
        std::vector<Side> sides;
        bool const near_left = x > (box.left + box.right) / 2;
        for (bool const left : {near_left, !near_left})
            for (double const base : {box.top + 14, box.bottom - 7})
                sides.push_back(
                    {left, base, shortened(event.text, tick_size, (left ? x - box.left : box.right - x) - 6)});
        auto const free = std::ranges::find_if(sides, [&](Side const& side) {
            double const width = tick_size * text_width(side.text), begin = side.left ? x - 5 - width : x + 5;
            return side.text == event.text &&
                   !covered(panel, axes, {begin, side.base - 11, begin + width, side.base + 4});
        });
        Side const& side = free == sides.end() ? sides.front() : *free;
        out = fmt::format(
            "<path d=\"M{} {}V{}\" {}/><text x=\"{}\" y=\"{}\" text-anchor=\"{}\" font-size=\"12\" fill=\"{}\" "
            "stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\">{}</text>",
            fixed(x), fixed(box.top), fixed(box.bottom), line_style({look.colour, true}, 1.3),
            fixed(side.left ? x - 5 : x + 5), fixed(side.base), side.left ? "end" : "start", look.colour,
            escaped_xml(side.text));
    } else {
        double const y = std::clamp(axes.y(event.y), box.top, box.bottom);
        out = fmt::format(
            "<circle cx=\"{0}\" cy=\"{1}\" r=\"7\" fill=\"#fff\" stroke=\"{2}\" stroke-width=\"1.6\"/><path d=\"{3}\" "
            "fill=\"{2}\"/><title>{4}</title>",
            fixed(x), fixed(y), look.colour, mark_path("x", x, y), escaped_xml(event.text));
    }
    return fmt::format("<g class=\"s event\" data-s=\"{}\">{}</g>\n", series, out);
}

}  // namespace rlslab::report::plot
