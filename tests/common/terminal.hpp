// Runs a command on a pseudo-terminal: what it prints there, and input as if typed.
#pragma once

#include <functional>
#include <pty.h>
#include <stdexcept>
#include <string>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

struct Screen {
    int code;  ///< as a shell gives it: 128 and the signal's number for who died of one
    std::string text;
};

/// Runs it in bash with standard input, output and error on a terminal of so many columns. What `type` first answers to
/// the text so far is typed.
inline Screen on_a_terminal(std::string const& command, std::function<std::string(std::string const&)> type = {},
                            unsigned short columns = 80) {
    winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    int terminal = -1;
    pid_t const child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child < 0) throw std::runtime_error("this machine gives no pseudo-terminal: is /dev/pts mounted?");
    if (child == 0) {
        setenv("TERM", "xterm", 1);
        unsetenv("NO_COLOR");
        execlp("bash", "bash", "-c", command.c_str(), nullptr);
        _exit(127);
    }
    Screen screen{-1, {}};
    char part[4096];
    for (ssize_t n;
         (n = ::read(terminal, part, sizeof part)) > 0;) {  // an error where the last of the terminal's writers is gone
        screen.text.append(part, size_t(n));
        std::string const keys = type ? type(screen.text) : "";
        if (keys.empty()) continue;
        type = {};
        if (::write(terminal, keys.data(), keys.size()) < 0) break;
    }
    int status = 0;
    waitpid(child, &status, 0);
    close(terminal);
    screen.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return screen;
}
