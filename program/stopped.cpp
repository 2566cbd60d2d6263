// What a signal that ends the program leaves behind: as git does it, a handler that cleans up and dies of the same signal.
#include "program/commands.hpp"

#include <rlslab/core/files.hpp>

#include <atomic>
#include <csignal>
#include <cstring>
#include <unistd.h>

namespace rlslab {
namespace {

char advice[512];
std::atomic<size_t> length = 0;
std::atomic<bool> terminal = false;

/// Only what a handler may call: unlink, write, raise.
void clean_up(int signal) {
    remove_unfinished_file();
    if (terminal) (void)!::write(STDERR_FILENO, "\n", 1);  // progress and ^C stand on this line
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
        if (before.sa_handler != SIG_IGN) ::sigaction(signal, &act, nullptr);  // whoever started it with nohup meant it
    }
}

}  // namespace rlslab
