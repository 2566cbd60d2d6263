// The proofs that theta and K are finite, without solving for them: never wrong, and sufficient for ordinary data.
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/linalg/finite.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <array>
#include <span>
#include <vector>

namespace rlslab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

template <class T>
StateVector<T> column(Vector<T> const& x) {
    StateVector<T> out(x.size());
    for (Index i = 0; i < x.size(); ++i) out[i] = x[i];
    return out;
}

/// Triangles, right-hand sides and psi = R'w, |w| < 1, of any scale: how many are proven to be solved in range, and how
/// many of these are not.
template <class T>
std::pair<int, int> proven_and_wrong(int cases, int lowest, int highest) {
    Seed seed{4};
    auto const scale = [&] { return std::ldexp(1.0, lowest + int(seed.next() % std::uint64_t(highest - lowest + 1))); };
    int proven = 0, wrong = 0;
    for (int n = 0; n < cases; ++n) {
        Index const d = Index(1 + seed.next() % 6);
        StateMatrix<T> L(d);
        StateVector<T> z(d), psi(d);
        double right = 0;
        double const of_z = scale();
        for (Index i = 0; i < d; ++i) {
            double const row = seed.next() % 2 ? scale() : 1;
            for (Index j = i; j < d; ++j) L(j, i) = T(seed.bell() * row);
            z[i] = T(seed.bell() * of_z);
            right += double(z[i]) * double(z[i]);
        }
        for (Index j = 0; j < d; ++j) {
            double sum = 0;
            for (Index i = 0; i <= j; ++i) sum += double(L(j, i)) * (seed.uniform() - 0.5) / double(d);
            psi[j] = T(sum);
        }
        auto const length = [&](Index j) {
            double sum = 0;
            for (Index i = 0; i <= j; ++i) sum += double(L(j, i)) * double(L(j, i));
            return sum;
        };
        if (!solved_in_range<T>(
                d, length, [&](Index j) { return double(L(j, j)) * double(L(j, j)); }, right))
            continue;
        ++proven;
        solve_lower_transposed(L, z);
        solve_outer(L, psi);
        wrong += !all_finite(z) || !all_finite(psi);
    }
    return {proven, wrong};
}

TEST(Finite, NothingIsProvenThatIsNotSo) {
    auto const check = []<class T>(T, int lowest, int highest) {
        auto const [proven, wrong] = proven_and_wrong<T>(20000, lowest, highest);
        EXPECT_EQ(wrong, 0) << ArithmeticTraits<T>::name << ", of " << proven;
        EXPECT_GT(proven, 500) << ArithmeticTraits<T>::name;  // of which there are enough to tell
        EXPECT_LT(proven, 19500) << ArithmeticTraits<T>::name;
    };
    check(Chopped<binary16>(0), -8, 8);
    check(Chopped<bfloat16>(0), -60, 60);
    check(0.0f, -60, 60);
    check(0.0, -500, 500);
}

/// Proven in every step but the first few: nobody pays for a solution that he did not ask for.
TEST(Finite, OrdinaryDataAreProven) {
    auto const unproven = []<class F>(Index d, double pole, F) {
        using T = typename F::scalar;
        F f(Problem<T>{.size = d, .forgetting = T(0.99)});
        Seed seed{5};
        Vector<T> psi = Vector<T>::Zero(d);
        int out = 0;
        double right = 0;
        for (int k = 0; k < 400; ++k) {
            for (Index i = d - 1; i > 0; --i) psi[i] = psi[i - 1];  // lags of one signal
            psi[0] = T(pole * double(psi[0]) + seed.bell());
            T const y = T(seed.bell());
            f.update(psi, y);
            right = 0.99 * right + double(y) * double(y);
            Matrix<T> const P_inverse = f.information();
            Stored<T> const R = f.stored();
            out += !solved_in_range<T>(
                d, [&](Index j) { return double(P_inverse(j, j)); },
                [&](Index j) { return double(R.F(j, j)) * double(R.F(j, j)); }, right);
        }
        return out;
    };
    Problem<double> const any{.size = 1};
    Problem<float> const any_float{.size = 1};
    for (double pole : {0.0, 0.9}) {
        for (Index d : {1, 4, 16, 64}) EXPECT_EQ(unproven(d, pole, Qr<double>(any)), 0) << d << ' ' << pole;
        for (Index d : {1, 4, 16}) EXPECT_EQ(unproven(d, pole, Qr<float>(any_float)), 0) << d << ' ' << pole;
    }
}

