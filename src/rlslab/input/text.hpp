// Text in lines of a certain width.
#pragma once

#include <string>
#include <string_view>

namespace rlslab {

/// The text broken at spaces into lines of at most `width` letters. The first line begins at column `at`, the others at
/// column `indent`. A word longer than a line stays whole. There is no line end after the last line.
std::string wrapped(std::string_view text, size_t at, size_t indent, size_t width);

/// The width of text on a terminal of so many columns: at least 40, at most `most`. 0 columns, no terminal: `most`.
size_t line_width(size_t columns, size_t most);

}  // namespace rlslab
