// The run that a result is from, as each JSON file, each CSV file and each page says it.
#pragma once

#include <string>
#include <vector>

namespace rlslab::report {

// The revision of the tree and the compiler that built the program; every result is stored with them.

/// Of the project: "0.2.0".
extern char const* const version;
/// `git describe` of the tree when it was built, or what -DRLSLAB_REVISION= said, or an archive of git's; "of no
/// repository" where none is known. src/cmake/revision.cmake writes the file that defines all three.
extern char const* const revision;
/// Name, version, kind of build, and the option that keeps rounding as written.
extern char const* const compiler;

/// What is empty is left out.
struct Provenance {
    std::string command = {};          ///< as in a shell, without the words on which no byte of a result depends
    std::string file = {};             ///< the record, as it was named
    std::string sha256 = {};           ///< of the file
    long rows = 0;                     ///< read from the file
    std::string instruction_set = {};  ///< of the kernels that ran; the bits do not depend on it
    std::string date = {};             ///< when the run began, UTC
};

/// This program: version, revision, compiler. The keys and values of `of` before them.
std::vector<std::pair<std::string, std::string>> items(Provenance const& of);
/// {"command": ..., "version": ...}; `rows` is a number.
std::string as_json(Provenance const& of);
/// Lines "# key: value", for the top of a CSV file.
std::string as_comments(Provenance const& of);
/// The foot of a page.
std::string as_html(Provenance const& of);

/// Text in single quotes, for a shell.
std::string in_quotes(std::string const& text);
/// A command line as a shell reads it: words that need quotes have them.
std::string shell_text(std::vector<std::string> const& words);
/// The time now: "2026-11-24T21:18:05Z".
std::string date_now();

}  // namespace rlslab::report
