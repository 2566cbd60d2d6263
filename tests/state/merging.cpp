// The laws of merging: processing rows in separate filters and merging these gives what one filter gives. A saboteur
// forgets the weight.
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Exact in bfloat16, as lambda is.
Records const& some_rows() {
    static Records const records = as_stored(laws::noise_records(4, 60, Seed{41}),
                                             [](double x) { return static_cast<double>(Chopped<bfloat16>(x)); });
    return records;
}
template <class T>
Problem<T> some_problem(double lambda, bool prior) {
    return {
        .size = 4, .forgetting = T(lambda), .prior = prior ? std::optional(Prior<T>{.variance = T(16)}) : std::nullopt};
}
template <class F>
F part(Index first, Index last, double lambda, bool prior = false) {
    using T = typename F::scalar;
    F f(some_problem<T>(lambda, prior));
    if (first < last)
        f.update_block(some_rows().psi.middleCols(first, last - first).cast<T>(),
                       some_rows().y.segment(first, last - first).cast<T>());
    return f;
}
template <class F>
F sum(F f, F const& newer) {
    f.merge(newer);
    return f;
}

template <class T>
Vector<Reference> widened(Vector<T> const& x) {
    return x.unaryExpr([](T const& v) { return widen(v); });
}
double distance(Vector<Reference> const& a, Vector<Reference> const& b) {
    return laws::norm(Vector<Reference>(a - b)) / laws::norm(b);
}

/// |theta merged - theta of all rows in Reference| / |theta|, in epsilons: parts of 25, 1 and 34 rows.
template <class F>
double merging_error(double lambda, bool prior) {
    using T = typename F::scalar;
    F const merged = sum(sum(part<F>(0, 25, lambda, prior), part<F>(25, 26, lambda)), part<F>(26, 60, lambda));
    Vector<Reference> const exact = part<QrBlock<Reference>>(0, 60, lambda, prior).theta();
    return distance(widened(Vector<T>(merged.theta())), exact) / epsilon<T>();
}
/// |theta of (a + b) + c - theta of a + (b + c)| / |theta|, in epsilons.
template <class F>
double associativity_error(double lambda) {
    using T = typename F::scalar;
    F const a = part<F>(0, 20, lambda), b = part<F>(20, 40, lambda), c = part<F>(40, 60, lambda);
    Vector<T> const left = sum(sum(a, b), c).theta(), right = sum(a, sum(b, c)).theta();
    return distance(widened(left), widened(right)) / epsilon<T>();
}

/// The battery's budget of a solution; both sides of associativity have it.
constexpr double budget = 60;

TEST(Merging, PartsMergedAreTheRowsFoldedIn) {
    for_each(TypeList<double, float, long double, Quad, Chopped<binary16>, Chopped<bfloat16>>{}, []<class T>() {
        for (double lambda : {1.0, 0.96875}) {
            for (bool prior : {false, true}) EXPECT_LE(merging_error<QrBlock<T>>(lambda, prior), budget) << lambda;
            EXPECT_LE(associativity_error<QrBlock<T>>(lambda), 2 * budget) << lambda;
        }
    });
}

/// R'R = lambda^n R1'R1 + R2'R2 and R'z likewise: to 2^-220 of the largest number, as the identities of one update.
TEST(Merging, InformationAddsUpInReference) {
    using F = QrBlock<Reference>;
    for (double lambda : {1.0, 0.96875}) {
        F const older = part<F>(0, 20, lambda, true), newer = part<F>(20, 60, lambda);
        F const both = sum(older, newer);
        Reference const weight = pow(Reference(lambda), 40);
        Matrix<Reference> const X = older.information(), Y = newer.information();
        Matrix<Reference> const off = both.information() - Matrix<Reference>(weight * X + Y);
        Vector<Reference> const b = X.lazyProduct(older.theta()), c = Y.lazyProduct(newer.theta());
        Vector<Reference> const off_b =
            both.information().lazyProduct(both.theta()) - Vector<Reference>(weight * b + c);
        for (Index j = 0; j < 4; ++j) {
            EXPECT_LE(abs(off_b[j]), ldexp(Reference(1), -220) * abs(c[j])) << lambda;
            for (Index i = 0; i < 4; ++i) EXPECT_LE(abs(off(i, j)), ldexp(Reference(1), -220) * Y(i, i)) << lambda;
        }
        // The last row is the newer part's.
        EXPECT_LE(distance(both.gain(), part<F>(0, 60, lambda, true).gain()), 0x1p-220);
    }
}
TEST(Merging, AnEmptyPartChangesNoBit) {
    using F = QrBlock<double>;
    F const f = part<F>(0, 30, 0.96875, true), g = sum(f, part<F>(0, 0, 0.96875));
    EXPECT_EQ(f.stored().F, g.stored().F);
    EXPECT_EQ(f.theta(), g.theta());
    EXPECT_EQ(f.gain(), g.gain());
}
TEST(Merging, AFilterMergesWithItself) {
    using F = QrBlock<double>;
    F f = part<F>(0, 30, 0.96875), twice = f;
    F const copy = f;
    f.merge(f);
    twice.merge(copy);
    EXPECT_EQ(f.stored().F, twice.stored().F);
}
TEST(Merging, WhatIsNoPartOfTheProblemIsRefused) {
    using F = QrBlock<double>;
    F f = part<F>(0, 30, 0.96875, true);
    EXPECT_THROW(f.merge(part<F>(30, 60, 0.96875, true)), std::invalid_argument);  // the prior would count twice
    EXPECT_THROW(f.merge(part<F>(30, 60, 1)), std::invalid_argument);
    EXPECT_THROW(f.merge(F({.size = 3, .forgetting = 0.96875, .prior = std::nullopt})), std::invalid_argument);
}

/// What a merging that takes the newer R as rows like any other would do; with the weight it is QrBlock's.
template <bool forgets_the_weight>
class Saboteur {
    double lambda_;
    StateVector<double> z_;
    StateMatrix<double> L_;
    Index rows_ = 0;

public:
    using scalar = double;
    explicit Saboteur(Problem<double> const& p) : lambda_(p.forgetting), z_(p.size), L_(p.size) {
        start_information_root(p, L_, z_);
    }
    void update_block(Matrix<double> const& psi, Vector<double> const& y) {
        for (Index k = 0; k < y.size(); ++k) {
            Matrix<double> A(1, psi.rows() + 1);
            A << psi.col(k).transpose(), y[k];
            reflect_block_into(std::sqrt(lambda_), L_, z_, A);
        }
        rows_ += y.size();
    }
    void merge(Saboteur const& newer) {
        Matrix<double> A(z_.size(), z_.size() + 1);
        A << Matrix<double>(newer.L_.view().transpose()), newer.z_.view();
        reflect_block_into(forgets_the_weight ? 1.0 : detail::power(std::sqrt(lambda_), newer.rows_), L_, z_, A);
        rows_ += newer.rows_;
    }
    Vector<double> theta() const { return solved_lower_transposed(L_, z_); }
};
TEST(MergingSaboteur, IsCaughtAndItsHonestTwinPasses) {
    EXPECT_GT(merging_error<Saboteur<true>>(0.96875, false), 1000);
    EXPECT_GT(associativity_error<Saboteur<true>>(0.96875) + merging_error<Saboteur<true>>(0.96875, true), 1000);
    EXPECT_LE(merging_error<Saboteur<false>>(0.96875, false), budget);
    EXPECT_LE(associativity_error<Saboteur<false>>(0.96875), 2 * budget);
}

}  // namespace
}  // namespace rlslab
