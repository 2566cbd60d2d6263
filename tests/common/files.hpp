// Helpers for tests of files: a folder that is removed with its test, and the message with which an action is refused.
#pragma once

#include "tests/common/message.hpp"

#include <rlslab/core/input_error.hpp>

#include <filesystem>
#include <fstream>
#include <stdlib.h>
#include <string>

namespace rlslab::files {

/// A folder for one test, called "" in messages.
struct Folder {
    std::filesystem::path path;
    Folder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "rlslab_XXXXXX").string();
        path = mkdtemp(pattern.data());
    }
    Folder(Folder const&) = delete;
    Folder& operator=(Folder const&) = delete;
    ~Folder() { std::filesystem::remove_all(path); }
    std::string file(std::string const& text, std::string const& name = "data.csv") const {
        std::ofstream(path / name, std::ios::binary) << text;
        return (path / name).string();
    }
    std::string without(std::string message) const {
        std::string const prefix = path.string() + "/";
        if (auto const at = message.find(prefix); at != message.npos) message.erase(at, prefix.size());
        return message;
    }
};

/// What it throws as InputError, or "no error".
template <class Action>
std::string message_of(Action const& action) {
    try {
        action();
    } catch (InputError const& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace rlslab::files
