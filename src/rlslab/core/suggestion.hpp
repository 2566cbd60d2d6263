// "Did you mean": the name that was probably meant, for columns, commands, options, variants, arithmetics, studies.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <vector>

namespace rlslab {

/// The name with the fewest letters wrong, missing, too many or swapped, at most a third of those asked; else the only name that
/// begins with what was asked. Upper and lower case count as the same. Empty: no name is near.
std::string_view nearest(std::string_view asked, std::vector<std::string_view> const& names);

/// " (did you mean "ud"?)", or nothing.
std::string did_you_mean(std::string_view asked, std::vector<std::string_view> const& names);

/// Throws InputError unless it is one of them: "--variants: no variant "udd" (did you mean "ud"?)"; where none is near, all are named.
/// `where` may be empty.
void expect_one_of(std::vector<std::string_view> const& names, std::string_view asked, std::string_view where, std::string_view what);

}  // namespace rlslab
