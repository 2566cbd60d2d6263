// Recognises files that are no table of text by their first bytes.
#pragma once

#include <string_view>

namespace rlslab {

/// "a PNG image" with what to do about it, for a text that begins so; "" for anything else.
std::string_view not_a_table(std::string_view begin);

}  // namespace rlslab
