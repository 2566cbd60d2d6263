// Each dense kernel leaves the same bits with the registers of every instruction set that this machine has as in the
// text for single rows, at every size up to 130 and for special values, whichever of them dispatch.hpp would choose.
#include "tests/linalg/known_rows.hpp"

#include <rlslab/linalg/kernels.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace kernels;

/// What the numbers are: ordinary; with zeros of both signs and of every magnitude; with infinities and NaN besides.
enum class Kind { ordinary, scaled, special };

template <class T>
T number(Seed& seed, Kind kind) {
    T const x = T(seed.bell());
    auto const chance = seed.next() % 16;
    if (kind == Kind::ordinary) return x;
    if (chance == 0) return T(0);
    if (chance == 1) return -T(0);
    if (chance < 6)
        return std::ldexp(x, int(seed.next() % 600) * (sizeof(T) == 8 ? 3 : 1) / 3 - (sizeof(T) == 8 ? 300 : 100));
    if (chance == 6) return std::numeric_limits<T>::denorm_min() * T(1 + seed.next() % 9);
    if (kind == Kind::special && seed.next() % 64 == 0) {
        T const bad[] = {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                         std::numeric_limits<T>::quiet_NaN()};
        return bad[seed.next() % 3];
    }
    return x;
}

/// Which numbers of the matrix a kernel reads and leaves defined.
enum class Part { full, symmetric, upper, lower };

/// The operands of a kernel, padded, with numbers behind each end that no result may depend on.
template <class T>
struct Operands {
    Index d, ld;
    Part part;
    std::vector<T, detail::Aligned<T>> A, B, v[8];
    T scalar, sum;
    bool flag = false;
    int overwritten = -1;  // the v that the kernel leaves undefined

    Operands(Index size, Part p, Kind kind, Seed seed)
        : d(size), ld(column_stride<T, Dynamic>(size)), part(p), A(size_t(ld * d)), B(A) {
        for (T& x : A) x = number<T>(seed, kind);
        for (T& x : B) x = number<T>(seed, kind);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < ld; ++i) {
                if (part == Part::upper && i > j) A[size_t(j * ld + i)] = T(0);
                if (part == Part::symmetric && i < j) A[size_t(j * ld + i)] = A[size_t(i * ld + j)];
            }
        for (auto& column : v) {
            column.resize(size_t(ld));
            for (T& x : column) x = number<T>(seed, kind);
        }
        scalar = number<T>(seed, Kind::ordinary);
        sum = std::abs(number<T>(seed, Kind::ordinary));
    }
    std::vector<T> results() const {
        std::vector<T> out{sum, T(flag)};
        for (int i = 0; i < 8; ++i)
            if (i != overwritten) out.insert(out.end(), v[i].begin(), v[i].begin() + d);
        for (Index j = 0; j < d; ++j)
            for (Index i = part == Part::lower ? j : 0; i < (part == Part::upper ? j + 1 : d); ++i)
                out.push_back(A[size_t(j * ld + i)]);
        return out;
    }
};

/// run(kernel) on a copy of the operands from which make(operands) takes the kernel.
template <class T, class Make, class Run>
std::vector<T> after(Operands<T> operands, Make make, Run run) {
    auto const kernel = make(operands);
    run(kernel);
    return operands.results();
}

/// The text for fixed sizes, of the operands' size; false where there is none.
template <class T, class Kernel, int... N>
bool run_small(Kernel const& kernel, std::integer_sequence<int, N...>) {
    if constexpr (requires { portable::evaluate_small<1, T>(kernel); })
        return ((kernel.d == N + 1 && (portable::evaluate_small<N + 1, T>(kernel), true)) || ...);
    return false;
}

/// With infinities the registers are compared with one another alone: in a triangle, the zeros beside the diagonal
/// times an infinity are NaN, which single rows never compute. (The filter is broken down then, and says so.)
template <class T, class Make>
void check_one(char const* name, Operands<T> const& operands, Kind kind, Make make) {
    std::vector<T> narrow;
    auto const same = [&](char const* set, std::vector<T> const& other) {
        long const at = difference(narrow, other);
        EXPECT_EQ(at, -1) << name << " on " << set << ", " << operands.d
                          << " parameters: " << narrow[size_t(std::max(at, 0L))] << " and "
                          << other[size_t(std::max(at, 0L))];
    };
    known_rows::on_each_set<T>([&](char const* set, auto evaluate) {
        auto const found = after(operands, make, evaluate);
        if (narrow.empty()) narrow = found;
        else same(set, found);
    });
    using Kernel = decltype(make(std::declval<Operands<T>&>()));
    if constexpr (requires(Kernel k) { portable::evaluate<portable::Any<Kernel, T>>(k); })
        if (kind != Kind::special)
            same("single rows",
                 after(operands, make, [](auto const& k) { portable::evaluate<portable::Any<Kernel, T>>(k); }));
    if constexpr (requires(Kernel k) { portable::evaluate_small<1, T>(k); })
        if (operands.d <= small_up_to && (kind != Kind::special || !UpperSweep<Kernel>))
            same("the text for fixed sizes", after(operands, make, [](auto const& k) {
                     EXPECT_TRUE(run_small<T>(k, std::make_integer_sequence<int, small_up_to>()));
                 }));
}

