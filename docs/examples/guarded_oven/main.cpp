// An oven's model in float, learnt for a week from a sensor that fails: with a guard, without, and across a restart.
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace {

using Bare = rlslab::Ud<float, 3>;
using Filter = rlslab::Guarded<Bare>;

/// T' = a T + b u + c: temperature beyond 20 degrees in tens of degrees, heater power in kW.
struct Oven {
    double a = 0.98, b = 0.5, c = 0.02, T = 0;
    double step(double power, double noise) { return T = a * T + b * power + c + noise; }
};

/// The farthest of the three numbers from the oven's.
double error(auto const& filter, Oven const& oven) {
    auto const theta = filter.theta();
    double const e[] = {theta[0] - oven.a, theta[1] - oven.b, theta[2] - oven.c};
    return std::max({std::abs(e[0]), std::abs(e[1]), std::abs(e[2])});
}

}  // namespace

int main() {
    rlslab::Problem<float> const problem{.size = 3, .forgetting = 0.999f, .prior = rlslab::Prior<float>{}};
    Filter guarded(problem), restarted(problem);
    Bare bare(problem);
    Oven oven;
    rlslab::Seed seed{7};
    double power = 1, after_the_door = 0;
    float last = 0;
    for (int k = 0; k < 60480; ++k) {  // a week, a row in ten seconds
        if (k % 60 == 0) power = 2 * seed.uniform();
        if (k >= 20000 && k < 30000) power = 0;       // a day off: no row carries information on b
        if (k == 40000) oven.a = 0.95, oven.b = 0.4;  // the door stays ajar
        float const psi[] = {last, float(power), 1};
        float const T = float(oven.step(power, 0.002 * seed.bell()));
        float read = T;
        if (k % 5000 == 4999) read = 1e6f;                                     // the converter's full scale
        if (k % 7000 == 6999) read = std::numeric_limits<float>::quiet_NaN();  // a broken wire
        guarded.update(psi, read);
        restarted.update(psi, read);
        if (std::isfinite(read)) bare.update(psi, read);
        last = T;
        if (k == 35000) {  // the controller restarts: what it wrote to its memory, a new filter reads
            std::vector<std::byte> memory(rlslab::state_size(restarted));
            rlslab::save(restarted, memory);
            Filter anew(problem);
            if (rlslab::load(anew, memory) != rlslab::StateFault::none) return 1;
            restarted = anew;
            memory[40] ^= std::byte{1};  // a worn cell: such a state is refused, and the filter is as it was
            if (rlslab::load(restarted, memory) == rlslab::StateFault::none) return 1;
        }
        if (k == 41000) after_the_door = error(guarded, oven);
    }
    rlslab::GuardCounts const& n = guarded.counts();
    std::printf("rows %ld: %ld unusable, %ld outliers, %ld changes, %ld windups, %ld breakdowns\n", long(n.rows),
                long(n.unusable), long(n.outliers), long(n.changes), long(n.windups), long(n.breakdowns));
    std::printf("largest error of a, b, c   guarded %.4f   bare %.4f\n", error(guarded, oven), error(bare, oven));
    std::printf("a thousand rows after the door was left ajar   %.4f\n", after_the_door);
    bool same = true;
    for (int i = 0; i < 3; ++i)
        same = same && guarded.theta()[i] == restarted.theta()[i] && guarded.gain()[i] == restarted.gain()[i];
    std::printf("restarted at row 35000: %s\n", same ? "the same bits" : "other bits");
    return same && error(guarded, oven) < 0.02 && !(error(bare, oven) < 0.02) ? 0 : 1;
}
