// What was built, and by what: kept with every result.
#pragma once

namespace rlslab {

/// `git describe` of the tree when it was built; cmake/revision.cmake writes the file that defines both.
extern char const* const revision;
/// Name, version, kind of build, and the option that keeps rounding as written.
extern char const* const compiler;

}  // namespace rlslab
