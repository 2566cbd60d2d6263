// Several outputs of forms that solve for theta, and of blocks: m outputs are m filters.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"
#include "tests/common/same.hpp"

#include <rlslab/adapt/outputs.hpp>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

template <class F>
inline constexpr bool takes_blocks = requires(MultiOutput<F>& f, Matrix<double> const& X) { f.update_block(X, X); };
Problem<double> problem_of(Index d, bool prior) {
    Problem<double> out{.size = d, .forgetting = prior ? 0.96875 : 1.0};
    if (!prior) out.prior = std::nullopt;
    return out;
}
template <class Number = double>
Matrix<Number> drawn(Seed& seed, Index rows, Index columns) {
    Matrix<Number> out(rows, columns);
    for (Number& x : out.reshaped()) x = Number(seed.bell());
    return out;
}
template <class F>
void block(F& f, Matrix<double> const& X, Vector<double> const& y) {
    if constexpr (TakesBlocks<F>) {
        f.update_block(X, y);
    } else {
        BlockGain<double> gain;
        f.update_block(X, y, gain);
    }
}

// --- m filters -------------------------------------------------------------------------------------------------------

/// Without a prior, rows of zeros, zeros in rows and a gain among them. A saboteur has one y otherwise.
template <class F, class Shared = MultiOutput<F>, Index m = 4>
int differs(Index d, bool prior, bool off = false) {
    Problem<double> const problem = problem_of(d, prior);
    std::vector<F> own(m, F(problem));
    Shared shared(problem, m);
    Seed seed{8};
    int bad = 0;
    for (int k = 0; k < 60; ++k) {
        Vector<double> psi = drawn(seed, d, 1), y = drawn(seed, m, 1);
        if (k % 7 == 3) psi[k % d] = 0;
        if (k % 11 == 5) psi.setZero();
        if (k == 30) psi = own[0].gain();
        auto const steps = shared.update(psi, Vector<double>(y));
        Matrix<double> const theta = shared.theta();
        if (off && k == 30) y[2] *= 1 + 0x1p-40;
        for (size_t j = 0; j < own.size(); ++j) {
            bad += !same(own[j].update(psi, y[Index(j)]), steps[j]);
            Vector<double> const one = own[j].theta();
            for (Index i = 0; i < d; ++i) bad += !same(one[i], theta(i, Index(j)));
        }
    }
    return bad;
}
/// A saboteur: one gain, but that of the row before.
template <class F>
struct GainOfBefore {
    F filter;
    Matrix<double> thetas;
    GainOfBefore(Problem<double> const& p, Index outputs) : filter(p), thetas(Matrix<double>::Zero(p.size, outputs)) {}
    std::vector<Step<double>> update(Vector<double> const& psi, Vector<double> const& y) {
        Vector<double> const K = filter.gain();
        Step<double> const step = filter.update(psi, y[0]);
        std::vector<Step<double>> out;
        for (Index j = 0; j < y.size(); ++j) {
            double const e = y[j] - psi.dot(thetas.col(j));
            thetas.col(j) += K * e;
            out.push_back({e, step.gamma * e, step.gamma});
        }
        return out;
    }
    Matrix<double> const& theta() const { return thetas; }
};
/// In blocks; of the third output nothing comes in the first two.
template <class F>
int differs_in_blocks(Index d, bool prior, Index rows, bool off = false) {
    Problem<double> const problem = problem_of(d, prior);
    std::vector<F> own(4, F(problem));
    MultiOutput<F> shared(problem, 2);
    Seed seed{std::uint64_t(rows)};
    int bad = 0;
    for (int k = 0; k < 4; ++k) {
        Matrix<double> const X = drawn(seed, d, rows);
        Matrix<double> Y = drawn(seed, rows, 4);
        if (k < 2) Y.rightCols(2).setZero();
        if (k == 2) shared.add_outputs(2);
        shared.update_block(X, Y.leftCols(shared.outputs()));
        if (off && k == 1) Y(0, 3) = 0x1p-40;
        for (size_t j = 0; j < own.size(); ++j) {
            block(own[j], X, Y.col(Index(j)));
            Vector<double> const one = own[j].theta();
            for (Index i = 0; i < d && Index(j) < shared.outputs(); ++i)
                bad += !same(one[i], shared.theta()(i, Index(j)));
        }
    }
    return bad;
}
TEST(Outputs, AreFiltersOfTheirOwnBitForBit) {
    int rows = 0, blocks = 0;
    for_each(Variants<double>{}, [&]<class F>() {
        if constexpr (requires { typename MultiOutput<F>; }) {
            ++rows, blocks += takes_blocks<F>;
            for (Index d : {1, 3, 9, 20})
                for (bool prior : {true, false}) {
                    if constexpr (!StartsWithoutPrior<F>)
                        if (!prior) continue;
                    EXPECT_EQ(differs<F>(d, prior), 0) << F::name << d << prior;
                    for (Index k : {1, 5, 17, 64}) {
                        int bad = 0;
                        if constexpr (takes_blocks<F>) bad = differs_in_blocks<F>(d, prior, k);
                        EXPECT_EQ(bad, 0) << F::name << d << ", " << k;
                    }
                }
            for (Index d : {1, 3, 9}) {
                EXPECT_EQ((differs<F, MultiOutput<F, 1>, 1>(d, true)), 0) << F::name << d;
                EXPECT_EQ((differs<F, MultiOutput<F, 2>, 2>(d, true)), 0) << F::name << d;
                EXPECT_GT((differs<F, GainOfBefore<F>>(d, true)), 0) << F::name << d;
            }
            EXPECT_GT(differs<F>(3, true, true), 0) << F::name;
        }
    });
    EXPECT_EQ((differs<Ud<double, 3>, MultiOutput<Ud<double, 3>, 4>>(3, true)), 0);
    EXPECT_EQ(rows, 16);
    EXPECT_EQ(blocks, 2);
    EXPECT_GT(differs_in_blocks<QrBlock<double>>(9, true, 5, true), 0);
}

