// VariablePrecision rounds as a format of so many bits does: against float, double, the chopped formats, and exact
// rationals.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Numbers of p bits with short and long significands, so that sums cancel and midpoints come up.
double draw(Seed& seed, int p) {
    PrecisionScope const precision(p);
    double const x = std::ldexp(seed.bell(), int(6 * seed.bell()));
    return double(VariablePrecision(seed.uniform() < 0.3 ? std::nearbyint(x * 4) / 4 : x));
}

/// One rounding of an exact value to p bits, ties to even, by its definition.
double rounded(Rational const& exact, int p) {
    if (exact == 0) return 0;
    int e = 0;
    Rational size = abs(exact);
    for (; size >= 2; size /= 2) ++e;
    for (; size < 1; size *= 2) --e;
    Rational const scaled = size * Rational(std::ldexp(1.0, p - 1));
    boost::multiprecision::mpz_int whole = numerator(scaled) / denominator(scaled);
    Rational const rest = scaled - Rational(whole);
    if (rest > Rational(1, 2) || (rest == Rational(1, 2) && whole % 2 != 0)) ++whole;
    return (exact < 0 ? -1 : 1) * std::ldexp(static_cast<double>(whole), e - p + 1);
}

TEST(VariablePrecision, EveryOperationIsRoundedOnce) {
    Seed seed{7};
    for (int p = 2; p <= 53; ++p)
        for (int k = 0; k < 2000; ++k) {
            double const x = draw(seed, p), y = draw(seed, p);
            PrecisionScope const precision(p);
            Rational const a(x), b(y);
            EXPECT_EQ(double(VariablePrecision(x) + VariablePrecision(y)), rounded(a + b, p))
                << p << ' ' << x << ' ' << y;
            EXPECT_EQ(double(VariablePrecision(x) - VariablePrecision(y)), rounded(a - b, p))
                << p << ' ' << x << ' ' << y;
            EXPECT_EQ(double(VariablePrecision(x) * VariablePrecision(y)), rounded(a * b, p))
                << p << ' ' << x << ' ' << y;
            if (y != 0) {
                EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), rounded(a / b, p))
                    << p << ' ' << x << ' ' << y;
            }
        }
}

/// A root lies on the right side of both midpoints beside it.
TEST(VariablePrecision, RootsAreRoundedOnce) {
    Seed seed{8};
    for (int p = 2; p <= 53; ++p)
        for (int k = 0; k < 500; ++k) {
            double const x = std::abs(draw(seed, p));
            if (x == 0) continue;
            PrecisionScope const precision(p);
            double const root = double(sqrt(VariablePrecision(x)));
            int e = 0;
            std::frexp(root, &e);
            Rational const half(std::ldexp(0.5, e - p)), r(root);
            EXPECT_TRUE((r - half) * (r - half) <= Rational(x) || root == std::ldexp(0.5, e)) << p << ' ' << x;
            EXPECT_LE(Rational(x), (r + half) * (r + half)) << p << ' ' << x;
        }
}

TEST(VariablePrecision, TwentyFourAreFloatAndElevenBinary16) {
    Seed seed{9};
    for (int k = 0; k < 20000; ++k) {
        {
            PrecisionScope const precision(24);
            float const x = float(seed.bell()), y = float(seed.bell());
            EXPECT_EQ(double(VariablePrecision(x) * VariablePrecision(y)), double(x * y));
            EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), double(x / y));
            EXPECT_EQ(double(sqrt(VariablePrecision(std::abs(x)))), double(std::sqrt(std::abs(x))));
        }
        {
            PrecisionScope const precision(11);
            double const x = 1 + seed.uniform(), y = 1 + seed.uniform();
            EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), double(Half(x) / Half(y)));
            EXPECT_EQ(double(VariablePrecision(x) + VariablePrecision(y)), double(Half(x) + Half(y)));
        }
    }
}

TEST(VariablePrecision, ThePrecisionIsTheThreadsAndComesBack) {
    EXPECT_EQ(PrecisionScope::bits(), 53);
    {
        PrecisionScope const outer(8);
        {
            PrecisionScope const inner(20);
            EXPECT_EQ(PrecisionScope::bits(), 20);
        }
        EXPECT_EQ(double(VariablePrecision(257.0)), 256);
    }
    EXPECT_EQ(PrecisionScope::bits(), 53);
    EXPECT_THROW(PrecisionScope(1), std::invalid_argument);
    EXPECT_THROW(PrecisionScope(54), std::invalid_argument);
}

/// With double's bits, and float's, every variant gives what it gives in double and float, where kernels run.
TEST(VariablePrecision, VariantsGiveTheBitsOfTheHardware) {
    for (auto const& [bits, name] : {std::pair{53, "double"}, std::pair{24, "float"}})
        for (CatalogueEntry const& e : variable_precision_catalogue()) {
            PrecisionScope const precision(bits);
            CatalogueEntry const* const hardware = find_entry(e.variant, name);
            ASSERT_TRUE(hardware);
            Records const records = as_stored(laws::noise_records(5, 60, Seed{4}), *hardware->arithmetic);
            auto const f = e.make(laws::problem(5, 0.96875), Seed{1}),
                       g = hardware->make(laws::problem(5, 0.96875), Seed{1});
            laws::process_rows(*f, records);
            laws::process_rows(*g, records);
            EXPECT_TRUE(laws::identical(f->stored(), g->stored())) << e.variant << ' ' << bits;
            EXPECT_TRUE(laws::identical(f->theta(), g->theta())) << e.variant << ' ' << bits;
        }
}

}  // namespace
}  // namespace rlslab
