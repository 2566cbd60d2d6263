// The revision of the tree and the compiler that built the program; every result is stored with them.
#pragma once

namespace rlslab::studies {

/// `git describe` of the tree when it was built; cmake/revision.cmake writes the file that defines both.
extern char const* const revision;
/// Name, version, kind of build, and the option that keeps rounding as written.
extern char const* const compiler;

}  // namespace rlslab::studies
