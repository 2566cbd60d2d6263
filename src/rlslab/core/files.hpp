// Files that are written completely or not at all.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace rlslab {

/// A file that cannot be made or written.
struct FileError : InputError {
    FileError(std::string const& what, int why) : InputError(what), error(why) {}
    int error;  ///< errno
};

/// Creates the folder and its parents; existing ones stay. Throws InputError if that fails.
void create_folder(std::filesystem::path const& folder);

/// Writes the text to PATH.PID.new in the same folder, of a long name the first 200 bytes, then renames that file to
/// `path`: a reader sees the old file or the whole new one. A symbolic link stays, and what it names is replaced. A
/// device or a pipe is written to. If the text cannot be written, PATH.PID.new is removed and FileError thrown.
/// on_disk: waits until the disk has the text, so that the same holds where the machine loses its power; milliseconds.
void replace_file(std::filesystem::path const& path, std::string_view text, bool on_disk = false);

/// Throws FileError where replace_file could not begin: for what is written after hours. Changes nothing.
void expect_replaceable(std::filesystem::path const& path);

/// Removes the PATH.PID.new files in the folder that killed processes left behind.
void remove_leftovers(std::filesystem::path const& folder);

/// For a signal handler that ends the process: removes the file that replace_file is writing at that moment, if any.
void remove_unfinished_file() noexcept;

}  // namespace rlslab
