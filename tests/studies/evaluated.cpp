// Other evaluations of the same texts: with the library's own they are the library's bits, and fused means fused.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "studies/published/evaluated_double.hpp"
#include "studies/published/evaluated_filters.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
using namespace studies;
namespace {

std::vector<std::string> const variants{"conventional_two_sided",
                                        "symmetric",
                                        "joseph",
                                        "joseph_rank_two",
                                        "potter",
                                        "carlson",
                                        "ud",
                                        "inverse_qr",
                                        "information",
                                        "qr",
                                        "gentleman",
                                        "extended_qr"};

/// How many numbers of theta and of what is stored differ from the catalogue's after 100 rows.
int differing(std::string const& variant, std::string const& evaluation, Index size, std::uint64_t seed) {
    Problem<double> const problem{.size = size, .forgetting = 0.98, .prior = Prior<double>{.variance = 100}};
    Records const records = white(size, 100, Seed{seed});
    auto const a = find_entry(variant)->make(problem, Seed{1}),
               b = evaluated(variant, evaluation).make(problem, Seed{1});
    process_rows(*a, records, 0, 100);
    process_rows(*b, records, 0, 100);
    int out = 0;
    for (Index i = 0; i < size; ++i) {
        out += a->theta()[i] != b->theta()[i];
        for (Index j = 0; j < size; ++j) out += a->stored().F(i, j) != b->stored().F(i, j);
    }
    return out;
}

TEST(Evaluated, InTheLibrarysOrderItIsTheLibrary) {
    for (std::string const& variant : variants)
        for (Index const size : {1, 3, 11})
            for (std::uint64_t const seed : {1u, 77u, 20261122u})
                EXPECT_EQ(differing(variant, "lanes", size, seed), 0) << variant << size;
}
TEST(Evaluated, FusedProductsChangeEveryVariant) {
    for (std::string const& variant : variants) EXPECT_GT(differing(variant, "fused", 5, 7), 0) << variant;
}
TEST(Evaluated, AnotherOrderOfTheDotChangesWhatHasOne) {
    for (char const* order : {"forward", "backward"})
        for (char const* variant : {"symmetric", "potter", "carlson", "ud"})
            EXPECT_GT(differing(variant, order, 11, 7), 0) << variant;
}

TEST(Evaluated, AProductIsFusedIntoASumAndRoundedElsewhere) {
    using T = FusedDouble;
    Seed seed{3};
    int different = 0;
    for (int n = 0; n < 1000; ++n) {
        double const a = seed.bell(), b = seed.bell(), c = seed.bell(), d = seed.bell();
        T const A(a), B(b), C(c), D(d);
        EXPECT_EQ(double(T(C + A * B)), std::fma(a, b, c));
        EXPECT_EQ(double(T(A * B + C)), std::fma(a, b, c));
        EXPECT_EQ(double(T(C - A * B)), std::fma(-a, b, c));
        EXPECT_EQ(double(T(A * B - C)), std::fma(a, b, -c));
        EXPECT_EQ(double(T(A * B + C * D)), std::fma(c, d, a * b));
        EXPECT_EQ(double(T(A * B - C * D)), std::fma(-c, d, a * b));
        EXPECT_EQ(double(T(A * B)), a * b);
        EXPECT_EQ(double(T(A * B / C)), a * b / c);
        EXPECT_EQ(double(T((A * B) * C)), a * b * c);
        T sum = C;
        sum += A * B;
        sum -= C * D;
        EXPECT_EQ(double(sum), std::fma(-c, d, std::fma(a, b, c)));
        different += std::fma(a, b, c) != c + a * b;
    }
    EXPECT_GT(different, 100) << "or nothing was tested";
}
TEST(Evaluated, TheOtherDotsAreOneRunningSum) {
    Seed seed{4};
    for (Index const n : {0, 1, 2, 9, 20}) {
        std::vector<double> x(std::vector<double>::size_type(n), 0.0), y = x;
        std::vector<ForwardDouble> fx, fy;
        std::vector<BackwardDouble> bx, by;
        for (Index i = 0; i < n; ++i) {
            x[size_t(i)] = seed.bell(), y[size_t(i)] = seed.bell();
            fx.emplace_back(x[size_t(i)]), fy.emplace_back(y[size_t(i)]);
            bx.emplace_back(x[size_t(i)]), by.emplace_back(y[size_t(i)]);
        }
        double forward = 0, backward = 0;
        for (size_t i = 0; i < size_t(n); ++i) forward += x[i] * y[i];
        for (size_t i = size_t(n); i-- > 0;) backward += x[i] * y[i];
        EXPECT_EQ(double(dot(fx.data(), fy.data(), n)), forward);
        EXPECT_EQ(double(dot(bx.data(), by.data(), n)), backward);
    }
}
TEST(Evaluated, AnotherNameIsRefused) {
    EXPECT_THROW(evaluated("qr", "sideways"), std::logic_error);
    EXPECT_THROW(evaluated("nothing", "fused"), std::logic_error);
}

}  // namespace
}  // namespace rlslab
