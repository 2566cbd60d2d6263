// A command line, from words to exit code; signals end it as in git: a handler cleans up and raises the signal again.
#include "src/lab/program/run.hpp"

#include "src/lab/program/commands.hpp"

#include <rlslab/core/files.hpp>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace rlslab::program {
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
