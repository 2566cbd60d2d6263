// The rlslab program: one line on standard error and exit code 2 for whatever goes wrong.
#include "commands.hpp"

#include <csignal>
#include <cstdio>

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);    // a closed pipe is then an error like any other, not a silent death
    try {
        return rlslab::parse({argv + (argc > 0), argv + argc})();
    } catch (std::bad_alloc const&) {
        std::fputs("rlslab: out of memory\n", stderr);
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab: %s\n", error.what());
    }
    return 2;
}
