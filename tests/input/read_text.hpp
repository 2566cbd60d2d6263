// Columns of a file of this text, or the line with which it is refused.
#pragma once

#include "tests/common/files.hpp"

#include <rlslab/input/csv.hpp>

namespace rlslab::text_files {

using Words = std::vector<std::string>;
using Numbers = std::vector<double>;

inline Columns read(std::string const& text, Words const& asked, CsvFormat format = {}) {
    files::Folder const folder;
    return read_columns(folder.file(text), asked, format);
}
inline std::string refusal(std::string const& text, Words const& asked, CsvFormat format = {}) {
    files::Folder const folder;
    return folder.without(files::message_of([&] { read_columns(folder.file(text), asked, format); }));
}

}  // namespace rlslab::text_files
