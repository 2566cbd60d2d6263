// The finished trials of a run: a file with one line for each trial. A line that was not written completely is ignored.
#pragma once

#include <rlslab/core/files.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace rlslab::studies {

/// A checksum of a text (FNV-1a); not for security.
constexpr std::uint64_t hash(std::string_view text, std::uint64_t from = 0xcbf29ce484222325) {
    for (char const c : text) from = (from ^ std::uint8_t(c)) * 0x100000001b3;
    return from;
}

/// Share `number` (from 1) of `of` shares of the trials. 1 of 1 is the whole.
struct Part {
    int number = 1, of = 1;
    bool whole() const { return of == 1; }
};
/// "2-of-8", as in the names of files
std::string name_of(Part part);

/// The lines of CSV of each finished trial of one study, by the trial's number.
using Trials = std::map<size_t, std::vector<std::string>>;

/// The file is FOLDER/NAME, of a part FOLDER/NAME.2-of-8. One with another key is ignored: the program, the study, its
/// budget or the seed has changed.
class Journal {
    std::filesystem::path path_;
    std::ofstream file_;
    int why_ = 0;  // the first write failed; a later one, of another thread, would find another errno
    Trials finished_;

public:
    /// Reads the finished trials of the whole and of every part. A part rewrites its own file alone. The whole copies
    /// the files of the parts into its own and removes them. Files of another key stay, except its own. Throws
    /// InputError if a file cannot be written.
    Journal(std::filesystem::path const& folder, std::string const& name, std::string const& key, Part part = {});

    Trials const& finished() const { return finished_; }
    /// Appends a line: if the process is killed meanwhile, complete or with a wrong checksum. Throws InputError.
    void add(size_t trial, std::vector<std::string> const& lines);
};

/// Removes the journals of a study, of a whole run and of parts.
void forget_trials(std::filesystem::path const& folder, std::string const& name);
/// The finished trials in the folders' journals of one study. Throws InputError for a journal with another key.
Trials finished_trials(std::vector<std::filesystem::path> const& folders, std::string const& name,
                       std::string const& key);
/// Writes the journal of a whole run. Throws InputError.
void write_journal(std::filesystem::path const& folder, std::string const& name, std::string const& key,
                   Trials const& finished);

/// A lock that allows one whole run at a time in a folder, or any number of parts that differ. It is released when this
/// object is destroyed or the process ends in any way. On a file system without locks it has no effect.
class FolderLock {
    int file_, own_ = -1;

public:
    /// Throws InputError if another run holds the lock, or if the folder's file .lock cannot be written.
    explicit FolderLock(std::filesystem::path const& folder, Part part = {});
    ~FolderLock();
    FolderLock(FolderLock const&) = delete;
    FolderLock& operator=(FolderLock const&) = delete;
};

}  // namespace rlslab::studies
