// What is around `symmetric` and what its form can do see the P in blocks as they see one on a square: the same bits.
#include "tests/common/on_a_square.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/hand_over.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

template <class T>
using Square = SymmetricOnASquare<T>;

/// theta, the gain and P.
template <class F>
std::vector<double> shown(F const& f) {
    std::vector<double> out;
    auto const add = [&](auto const& numbers) {
        for (auto const& x : numbers.reshaped()) out.push_back(double(x));
    };
    using T = typename F::scalar;
    add(Vector<T>(f.theta()));
    add(Vector<T>(f.gain()));
    add(f.stored().F);
    return out;
}
template <class T>
Problem<T> problem_of(Index d) {
    return {.size = d, .forgetting = T(0.96875), .prior = Prior<T>{.variance = T(16)}};
}
template <class T>
struct Row {
    Vector<T> psi;
    T y;
    Row(Index d, Seed& seed) : psi(d), y(T(seed.bell())) {
        for (T& x : psi) x = T(seed.bell());
    }
};

/// operation(filter, row) and updates in turn.
template <class T, class Operation>
void check_operation(char const* name, Operation operation) {
    for (Index d : {3, 4, 7, 8, 9, 16, 17, 33}) {
        Symmetric<T> blocks(problem_of<T>(d));
        Square<T> square(problem_of<T>(d));
        Seed seed{std::uint64_t(d)};
        for (int k = 0; k < 3 * d; ++k) {
            Row<T> const row(d, seed);
            blocks.update(row.psi, row.y);
            square.update(row.psi, row.y);
            EXPECT_EQ(operation(blocks, row), operation(square, row)) << name << ' ' << d << ' ' << k;
            ASSERT_EQ(shown(blocks), shown(square)) << name << ' ' << d << ' ' << k;
        }
    }
}
template <class T>
void check_form() {
    using R = Row<T>;
    check_operation<T>("discount", [](auto& f, R const&) { return discount(f, T(0.75)), 0; });
    check_operation<T>("inflate", [](auto& f, R const& row) { return inflate(f, T(0.25), Regressor<T>(row.psi)), 0; });
    check_operation<T>("reset", [](auto& f, R const& row) {
        reset(f, T(4), Regressor<T>(row.psi));
        return f.stored().F == Matrix<T>(T(4) * Matrix<T>::Identity(row.psi.size(), row.psi.size()));
    });
    check_operation<T>("remove",
                       [](auto& f, R const& row) { return remove(f, Regressor<T>(row.psi), row.y, T(1)).remaining; });
    check_operation<T>("variance", [](auto& f, R const& row) { return variance(f, row.psi.size() - 1); });
    check_operation<T>("variance_along",
                       [](auto& f, R const& row) { return variance_along(f, Regressor<T>(row.psi)); });
    check_operation<T>("least_share", [](auto& f, R const& row) {
        StateMatrix<T> L(row.psi.size());
        StateVector<T> D(row.psi.size());
        return least_share(f.form(), L, D);
    });
}
TEST(SymmetricInBlocks, IsChangedThroughItsFormAsASquareIs) {
    check_form<double>();
    check_form<float>();
}

