// long_run ROWS [SEED]: a guarded Ud<float, 5> through abuse, for as long as wanted. Its log stands in
// docs/long_run.md.
#include "tests/long_run/abuse.hpp"

#include <rlslab/adapt/guard.hpp>

int main(int arguments, char** argument) {
    using namespace rlslab;
    auto const length = long_run::length_of("long_run", arguments, argument);
    if (!length) return 2;
    auto const [rows, seed] = *length;
    Guarded<Ud<float, 5>> g({.forgetting = float(long_run::lambda), .prior = Prior<float>{.variance = 100}});
    auto const tell = [&g](Index k, long_run::Survived const& s) {
        std::printf(
            "%13lld rows: %lld not finite, %lld of %lld P not definite, %lld of %lld beyond 2x; %lld breakdowns\n",
            (long long)k, (long long)s.not_finite, (long long)s.not_definite, (long long)s.checked,
            (long long)s.all_worse(), (long long)s.all_compared(), (long long)g.counts().breakdowns);
        std::fflush(stdout);
    };
    long_run::Survived const s =
        long_run::survive(g, rows, Seed{std::uint64_t(seed)}, std::max<Index>(rows / 10, 1), tell);
    std::printf("\n%-16s %10s %11s %26s\n", "disturbance", "times", "beyond 2x", "largest error over fresh's");
    for (size_t i = 0; i < long_run::names.size(); ++i)
        std::printf("%-16s %10lld %11lld %26.4f\n", long_run::names[i], (long long)s.compared[i], (long long)s.worse[i],
                    s.ratio[i]);
    auto const& n = g.counts();
    std::printf("\n%lld rows: %lld unusable, %lld outliers, %lld changes, %lld windups, %lld breakdowns\n",
                (long long)n.rows, (long long)n.unusable, (long long)n.outliers, (long long)n.changes,
                (long long)n.windups, (long long)n.breakdowns);
    return s.not_finite + s.not_definite + s.all_worse() == 0 ? 0 : 1;
}
