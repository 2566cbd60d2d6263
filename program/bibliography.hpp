// The sources of docs/literature.md 6, which are in the program, as BibTeX.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::program {

/// An entry: "Carlson, N. A. Fast triangular ... filter. AIAA J. 11(9):1259–1265, 1973. No DOI known. Cited, not read.
/// (`carlson`)".
struct Source {
    std::string text;               ///< the whole of it, on one line
    std::vector<std::string> for_;  ///< variants, headers, studies: the names in the brackets at its end

    std::string author = {}, title = {}, venue = {}, year = {}, doi = {}, note = {};
    /// "bierman1977"
    std::string key() const;
    /// An @article where the venue has a volume and pages, otherwise a @misc with the venue as it was printed.
    std::string bibtex() const;
};

/// All of them, in the order of the page.
std::vector<Source> const& sources();
/// Those of a variant.
std::vector<Source const*> sources_of(std::string_view variant);
/// The program itself, with its version and revision.
std::string bibtex_of_program();

}  // namespace rlslab::program