/// Rows of which some are outliers, some no numbers, and from the middle on some zero along one parameter, so that P
/// winds up.
template <class A, class B>
void check_around(A a, B b, Index d) {
    using T = typename A::scalar;
    Seed seed{std::uint64_t(d)};
    for (int k = 0; k < 600; ++k) {
        Row<T> row(d, seed);
        if (k % 97 == 96) row.y = T(1e6);
        if (k % 151 == 150) row.psi[d - 1] = std::numeric_limits<T>::quiet_NaN();
        if (k > 300) row.psi[d / 2] = T(0);
        auto const x = a.update(row.psi, row.y), y = b.update(row.psi, row.y);
        ASSERT_EQ(x.health, y.health) << d << ' ' << k;
        if (k % 10 == 9) {
            ASSERT_EQ(shown(a), shown(b)) << d << ' ' << k;
        }
    }
}
template <class T>
void check_compositions() {
    for (Index d : {4, 8, 9, 17}) {
        Problem<T> const problem = problem_of<T>(d);
        check_around(Guarded<Symmetric<T>>(problem), Guarded<Square<T>>(problem), d);
        constexpr GuardPolicy rebuilding{.breakdown = Action::rebuild};
        check_around(Guarded<Symmetric<T>, rebuilding>(problem), Guarded<Square<T>, rebuilding>(problem), d);
    }
}
TEST(SymmetricInBlocks, IsGuardedAsASquareIs) {
    check_compositions<double>();
    check_compositions<float>();
}
/// Without forgetting, on nearly dependent rows: P in float comes to its end within 300 rows.
TEST(SymmetricInBlocks, IsHandedOverAsASquareIs) {
    for (Index d : {4, 9, 17}) {
        Problem<float> const problem{.size = d, .forgetting = 1};
        RelayOptions const options{.bits = 8, .every = 5};
        Relay<Symmetric<float>, Ud<double>> blocks(problem, options);
        Relay<Square<float>, Ud<double>> square(problem, options);
        Seed seed{std::uint64_t(d)};
        for (int k = 0; k < 300; ++k) {
            Row<float> row(d, seed);
            row.psi[d - 1] = row.psi[0] + 0.001f * row.psi[d - 1];
            blocks.update(row.psi, row.y);
            square.update(row.psi, row.y);
            ASSERT_EQ(blocks.handed_over(), square.handed_over()) << d << ' ' << k;
            ASSERT_EQ(Vector<float>(blocks.theta()), Vector<float>(square.theta())) << d << ' ' << k;
        }
        EXPECT_TRUE(blocks.handed_over()) << d;
    }
}
TEST(SymmetricInBlocks, IsRemovedFromAWindowAsASquareIs) {
    for (Index d : {4, 8, 9, 17}) {
        WindowOptions<double> const options{.rows = 3 * d};
        Windowed<Symmetric<double>> blocks(problem_of<double>(d), options);
        Windowed<Square<double>> square(problem_of<double>(d), options);
        Seed seed{std::uint64_t(d)};
        for (int k = 0; k < 12 * d; ++k) {
            Row<double> const row(d, seed);
            blocks.update(row.psi, row.y);
            square.update(row.psi, row.y);
            ASSERT_EQ(shown(blocks), shown(square)) << d << ' ' << k;
        }
        EXPECT_EQ(blocks.refactored(), square.refactored()) << d;
    }
}

/// States are the square's, byte for byte, and go both ways.
TEST(SymmetricInBlocks, IsSavedAndLoadedAsASquareIs) {
    for (Index d : {1, 4, 7, 8, 9, 16, 17, 40}) {
        Symmetric<double> blocks(problem_of<double>(d)), loaded({.size = d});
        Square<double> square(problem_of<double>(d)), from_blocks({.size = d});
        Seed seed{std::uint64_t(d)};
        for (int k = 0; k < 20; ++k) {
            Row<double> const row(d, seed);
            blocks.update(row.psi, row.y);
            square.update(row.psi, row.y);
        }
        auto const bytes = state_of(square);
        ASSERT_EQ(state_of(blocks), bytes) << d;
        EXPECT_EQ(load(loaded, bytes), StateFault::none) << d;
        EXPECT_EQ(load(from_blocks, bytes), StateFault::none) << d;
        EXPECT_EQ(state_of(loaded), bytes) << d;
        for (int k = 0; k < 5; ++k) {
            Row<double> const row(d, seed);
            for (auto* f : {&blocks, &loaded}) f->update(row.psi, row.y);
            for (auto* f : {&square, &from_blocks}) f->update(row.psi, row.y);
        }
        EXPECT_EQ(shown(loaded), shown(square)) << d;
        EXPECT_EQ(shown(blocks), shown(from_blocks)) << d;
    }
}

}  // namespace
}  // namespace rlslab
