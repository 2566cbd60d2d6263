// Folding in a block gives the same bits with registers of any width: baseline, AVX2, AVX-512, and a scalar without
// registers.
#include "tests/common/each_isa.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <gtest/gtest.h>

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
        for (Index size : {1, 2, 3, 4, 5, 8, 9, 15, 16, 17, 33})
            for (Index rows : {1, 2, 7, 8, 9, 16, 23, 64, 65, 256, 259}) {
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

// --- accuracy --------------------------------------------------------------------------------------------------------

/// Rows of one kind: (0, 1, 2) condition 1, 1e7, 1e14; (3) columns from 2^-400 to 2^400; (4) rank d/2; (5) columns of
/// zeros, (6) in the first block alone; (7) fewer rows than columns.
Matrix<double> rows_of(int kind, Index d, double unit, Seed seed) {
    Matrix<double> A(kind == 7 ? d / 2 : 300, d);
    for (double& x : A.reshaped()) x = seed.bell();
    if (kind == 1 || kind == 2)  // columns that are nearly parallel
        for (Index j = 1; j < d; ++j) A.col(j) = A.col(0) + (kind == 1 ? 1e-7 : 1e-14) * A.col(j);
    for (Index j = 0; j < d; ++j) {
        if (kind == 3) A.col(j) *= std::ldexp(1.0, int(800 * j / d) - 400);
        if (kind == 4 && j >= d / 2) A.col(j) = 2 * A.col(j - d / 2) + A.col(0);
        if (kind == 5 && j % 3 == 1) A.col(j).setZero();
        if (kind == 6 && j % 3 == 1) A.col(j).head(256).setZero();
    }
    return A * unit;
}
/// max_ij |R'R - A'A|_ij / (|a_i| |a_j|) in epsilons: R is exact for rows whose columns are changed by half of that,
/// relative to each.
double backward_error(Matrix<double> const& A, Matrix<double> const& L) {
    using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    Wide const a = A.cast<long double>(), l = Wide(L.cast<long double>().triangularView<Eigen::Lower>()),
               error = a.transpose() * a - l * l.transpose();
    long double worst = 0;
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.cols(); ++i) {
            long double const size = a.col(i).norm() * a.col(j).norm();
            worst = std::max(worst, size > 0 ? std::abs(error(i, j)) / size : std::abs(error(i, j)));
        }
    return double(worst / std::numeric_limits<double>::epsilon());
}
Matrix<double> folded_in(Matrix<double> const& A) {
    QrBlock<double> f({.size = A.cols(), .prior = std::nullopt});
    for (Index k = 0; k < A.rows(); k += QrBlock<double>::block) {
        Index const rows = std::min(QrBlock<double>::block, A.rows() - k);
        f.update_block(A.middleRows(k, rows).transpose(), Vector<double>::Ones(rows));
    }
    return f.stored().F;
}
/// A reflection of B rows changes a column by a few roundings and by those of its dot products, which grow as sqrt(B/8)
/// in eight lanes and as sqrt(B) in one: some sqrt(256) = 16 epsilons of a column's length, that of Q and of Q' each.
TEST(Reflections, ABlockIsExactForRowsThatDifferByRounding) {
    for (Index d : {3, 8, 9, 16, 20, 40})
        for (int kind = 0; kind < 8; ++kind)
            for (double unit : {1.0, 0x1p-1000, 0x1p-440, 0x1p-300, 0x1p500, 0x1p1000}) {
                if (kind == 3 && unit != 1.0) continue;
                EXPECT_LE(backward_error(rows_of(kind, d, unit, Seed{std::uint64_t(d)}),
                                         folded_in(rows_of(kind, d, unit, Seed{std::uint64_t(d)}))),
                          32)
                    << d << " parameters, kind " << kind << ", " << unit;
            }
    Matrix<double> const A = rows_of(0, 9, 1, Seed{1});
    EXPECT_GT(backward_error(A, folded_in(A * (1 + 0x1p-46))), 32);  // it can fail
}

}  // namespace
}  // namespace rlslab
