// Two logarithmic axes, one line for each series, and names at the lines' ends that do not overlap.
#include "plot.hpp"

#include "measured.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <ranges>
#include <set>

namespace rlslab::bench {
namespace {

/// A logarithmic axis from pixel `begin` at `low` to pixel `end` at `high`.
struct Axis {
    double low, high, begin, end;
    double operator()(double x) const { return begin + (end - begin) * std::log(x / low) / std::log(high / low); }
};

/// Which of its family each series is, from 0.
std::vector<int> ranks(std::vector<Series> const& series) {
    std::map<std::string, int> seen;
    std::vector<int> out;
    for (Series const& s : series) out.push_back(seen[style_of(s.family)]++);
    return out;
}

/// Heights near those wanted, in their order, at least `gap` apart, none below `bottom`: halfway between what is had by
/// only pushing down and by only pushing up, both of which keep the gap.
std::vector<double> spread(std::vector<double> wanted, double gap, double bottom) {
    std::vector<size_t> order(wanted.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](size_t i) { return wanted[i]; });
    std::vector<double> down = wanted, up = wanted;
    double least = -1e300, most = 1e300;
    for (size_t i : order) least = (down[i] = std::max(down[i], least)) + gap;
    for (size_t i : order | std::views::reverse) most = (up[i] = std::min(up[i], most)) - gap;
    most = bottom;
    for (size_t i : order | std::views::reverse) most = (wanted[i] = std::min((down[i] + up[i]) / 2, most)) - gap;
    return wanted;
}

std::string grid(std::set<double> const& sizes, Axis const& x, Axis const& y) {
    std::string out;
    for (double size : sizes)
        out += fmt::format("<line class='grid' x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2:.1f}'/>"
                           "<text x='{0:.1f}' y='{3:.1f}' text-anchor='middle'>{4}</text>\n",
                           x(size), y.begin, y.end, y.begin + 20, size);
    for (double decade = y.low; decade <= y.high * 1.001; decade *= 10) {
        out += fmt::format("<line class='grid' x1='{0:.1f}' x2='{1:.1f}' y1='{2:.1f}' y2='{2:.1f}'/>"
                           "<text x='{3:.1f}' y='{4:.1f}' text-anchor='end'>{5}</text>\n",
                           x.begin - 12, x.end + 12, y(decade), x.begin - 18, y(decade) + 4, time_for_people(decade));
    }
    return out;
}

std::string line(Series const& s, int rank, Axis const& x, Axis const& y) {
    std::string path, marks;
    for (Point const& p : s.points) {
        path += fmt::format("{:.1f},{:.1f} ", x(p.size), y(p.nanoseconds));
        marks += fmt::format("<g><title>{}</title>{}</g>", p.says, mark(rank, x(p.size), y(p.nanoseconds), 4));
    }
    return fmt::format("<polyline points='{}'/>{}", path, marks);
}

}  // namespace

std::string style_of(std::string const& family) {
    std::string out = family;
    std::ranges::replace(out, ' ', '-');
    return out;
}

std::string mark(int n, double x, double y, double r) {
    auto const polygon = [&](std::initializer_list<std::pair<double, double>> corners) {
        std::string points;
        for (auto const& [dx, dy] : corners) points += fmt::format("{:.1f},{:.1f} ", x + r * dx, y + r * dy);
        return points;
    };
    char const* const hollow = n >= 5 ? " class='hollow'" : "";
    switch (n % 5) {
        case 0: return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{:.1f}'{}/>", x, y, r, hollow);
        case 1: return fmt::format("<polygon points='{}'{}/>", polygon({{-.9, -.9}, {.9, -.9}, {.9, .9}, {-.9, .9}}), hollow);
        case 2: return fmt::format("<polygon points='{}'{}/>", polygon({{0, -1.2}, {1.1, .8}, {-1.1, .8}}), hollow);
        case 3: return fmt::format("<polygon points='{}'{}/>", polygon({{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}}), hollow);
        default: return fmt::format("<polygon points='{}'{}/>", polygon({{0, 1.2}, {1.1, -.8}, {-1.1, -.8}}), hollow);
    }
}

std::string plot(std::vector<Series> const& series, double width, double height, bool labels) {
    std::set<double> sizes;
    double least = 1e300, most = 0;
    for (Series const& s : series)
        for (Point const& p : s.points) {
            sizes.insert(p.size);
            least = std::min(least, p.nanoseconds);
            most = std::max(most, p.nanoseconds);
        }
    if (sizes.size() < 2) return "";
    Axis const x{*sizes.begin(), *sizes.rbegin(), 78, labels ? width - 200 : width - 20};
    Axis const y{std::pow(10, std::floor(std::log10(least))), std::pow(10, std::ceil(std::log10(most))), height - 50, 14};
    std::string out = fmt::format("<svg viewBox='0 0 {0:.0f} {1:.0f}' style='max-width:{0:.0f}px' role='img' "
                                  "aria-label='time of an update against the number of parameters'>\n", width, height);
    out += grid(sizes, x, y);
    out += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>parameters d</text>\n", (x.begin + x.end) / 2,
                       height - 8);
    std::vector<double> ends;
    for (Series const& s : series) ends.push_back(y(s.points.back().nanoseconds));
    std::vector<double> const heights = spread(ends, 16, y.begin);
    std::vector<int> const rank = ranks(series);
    for (size_t i = 0; i < series.size(); ++i) {
        Series const& s = series[i];
        out += fmt::format("<g class='line {}'>{}", style_of(s.family), line(s, rank[i], x, y));
        if (labels)
            out += fmt::format("<polyline class='leader' points='{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}'/>"
                               "<text x='{:.1f}' y='{:.1f}'>{}</text>",
                               x(s.points.back().size) + 7, ends[i], x.end + 14, ends[i], x.end + 30, heights[i], x.end + 34,
                               heights[i] + 4.5, s.name);
        out += "</g>\n";
    }
    return out + "</svg>\n";
}

std::string legend(std::vector<Series> const& series) {
    std::vector<int> const rank = ranks(series);
    std::string out = "<p class='legend'>";
    for (size_t i = 0; i < series.size(); ++i)
        out += fmt::format("<span><svg class='key' width='28' height='14' viewBox='0 0 28 14'><g class='line {}'>"
                           "<polyline points='1,7 27,7'/>{}</g></svg>{}</span> ",
                           style_of(series[i].family), mark(rank[i], 14, 7, 4), series[i].name);
    return out + "</p>\n";
}

}  // namespace rlslab::bench
