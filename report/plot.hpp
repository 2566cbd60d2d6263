// The parts from which the renderer draws a panel; internal. Lengths are units of the SVG; y grows downward.
#pragma once

#include "report/axis.hpp"
#include "report/figure.hpp"

#include <optional>
#include <string>

namespace rlslab::report::plot {

inline bool logarithmic_y(Figure const& figure, Panel const& panel) { return figure.log_y || panel.log_y; }

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

constexpr double tick_size = 12;  ///< of the font of ticks and names

/// The text, or its beginning and "…" if it is wider than this in a font of this size.
std::string shortened(std::string const& text, double size, double width);
/// The text broken at spaces into lines of at most this width, and at most so many lines.
std::vector<std::string> wrapped(std::string const& text, double size, double width, size_t most);
std::string text_at(double x, double y, std::string const& text, std::string const& attributes);

/// The mark's outline about (x, y); "" for no mark.
std::string mark_path(std::string const& mark, double x, double y);
/// Attributes of marks and lines of this look.
std::string mark_style(Look const& look, double width = 1.3);
std::string line_style(Look const& look, double width);

struct Point {
    double x, y;
};
/// Where the mark of a point stands: at the lower edge if y is less than the panel's least; none outside the box.
std::optional<Point> mark_place(Panel const& panel, Curve const& curve, size_t i, Axes const& axes);

/// A curve: its band or bars, its line, its marks with tooltips; nothing outside the box.
std::string curve_group(Figure const& figure, Panel const& panel, Curve const& curve, size_t series, bool guide, Axes const& axes);
/// Events, drawn over the curves. The text of an upright line stands at the end and on the side where no curve is, if there is such a
/// place.
std::string event_group(Event const& event, Panel const& panel, Look const& look, size_t series, Axes const& axes);

/// Cells of a heat map; they meet halfway between their places.
struct Cells {
    std::vector<std::string> rows;  ///< from the bottom
    std::vector<double> places;     ///< along x, ascending
    Range x;                        ///< with the outer edges
};

/// A panel's axes with their labels.
struct Bottom {
    std::vector<Tick> ticks;
    int left_out = 0;
    bool slanted = false;
    double height = 0;
};
struct Frame {
    Axes axes;
    Ticks left;
    Bottom bottom;
    std::vector<std::string> x_lines, y_lines;
    double widest;  ///< of the labels on the left
};
/// `names`: the width of the margin on the right.
Frame frame_of(Figure const& figure, Panel const& panel, Cells const& cells, double names, double width, double height);
std::string grid_group(Figure const& figure, Frame const& frame);
std::string labels_group(Frame const& frame, double height);

/// The place in the legend; its size if the name is not in it.
size_t series_number(std::vector<Curve const*> const& legend, std::string const& name);

/// Whether names stand beside single points: such a figure needs more space.
bool names_points(Figure const& figure);

/// Where a panel's curves are named in it: at their ends, in a margin of this width, or beside single points.
struct Names {
    double width = 0;
    bool at_ends = false, beside = false;
};
Names names_of(Figure const& figure, Panel const& panel, bool named, double most);
struct NamesGroup {
    std::string svg;
    std::vector<Curve const*> left_out;  ///< found no place
};
NamesGroup names_group(Panel const& panel, Names const& names, std::vector<Curve const*> const& legend, Axes const& axes);

/// A single point that has a name: its mark, its error bar, the name's width.
struct NamedPoint {
    double x, y;
    Box bar;
    double width;
    bool first = false;  ///< chooses before the others
};
constexpr double name_height = 13, leader_from = 13;  ///< a leader leads to a name that is farther from its mark
/// The square of the distance.
double distance2(Box const& box, double x, double y);
/// A place for each name, or none:
///   (1) inside `within`                          (2) touches no mark, bar or other name
///   (3) is nearer to its mark than to any other  (4) its leader, if it needs one, crosses no other mark, name or leader
/// As many names as twenty greedy passes find places for: those that found none go first in the next pass.
std::vector<std::optional<Box>> places_beside(std::vector<NamedPoint> const& points, Box const& within);

Cells cells_of(Figure const& figure, Panel const& panel);
std::string cells_group(Figure const& figure, Panel const& panel, Cells const& cells, Axis const& x, Box const& box, Range shades);
/// The range of the shades over all panels: [0, 1] if that holds them.
Range shades_of(Figure const& figure);
/// A colour for a part in [0, 1]; NaN: none.
std::string shade(double part);

}  // namespace rlslab::report::plot
