// In place of mat73.cpp where matio is absent.
#include <rlslab/input/formats/mat.hpp>

namespace rlslab {

Columns read_mat73(std::string const& path, std::vector<std::string> const&) {
    throw InputError(name_of_file(path) +
                     ": a MATLAB file of version 7.3, and this program was built without matio (save it with -v7)");
}

}  // namespace rlslab
