// A symmetric matrix in blocks takes part in the operations of a square, number by number, with every instruction set;
// and `symmetric` on it is the recursion on a square, bit for bit.
#include "tests/common/each_isa.hpp"
#include "tests/common/on_a_square.hpp"
#include "tests/linalg/known_rows.hpp"

#include <rlslab/variants/symmetric.hpp>

#include <gtest/gtest.h>

namespace rlslab {
using namespace known_rows;
namespace {

using namespace kernels;

template <class T>
class Blocks : public testing::Test {};
using HardwareArithmetics = testing::Types<float, double>;
TYPED_TEST_SUITE(Blocks, HardwareArithmetics);

/// A symmetric square, two vectors along it, and the x of a product; what is padding is no number.
template <class T>
struct Operands {
    StateMatrix<T> A;
    StateVector<T> w, f, x;

    Operands(Index d, Kind kind, Seed seed) : A(d), w(d), f(d), x(d) {
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) A(i, j) = A(j, i) = number<T>(seed, kind);
        for (auto* v : {&w, &f}) {
            for (Index i = 0; i < d; ++i) (*v)[i] = number<T>(seed, kind);
            for (Index i = d; i < padded<T, Dynamic>(d); ++i) v->data()[i] = std::numeric_limits<T>::quiet_NaN();
        }
        for (Index i = 0; i < d; ++i) x[i] = number<T>(seed, kind);
    }
    std::vector<T> product(StateMatrix<T> const& by) const {
        std::vector<T> out;
        for (Index i = 0; i < by.size(); ++i) {
            T sum = by(i, 0) * x[0];
            for (Index j = 1; j < by.size(); ++j) sum += by(i, j) * x[j];
            out.push_back(sum);
        }
        return out;
    }
};
template <class T>
bool same(SymmetricMatrix<T> const& S, StateMatrix<T> const& A) {
    bool equal = true;
    for (Index j = 0; j < A.size(); ++j)
        for (Index i = 0; i < A.size(); ++i) equal = equal && known_rows::same(S(i, j), A(i, j));
    return equal;
}
template <class T>
std::vector<T> numbers(StateVector<T> const& x) {
    return {x.data(), x.data() + x.size()};
}

template <class T>
void check_kernels(Index d, Kind kind) {
    Operands<T> const o(d, kind, Seed{std::uint64_t(d)});
    T const correction = T(0.015625);
    StateMatrix<T> less = o.A, more = o.A;
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i <= j; ++i) {
            T const t = o.A(i, j) - o.w[i] * o.f[j], product = o.w[i] * o.w[j];
            less(i, j) = less(j, i) = t + t * correction;
            more(i, j) = more(j, i) = o.A(i, j) + product;
        }
    on_each_set<T>([&](char const* set, auto evaluate) {
        SCOPED_TRACE(std::string(set) + ", " + std::to_string(d) + " parameters");
        SymmetricMatrix<T> S(o.A);
        StateVector<T> out(d);
        ASSERT_TRUE(same(S, o.A));
        evaluate(OnBlocks<Multiply<T>>{{d, S.side, S.data(), out.data(), o.x.data()}});
        EXPECT_TRUE(known_rows::same(numbers(out), o.product(o.A))) << "Multiply";

        OnBlocks<SubtractRankOne<T>> const subtract{{d, S.side, S.data(), o.w.data(), o.f.data(), correction}};
        evaluate(subtract);
        EXPECT_TRUE(same(S, less)) << "SubtractRankOne";

        S = SymmetricMatrix<T>(o.A);
        evaluate(OnBlocks<AddSquare<T>>{{d, S.side, S.data(), o.w.data()}});
        EXPECT_TRUE(same(S, more)) << "AddSquare";
    });
}
TYPED_TEST(Blocks, TakePartInTheOperationsOfASquare) {
    for (Index d = 1; d <= 73; ++d)
        for (Kind kind : kinds) {
            check_kernels<TypeParam>(d, kind);
            if (testing::Test::HasFailure()) return;  // one size tells enough
        }
}

/// theta, P and the step after each row.
template <class T, int N>
void check_recursion(Index d, Index rows = 12) {
    for (Kind kind : kinds) {
        Problem<T> const problem{.size = d, .forgetting = T(0.984375)};
        twins::Rows const given = rows_of<T>(d, rows, kind, Seed{std::uint64_t(d)});
        auto const square = twins::trace(SymmetricOnASquare<T, N>(problem), given);
        twins::expect_one("in blocks", twins::trace(Symmetric<T, N>(problem), given), square);
    }
}
TYPED_TEST(Blocks, CarryTheRecursionOfASquare) {
    using T = TypeParam;
    on_each_isa([] {
        for (Index d : {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 23, 24, 25, 31, 32, 33, 64, 65, 127, 129})
            check_recursion<T, Dynamic>(d);
        [&]<int... N>(std::integer_sequence<int, N...>) {
            (check_recursion<T, N>(N), ...);
        }(std::integer_sequence<int, 2, 3, 4, 5, 8, 9, 17>{});
    });
}

TEST(Blocks, TakeHalfTheMemory) {
    EXPECT_EQ(SymmetricMatrix<double>(512).stored().size(), 512u * 520 / 2);
    EXPECT_EQ(SymmetricMatrix<double>(513).stored().size(), 520u * 528 / 2);
    EXPECT_LT(sizeof(Symmetric<double, 64>), sizeof(SymmetricOnASquare<double, 64>) * 6 / 10);
    EXPECT_EQ(sizeof(SymmetricMatrix<double, 4>), sizeof(StateMatrix<double, 4>));
}
TEST(Blocks, LeaveNothingToAFilterThatWasMovedFrom) {
    SymmetricMatrix<double> S(9);
    S(8, 1) = 3;
    EXPECT_EQ(S(1, 8), 3);
    SymmetricMatrix<double> const taken = std::move(S);
    EXPECT_EQ(taken(8, 1), 3);
    EXPECT_EQ(S.size(), 0);
}

}  // namespace
}  // namespace rlslab
