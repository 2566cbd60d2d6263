// Lines, bands, bars, marks. What lies outside the panel is cut off here, not by the viewer: a file holds what it shows.
#include "report/plot.hpp"
#include "report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace rlslab::plot {
namespace {

struct Point {
    double x, y;
};
using Run = std::vector<Point>;
constexpr double far = 1e9;    // so far outside, a place and its difference from another are still finite

/// The curve's points in the drawing, apart where one cannot be shown.
template <class Y>
std::vector<Run> runs(Curve const& curve, Axes const& axes, Y const& y_of) {
    std::vector<Run> out(1);
    for (size_t i = 0; i < curve.x.size(); ++i) {
        double const y = y_of(i);
        if (axes.x.shows(curve.x[i]) && axes.y.shows(y))
            out.back().push_back({std::clamp(axes.x(curve.x[i]), -far, far), std::clamp(axes.y(y), -far, far)});
        else if (!out.back().empty())
            out.emplace_back();
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
    for (auto const& [step, room] : {std::pair{-dx, a.x - box.left}, {dx, box.right - a.x}, {-dy, a.y - box.top}, {dy, box.bottom - a.y}}) {
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
    return i < curve.low.size() && i < curve.high.size() && (curve.low[i] != curve.y[i] || curve.high[i] != curve.y[i]) &&
           !std::isnan(curve.low[i]) && !std::isnan(curve.high[i]);
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
        for (; to < curve.x.size() && to < curve.low.size() && to < curve.high.size() && axes.x.shows(curve.x[to]) &&
               !std::isnan(curve.low[to]) && !std::isnan(curve.high[to]); ++to)
            wide |= has_interval(curve, to);
        if (wide && to - from > 1) {
            Run upper, lower;
            for (size_t i = from; i < to; ++i) {
                double const x = axes.x(curve.x[i]);
                upper.push_back({x, inside(curve.high[i], axes)}), lower.push_back({x, inside(curve.low[i], axes)});
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

std::string bars(Curve const& curve, Axes const& axes) {
    std::string path;
    for (size_t i = 0; i < curve.x.size(); ++i) {
        if (!axes.x.shows(curve.x[i]) || !has_interval(curve, i)) continue;
        double const x = axes.x(curve.x[i]), top = inside(curve.high[i], axes), bottom = inside(curve.low[i], axes);
        path += fmt::format("M{0} {1}h6M{2} {1}V{3}M{0} {3}h6", fixed(x - 3), fixed(top), fixed(x), fixed(bottom));
    }
    return path.empty() ? "" : fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\"/>", path, curve.look.colour);
}

std::string stems(Curve const& curve, Axes const& axes) {
    std::string path;
    double const foot = inside(0, axes);
    for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
        if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i]))
            path += fmt::format("M{} {}V{}", fixed(axes.x(curve.x[i])), fixed(foot), fixed(inside(curve.y[i], axes)));
    return path.empty() ? "" : fmt::format("<path d=\"{}\" {}/>", path, line_style({curve.look.colour}, 1.6));
}

std::string says(Figure const& figure, Curve const& curve, size_t i) {
    if (i < curve.says.size()) return curve.says[i];
    size_t const place = static_cast<size_t>(std::clamp(curve.x[i], 0.0, 1e6));
    std::string const x =
        place < figure.x_names.size() ? figure.x_names[place] : (figure.x.empty() ? "" : figure.x + " ") + number_text(curve.x[i]);
    std::string out = fmt::format("{}: {}, {}{}", curve.name, x, figure.y.empty() ? "" : figure.y + " ", number_text(curve.y[i]));
    if (has_interval(curve, i)) out += fmt::format(" ({} to {})", number_text(curve.low[i]), number_text(curve.high[i]));
    return out;
}

/// Marks with tooltips. Along a line they keep a distance, and of very many only some are drawn; of the points of a cloud each
/// place is drawn once.
std::string marks(Figure const& figure, Curve const& curve, Axes const& axes) {
    constexpr double apart = 9;
    constexpr size_t many = 120, enough = 40, cloud = 2000;
    std::vector<std::pair<size_t, Point>> all;
    for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
        if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i]))
            if (Point const p{axes.x(curve.x[i]), axes.y(curve.y[i])}; axes.box.holds(p.x, p.y)) all.emplace_back(i, p);
    std::string out;
    if (curve.line) {
        size_t const stride = all.size() > many ? all.size() / enough : 1;
        Point last{-far, -far};
        for (size_t k = 0; k < all.size(); ++k) {
            auto const& [i, p] = all[k];
            bool const end = k == 0 || k + 1 == all.size();
            if (!end && (k % stride || (std::abs(p.x - last.x) < apart && std::abs(p.y - last.y) < apart))) continue;
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
            else out += fmt::format("<path d=\"{}\"><title>{}</title></path>", mark, escaped_xml(says(figure, curve, i)));
        }
        if (!path.empty()) out = fmt::format("<path d=\"{}\"><title>{}</title></path>", path, escaped_xml(curve.name));
    }
    return out.empty() ? "" : fmt::format("<g {}>{}</g>", mark_style(curve.look), out);
}

}  // namespace

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

