// Texts that stand in a drawing: wrapped, and names beside their curves without touching each other.
#include "report/plot.hpp"
#include "report/svg.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace rlslab::report::plot {

bool names_points(Figure const& figure) {
    return figure.names &&
           std::ranges::all_of(figure.panels, [](Panel const& panel) { return std::ranges::none_of(panel.curves, &Curve::line); });
}

Names names_of(Figure const& figure, Panel const& panel, bool named, double most) {
    Names out;
    if (!named || !figure.names) return out;
    for (Curve const& curve : panel.curves) (curve.x.size() > 1 && curve.line ? out.at_ends : out.beside) = true;
    if (out.at_ends)
        for (auto const* curves : {&panel.curves, &panel.guides})
            for (Curve const& curve : *curves) out.width = std::max(out.width, tick_size * text_width(curve.name) + 42);
    out.width = std::min(out.width, most);
    return out;
}

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
        if (!out.empty() && (size * text_width(out.back() + ' ' + word) <= width || out.size() == most)) out.back() += ' ' + word;
        else out.push_back(word);
        from = to + 1;
    }
    for (std::string& line : out) line = shortened(line, size, width);
    return out;
}

std::string text_at(double x, double y, std::string const& text, std::string const& attributes) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", fixed(x), fixed(y), attributes, escaped_xml(text));
}

namespace {

/// Heights near the wished ones, in their order, inside [top, bottom], `gap` apart or as far apart as fits: the mean of those that
/// pushing down alone and pushing up alone give, then moved inside.
std::vector<double> spread(std::vector<double> wished, double gap, double top, double bottom) {
    size_t const n = wished.size();
    if (n < 2) return wished;
    gap = std::min(gap, (bottom - top) / double(n - 1));
    std::vector<size_t> order(n);
    for (size_t i = 0; i < n; ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](size_t i) { return wished[i]; });
    std::vector<double> down = wished, up = wished;
    double least = -1e300, most = 1e300;
    for (size_t k = 0; k < n; ++k) least = (down[order[k]] = std::max(down[order[k]], least)) + gap;
    for (size_t k = n; k-- > 0;) most = (up[order[k]] = std::min(up[order[k]], most)) - gap;
    for (size_t k = 0; k < n; ++k) {  // k names above it and n - 1 - k below it need their room
        double& height = wished[order[k]];
        height = std::max(top + double(k) * gap, std::min((down[order[k]] + up[order[k]]) / 2, bottom - double(n - 1 - k) * gap));
    }
    return wished;
}

std::optional<Point> last_place(Panel const& panel, Curve const& curve, Axes const& axes) {
    for (size_t i = std::min(curve.x.size(), curve.y.size()); i-- > 0;)
        if (auto const at = mark_place(panel, curve, i, axes)) return at;
    return {};
}

std::string names_at_ends(Panel const& panel, double width, std::vector<Curve const*> const& legend, Axes const& axes) {
    struct End {
        Curve const* curve;
        double x, y;
    };
    std::vector<End> ends;
    std::vector<double> wished;
    for (auto const* curves : {&panel.curves, &panel.guides})
        for (Curve const& curve : *curves)
            if (auto const at = last_place(panel, curve, axes)) ends.push_back({&curve, at->x, at->y}), wished.push_back(at->y);
    std::vector<double> const heights = spread(wished, 15, axes.box.top, axes.box.bottom);
    std::string out;
    for (size_t i = 0; i < ends.size(); ++i) {
        auto const& [curve, x, y] = ends[i];
        out += fmt::format(
            "<g class=\"s name\" data-s=\"{}\"><path d=\"M{} {}L{} {}L{} {}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\"/>",
            series_number(legend, curve->name), fixed(x + 6), fixed(y), fixed(axes.box.right + 8), fixed(y), fixed(axes.box.right + 24),
            fixed(heights[i]), curve->look.colour);
        out += text_at(axes.box.right + 28, heights[i] + 4.3, shortened(curve->name, tick_size, width - 30),
                       fmt::format("font-size=\"{}\"", tick_size)) +
               "</g>";
    }
    return out;
}

/// Each name beside its last point, with a line to it where that is not near.
NamesGroup names_beside(Panel const& panel, std::vector<Curve const*> const& legend, Axes const& axes) {
    std::vector<NamedPoint> points;
    std::vector<Curve const*> curves;
    for (Curve const& curve : panel.curves)
        for (size_t i = std::min(curve.x.size(), curve.y.size()); i-- > 0;) {
            auto const at = mark_place(panel, curve, i, axes);
            if (!at) continue;
            Box bar{at->x, at->y, at->x, at->y};
            auto const height = [&](double y) {
                return axes.y.shows(y) ? std::clamp(axes.y(y), axes.box.top, axes.box.bottom) : axes.box.bottom;
            };
            if (curve.bars && i < curve.lower.size() && i < curve.upper.size())
                bar = {at->x - 3, height(curve.upper[i]), at->x + 3, height(curve.lower[i])};
            bool const last = curves.empty() || curves.back() != &curve;  // the others of a curve are in the way, and have no name
            double const width = last ? tick_size * text_width(curve.name) * (curve.strong ? 1.1 : 1) : 0;
            points.push_back({at->x, at->y, bar, width, curve.strong}), curves.push_back(&curve);
        }
    std::vector<std::optional<Box>> const places = places_beside(points, axes.box);
    NamesGroup out;
    for (size_t i = 0; i < points.size(); ++i) {
        Curve const& curve = *curves[i];
        if (points[i].width == 0) continue;
        if (!places[i]) {
            out.left_out.push_back(&curve);
            continue;
        }
        Box const& place = *places[i];
        double const x = points[i].x, y = points[i].y;
        std::string const line = distance2(place, x, y) < leader_from * leader_from
                                     ? ""
                                     : fmt::format("<path d=\"M{} {}L{} {}\" stroke=\"{}\" stroke-width=\"1\"/>", fixed(x), fixed(y),
                                                   fixed(std::clamp(x, place.left, place.right)),
                                                   fixed(std::clamp(y, place.top, place.bottom)), curve.look.colour);
        out.svg += fmt::format("<g class=\"s name\" data-s=\"{}\">{}{}</g>\n", series_number(legend, curve.name), line,
                               text_at(place.left, place.bottom - 2.6, curve.name,
                                       fmt::format("font-size=\"{}\"{}", tick_size, curve.strong ? " font-weight=\"700\"" : "")));
    }
    return out;
}

}  // namespace

NamesGroup names_group(Panel const& panel, Names const& names, std::vector<Curve const*> const& legend, Axes const& axes) {
    if (names.at_ends) return {names_at_ends(panel, names.width, legend, axes), {}};
    return names.beside ? names_beside(panel, legend, axes) : NamesGroup{};
}

}  // namespace rlslab::report::plot
