// How long a run takes: some trials, run in a child process that can be stopped at any time.
#include <rlslab/studies/factors.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rlslab::studies {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

/// Runs trials that lie evenly over all of them and writes the seconds of each; the parent reads as long as it wants.
[[noreturn]] void run_some(Study const& study, std::vector<Trial> const& trials, int to) {
    constexpr size_t golden = 0x9e3779b97f4a7c15;  // its multiples modulo the number of trials spread evenly
    for (size_t i = 0; i < trials.size(); ++i) {
        Trial const& trial = trials[(i * golden >> 32) * trials.size() >> 32];  // of fewer than 2^32
        TrialOutput out(trial);
        auto const start = Clock::now();
        try {
            study.measure(trial, out);
        } catch (std::exception const&) {
            break;
        }
        double const took = seconds_since(start);
        if (write(to, &took, sizeof took) != ssize_t(sizeof took)) break;
    }
    _exit(0);
}

}  // namespace

TimeEstimate estimated_time(Study const& study, RunOptions const& options, double seconds) {
    std::vector<Factor> const factors = factors_of(study, options);
    std::vector<Trial> const trials = trials_of(study, factors, options);
    TimeEstimate out{.trials = trials.size(), .of_one = seconds};
    int ends[2];
    if (trials.empty() || pipe(ends) != 0) return out;
    pid_t const child = fork();
    if (child == 0) {
        close(ends[0]);
        run_some(study, trials, ends[1]);
    }
    close(ends[1]);
    double sum = 0, took = 0;
    auto const start = Clock::now();
    for (double left = seconds; child > 0 && left > 0; left = seconds - seconds_since(start)) {
        pollfd one{.fd = ends[0], .events = POLLIN, .revents = 0};
        if (poll(&one, 1, int(1000 * left) + 1) <= 0 || read(ends[0], &took, sizeof took) != ssize_t(sizeof took))
            break;
        sum += took, ++out.tried;
    }
    close(ends[0]);
    if (child > 0) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    if (out.tried > 0) out.of_one = sum / double(out.tried);
    return out;
}

}  // namespace rlslab::studies
