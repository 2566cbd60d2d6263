// A system drifts, then its input goes silent. With forgetting P grows without bound in silence (windup), and theta
// follows noise; a filter whose time stands still meanwhile keeps what it knew.
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

using Filter = rlslab::Ud<float, 2>;

/// The cure: a row that excites nothing is not processed. Its time does not pass either, so that P keeps its size.
/// psi'psi is what a row adds to the information; below `least` it is noise.
void update_if_excited(Filter& filter, float const (&psi)[2], float y, float least) {
    if (psi[0] * psi[0] + psi[1] * psi[1] >= least) filter.update(psi, y);
}

float largest_variance(Filter const& filter) {
    auto const P = filter.covariance();
    return std::max(P(0, 0), P(1, 1));
}

}  // namespace

int main() {
    Filter plain({.size = 2, .forgetting = 0.98f}), cured = plain;
    rlslab::Seed seed{1};
    float b[] = {1, -0.5f}, u = 0;
    auto const error = [&](Filter const& f) { return std::hypot(f.theta()[0] - b[0], f.theta()[1] - b[1]); };
    std::printf("                      plain                 cured\n");
    std::printf("                P       error        P       error\n");
    float worst_plain = 0, worst_cured = 0;
    for (char const* phase : {"driven", "silent", "driven again"}) {
        bool const silent = phase[0] == 's';
        float at_worst[2] = {};
        for (int k = 0; k < 1000; ++k) {
            float const before = u;
            u = (silent ? 1e-4f : 1) * float(seed.bell());
            if (!silent) b[0] += 1e-3f;
            float const psi[] = {u, before}, y = b[0] * u + b[1] * before + 0.01f * float(seed.bell());
            plain.update(psi, y);
            update_if_excited(cured, psi, y, 1e-3f);
            if (k < 100 && phase[0] == 'd' && phase[6] == '\0') continue;  // both are learning
            at_worst[0] = std::max(at_worst[0], error(plain));
            at_worst[1] = std::max(at_worst[1], error(cured));
        }
        std::printf("%-12s %8.1e %8.2f %11.1e %8.2f\n", phase, double(largest_variance(plain)), double(at_worst[0]),
                    double(largest_variance(cured)), double(at_worst[1]));
        worst_plain = std::max(worst_plain, at_worst[0]);
        worst_cured = std::max(worst_cured, at_worst[1]);
    }
    return worst_cured < 0.2f && worst_plain > 10 * worst_cured ? 0 : 1;
}
