// "Did you mean": the nearest known name, for columns, commands, options, variants, arithmetics, studies.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <vector>

namespace rlslab {

/// The name with the fewest letters wrong, missing, extra or swapped, but at most a third as many as `requested` has
/// letters; otherwise the only name that begins with `requested`. Case is ignored. Empty: no name is near.
std::string_view nearest(std::string_view requested, std::vector<std::string_view> const& names);

/// " (did you mean "ud"?)", or an empty text if no name is near.
std::string did_you_mean(std::string_view requested, std::vector<std::string_view> const& names);

/// Throws InputError unless `requested` is one of the names: "--variants: no variant "udd" (did you mean "ud"?)". If no
/// name is near, the message lists all of them. `where` may be empty.
void expect_one_of(std::vector<std::string_view> const& names, std::string_view requested, std::string_view where,
                   std::string_view what);

}  // namespace rlslab
