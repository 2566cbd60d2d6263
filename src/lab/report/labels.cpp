// Texts that stand in a drawing: wrapped, and names beside single points.
#include "src/lab/report/plot.hpp"
#include "src/lab/report/svg.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::report::plot {

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
