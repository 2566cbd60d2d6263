// What an interrupted run has finished: a file of lines, one for each trial, each whole or not there.
#pragma once

#include <rlslab/core/files.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace rlslab {

/// Of text, for telling apart, not for safety (FNV-1a).
constexpr std::uint64_t hash(std::string_view text, std::uint64_t from = 0xcbf29ce484222325) {
    for (char const c : text) from = (from ^ std::uint8_t(c)) * 0x100000001b3;
    return from;
}

/// A trial's lines of CSV by its number. Begun again when the key in the file is another: the program, the study, its
/// budget or the seed has changed.
class Journal {
    std::filesystem::path path_;
    std::ofstream file_;
    std::map<size_t, std::vector<std::string>> finished_;

public:
    /// Throws InputError when the file cannot be read or written.
    Journal(std::filesystem::path path, std::string const& key);

    std::map<size_t, std::vector<std::string>> const& finished() const { return finished_; }
    /// One line at the end: killed at any moment, it is there whole or its checksum is wrong. Throws InputError.
    void add(size_t trial, std::vector<std::string> const& lines);
};

/// One run at a time in a folder: held until destroyed, or until the process ends in whatever way. Where the file system has
/// no locks, none is held.
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
