// A plot of times against sizes, both logarithmic, as SVG that needs nothing else.
#pragma once

#include <string>
#include <vector>

namespace rlslab::bench {

struct Point {
    double size, nanoseconds;
    std::string says;    ///< the tooltip
};

struct Series {
    std::string name, family;
    std::vector<Point> points;    ///< in order of size
};

/// The style's class for a family: its colour is in the page's style sheet.
std::string style_of(std::string const& family);

/// The mark of the n-th series of a family, of radius r: colour alone tells nobody apart.
std::string mark(int n, double x, double y, double r);

/// width x height pixels. Wide ones name each line where it ends; narrow ones leave that to a legend.
std::string plot(std::vector<Series> const& series, double width, double height, bool labels);

/// Names and marks of the series, for all plots of them.
std::string legend(std::vector<Series> const& series);

}  // namespace rlslab::bench
