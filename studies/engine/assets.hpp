// Files that the report carries with it; their bytes are in the program.
#pragma once

#include <string_view>

namespace rlslab::assets {

std::string_view style();     ///< studies/report/report.css
std::string_view script();    ///< studies/report/report.js
std::string_view plotly();    ///< plotly.js, basic bundle (MIT); empty if it was not there when the program was built
std::string_view temml();     ///< Temml, LaTeX to MathML (MIT); likewise

}  // namespace rlslab::assets
