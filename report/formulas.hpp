// Every formula that the sources of this tree mark as R"tex(...)tex", as MathML: written by pandoc when the program is
// built.
#pragma once

#include <span>
#include <string_view>

namespace rlslab::report {

struct Formula {
    std::string_view tex, mathml;
};
std::span<Formula const> formulas();  ///< empty if there was no pandoc

}  // namespace rlslab::report
