// A command line, from its words to the exit code.
#include "src/lab/program/run.hpp"

#include "src/lab/program/commands.hpp"

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

namespace rlslab::program {
using namespace report;

void prepare_process() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    sigprocmask(SIG_UNBLOCK, &pipe, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_IGN);
    when_stopped("");
    // A file that is opened takes the least free number: one that is closed gets a file that cannot be used that way.
    for (int const file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(file, F_GETFD) < 0) (void)!::open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int run(std::vector<std::string> const& words, int rank, std::string const& name) {
    bool understood = false;
    try {
        set_command(words, name);
        auto const command = parse(words);
        understood = true;
        return command();
    } catch (std::bad_alloc const&) {
        std::fprintf(stderr, "%s: out of memory\n", name.c_str());
    } catch (std::exception const& error) {
        std::string line = error.what();
        for (char& c : line)
            if (c == '\n' || c == '\r') c = ' ';
        if (understood || rank == 0) std::fprintf(stderr, "%s: %s\n", name.c_str(), line.c_str());
    } catch (...) {
        std::fprintf(stderr, "%s: something was thrown that is no std::exception\n", name.c_str());
    }
    return 2;
}

}  // namespace rlslab::program
