// The finished trials of an interrupted run: a file with one line for each trial. A line that was not written completely is ignored.
#pragma once

#include <rlslab/core/files.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace rlslab {

/// A checksum that tells texts apart; not for security (FNV-1a).
constexpr std::uint64_t hash(std::string_view text, std::uint64_t from = 0xcbf29ce484222325) {
    for (char const c : text) from = (from ^ std::uint8_t(c)) * 0x100000001b3;
    return from;
}

/// The lines of CSV of each finished trial, by its number. The file starts anew if its key is another one: then the program, the study, its
/// budget or the seed has changed.
class Journal {
    std::filesystem::path path_;
    std::ofstream file_;
    std::map<size_t, std::vector<std::string>> finished_;

public:
    /// Throws InputError when the file cannot be read or written.
    Journal(std::filesystem::path path, std::string const& key);

    std::map<size_t, std::vector<std::string>> const& finished() const { return finished_; }
    /// Appends one line. If the process is killed meanwhile, the line is complete or its checksum is wrong. Throws InputError.
    void add(size_t trial, std::vector<std::string> const& lines);
};

/// A lock that allows one run at a time in a folder. It is released when this object is destroyed or the process ends in any way. On a file
/// system without locks it has no effect.
class FolderLock {
    int file_;

public:
    /// Throws InputError when another run holds it, or the folder's file .lock cannot be written.
    explicit FolderLock(std::filesystem::path const& folder);
    ~FolderLock();
    FolderLock(FolderLock const&) = delete;
    FolderLock& operator=(FolderLock const&) = delete;
};

}  // namespace rlslab
