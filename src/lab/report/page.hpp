// A page: one HTML file that opens offline and loads nothing. Figures are drawn by svg.hpp, formulas are MathML where
// pandoc was there when the program was built. What is interactive needs JavaScript; everything is there without.
#pragma once

#include "src/lab/report/figure.hpp"

namespace rlslab::report {

/// Text for HTML, "+- " as a plus-minus sign.
std::string escaped(std::string_view text);

/// Panels as SVG, with title and legend; wide and narrow versions where one would not be legible at both. Without
/// JavaScript all series are shown.
std::string figure_html(Figure const& figure);

/// A formula in LaTeX, written in the source as R"tex(...)tex": the build searches for that.
std::string formula_html(std::string_view tex);
/// The same as MathML; empty if the program was built without pandoc, or the source does not mark it as R"tex(...)tex".
std::string_view mathml(std::string_view tex);
/// LaTeX as text that can be read: P_k = lambda^-1 (I - K psi') ...
std::string readable(std::string_view tex);
/// Whether formulas are MathML in this build.
bool has_mathml();

/// A table that scrolls inside its box, and says so where it has more columns than fit. Cells are text, not HTML. The
/// first column is aligned left, numbers right. `strong`: rows that stand out.
std::string table_html(std::vector<std::string> const& head, std::vector<std::vector<std::string>> const& rows,
                       std::vector<size_t> const& strong = {});

/// The whole page. The body is HTML. Classes: soft (small print), question, claims (ul; li.holds, li.fails with <b>).
std::string page(std::string_view title, std::string_view body);

}  // namespace rlslab::report
