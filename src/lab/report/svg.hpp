// Draws a figure as SVG text. The same figure gives the same bytes on every machine: numbers are written with fixed
// digits, and no function of libm is called that may differ between processors.
#pragma once

#include "src/lab/report/figure.hpp"

namespace rlslab::report {

/// The whole figure as a file of its own: title, panels, legend.
std::string svg(Figure const& figure);

/// One panel as an <svg> element for a page, `width` x `height` units, as large as its box.
std::string panel_svg(Figure const& figure, size_t panel, double width, double height);

/// What a legend lists: each name once, curves before guides, in order of appearance. The number of a series in the
/// legend is the attribute data-s of what is drawn of it.
std::vector<Curve const*> legend_of(Figure const& figure);

/// The line and the mark of a series, for a legend.
std::string key_svg(Curve const& curve);

/// Text for XML and HTML: the five characters, and control characters as '?'.
std::string escaped_xml(std::string_view text);

}  // namespace rlslab::report
