// Inside the renderer: the parts a panel is drawn from. Lengths are units of the SVG; y grows downward.
#pragma once

#include "report/axis.hpp"
#include "report/figure.hpp"

#include <string>

namespace rlslab::plot {

struct Box {
    double left, top, right, bottom;
    bool holds(double x, double y) const { return x >= left - 0.05 && x <= right + 0.05 && y >= top - 0.05 && y <= bottom + 0.05; }
};
struct Axes {
    Axis x, y;
    Box box;
};

/// One digit behind the point, no trailing zero: "12.5", "12".
std::string fixed(double x);
/// A number for a tooltip: four digits.
std::string number_text(double x);

/// The mark's outline about (x, y); "" for no mark.
std::string mark_path(std::string const& mark, double x, double y);
/// Attributes of marks and lines of this look.
std::string mark_style(Look const& look);
std::string line_style(Look const& look, double width);

/// A curve: its band or bars, its line, its marks with tooltips; nothing outside the box.
std::string curve_group(Figure const& figure, Curve const& curve, size_t series, bool guide, Axes const& axes);
/// What happened, over the curves. `looks`: of the curves by name.
std::string event_group(Event const& event, Look const& look, size_t series, Axes const& axes);

/// Cells of a heat map; they meet halfway between their places.
struct Cells {
    std::vector<std::string> rows;     ///< from the bottom
    std::vector<double> places;        ///< along x, ascending
    Range x;                           ///< with the outer edges
};
Cells cells_of(Figure const& figure, Panel const& panel);
std::string cells_group(Figure const& figure, Panel const& panel, Cells const& cells, Axis const& x, Box const& box, Range shades);
/// The range of the shades over all panels: [0, 1] if that holds them.
Range shades_of(Figure const& figure);
/// A colour for a part in [0, 1]; NaN: none.
std::string shade(double part);

}  // namespace rlslab::plot
