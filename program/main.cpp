// The rlslab program: any error gives one line on standard error and exit code 2.
#include "program/commands.hpp"

#include <csignal>
#include <cstdio>

namespace {

/// A closed pipe ends the program silently, as with git, also if its parent ignores SIGPIPE and the program inherited that.
void die_of_closed_pipes() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    sigprocmask(SIG_UNBLOCK, &pipe, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
}

}  // namespace

int main(int argc, char** argv) {
    die_of_closed_pipes();
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is then an error like any other
    rlslab::when_stopped("");
    try {
        return rlslab::parse({argv + (argc > 0), argv + argc})();
    } catch (std::bad_alloc const&) {
        std::fputs("rlslab: out of memory\n", stderr);
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab: %s\n", error.what());
    }
    return 2;
}
