// A filter that was moved from has no size: it refuses every row, and may be assigned to.
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(MovedFrom, AFilterRefusesRowsUntilItIsAssignedTo) {
    Vector<double> const psi{{1.0, 2.0, 3.0}};
    int tried = 0;
    for_each(Variants<double>{}, [&]<class F>() {
        F f({.size = 3});
        f.update(psi, 1.0);
        F g = std::move(f);
        EXPECT_THROW(f.update(psi, 1.0), std::invalid_argument) << F::name;  // NOLINT: what is tested
        f = g;
        f.update(psi, 2.0), g.update(psi, 2.0);
        EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(g.theta())) << F::name;
        ++tried;
    });
    EXPECT_GE(tried, 15);
}

}  // namespace
}  // namespace rlslab
