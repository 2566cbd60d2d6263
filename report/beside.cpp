// Names beside single points: which goes where, so that each is read with its own mark.
#include "report/plot.hpp"

#include <algorithm>
#include <array>

namespace rlslab::report::plot {
namespace {

struct Line {
    Point from, to;
};
struct Candidate {
    Box box;
    Line leader;
    bool leads;
};

bool apart(Box const& a, Box const& b) { return a.left >= b.right || b.left >= a.right || a.top >= b.bottom || b.top >= a.bottom; }
Box around(double x, double y, double half) { return {x - half, y - half, x + half, y + half}; }

/// Of a square that holds the mark, with its ring where it has one.
double mark_half(NamedPoint const& point) { return point.first ? 9 : 6; }

/// Positive where a, b, c turn left.
double turn(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
bool cross(Line const& a, Line const& b) {
    return turn(a.from, a.to, b.from) * turn(a.from, a.to, b.to) <= 0 && turn(b.from, b.to, a.from) * turn(b.from, b.to, a.to) <= 0;
}
bool cross(Line const& line, Box const& box) {
    if (box.holds(line.to.x, line.to.y)) return true;
    Point const corners[]{{box.left, box.top}, {box.right, box.top}, {box.right, box.bottom}, {box.left, box.bottom}};
    for (size_t i = 0; i < 4; ++i)
        if (cross(line, Line{corners[i], corners[(i + 1) % 4]})) return true;
    return false;
}

/// Around the mark in rings, the nearest first: sixteen directions, and over and under it shifted by parts of the name's width.
std::vector<Candidate> candidates(NamedPoint const& point) {
    constexpr std::array<std::pair<double, double>, 16> directions{{{1, 0},
                                                                    {-1, 0},
                                                                    {0, -1},
                                                                    {0, 1},
                                                                    {0.7, -0.7},
                                                                    {0.7, 0.7},
                                                                    {-0.7, -0.7},
                                                                    {-0.7, 0.7},
                                                                    {0.92, -0.38},
                                                                    {0.92, 0.38},
                                                                    {-0.92, -0.38},
                                                                    {-0.92, 0.38},
                                                                    {0.38, -0.92},
                                                                    {0.38, 0.92},
                                                                    {-0.38, -0.92},
                                                                    {-0.38, 0.92}}};
    double const half = name_height / 2;
    std::vector<Candidate> out;
    auto const add = [&](double left, double middle) {
        Candidate c{{left, middle - half, left + point.width, middle + half}, {}, false};
        c.leader = {{point.x, point.y}, {std::clamp(point.x, c.box.left, c.box.right), std::clamp(point.y, c.box.top, c.box.bottom)}};
        c.leads = distance2(c.box, point.x, point.y) >= leader_from * leader_from;
        out.push_back(c);
    };
    for (double const ring : {8.0, 16.0, 24.0, 34.0, 44.0, 56.0, 70.0, 86.0}) {
        double const r = ring + mark_half(point) - 6;
        for (auto const& [dx, dy] : directions)  // the side of the box that faces the mark stands on the ring
            add(point.x + r * dx -
                    (dx > 0.5    ? 0
                     : dx < -0.5 ? point.width
                                 : point.width / 2),
                point.y + r * dy +
                    (dy > 0.3    ? half
                     : dy < -0.3 ? -half
                                 : 0));
        for (double const part : {0.3, 0.7, 0.1, 0.9})
            for (double const middle : {point.y - r - half, point.y + r + half}) add(point.x - part * point.width, middle);
    }
    return out;
}

/// Rules (1) to (4) as far as they concern the marks.
bool fits(Candidate const& c, size_t own, std::vector<NamedPoint> const& points, Box const& within) {
    if (c.box.left < within.left + 1 || c.box.right > within.right - 1 || c.box.top < within.top + 1 || c.box.bottom > within.bottom - 1)
        return false;
    double const distance = distance2(c.box, points[own].x, points[own].y);
    for (size_t k = 0; k < points.size(); ++k) {
        NamedPoint const& p = points[k];
        if (!apart(c.box, around(p.x, p.y, mark_half(p))) || !apart(c.box, p.bar)) return false;
        if (k == own) continue;
        if (!(distance < distance2(c.box, p.x, p.y)) || (c.leads && cross(c.leader, around(p.x, p.y, mark_half(p))))) return false;
    }
    return true;
}

bool together(Candidate const& a, Candidate const& b) {
    return apart(a.box, b.box) && !(a.leads && cross(a.leader, b.box)) && !(b.leads && cross(b.leader, a.box)) &&
           !(a.leads && b.leads && cross(a.leader, b.leader));
}

}  // namespace

double distance2(Box const& box, double x, double y) {
    double const dx = std::max({box.left - x, 0.0, x - box.right}), dy = std::max({box.top - y, 0.0, y - box.bottom});
    return dx * dx + dy * dy;
}

std::vector<std::optional<Box>> places_beside(std::vector<NamedPoint> const& points, Box const& within) {
    constexpr size_t most = 60;  // of more, most would find no place
    size_t const n = points.size();
    std::vector<std::vector<Candidate>> free(n);
    std::vector<size_t> order;
    for (size_t i = 0; i < n && n <= most; ++i) {
        if (points[i].width == 0) continue;
        for (Candidate const& c : candidates(points[i]))
            if (fits(c, i, points, within)) free[i].push_back(c);
        order.push_back(i);
    }
    std::ranges::stable_sort(order, {}, [&](size_t i) { return std::pair(!points[i].first, free[i].size()); });
    std::vector<std::optional<Box>> best(n);
    size_t fewest = n + 1;
    for (int pass = 0; pass < 20 && fewest > 0; ++pass) {
        std::vector<std::optional<Box>> places(n);
        std::vector<Candidate> taken;
        std::vector<size_t> placed, failed;
        for (size_t const i : order) {
            auto const c = std::ranges::find_if(free[i], [&](Candidate const& x) {
                return std::ranges::all_of(taken, [&](Candidate const& t) { return together(x, t); });
            });
            if (c == free[i].end()) failed.push_back(i);
            else taken.push_back(*c), places[i] = c->box, placed.push_back(i);
        }
        if (failed.size() < fewest) fewest = failed.size(), best = std::move(places);
        order = failed;
        order.insert(order.end(), placed.begin(), placed.end());
        std::ranges::stable_partition(order, [&](size_t i) { return points[i].first; });
    }
    return best;
}

}  // namespace rlslab::report::plot