/// make(operands) where a sweep goes through its matrix the other way: each remainder of a group of columns, and of a
/// block of rows.
template <class T, class Make>
void check_large(char const* name, Part part, Make make) {
    using K = decltype(make(std::declval<Operands<T>&>()));
    for (Index from : {by_columns_from<K>.from, by_columns_from<K>.from_on_wide})
        for (Index more : {0, 1, 2, 4, 11, 13, 14, 23})
            for (Kind kind : {Kind::scaled, Kind::special})
                if (from != never)
                    check_one(name, Operands<T>(from + more, part, kind, Seed{std::uint64_t(from + more)}), kind, make);
}

/// make(operands) at every size, with numbers of every kind.
template <class T, class Make>
void check(char const* name, Part part, Make make, Index cubic_up_to = 130) {
    for (Index d = 1; d <= 130; ++d) {
        if (d > cubic_up_to && d != 64 && d < 129) continue;
        for (Kind kind : {Kind::ordinary, Kind::scaled, Kind::special})
            check_one(name, Operands<T>(d, part, kind, Seed{std::uint64_t(d)}), kind, make);
        if (testing::Test::HasFailure()) return;  // one size tells enough
    }
}

template <class T>
class KernelBits : public testing::Test {};
using HardwareArithmetics = testing::Types<float, double>;
TYPED_TEST_SUITE(KernelBits, HardwareArithmetics);

TYPED_TEST(KernelBits, OfElementwiseKernelsAreTheSame) {
    using T = TypeParam;
    using O = Operands<T>;
    auto const over = [](O& o) { return OverColumn<T>{o.d, o.v[0].data(), o.v[1].data()}; };
    check<T>("DivideByOne", Part::full, [=](O& o) { return DivideByOne<T>{over(o), o.scalar}; });
    check<T>("Divide", Part::full, [=](O& o) { return Divide<T>{over(o), o.v[2].data()}; });
    check<T>("Scale", Part::full, [=](O& o) { return Scale<T>{over(o), o.v[2].data()}; });
    check<T>("SquareRoots", Part::full, [=](O& o) { return SquareRoots<T>{over(o)}; });
    check<T>("AddScaled", Part::full, [=](O& o) { return AddScaled<T>{over(o), o.v[2].data(), o.scalar}; });
    check<T>("ScaleByOne", Part::full, [=](O& o) { return ScaleByOne<T>{over(o), o.scalar}; });
    check<T>("Add", Part::full, [=](O& o) { return Add<T>{over(o), o.v[2].data()}; });
    check<T>("AddProduct", Part::full, [=](O& o) { return AddProduct<T>{over(o), o.v[2].data(), o.v[3].data()}; });
    check<T>("PrefixSums", Part::full, [=](O& o) { return PrefixSums<T>{over(o), o.v[2].data(), &o.sum}; });
    check<T>("AllFinite", Part::full, [=](O& o) { return AllFinite<T>{over(o), &o.flag}; });
}

TYPED_TEST(KernelBits, OfProductsAreTheSame) {
    using T = TypeParam;
    using O = Operands<T>;
    check<T>("MultiplyTransposed", Part::full, [](O& o) {
        return MultiplyTransposed<T, Shape::full>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data()};
    });
    check<T>("MultiplyTransposed, upper", Part::upper, [](O& o) {
        return MultiplyTransposed<T, Shape::upper>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data()};
    });
    check<T>(
        "MultiplySquares", Part::full,
        [](O& o) { return MultiplySquares<T>{o.d, o.ld, o.B.data(), o.B.data(), o.ld, 1, o.A.data()}; }, 33);
}

