// Roots are those of exactly the coefficients given, to the last bit: simple, multiple, complex, at zero, far apart.
#include <rlslab/model/difference.hpp>

#include <rlslab/arithmetic/multiprecision.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using Point = std::complex<double>;

Reference value(std::vector<double> const& p, double at) {
    Reference out = 1;
    for (double const c : p) out = out * at + c;
    return out;
}
/// The double nearest to a simple real root: the sign changes between the middles to its neighbours.
bool is_nearest(std::vector<double> const& p, double root) {
    auto const middle = [&](double to) { return (Reference(root) + std::nextafter(root, to)) / 2; };
    auto const at = [&](Reference const& x) {
        Reference out = 1;
        for (double const c : p) out = out * x + c;
        return out;
    };
    return value(p, root) == 0 || at(middle(-INFINITY)) * at(middle(INFINITY)) < 0;
}

TEST(Roots, RealOnesAreTheNearestDoubles) {
    Seed seed{4};
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<double> p{1};
        int const n = 1 + trial % 8;
        for (int i = 0; i < n; ++i) {  // about (z - 1)(z + 2)(z - 3) ..., with rounded coefficients
            double const root = (i % 2 ? -1 : 1) * (i + 0.5 + 0.4 * seed.uniform());
            std::vector<double> product(p.size() + 1, 0.0);
            for (size_t k = 0; k < p.size(); ++k) product[k] += p[k], product[k + 1] -= root * p[k];
            p = product;
        }
        p.erase(p.begin());
        auto const found = roots(p);
        ASSERT_EQ(found.size(), size_t(n));
        for (Point const z : found) {
            EXPECT_EQ(z.imag(), 0);
            EXPECT_TRUE(is_nearest(p, z.real())) << z.real();
        }
        EXPECT_TRUE(n < 2 || std::abs(found[0]) > std::abs(found[1]));
    }
    EXPECT_FALSE(is_nearest({-2, 0.75}, std::nextafter(1.5, 2)));
}
TEST(Roots, MultipleOnesAreEqual) {
    EXPECT_EQ(roots({-1, 0.25}), (std::vector<Point>{0.5, 0.5}));
    EXPECT_EQ(roots({-1.5, 0.75, -0.125}), (std::vector<Point>{0.5, 0.5, 0.5}));
    EXPECT_EQ(roots({0, 2, 0, 1}), (std::vector<Point>{{0, 1}, {0, 1}, {0, -1}, {0, -1}}));
}
TEST(Roots, AtZeroAndFarApart) {
    EXPECT_EQ(roots({}), std::vector<Point>{});
    EXPECT_EQ(roots({0, 0}), (std::vector<Point>{0, 0}));
    EXPECT_EQ(roots({-3, 2, 0}), (std::vector<Point>{2, 1, 0}));
    auto const far = roots({-0x1p500, 1});  // z = 2^500 and nearly 2^-500
    EXPECT_EQ(far[0], Point(0x1p500));
    EXPECT_EQ(far[1], Point(0x1p-500));
    EXPECT_EQ(roots({0, -0x1p-1000}), (std::vector<Point>{0x1p-500, -0x1p-500}));
}
TEST(Roots, OfCoefficientsOfAnySize) {
    Seed seed{5};
    for (int n = 3; n <= 30; n += 9) {
        std::vector<double> p;
        for (int i = 0; i < n; ++i) p.push_back(std::ldexp(2 * seed.uniform() - 1, int(2000 * seed.uniform()) - 1000));
        auto const found = roots(p);
        ASSERT_EQ(found.size(), size_t(n));
        for (Point const z : found) {
            EXPECT_TRUE(z.imag() != 0 || !std::isnormal(z.real()) || is_nearest(p, z.real())) << n << " " << z;
        }
    }
}
TEST(Roots, ComplexPairs) {
    auto const r = roots({-1.5, 0.7});
    EXPECT_EQ(r[0], std::conj(r[1]));
    EXPECT_EQ(r[0].real(), 0.75);
    EXPECT_EQ(r[0].imag(), static_cast<double>(sqrt(Reference(0.7) - Reference(0.5625))));
}
TEST(Roots, OfWhatIsNotFinite) {
    for (double const bad : {double(INFINITY), double(NAN)})
        for (Point const z : roots({1, bad})) EXPECT_TRUE(std::isnan(z.real()) && std::isnan(z.imag()));
}

}  // namespace
}  // namespace rlslab
