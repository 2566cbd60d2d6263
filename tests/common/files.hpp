// Helpers for tests of files: a folder that is removed with its test, what is in a file, a command of the shell, and
// the message with which an action is refused.
#pragma once

#include "tests/common/message.hpp"

#include <rlslab/core/input_error.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdlib.h>
#include <string>
#include <sys/wait.h>
#include <vector>

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

inline std::string read(std::filesystem::path const& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Without their ends.
inline std::vector<std::string> lines_of(std::string const& text) {
    std::vector<std::string> out;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
}

struct Ran {
    int code;
    std::string text;  ///< standard output and error
};
inline Ran shell(std::string const& command) {
    std::FILE* const pipe = popen(("{ " + command + "; } 2>&1 </dev/null").c_str(), "r");
    Ran out{-1, ""};
    std::array<char, 4096> buffer;
    while (size_t const got = std::fread(buffer.data(), 1, buffer.size(), pipe)) out.text.append(buffer.data(), got);
    int const status = pclose(pipe);
    out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return out;
}
/// Standard output alone, of a command that is expected to succeed.
inline std::string output_of(std::string const& command) {
    Ran const ran = shell("( " + command + " ) 2>/dev/null");
    EXPECT_EQ(ran.code, 0) << command;
    return ran.text;
}
inline bool there_is(std::string const& program) { return shell(program + " --version").code == 0; }

/// What it throws as Error, or "no error".
template <class Error = InputError, class Action>
std::string message_of(Action const& action) {
    try {
        action();
    } catch (Error const& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace rlslab::files
