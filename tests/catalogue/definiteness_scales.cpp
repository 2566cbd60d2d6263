// The quick proof about a stored P and the exact decision agree in every arithmetic, at every scale that it has.
#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/catalogue/erase.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// A filter that holds what it was given, and shows it in double by `shown`.
template <class T>
struct Holds final : AnyFilter {
    using Shown = Stored<double>(Stored<T> const&);
    Stored<T> held;
    Shown* shown;
    Holds(Stored<T> stored, Shown* in_double) : held(std::move(stored)), shown(in_double) {}
    Step<double> take(Regressor<double>, double, Matrix<double> const*) override {
        throw std::logic_error("not asked");
    }
    Step<double> update_block(Records const&, Index, Index) override { throw std::logic_error("not asked"); }
    Report report(Number what) const override {
        if (what == Number::stored) return held.template mapped<Reference>(&widened<T>);
        if (what == Number::stored_in_double) return shown(held);
        return Vector<Reference>();
    }
    std::unique_ptr<AnyFilter> clone() const override { return nullptr; }
    std::vector<std::byte> saved() const override { return {}; }
    void load(std::span<std::byte const>) override { throw std::logic_error("not asked"); }
};

/// x 2^e by steps that every arithmetic has.
template <class T>
T times_power(T x, int e) {
    for (; e > 0; e -= std::min(e, 10)) x *= T(std::ldexp(1.0, std::min(e, 10)));
    for (; e < 0; e += std::min(-e, 10)) x *= T(std::ldexp(1.0, -std::min(-e, 10)));
    return x;
}

int whole(Seed& seed, int least, int most) { return least + int(seed.next() % std::uint64_t(most - least + 1)); }

/// Small integers times powers of two along rows and columns: singular where `singular` (until a scale underflows), in
/// parts a triangle, in parts one but for an entry.
template <class T>
Stored<T> random_stored(Seed& seed) {
    using Quantity = typename Stored<T>::Quantity;
    using Form = typename Stored<T>::Form;
    constexpr int scales[] = {0, 12, 400, 1500, 3000};
    Index const d = whole(seed, 1, 4);
    int const scale = scales[whole(seed, 0, 4)];
    bool const plain = whole(seed, 0, 1) == 0, singular = whole(seed, 0, 1) == 0, triangle = whole(seed, 0, 1) == 0;
    Matrix<double> B(d, d);
    for (double& b : B.reshaped()) b = whole(seed, -3, 3);
    if (triangle) B = Matrix<double>(B.triangularView<Eigen::Upper>());
    if (singular) B.col(whole(seed, 0, int(d) - 1)) = -B.col(whole(seed, 0, int(d) - 1));
    if (plain) B = Matrix<double>(B * B.transpose());
    std::vector<int> rows, columns;
    bool const graded = !plain && whole(seed, 0, 1) == 0;  // small below the diagonal, large above it
    int const grade = whole(seed, 0, std::min(scale, 1000)), all = whole(seed, -200, 100);
    for (int i = 0; i < d; ++i) {
        rows.push_back(graded ? all - i * grade : whole(seed, -scale, scale) / 2);
        columns.push_back(graded ? i * grade : whole(seed, -scale, scale) / 2);
    }
    Stored<T> out{whole(seed, 0, 1) == 0 ? Quantity::covariance : Quantity::information,
                  plain ? Form::plain : Form::factor, Matrix<T>(d, d)};
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i)
            out.F(i, j) = times_power(T(B(i, j)), rows[size_t(i)] + (plain ? rows : columns)[size_t(j)]);
    if (!plain && whole(seed, 0, 1) == 0) {
        out.D.resize(d);
        for (T& x : out.D) x = times_power(T(double(whole(seed, 0, 20) - 1)), whole(seed, -scale, scale));
    }
    return out;
}

struct Found {
    int quick = 0, positive = 0, wrong = 0;
};
template <class T>
Found over_random(int trials, typename Holds<T>::Shown* shown) {
    Found found;
    Seed seed{12}, draws{1};
    RoundingSeedScope<T> const rounding(draws);
    Arithmetic const arithmetic = arithmetic_of<T>();
    for (int k = 0; k < trials; ++k) {
        Holds<T> const filter(random_stored<T>(seed), shown);
        Health const exact = definiteness(filter.stored());
        found.quick += surely_positive(filter.stored_in_double(), arithmetic.digits > 53 ? 0x1p-53 : 0);
        found.positive += exact == Health::sound;
        found.wrong += breakdown(filter, arithmetic) != exact;
    }
    return found;
}

template <class T>
struct QuickLook : testing::Test {};
template <class Tuple>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
    using type = testing::Types<T...>;
};
TYPED_TEST_SUITE(QuickLook, TypesOf<Arithmetics>::type);

TYPED_TEST(QuickLook, NeverContradictsTheExactDecision) {
    Found const found = over_random<TypeParam>(4000, &in_double<TypeParam>);
    EXPECT_EQ(found.wrong, 0);
    EXPECT_GT(found.positive, 600);
    EXPECT_GT(found.quick, found.positive / 4) << "worth its name";
}

template <class T>
int contradictions_of_plain_rounding() {
    return over_random<T>(4000,
                          [](Stored<T> const& s) {
                              return s.template mapped<double>([](T const& x) { return static_cast<double>(x); });
                          })
        .wrong;
}
TEST(ALook, IsMisledByZerosThatRoundingMade) {
    EXPECT_GT(contradictions_of_plain_rounding<Quad>(), 0);
    EXPECT_GT(contradictions_of_plain_rounding<Reference>(), 0);
    EXPECT_EQ(contradictions_of_plain_rounding<double>(), 0);
}

/// F F' of F = [2^-700 1; 2^-1400 2^-700] is singular; in double F is a triangle that is not.
template <class T>
Health of_the_disguised_triangle() {
    T const a = times_power(T(1), -700), b = times_power(T(1), -1400);
    Matrix<T> F(2, 2);
    F << a, T(1), b, a;
    return breakdown(Holds<T>({Stored<T>::Quantity::covariance, Stored<T>::Form::factor, F}, &in_double<T>),
                     arithmetic_of<T>());
}
TEST(ALook, SeesThroughADisguisedTriangle) {
    EXPECT_EQ(of_the_disguised_triangle<Quad>(), Health::indefinite);
    EXPECT_EQ(of_the_disguised_triangle<Reference>(), Health::indefinite);
    if (ArithmeticTraits<long double>::min_exp < -1500) {
        EXPECT_EQ(of_the_disguised_triangle<long double>(), Health::indefinite);
    }
}

}  // namespace
}  // namespace rlslab
