// A plot worked out: which curves, from which numbers, in which colours. What draws it (a browser, gnuplot) only draws.
#pragma once

#include "study.hpp"

namespace rlslab {

/// How a series looks, in every figure: colours of Okabe and Ito, told apart with any kind of colour vision, and for those
/// who see none, or print, a mark and a dash.
struct Look {
    std::string colour;
    bool dashed;
    std::string mark;    ///< circle, square, diamond, triangle-up, triangle-down, star, cross, x; "-open" where hollow
};
/// Of a variant by its name; of anything else by its place among the others.
Look look_of(std::string_view series, size_t place);

struct Curve {
    std::string name;
    Look look;
    std::vector<double> x, y, low, high;    ///< ascending in x; low and high differ from y where several rows share an x
    std::vector<std::string> row = {};      ///< cells: what each stands at along the other axis
    bool marks = true, line = true;
};

struct Panel {
    std::string name;
    std::vector<Curve> curves, guides;
};

struct Figure {
    std::string name;                      ///< gain_error-1: also of its files
    std::string title, x, y;
    bool log_x, log_y, cells;             ///< cells: y is the shade, `series` what stands along y
    std::vector<Panel> panels;
    std::string series = {};
    bool square = false;                   ///< a unit is as long along x as along y
    bool own_y = false;                    ///< each panel has its own range of y
};

/// Numbers that a logarithmic axis cannot show (0, NaN, infinity) are left out of the curve.
std::vector<Figure> figures(Study const& study, Table const& table);

/// A script that draws the figure as FOLDER/NAME.svg and .pdf, with its numbers in it.
std::string gnuplot_script(Figure const& figure);

}  // namespace rlslab
