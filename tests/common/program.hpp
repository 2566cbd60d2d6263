// Helpers for tests of the program: a folder for each test, and a shell in it.
#pragma once

#include "tests/common/files.hpp"

namespace fs = std::filesystem;

inline std::string const program = RLSLAB_PROGRAM, root = RLSLAB_SOURCE_DIR;

using rlslab::files::lines_of, rlslab::files::read;

/// The command on so many ranks of an MPI job, more of them than cores if need be.
inline std::string on_ranks(int number, std::string const& command) {
    return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe --bind-to none -n " +
           std::to_string(number) + " " + command;
}

/// CSV without the lines that say which run it is from.
inline std::string without_run(std::string const& csv) {
    size_t at = 0;
    while (csv.compare(at, 1, "#") == 0) at = csv.find('\n', at) + 1;
    return csv.substr(at);
}

struct Outcome {
    int code;
    std::string out, err;
};

/// A folder of its own for each test, where the shell runs; `rlslab` in a command is the program.
class Program : public testing::Test {
protected:
    rlslab::files::Folder const temporary;
    fs::path const folder = temporary.path;
    void SetUp() override {
        write("ok.csv", "u,y\n" + rows(40, [](int k) { return std::to_string(k * 5 % 13); }));
    }
    void write(std::string const& file, std::string const& text) const { std::ofstream(folder / file) << text; }
    template <class U>
    static std::string rows(int n, U u) {
        std::string text;
        for (int k = 0; k < n; ++k) text += u(k) + "," + std::to_string(k * 7 % 11) + "\n";
        return text;
    }
    Outcome shell(std::string const& command) const {
        std::string const line = "cd '" + folder.string() + "' && rlslab() { '" + program + "' \"$@\"; } && { " +
                                 command + "; } >out.txt 2>err.txt </dev/null";
        int const status = std::system(("bash -c '" + quoted(line) + "'").c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder / "out.txt"), read(folder / "err.txt")};
    }
    static std::string quoted(std::string const& text) {
        std::string out;
        for (char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return out;
    }
    /// One line on stderr that names the `things`, nothing on stdout, exit code 2.
    void refused(std::string const& command, std::string const& things) const {
        Outcome const run = shell("rlslab " + command);
        EXPECT_EQ(run.code, 2) << command;
        EXPECT_EQ(run.out, "") << command;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        EXPECT_THAT(run.err, rlslab::Names(things)) << command;
        EXPECT_TRUE(run.err.starts_with("rlslab: ")) << run.err;
    }
};