/// A square that overflows once was a step of gamma 0, theta 0, sound; the next had theta NaN, and was sound.
TEST(Finite, AnOverflowIsReportedAtOnce) {
    for (auto const& [arithmetic, large] :
         {std::pair{"double", 1e200}, std::pair{"binary16", 1024.0}, std::pair{"float", 1e30}})
        for (CatalogueEntry const& entry : catalogue()) {
            if (entry.arithmetic->name != arithmetic) continue;
            auto const f = entry.make(laws::problem(2), Seed{1});
            for (int k = 0; k < 3; ++k) {
                Health const health = f->update({k == 0 ? large : 1.0, k / 2.0}, 1).health;
                bool finite = true;
                for (Reference const& x : f->theta()) finite = finite && isfinite(x);
                for (Reference const& x : f->gain()) finite = finite && isfinite(x);
                EXPECT_TRUE(finite || health != Health::sound) << entry.variant << ' ' << arithmetic << ' ' << k;
                // Roots of the sums are within the range where the sums are not.
                bool const squares = entry.variant == "gentleman" || entry.variant == "cholesky_sparse" ||
                                     entry.variant == "conventional";
                if (squares && k == 0) {
                    EXPECT_EQ(name_of(health), "nonfinite") << entry.variant << ' ' << arithmetic;
                }
            }
        }
}

template <class F>
Health fed(Problem<typename F::scalar> const& problem, Eigen::MatrixXd const& psi, Vector<double> const& y) {
    F f(problem);
    return process(f, psi, y).health;
}
TEST(Finite, WhatIsFedInBlocksIsReported) {
    Records const records = laws::noise_records(3, 200, Seed{6});
    Problem<double> const p = laws::problem(3);
    EXPECT_EQ(name_of(fed<QrBlock<double>>(p, records.psi, records.y)), "sound");
    for (double bad : {nan, infinity}) {
        for (Index k : {0, 63, 64, 199}) {  // in the first, in the last block, at their edges
            Eigen::MatrixXd psi = records.psi;
            psi(1, k) = bad;
            EXPECT_EQ(name_of(fed<QrBlock<double>>(p, psi, records.y)), "nonfinite") << k;
            Vector<double> y = records.y;
            y[k] = bad;
            EXPECT_EQ(name_of(fed<QrBlock<double>>(p, records.psi, y)), "nonfinite") << k;
        }
        // A row of zeros lets nothing of its y into theta; it is reported all the same.
        EXPECT_EQ(name_of(fed<QrBlock<double>>(p, Eigen::MatrixXd::Zero(3, 2), Vector<double>{{1, bad}})), "nonfinite");
    }
    Problem<double> no_prior = p;
    no_prior.prior.reset();
    EXPECT_EQ(name_of(fed<QrBlock<double>>(no_prior, records.psi.leftCols(2), records.y.head(2))), "undetermined");
    EXPECT_EQ(name_of(fed<QrBlock<double>>(no_prior, records.psi.leftCols(4), records.y.head(4))), "sound");
    EXPECT_EQ(name_of(fed<Information<double>>(no_prior, records.psi.leftCols(2), records.y.head(2))), "undetermined");
}

// The types that an update accepts as a regressor. It must not accept numbers that do not lie one after another in
// memory.
using Eigen::Map, Eigen::Ref, Eigen::VectorXd, Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Dynamic, Dynamic, Eigen::RowMajor>;
using EveryOther = Map<VectorXd const, 0, Eigen::InnerStride<2>>;
using AnyStride = Map<VectorXd const, 0, Eigen::InnerStride<>>;

template <class X>
concept Taken = requires(Ud<double>& f, X const& x) { f.update(x, 1.0); };
template <class X>
concept TakenInFloat = requires(Ud<float>& f, X const& x) { f.update(x, 1.0f); };

static_assert(Taken<VectorXd> && Taken<Eigen::Vector2d> && Taken<Eigen::RowVectorXd> && Taken<Eigen::ArrayXd>);
static_assert(Taken<Map<VectorXd const>> && Taken<Ref<VectorXd>> && Taken<Ref<VectorXd const>>);
static_assert(Taken<MatrixXd::ColXpr> && Taken<MatrixXd::ConstColXpr> && Taken<RowMajor::RowXpr> &&
              Taken<VectorXd::SegmentReturnType>);
static_assert(Taken<Eigen::Transpose<VectorXd>>);
static_assert(Taken<std::vector<double>> && Taken<std::array<double, 2>> && Taken<std::span<double>> &&
              Taken<std::span<double const, 2>>);