// --- blocks ----------------------------------------------------------------------------------------------------------

/// Exactly: P, theta and K of a block are those of its rows, one by one.
template <Index d>
bool a_block_is_its_rows(Rational const& off = 0) {
    using Q = Rational;
    JosephRankTwo<Q> rows(Problem<Q>{.size = d, .forgetting = Q(31) / 32}), blocks = rows;
    Seed seed{3};
    for (Index k : {1, 2, 5}) {
        Matrix<Q> X(d, k);
        Vector<Q> y(k);
        for (Q& x : X.reshaped()) x = int(seed.next() % 19) - 9;
        for (Q& x : y) x = int(seed.next() % 19) - 9;
        for (Index j = 0; j < k; ++j) rows.update(Regressor<Q>(Vector<Q>(X.col(j))), y[j]);
        BlockGain<Q> gain;
        if (blocks.update_block(X, y, gain, [&](auto K) { K(0, 0) += off; }) != Health::sound) return false;
    }
    return Matrix<Q>(rows.covariance()) == Matrix<Q>(blocks.covariance()) &&
           Vector<Q>(rows.theta()) == Vector<Q>(blocks.theta()) && Vector<Q>(rows.gain()) == Vector<Q>(blocks.gain());
}
TEST(BlockGain, IsTheGainOfItsRowsExactly) {
    EXPECT_TRUE(a_block_is_its_rows<1>());
    EXPECT_TRUE(a_block_is_its_rows<3>());
    EXPECT_FALSE(a_block_is_its_rows<3>(Rational(1) / 1000000));
}
/// An error h of K adds h h' s to P: (I - K X')P(I - K X')' + K Lambda K' is least at K.
TEST(BlockGain, PassesAnErrorOfKInSecondOrderExactly) {
    using Q = Rational;
    JosephRankTwo<Q> right(Problem<Q>{.size = 3, .forgetting = Q(1)}), wrong = right;
    Matrix<Q> X(3, 2);
    X << 1, 2, 0, 1, 3, -1;
    Vector<Q> const y = Vector<Q>::Zero(2);
    Q const h = Q(1) / 64;
    BlockGain<Q> gain;
    Matrix<Q> const P = right.covariance();
    Q const s = (X.col(1).transpose() * P * X.col(1))(0, 0) + 1;
    right.update_block(X, y, gain);
    wrong.update_block(X, y, gain, [&](auto K) { K(2, 1) += h; });
    Matrix<Q> more = Matrix<Q>(wrong.covariance()) - Matrix<Q>(right.covariance());
    EXPECT_EQ(more(2, 2), Q(h * h * s));
    more(2, 2) = 0;
    EXPECT_EQ(more, Matrix<Q>(Matrix<Q>::Zero(3, 3)));
}
template <class F>
void check_unusable() {
    Seed seed{6};
    Problem<double> const problem{.size = 4, .forgetting = 0.96875};
    MultiOutput<F> f(problem, 3), without(problem, 3);
    for (double bad : {double(NAN), double(INFINITY)})
        for (Index at : {0, 3, 6}) {
            Matrix<double> X = drawn(seed, 4, 7), Y = drawn(seed, 7, 3);
            f.update_block(X, Y), without.update_block(X, Y);
            (at == 3 ? Y(at, 2) : X(1, at)) = bad;
            Matrix<double> const before = f.theta(), factor = f.filter().stored().F;
            EXPECT_EQ(f.update_block(X, Y), Health::nonfinite);
            EXPECT_EQ(f.theta(), before);
            EXPECT_EQ(Matrix<double>(f.filter().stored().F), factor);
            EXPECT_EQ(f.update_block(X, Y, UnusableRows::are_left_out), Health::sound);
            Matrix<double> some(4, 6), some_outputs(6, 3);
            some << X.leftCols(at), X.rightCols(6 - at);
            some_outputs << Y.topRows(at), Y.bottomRows(6 - at);
            without.update_block(some, some_outputs);
            EXPECT_EQ(f.theta(), without.theta());
        }
    EXPECT_EQ(f.left_out(), 6);
    Matrix<double> const none = Matrix<double>::Constant(4, 2, NAN), before = f.theta();
    EXPECT_EQ(f.update_block(none, Matrix<double>::Zero(2, 3), UnusableRows::are_left_out), Health::nonfinite);
    EXPECT_EQ(f.theta(), before);
    for (auto [d, k, rows, m] : {std::array<Index, 4>{4, 0, 0, 3}, {3, 2, 2, 3}, {4, 2, 3, 3}, {4, 2, 2, 2}})
        EXPECT_THROW(f.update_block(drawn(seed, d, k), drawn(seed, rows, m)), std::invalid_argument);
    // Views of larger matrices, and rows that are the filter's own numbers.
    Matrix<double> const X = drawn(seed, 9, 7), Y = drawn(seed, 11, 5);
    f.update_block(X.middleRows(2, 4), Y.block(3, 1, 7, 3));
    without.update_block(Matrix<double>(X.middleRows(2, 4)), Matrix<double>(Y.block(3, 1, 7, 3)));
    EXPECT_EQ(f.theta(), without.theta());
}
TEST(Outputs, RefuseABlockOrLeaveRowsOut) {
    check_unusable<QrBlock<double>>();
    check_unusable<JosephRankTwo<double>>();
}
TEST(Outputs, OfManyPartsMergeAndContinueFromAState) {
    using Many = MultiOutput<QrBlock<double>>;
    Problem<double> const problem{.size = 5, .prior = std::nullopt};
    Seed seed{7};
    Many a(problem, 3), b(problem, 3), c(problem, 3);
    std::vector<QrBlock<double>> own(3, QrBlock<double>(problem)), part = own;
    Matrix<double> const X = drawn(seed, 5, 20), Y = drawn(seed, 20, 3);
    a.update_block(X.leftCols(9), Y.topRows(9)), b.update_block(X.rightCols(11), Y.bottomRows(11));
    c.merge(a), c.merge(b);
    for (size_t j = 0; j < 3; ++j) {
        own[j].update_block(X.leftCols(9), Y.col(Index(j)).head(9));
        part[j].update_block(X.rightCols(11), Y.col(Index(j)).tail(11));
        own[j].merge(part[j]);
        EXPECT_EQ(Vector<double>(c.theta().col(Index(j))), Vector<double>(own[j].theta())) << j;
    }
    EXPECT_THROW(c.merge(Many(problem, 2)), std::invalid_argument);
    auto const bytes = state_of(c);
    Many d(problem, 3), other(problem, 4);
    EXPECT_EQ(load(d, std::span<std::byte const>(bytes)), StateFault::none);
    EXPECT_NE(load(other, std::span<std::byte const>(bytes)), StateFault::none);
    c.update_block(X, Y), d.update_block(X, Y);
    EXPECT_EQ(state_of(c), state_of(d));
}
/// Parts that do not determine theta together, and an output whose theta overflows.
TEST(Outputs, HaveAHealthThatIsTrueOfAllOfThem) {
    using Many = MultiOutput<QrBlock<double>>;
    Problem<double> const problem{.size = 5, .prior = std::nullopt};
    Seed seed{9};
    Matrix<double> const X = drawn(seed, 5, 6), Y = drawn(seed, 6, 2);
    Many a(problem, 2), b(problem, 2), empty(problem, 2);
    a.update_block(X.leftCols(2), Y.topRows(2)), b.update_block(X.middleCols(2, 2), Y.middleRows(2, 2));
    EXPECT_EQ(empty.merge(a), Health::undetermined);
    EXPECT_EQ(a.merge(b), Health::undetermined);
    EXPECT_EQ(a.merge(a), Health::undetermined);
    EXPECT_EQ(a.update_block(X, Y), Health::sound);
    Many far(Problem<double>{.size = 1, .prior = std::nullopt}, 3), newer = far;
    EXPECT_EQ(far.update_block(Matrix<double>::Constant(1, 1, 1e-3), Matrix<double>{{1.0, 2.0, 1e308}}),
              Health::nonfinite);
    EXPECT_EQ(newer.merge(far), Health::nonfinite);
    EXPECT_EQ(newer.update_block(Matrix<double>::Constant(1, 1, 1e-3), Matrix<double>{{1.0, 2.0, 1e300}}),
              Health::nonfinite);
}
/// lambda^k underflows: P is infinite, or negative, after a block that began well.
TEST(BlockGain, SaysWhatItLeavesOfP) {
    JosephRankTwo<float> f(Problem<float>{.size = 4, .forgetting = 0.9F, .prior = Prior<float>{.variance = 1024}});
    Seed seed{2};
    Matrix<float> const X = drawn<float>(seed, 4, 1000);
    BlockGain<float> gain;
    EXPECT_EQ(f.update_block(X, Vector<float>(X.row(0)), gain), Health::nonfinite);
}
TEST(Outputs, AreRefusedBeforeMemoryIsTaken) {
    using Many = MultiOutput<Ud<double>>;
#ifndef RLSLAB_SANITIZED  // which ends the program in place of std::bad_alloc
    EXPECT_THROW(Many({.size = 8}, Index(1) << 50), std::exception);
#endif
    EXPECT_THROW(Many({.size = 8}, std::numeric_limits<Index>::max()), std::exception);
    EXPECT_THROW((MultiOutput<Qr<double>>({.size = 8}, 2, MissingOutput::stands)), std::invalid_argument);
    Many from_elsewhere(Problem<double>{.size = 2, .prior = Prior<double>{.theta = Vector<double>::Ones(2)}}, 1);
    EXPECT_THROW(from_elsewhere.add_outputs(1), std::invalid_argument);
}

