// The style sheet and the script of pages, as text; src/lab/report/CMakeLists.txt writes the file that defines both.
#pragma once

namespace rlslab::report {

extern char const* const page_style;   ///< page.css
extern char const* const page_script;  ///< page.js

}  // namespace rlslab::report
