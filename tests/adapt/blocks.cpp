// What is around `symmetric` and what its form can do see the P in blocks as they see one on a square: the same bits.
#include "tests/common/on_a_square.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/guard.hpp>
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

}  // namespace
}  // namespace rlslab
