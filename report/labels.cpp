// Texts that stand in a drawing: wrapped, and names beside their curves without touching each other.
#include "report/plot.hpp"
#include "report/svg.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace rlslab::plot {

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
        bool const begins = (static_cast<unsigned char>(c) & 0xc0) != 0x80;    // a character of UTF-8
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
        else
            out.push_back(word);
        from = to + 1;
    }
    for (std::string& line : out) line = shortened(line, size, width);
    return out;
}

std::string text_at(double x, double y, std::string const& text, std::string const& attributes) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", fixed(x), fixed(y), attributes, escaped_xml(text));
}

namespace {

/// Heights near those wished for, in their order, inside [top, bottom], `gap` apart or as far as there is room: halfway between
/// only pushing down and only pushing up, then moved inside.
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
    for (size_t k = 0; k < n; ++k) {    // k names above it and n - 1 - k below it need their room
        double& height = wished[order[k]];
        height = std::max(top + double(k) * gap, std::min((down[order[k]] + up[order[k]]) / 2, bottom - double(n - 1 - k) * gap));
    }
    return wished;
}

std::optional<std::pair<double, double>> last_place(Curve const& curve, Axes const& axes) {
    for (size_t i = std::min(curve.x.size(), curve.y.size()); i-- > 0;)
        if (axes.x.shows(curve.x[i]) && axes.y.shows(curve.y[i])) {
            std::pair const at{axes.x(curve.x[i]), axes.y(curve.y[i])};
            if (axes.box.holds(at.first, at.second)) return at;
        }
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
            if (auto const at = last_place(curve, axes)) ends.push_back({&curve, at->first, at->second}), wished.push_back(at->second);
    std::vector<double> const heights = spread(wished, 15, axes.box.top, axes.box.bottom);
    std::string out;
    for (size_t i = 0; i < ends.size(); ++i) {
        auto const& [curve, x, y] = ends[i];
        out += fmt::format("<g class=\"s name\" data-s=\"{}\"><path d=\"M{} {}L{} {}L{} {}\" fill=\"none\" stroke=\"{}\" stroke-width=\".8\" stroke-opacity=\".6\"/>",
                           series_number(legend, curve->name), fixed(x + 6), fixed(y), fixed(axes.box.right + 8), fixed(y), fixed(axes.box.right + 24),
                           fixed(heights[i]), curve->look.colour);
        out += text_at(axes.box.right + 28, heights[i] + 4.3, shortened(curve->name, tick_size, width - 30), fmt::format("font-size=\"{}\"", tick_size)) + "</g>";
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
                               text_at(box.left, y + dy + 4.3, curve.name, fmt::format("font-size=\"{}\"", tick_size)));
            break;
        }
    }
    return out;
}

}  // namespace

std::string names_group(Panel const& panel, Names const& names, std::vector<Curve const*> const& legend, Axes const& axes) {
    return names.at_ends ? names_at_ends(panel, names.width, legend, axes) : names.beside ? names_beside(panel, legend, axes) : "";
}

}  // namespace rlslab::plot
