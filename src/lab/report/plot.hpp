// The parts from which the renderer draws a panel; internal. Lengths are units of the SVG; y grows downward.
#pragma once

#include "src/lab/report/axis.hpp"
#include "src/lab/report/figure.hpp"

#include <optional>
#include <string>

namespace rlslab::report::plot {

inline bool logarithmic_y(Figure const& figure, Panel const& panel) { return figure.log_y || panel.log_y; }

struct Box {
    double left, top, right, bottom;
    bool holds(double x, double y) const {
        return x >= left - 0.05 && x <= right + 0.05 && y >= top - 0.05 && y <= bottom + 0.05;
    }
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
std::string curve_group(Figure const& figure, Panel const& panel, Curve const& curve, size_t series, bool guide,
                        Axes const& axes);
/// Events, drawn over the curves. An upright line's text stands at an end and side without a curve, if there is one.
std::string event_group(Event const& event, Panel const& panel, Look const& look, size_t series, Axes const& axes);

/// Cells of a heat map; they meet halfway between their places.
struct Cells {
    std::vector<std::string> rows;  ///< from the bottom
    std::vector<double> places;     ///< along x, ascending
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
};
Frame frame_of(Figure const& figure, Panel const& panel, Cells const& cells, double width, double height);
std::string grid_group(Figure const& figure, Frame const& frame);
std::string labels_group(Frame const& frame, double height);

/// The place in the legend; its size if the name is not in it.
size_t series_number(std::vector<Curve const*> const& legend, std::string const& name);

constexpr double name_height = 13;
/// The square of the distance.
double distance2(Box const& box, double x, double y);
/// Names beside single points, those of strong curves first: at the first of eight places around the mark that is
/// inside the panel, touches no mark, bar or other name, and is nearer to its own mark than to any other. A name that
/// finds none is in the legend alone.
std::string names_group(Panel const& panel, std::vector<Curve const*> const& legend, Axes const& axes);

Cells cells_of(Figure const& figure, Panel const& panel);
std::string cells_group(Figure const& figure, Panel const& panel, Cells const& cells, Axis const& x, Box const& box,
                        Range shades);
/// The range of the shades over all panels: [0, 1] if that holds them.
Range shades_of(Figure const& figure);
/// A colour for a part in [0, 1]; NaN: none.
std::string shade(double part);

}  // namespace rlslab::report::plot