/// Rows that leave directions to the prior: a constant and 31 dummies. Errors of theta and of P in float.
template <class F>
std::array<double, 2> errors_on_dummies(double variance) {
    constexpr Index d = 32, k = 8;
    using Wide = Eigen::Matrix<long double, Dynamic, Dynamic>;
    MultiOutput<F> f(Problem<float>{.size = d, .prior = Prior<float>{.variance = float(variance)}}, 1);
    Wide H = Wide::Identity(d, d) / static_cast<long double>(variance), b = Wide::Zero(d, 1);
    Seed seed{3};
    for (Index block = 0; block < 16; ++block) {
        Matrix<float> X = Matrix<float>::Zero(d, k), Y(k, 1);
        for (Index j = 0; j < k; ++j) {
            Index const group = Index(seed.next() % (d - 1));
            X(0, j) = X(1 + group, j) = 1;
            Y(j, 0) = float(0.1 * double(group) + 1e-4 * seed.bell());
        }
        f.update_block(X, Y);
        H += X.cast<long double>() * X.transpose().cast<long double>();
        b += X.cast<long double>() * Y.cast<long double>();
    }
    Wide const right = H.ldlt().solve(b), P_right = H.ldlt().solve(Wide(Wide::Identity(d, d)));
    auto const stored = f.filter().stored();
    Wide P = Wide(stored.F.template cast<long double>());
    if (stored.form == Stored<float>::Form::factor) {
        Wide const L = P.triangularView<Eigen::Lower>();
        P = Wide(L * L.transpose()).ldlt().solve(Wide(Wide::Identity(d, d)));
    }
    Wide const theta = f.theta().template cast<long double>();
    return {double((theta - right).norm() / right.norm()), double((P - P_right).norm() / P_right.norm())};
}
TEST(Outputs, QrErrsAsTheRootOfTheConditionWhereThePriorIsNeeded) {
    double last = 0;
    for (double variance : {16.0, 1024.0, 65536.0, 4194304.0}) {
        auto const qr = errors_on_dummies<QrBlock<float>>(variance);
        double const root = 0x1p-24 * std::sqrt(128 * variance);  // u sqrt(|X|^2 / gamma)
        EXPECT_LE(qr[0], 4 * root) << variance;
        EXPECT_LE(qr[1], 4 * root) << variance;
        EXPECT_GT(qr[0], 2 * last) << variance;
        last = qr[0];
    }
    auto const joseph = errors_on_dummies<JosephRankTwo<float>>(65536), qr = errors_on_dummies<QrBlock<float>>(65536);
    EXPECT_GT(qr[0], 5 * joseph[0]);
    EXPECT_GT(qr[1], 5 * joseph[1]);
}

}  // namespace
}  // namespace rlslab
