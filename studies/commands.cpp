// Options checked in one line, and answers written whole.
#include "commands.hpp"

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace rlslab {

CLI::Validator whole(long least, long most) {
    return {[=](std::string& text) {
                long value = 0;
                auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                bool const good = error == std::errc() && end == text.data() + text.size() && least <= value && value <= most;
                return good ? "" : fmt::format("expected a whole number from {} to {}, found \"{}\"", least, most, printable(text));
            },
            ""};
}

CLI::Validator real(char const* expected, bool (*holds)(double)) {
    return {[=](std::string& text) {
                double value = 0;
                auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                bool const good = error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && holds(value);
                return good ? "" : fmt::format("expected {}, found \"{}\"", expected, printable(text));
            },
            ""};
}

void print(std::string const& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw InputError(fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

Progress progress_after_a_second(std::string doing) {
    auto const start = std::chrono::steady_clock::now();
    bool const terminal = isatty(STDERR_FILENO);
    return [start, terminal, doing, shown = -1](double part) mutable {
        int const percent = int(100 * part), step = terminal ? 1 : 25;
        double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (seconds < 1 || percent / step == shown / step) return;
        shown = percent;
        double const left = part > 0 ? seconds * (1 - part) / part : 0;
        std::string const line = fmt::format("{} {:3} %{:<14}", doing, percent,
                                             left < 5 ? "" : left < 90 ? fmt::format(", {:.0f} s left", left)
                                                                       : fmt::format(", {:.0f} min left", left / 60));
        std::string const blank(line.size(), ' ');
        if (!terminal)
            std::fprintf(stderr, "%s\n", line.c_str());
        else if (percent == 100)
            std::fprintf(stderr, "\r%s\r", blank.c_str());
        else
            std::fprintf(stderr, "\r%s", line.c_str());
    };
}

}  // namespace rlslab