static_assert(Taken<double[2]>);

// A row of a matrix by columns learned wrong numbers and called every step sound.
static_assert(!Taken<MatrixXd::RowXpr> && !Taken<MatrixXd::ConstRowXpr> && !Taken<Eigen::Matrix2d::RowXpr> &&
              !Taken<RowMajor::ColXpr>);
static_assert(!Taken<EveryOther> && !Taken<AnyStride> && !Taken<Eigen::Reverse<VectorXd, Eigen::Vertical>>);
static_assert(!Taken<Eigen::Diagonal<MatrixXd>> && !Taken<Ref<VectorXd, 0, Eigen::InnerStride<>>>);
// Nor expressions, which have no numbers yet, nor whole matrices, nor numbers of another arithmetic.
static_assert(!Taken<decltype(2 * std::declval<VectorXd const&>())> && !Taken<MatrixXd> && !Taken<Map<MatrixXd const>>);
static_assert(!Taken<Eigen::VectorXf> && !Taken<std::vector<float>> && !Taken<std::vector<int>> &&
              !Taken<Eigen::VectorXi>);
static_assert(TakenInFloat<std::vector<float>> && !TakenInFloat<std::vector<double>> && !TakenInFloat<VectorXd>);

// A pointer and a size; a zero is no pointer, and a pointer to other numbers none of ours.
static_assert(std::constructible_from<Regressor<double>, double*, int> &&
              std::constructible_from<Regressor<double>, double const*, Index>);
static_assert(!std::constructible_from<Regressor<double>, int, int> &&
              !std::constructible_from<Regressor<double>, std::nullptr_t, int>);
static_assert(!std::constructible_from<Regressor<double>, float const*, int>);

/// y = 3 x1 + 2 x2 without noise, from the rows of X as `row` hands them on.
template <class Row>
VectorXd learned(MatrixXd const& X, Row row) {
    Ud<double> f({.size = 2, .prior = Prior<double>{.variance = 1e9}});
    for (Index k = 0; k < X.rows(); ++k) row(f, k, 3 * X(k, 0) + 2 * X(k, 1));
    return f.theta();
}

TEST(Regressor, EveryFormOfARowLearnsTheSameNumbers) {
    Seed seed{3};
    MatrixXd const X = MatrixXd::NullaryExpr(20, 2, [&seed] { return seed.bell(); });
    RowMajor const by_rows = X;
    VectorXd const theta =
        learned(X, [&](auto& f, Index k, double y) { f.update(Eigen::Vector2d(X(k, 0), X(k, 1)), y); });
    EXPECT_NEAR(theta[0], 3, 1e-7);
    EXPECT_NEAR(theta[1], 2, 1e-7);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(X.row(k).eval(), y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(VectorXd(X.row(k)), y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(by_rows.row(k), y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(MatrixXd(X.transpose()).col(k), y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(std::vector{X(k, 0), X(k, 1)}, y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update(std::array{X(k, 0), X(k, 1)}, y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update({X(k, 0), X(k, 1)}, y); }), theta);
    EXPECT_EQ(learned(X, [&](auto& f, Index k, double y) { f.update({&by_rows(k, 0), 2}, y); }), theta);
}
/// The zero was once a null pointer that the update read from.
TEST(Regressor, NumbersInBracesAreNumbers) {
    Ud<double> f({.size = 2});
    f.update({0, 2}, 6);
    EXPECT_EQ(f.theta()[0], 0);
    EXPECT_NEAR(f.theta()[1], 3, 1e-3);
    using Half = Chopped<binary16>;
    Qr<Half> short_word({.size = 2});
    EXPECT_EQ(name_of(short_word.update({Half(0), Half(2)}, Half(6)).health), "sound");
}
TEST(Regressor, AnotherSizeIsRefusedBeforeItIsRead) {
    for (CatalogueEntry const& entry : catalogue()) {
        auto const f = entry.make(laws::problem(3), Seed{1}), untouched = f->clone();
        for (Index size : {0, 1, 2, 4, 100}) {
            std::vector<double> const psi(size_t(size), 1.0);
            EXPECT_THROW(f->update(psi, 1), std::invalid_argument) << entry.variant << ' ' << size;
        }
        EXPECT_TRUE(laws::identical(f->theta(), untouched->theta()))
            << entry.variant << ": the refused row left something";
    }
}

}  // namespace
}  // namespace rlslab
