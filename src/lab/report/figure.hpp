// A figure as data: curves, their numbers, their looks. svg.hpp draws it; nothing here knows what it shows.
#pragma once

#include <rlslab/core/family.hpp>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::report {

/// How a series looks, in every figure: colours of Okabe and Ito, told apart with any kind of colour vision, and for
/// those who see none, or print, a mark and a dash.
struct Look {
    std::string colour = {};  ///< #rrggbb
    bool dashed = false;
    /// circle, square, diamond, triangle-up, triangle-down, star, cross, x; "-open" where hollow; "": none
    std::string mark = {};
};
/// Of a variant by its family; of anything else by its place among the others.
Look look_of(std::optional<Family> const& family, size_t place);

/// Points in the order in which they are joined. Where a number is NaN, infinite, or not positive on a logarithmic
/// axis, the point is left out and the line is broken.
struct Curve {
    std::string name;
    Look look = {};
    std::vector<double> x = {}, y = {};
    std::vector<double> lower = {}, upper = {};  ///< an interval about each y, drawn where it is not y itself; or empty
    std::vector<std::string> row = {};           ///< cells: what each stands at along the other axis
    bool marks = true, line = true;
    bool stems = false;                  ///< an upright line from y = 0 to each point
    bool bars = false;                   ///< lower and upper as an error bar at each point; otherwise as a band
    std::vector<std::string> says = {};  ///< a tooltip for each point; if empty, they tell name and numbers
    bool strong = false;  ///< thicker and over the others, which are lighter in a panel that has such a curve
};

/// Something that happens at one place: a breakdown at a point, or with y = NaN an upright line, its text at the top.
struct Event {
    double x, y = std::numeric_limits<double>::quiet_NaN();
    std::string text;
    std::string series = {};  ///< the curve it happens to: it has its colour, and is hidden with it
};

struct Panel {
    std::string name;
    std::vector<Curve> curves = {},
                       guides = {};  ///< guides: to compare with; cut off where they leave the curves' range
    std::vector<Event> events = {};
    bool log_y = false;  ///< besides the figure's; for a figure with own_y
    /// The axis ends here: a triangle at its lower edge stands for less.
    double y_least = -std::numeric_limits<double>::infinity();
    std::vector<double> y_holds = {};  ///< besides the figure's
};

struct Figure {
    std::string name;  ///< gain_error-1: also of its file; letters, digits, '_', '-', '.'
    std::string title, x, y;
    bool log_x = false, log_y = false;
    bool cells = false;  ///< y is the shade in [0, 1], `series` what stands along y; the panel's first curve
    std::vector<Panel> panels = {};
    std::string series = {};
    bool square = false;                    ///< a unit is as long along x as along y
    bool own_y = false;                     ///< each panel has its own range of y
    std::vector<std::string> x_names = {};  ///< categories: x = 0, 1, ... stand for these
    std::vector<double> x_ticks = {};       ///< where the ticks are, if they should be at sizes that occur
    std::vector<double> y_holds = {};       ///< numbers that the range of y has to hold, such as 0
    bool names = false;                     ///< of single points: each stands beside its mark, where there is room
    std::string note = {};                  ///< a sentence under the title
    std::vector<size_t> strong_x = {};      ///< categories that stand out
    std::vector<std::string> first = {};    ///< series that a page shows at first, the others on request; empty: all
};

}  // namespace rlslab::report