/// check_sweep(name, part, make) for each sweep.
template <class T, class Check>
void each_sweep(Check check_sweep) {
    using O = Operands<T>;
    auto const rank_one = [](O& o) {
        return SubtractRankOne<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data(), o.scalar};
    };
    auto const over = [](O& o) { return OverTriangle<T>{o.d, o.ld, o.A.data(), o.v[0].data()}; };
    auto const ud = [=](O& o) { return SweepUd<T>{over(o), o.v[1].data(), o.v[2].data()}; };
    auto const carlson = [=](O& o) {
        return SweepCarlson<T>{over(o), o.v[1].data(), o.v[2].data(), o.v[3].data(), o.scalar};
    };
    auto const rotations = [=](O& o) {
        for (T& c : o.v[1]) c = std::abs(c);  // as cosines are here
        return SweepRotations<T>{over(o), o.v[1].data(), o.v[2].data(), o.scalar};
    };
    auto const carlson_delta = [=](O& o) {
        return SweepCarlsonDelta<T>{over(o), o.v[1].data(), o.v[2].data(), o.v[3].data(), o.v[4].data()};
    };
    auto const rotations_delta = [=](O& o) {
        for (T& c : o.v[1]) c = std::abs(c);
        return SweepRotationsDelta<T>{over(o),       o.v[1].data(), o.v[2].data(),
                                      o.v[3].data(), o.v[4].data(), o.v[5].data()};
    };
    auto const multiplied = [](auto make) {
        return [=](O& o) { return ThenMultiply<decltype(make(o))>{make(o), o.v[4].data(), o.v[5].data()}; };
    };
    check_sweep("Multiply", Part::full, [](O& o) {
        return Multiply<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data()};
    });
    check_sweep("SubtractRankOne", Part::full, rank_one);
    check_sweep("SubtractRankOne and the product", Part::full, multiplied(rank_one));
    check_sweep("AddSquare", Part::full, [](O& o) { return AddSquare<T>{o.d, o.ld, o.A.data(), o.v[0].data()}; });
    check_sweep("SubtractRankTwo", Part::symmetric,
                [](O& o) { return SubtractRankTwo<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data(), o.scalar}; });
    check_sweep("SweepUd", Part::upper, ud);
    check_sweep("SweepUd and the product", Part::upper, multiplied(ud));
    check_sweep("SweepCarlson", Part::upper, carlson);
    check_sweep("SweepCarlson and the product", Part::upper, multiplied(carlson));
    check_sweep("SweepRotations", Part::upper, rotations);
    check_sweep("SweepRotations and the product", Part::upper, multiplied(rotations));
    check_sweep("SweepCarlsonDelta", Part::upper, carlson_delta);
    check_sweep("SweepRotationsDelta", Part::upper, rotations_delta);
}
TYPED_TEST(KernelBits, OfSweepsAreTheSame) {
    each_sweep<TypeParam>([](char const* name, Part part, auto make) { check<TypeParam>(name, part, make); });
}
TYPED_TEST(KernelBits, OfSweepsAreTheSameBothWaysThroughLargeMatrices) {
    each_sweep<TypeParam>([](char const* name, Part part, auto make) { check_large<TypeParam>(name, part, make); });
}

TYPED_TEST(KernelBits, OfLowerTrianglesAreTheSame) {
    using T = TypeParam;
    using O = Operands<T>;
    check<T>("Eliminate", Part::lower, [](O& o) { return Eliminate<T>{o.d, o.ld, o.A.data(), o.v[0].data()}; });
    check<T>("SolveLower", Part::lower, [](O& o) { return SolveLower<T>{o.d, o.ld, o.A.data(), o.v[0].data()}; });
    check<T>("RotateOut", Part::lower, [](O& o) {
        for (T& c : o.v[0]) c = std::abs(c);  // as cosines are here
        for (Index j = 0; j < o.d; ++j) std::fill_n(o.A.begin() + j * o.ld, j, T(0));
        return RotateOut<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data()};
    });
    check<T>("SweepGentleman", Part::lower, [](O& o) {
        o.overwritten = 0;
        return SweepGentleman<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data(), o.v[2].data(), o.v[3].data()};
    });
    auto const fold = [](O& o) {
        for (T& D : o.v[2]) D = std::abs(D);
        o.sum = T(1);
        return FoldGentleman<T>{o.d,           o.ld,          o.A.data(),    o.v[0].data(), o.v[1].data(), &o.scalar,
                                o.v[2].data(), o.v[3].data(), o.v[4].data(), &o.sum,        T(0.984375)};
    };
    for (Index d = 1; d <= 130; ++d)  // (tests/linalg/kernels.cpp compares it with the formulas)
        check_one("FoldGentleman", Operands<T>(d, Part::lower, Kind::scaled, Seed{std::uint64_t(d)}), Kind::scaled,
                  fold);
    check<T>("RotateIn", Part::lower, [](O& o) {
        return RotateIn<T>{o.d,    o.ld,          o.A.data(),    o.v[0].data(),     o.v[1].data(),
                           &o.sum, o.v[2].data(), o.v[3].data(), std::abs(o.scalar)};
    });
    check<T>("ReflectIn", Part::lower, [](O& o) {
        return ReflectIn<T>{o.d,    o.ld,          o.A.data(),      o.v[0].data(),     o.v[1].data(),
                            &o.sum, o.v[2].data(), &o.v[3].front(), std::abs(o.scalar)};
    });
}

