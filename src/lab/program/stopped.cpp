// Signals that end the program: as in git, a handler cleans up and then raises the same signal again.
#include "src/lab/program/commands.hpp"

#include <rlslab/core/files.hpp>

#include <atomic>
#include <csignal>
#include <cstring>
#include <unistd.h>

namespace rlslab::program {
using namespace report;
namespace {

char advice[512];
std::atomic<size_t> length = 0;
std::atomic<bool> terminal = false;

/// Calls only functions that a signal handler may call: unlink, write, raise.
void clean_up(int signal) {
    remove_unfinished_file();
    if (terminal) (void)!::write(STDERR_FILENO, "\n", 1);  // the line of progress, and ^C, end here
    if (length > 0) (void)!::write(STDERR_FILENO, advice, length);
    ::raise(signal);  // the handler is gone (SA_RESETHAND): its default comes when this one returns
}

}  // namespace

void when_stopped(std::string const& text) {
    terminal = ::isatty(STDERR_FILENO) == 1;
    length = 0;
    size_t const fits = std::min(text.size(), sizeof advice);
    std::memcpy(advice, text.data(), fits);
    length = fits;
    struct sigaction act {};
    act.sa_handler = clean_up;
    act.sa_flags = SA_RESETHAND;
    for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        ::sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) ::sigaction(signal, &act, nullptr);  // with nohup it stays ignored
    }
}

}  // namespace rlslab::program
