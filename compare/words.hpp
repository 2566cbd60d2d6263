// What the text and the page of a comparison say in the same words.
#pragma once

#include "compare/compare.hpp"

namespace rlslab {

/// Text broken at spaces before column 114, the width of the table; lines after the first begin at column `indent`, as the first does.
std::string wrapped(std::string const& text, size_t indent);

/// "first, second, third", broken likewise; it begins at column `at`, further lines with `indent`.
std::string listed(std::vector<std::string> const& items, std::string const& indent, size_t at);

/// "none", "indefinite at 25", "in 2 of 4 orders".
std::string breakdown_text(Result const& result);

/// The prior, and what it does to theta.
std::string prior_text(Comparison const& comparison);

}  // namespace rlslab