TYPED_TEST(KernelBits, OfReflectionsAreTheSame) {
    using T = TypeParam;
    using O = Operands<T>;
    check<T>("SumOfSquares", Part::full, [](O& o) { return SumOfSquares<T>{o.d, o.v[0].data(), &o.sum}; });
    check<T>("Division", Part::full, [](O& o) { return Division<T>{o.d, o.v[0].data(), o.scalar}; });
    check<T>("Reflection", Part::full, [](O& o) {  // columns without padding: as many as there are numbers for
        return Reflection<T>{o.d, o.d, o.d, o.v[0].data(), o.scalar, o.A.data(), o.v[1].data(), &o.sum};
    });
}

/// A panel's operands, as ReflectPanel wants them: numbers in range, some columns zeros of either sign, some those of
/// others, R above A, and what is behind A's rows zero.
template <class T>
struct PanelOperands {
    Index rows, columns, ld;
    std::vector<T, detail::Aligned<T>> A, above, last, V;

    PanelOperands(Index rows_of, Index columns_of, Seed seed)
        : rows(rows_of), columns(columns_of), ld(column_stride<T, Dynamic>(rows)), A(size_t(ld * columns)),
          above(size_t(8 * columns)), last(8), V(size_t(8 * padded<T, Dynamic>(rows) + 64)) {
        int const span = sizeof(T) == 8 ? 400 : 16, kind = int(seed.next() % 4);
        int const scale = kind == 0 ? 0 : int(seed.next() % std::uint64_t(2 * span)) - span;
        auto const number = [&](int exponent) {
            auto const chance = seed.next() % 16;
            if (chance < 2 && kind != 0) return chance == 0 ? T(0) : -T(0);
            return std::ldexp(T(seed.bell()), exponent - (kind == 3 && chance < 6 ? int(seed.next() % 40) : 0));
        };
        for (Index j = 0; j < columns; ++j) {
            int const exponent = kind < 2 ? scale : int(seed.next() % std::uint64_t(2 * span)) - span;
            auto const how = kind == 0 ? 9 : seed.next() % 10;
            for (Index k = 0; k < rows; ++k) {
                T& a = A[size_t(j * ld + k)];
                a = how == 0            ? (k % 2 ? T(0) : -T(0))
                    : how == 1 && j > 0 ? A[size_t((j - 1) * ld + k)]
                                        : number(exponent);
            }
            for (Index q = 0; q < 8; ++q) above[size_t(q * columns + j)] = how == 0 ? -T(0) : number(exponent);
        }
        for (T& z : last) z = number(0);
    }
    ReflectPanel<T> panel() { return {rows, columns, ld, A.data(), above.data(), columns, last.data(), V.data()}; }
    /// What is defined afterwards: R, and the columns that are not pivots.
    std::vector<T> results() const {
        std::vector<T> out(last.begin(), last.begin() + std::min<Index>(8, columns - 1));
        for (Index q = 0; q < std::min<Index>(8, columns - 1); ++q)
            for (Index j = q; j + 1 < columns; ++j) out.push_back(above[size_t(q * columns + j)]);
        for (Index j = 0; j < columns; ++j)
            for (Index k = 0; k < rows; ++k) out.push_back(A[size_t(j * ld + k)]);
        return out;
    }
};
template <class T>
long panel_difference(Index rows, Index columns, Seed seed, auto run) {
    PanelOperands<T> plain(rows, columns, seed), other = plain;
    portable::evaluate<portable::Any<ReflectPanel<T>, T>>(plain.panel());
    run(other.panel());
    return difference(plain.results(), other.results());
}
TYPED_TEST(KernelBits, OfPanelsAreTheSameAsOfTheTextForOneNumberAtATime) {
    using T = TypeParam;
    Seed seed{11};
    for (int trial = 0; trial < 12500; ++trial) {
        Index const rows = trial % 4 ? 1 + Index(seed.next() % 40) : 250 + Index(seed.next() % 10),
                    columns = trial % 4 ? 2 + trial % 33 : 2 + Index(seed.next() % 60);
        Seed const of{seed.next()};
        on_each_isa([&] {
            long const at = panel_difference<T>(rows, columns, of, [](auto const& k) { run_kernel<T, Dynamic>(k); });
            ASSERT_EQ(at, -1) << rows << " rows, " << columns << " columns on " << name_of(isa);
        });
        long const narrow = panel_difference<T>(rows, columns, of,
                                                [](auto const& k) { portable::evaluate<portable::Packed<T, 16>>(k); });
        ASSERT_EQ(narrow, -1) << rows << " rows, " << columns << " columns";
    }
}
/// Saboteurs: a product of columns behind the panel in eight lanes, and rows behind the last that are not zero.
TYPED_TEST(KernelBits, OfPanelsDifferIfSumsGoInAnotherOrderOrReachTooFar) {
    using T = TypeParam;
    auto const in_another_order = [](ReflectPanel<T> k) {  // nine columns behind: one by one they go in eight lanes
        std::vector<T, detail::Aligned<T>> A(k.A, k.A + k.ld * k.columns), above(k.above, k.above + 8 * k.ld_above),
            last(k.last, k.last + 8);
        for (Index j = 8; j < k.columns; ++j) {
            PanelOperands<T> one(k.rows, 9, Seed{1});
            std::copy_n(A.data(), 8 * k.ld, one.A.data());
            std::copy_n(A.data() + j * k.ld, k.ld, one.A.data() + 8 * k.ld);
            for (Index q = 0; q < 8; ++q) {
                for (Index i = 0; i < 8; ++i) one.above[size_t(q * 9 + i)] = above[size_t(q * k.ld_above + i)];
                one.last[size_t(q)] = j + 1 < k.columns ? above[size_t(q * k.ld_above + j)] : last[size_t(q)];
            }
            portable::evaluate<portable::Packed<T, 16>>(one.panel());
            std::copy_n(one.A.data() + 8 * k.ld, k.ld, k.A + j * k.ld);
        }
    };
    EXPECT_NE(panel_difference<T>(64, 18, Seed{3}, in_another_order), -1);
    auto const too_far = [](ReflectPanel<T> const& k) {
        k.A[k.rows] = T(1);
        portable::evaluate<portable::Packed<T, 16>>(k);
    };
    EXPECT_NE(panel_difference<T>(61, 18, Seed{3}, too_far), -1);
}

