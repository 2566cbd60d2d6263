// Text in lines of a certain width.
#pragma once

#include <string>
#include <string_view>

namespace rlslab {

/// The text broken at spaces where a line of `width` letters would be passed. The first line begins at column `at`, the others at
/// column `indent`. A word longer than a line is left whole. The last line is not ended.
std::string wrapped(std::string_view text, size_t at, size_t indent, size_t width);

}  // namespace rlslab
