// The types that an update accepts as a regressor. It must not accept numbers that do not lie one after another in
// memory.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <array>
#include <span>
#include <vector>

namespace rlslab {
namespace {

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
