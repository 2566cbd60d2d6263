// The revision of the tree and the compiler that built the program; every result is stored with them.
#pragma once

namespace rlslab::report {

/// Of the project: "0.2.0".
extern char const* const version;
/// `git describe` of the tree when it was built, or what -DRLSLAB_REVISION= said, or an archive of git's; "of no
/// repository" where none is known. src/cmake/revision.cmake writes the file that defines all three.
extern char const* const revision;
/// Name, version, kind of build, and the option that keeps rounding as written.
extern char const* const compiler;

}  // namespace rlslab::report
