// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace rlslab {

/// Makes the folder, and those it is in, unless they are there. Throws InputError.
void create_folder(std::filesystem::path const& folder);

/// Writes the text to a file beside it, PATH.PID.new, and renames that: a reader sees all of the text or what was there before.
/// Throws InputError and removes the file beside when the text cannot be written. on_disk: so also where the machine loses its power,
/// and the text is on the disk when this returns (as far as the disk tells the truth): milliseconds.
void replace_file(std::filesystem::path const& path, std::string_view text, bool on_disk = false);

/// Removes what processes that were killed were writing there by replace_file.
void remove_leftovers(std::filesystem::path const& folder);

/// For a signal handler whose process is about to die: removes the file that replace_file is writing, if it is.
void remove_unfinished_file() noexcept;

}  // namespace rlslab
