// A thousand sensors, each with an offset and a drift of its own: one filter for eight at a time, in lockstep.
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr int sensors = 1000, lanes = 8;

struct Truth {
    float offset, drift;
};

}  // namespace

int main() {
    using Eight = rlslab::Pack<float, lanes>;
    rlslab::Seed seed{1};
    std::vector<Truth> truth(sensors);
    for (Truth& t : truth) t = {float(seed.bell()), 0.1f * float(seed.bell())};

    std::vector<rlslab::Ud<Eight, 2>> together(sensors / lanes,
                                               rlslab::Ud<Eight, 2>({.size = 2, .forgetting = Eight(0.999f)}));
    std::vector<rlslab::Ud<float, 2>> alone(sensors, rlslab::Ud<float, 2>({.size = 2, .forgetting = 0.999f}));
    for (int k = 0; k < 500; ++k) {
        float const hours = float(k) / 100;
        for (int first = 0; first < sensors; first += lanes) {
            Eight readings(0.0f);
            for (int lane = 0; lane < lanes; ++lane) {
                auto const [offset, drift] = truth[size_t(first + lane)];
                readings.set(lane, offset + drift * hours + 0.05f * float(seed.bell()));
            }
            together[size_t(first / lanes)].update({Eight(1.0f), Eight(hours)}, readings);
            for (int lane = 0; lane < lanes; ++lane) alone[size_t(first + lane)].update({1.0f, hours}, readings[lane]);
        }
    }

    int same = 0;
    double squares = 0;
    for (int i = 0; i < sensors; ++i) {
        auto const theta = together[size_t(i / lanes)].theta();
        float const offset = theta[0][i % lanes], drift = theta[1][i % lanes];
        same += offset == alone[size_t(i)].theta()[0] && drift == alone[size_t(i)].theta()[1];
        squares += std::pow(offset + 5 * drift - truth[size_t(i)].offset - 5 * truth[size_t(i)].drift, 2);
    }
    double const error = std::sqrt(squares / sensors);
    std::printf("%d sensors, %d filters; the bits of a filter alone: %d of %d\n", sensors, int(together.size()), same,
                sensors);
    std::printf("root mean square error at the end: %.4f of a noise of 0.05\n", error);
    return same == sensors && error < 0.01 ? 0 : 1;
}
