// Folding in a block gives the same bits with registers of any width: baseline, AVX2, AVX-512, and a scalar without
// registers.
#include "tests/common/each_isa.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace rlslab {
namespace {

/// R', theta and the reports of single rows after a few blocks of so many rows, zeros and numbers of very different
/// size among them.
template <class T>
std::vector<double> folded(Index size, Index rows, double unit) {
    Seed seed{std::uint64_t(64 * size + rows)};
    auto const number = [&seed, unit] { return double(float(seed.next() % 7 == 0 ? 0 : seed.bell() * unit)); };
    QrBlock<T> filter(Problem<T>{.size = size, .forgetting = T(0.96875), .prior = std::nullopt});
    std::vector<double> out;
    for (int block = 0; block < 3; ++block) {
        Matrix<T> psi(size, rows);
        Vector<T> y(rows);
        for (Index k = 0; k < rows; ++k) {
            for (Index i = 0; i < size; ++i) psi(i, k) = T(number());
            y[k] = T(number());
        }
        filter.update_block(psi, y);
        Step<T> const step = filter.update({psi.col(0).data(), size}, y[0]);
        out.insert(out.end(), {static_cast<double>(step.residual), static_cast<double>(step.gamma)});
    }
    Matrix<T> const L = filter.stored().F;
    for (Index j = 0; j < size; ++j)
        for (Index i = j; i < size; ++i) out.push_back(static_cast<double>(L(i, j)));
    for (T const& x : Vector<T>(filter.theta())) out.push_back(static_cast<double>(x));
    for (double& x : out) x = std::isnan(x) ? -1 : x;  // equal to itself
    return out;
}
template <class T>
void check() {
    for (double unit : {1.0, 0x1p-70, 0x1p60})  // squares that underflow in float, or overflow, go another way
        for (Index size : {1, 2, 3, 4, 5, 8, 9, 15, 33})
            for (Index rows : {1, 2, 7, 8, 9, 16, 23, 64, 65}) {
                std::vector<double> const plain = folded<Counted<T>>(size, rows, unit);
                on_each_isa([&] {
                    EXPECT_EQ(folded<T>(size, rows, unit), plain) << size << " parameters, " << rows << " rows";
                });
            }
}
TEST(Reflections, HaveTheSameBitsWithAnyRegistersInDouble) { check<double>(); }
TEST(Reflections, HaveTheSameBitsWithAnyRegistersInFloat) { check<float>(); }

/// A NaN or an infinity is not lost among the rows of a block, wherever it stands.
TEST(Reflections, ANanAnywhereInABlockIsSeen) {
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (Index at = 0; at < 9; ++at) {
            QrBlock<double> filter({.size = 2});
            Matrix<double> psi = Matrix<double>::Zero(2, 9);
            psi(0, at) = bad;
            filter.update_block(psi, Vector<double>::Zero(9));
            EXPECT_FALSE(std::isfinite(filter.theta()[0])) << at;
        }
}

}  // namespace
}  // namespace rlslab