/// Two saboteurs: lanes added from the first to the last, and a product that is not rounded before it is subtracted.
template <class T>
struct FirstToLast : portable::SimdBlock<T, 16> {
    static void sums(FirstToLast (&a)[4], T* out) {
        for (int c = 0; c < 4; ++c) {
            T lane[8], sum = T(0);
            a[c].store(lane);
            for (T const& x : lane) sum += x;
            out[c] = sum;
        }
    }
};
template <class T>
struct Fused : portable::SimdBlock<T, 16> {
    void subtract_product(Fused const& a, T b) {
        T x[8], y[8];
        this->store(x), a.store(y);
        for (int i = 0; i < 8; ++i) x[i] = std::fma(-y[i], b, x[i]);
        this->load(x);
    }
};

TYPED_TEST(KernelBits, DifferIfLanesAreAddedInAnotherOrderOrAProductIsFused) {
    using T = TypeParam;
    using O = Operands<T>;
    O const operands(21, Part::full, Kind::ordinary, Seed{1});
    auto const differs = [&](auto make, auto run) {
        auto const right = [](auto const& k) { portable::evaluate<portable::SimdBlock<T, 16>>(k); };
        return difference(after(operands, make, right), after(operands, make, run)) != -1;
    };
    EXPECT_TRUE(differs(
        [](O& o) {
            return MultiplyTransposed<T, Shape::full>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data()};
        },
        [](auto const& k) { portable::evaluate<FirstToLast<T>>(k); }));
    EXPECT_TRUE(
        differs([](O& o) { return SubtractRankOne<T>{o.d, o.ld, o.A.data(), o.v[0].data(), o.v[1].data(), o.scalar}; },
                [](auto const& k) { portable::evaluate<Fused<T>>(k); }));
}

}  // namespace
}  // namespace rlslab