std::string mark_style(Look const& look) {
    return fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.3\"", look.mark.ends_with("-open") ? "#fff" : look.colour, look.colour);
}
std::string line_style(Look const& look, double width) {
    return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}", look.colour, width,
                       look.dashed ? " stroke-dasharray=\"6 4\"" : "");
}

std::string curve_group(Figure const& figure, Curve const& curve, size_t series, bool guide, Axes const& axes) {
    std::string out;
    if (!guide) out += curve.bars ? bars(curve, axes) : band(curve, axes);
    if (!guide && curve.stems) out += stems(curve, axes);
    std::string path;
    if (curve.line)
        for (Run const& run : runs(curve, axes, [&](size_t i) { return i < curve.y.size() ? curve.y[i] : NAN; }))
            path += path_of(thinned(run), axes.box);
    if (!path.empty())
        out += fmt::format("<path d=\"{}\" {}><title>{}</title></path>", path, line_style(curve.look, guide ? 1.4 : 1.8),
                           escaped_xml(curve.name));
    if (curve.marks && !guide && !curve.look.mark.empty()) out += marks(figure, curve, axes);
    return fmt::format("<g class=\"s\" data-s=\"{}\">{}</g>\n", series, out);
}

std::string event_group(Event const& event, Look const& look, size_t series, Axes const& axes) {
    if (!axes.x.shows(event.x)) return "";
    double const x = axes.x(event.x);
    if (x < axes.box.left - 0.05 || x > axes.box.right + 0.05) return "";
    std::string out;
    if (std::isnan(event.y) || !axes.y.shows(event.y)) {
        bool const left = x > (axes.box.left + axes.box.right) / 2;
        std::string const text = shortened(event.text, tick_size, (left ? x - axes.box.left : axes.box.right - x) - 6);
        out = fmt::format("<path d=\"M{} {}V{}\" {}/><text x=\"{}\" y=\"{}\" text-anchor=\"{}\" font-size=\"12\" fill=\"{}\">{}</text>",
                          fixed(x), fixed(axes.box.top), fixed(axes.box.bottom), line_style({look.colour, true}, 1.3),
                          fixed(left ? x - 5 : x + 5), fixed(axes.box.top + 14), left ? "end" : "start", look.colour, escaped_xml(text));
    } else {
        double const y = std::clamp(axes.y(event.y), axes.box.top, axes.box.bottom);
        out = fmt::format(
            "<circle cx=\"{0}\" cy=\"{1}\" r=\"7\" fill=\"#fff\" stroke=\"{2}\" stroke-width=\"1.6\"/><path d=\"{3}\" fill=\"{2}\"/>"
            "<title>{4}</title>",
            fixed(x), fixed(y), look.colour, mark_path("x", x, y), escaped_xml(event.text));
    }
    return fmt::format("<g class=\"s event\" data-s=\"{}\">{}</g>\n", series, out);
}

}  // namespace rlslab::plot
