// SLICOT's FD01AD solves the same problem as the fast forms: the same prior, the same errors.
#include "bench/fd01ad.hpp"
#include "tests/fast/samples.hpp"

#include <rlslab/fast/qr_lattice.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(FastPeers, Fd01adHasTheErrorsOfTheQrLattice) {
    for (Index const d : {1, 2, 5, 12})
        for (double const lambda : {1.0, 0.96875, 0.75}) {
            FastProblem<double> const problem{.size = d, .forgetting = lambda, .energy = 0.25};
            bench::Fd01ad peer(problem);
            QrLattice<double> ours(problem);
            for (auto const& [u, y] : fast_tests::samples(500, 13)) {
                Step<double> const a = peer.update(u, y), b = ours.update(u, y);
                EXPECT_NEAR(a.innovation, b.innovation, 1e-10) << d << ' ' << lambda;
                EXPECT_NEAR(a.residual, b.residual, 1e-10) << d << ' ' << lambda;
                EXPECT_NEAR(a.gamma, b.gamma, 1e-10) << d << ' ' << lambda;
            }
        }
}

}  // namespace
}  // namespace rlslab
