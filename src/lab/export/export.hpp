// A filter as one header of C99, made from its variant's page.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::exporting {

struct Exported {
    std::string variant = "ud";
    int size = 0;
    bool in_double = false;
    std::string name;  ///< of the type, and what its functions' names begin with: a name of C
    std::string made_by;
    bool loops = true;
};
/// Throws std::logic_error where the page cannot be written so; nothing that is in the list of variants does.
std::string c_header(Exported const& what);

std::vector<std::string_view> const& exported_variants();
/// gentleman in float keeps sums in double, which is no operation of its scalar.
bool is_exported(std::string_view variant, bool in_double);
inline constexpr int largest_exported = 16;

}  // namespace rlslab::exporting
