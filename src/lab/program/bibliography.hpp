// The entries of docs/literature.bib, which are in the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::program {

struct Source {
    std::vector<std::string> for_;  ///< variants, headers, studies: the line "% ud, qr" above the entry
    std::string bibtex;             ///< the entry as it stands there
};

/// All of them, in the order of the file.
std::vector<Source> const& sources();
/// Those of a variant or of a study.
std::vector<Source const*> sources_of(std::string_view name);
/// The program itself, with its version and revision.
std::string bibtex_of_program();

}  // namespace rlslab::program
