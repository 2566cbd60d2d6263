// Helpers for tests of CSV: a text as a file, its columns, and the message with which it is refused.
#pragma once

#include "tests/common/files.hpp"

#include <rlslab/input/csv.hpp>

#include <vector>

namespace rlslab {

using files::Folder, files::message_of;
using Names = std::vector<std::string>;
using Numbers = std::vector<double>;

inline Columns read(std::string const& text, Names const& asked, CsvFormat format = {}) {
    Folder const folder;
    return read_columns(folder.file(text), asked, format);
}
inline std::string refusal(std::string const& text, Names const& asked, CsvFormat format = {}) {
    Folder const folder;
    return folder.without(message_of([&] { read_columns(folder.file(text), asked, format); }));
}

}  // namespace rlslab
