// What is around `symmetric` and what its form can do see the P in blocks as they see one on a square: the same bits.
#include "tests/common/on_a_square.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

template <class T>
using Square = SymmetricOnASquare<T>;

template <class T>
Problem<T> problem_of(Index d) {
    return {.size = d, .forgetting = T(0.96875), .prior = Prior<T>{.variance = T(16)}};
}
twins::Rows noise(Index d, Index count) {
    Seed seed{std::uint64_t(d)};
    twins::Rows out;
    for (Index k = 0; k < count; ++k)
        out.push_back({Vector<double>::NullaryExpr(d, [&] { return seed.bell(); }), seed.bell(), 1, k});
    return out;
}

/// operation(filter, row) and updates in turn; what it tells stands for the residual.
template <class T, class Operation>
void check_operation(char const* name, Operation operation) {
    auto const act = [operation](auto& f, twins::Row<T> const& row) {
        Step<T> step = f.update(row.psi, row.y);
        step.residual = T(operation(f, row));
        return step;
    };
    for (Index d : {3, 4, 7, 8, 9, 16, 17, 33})
        twins::expect_one(name, twins::trace(Symmetric<T>(problem_of<T>(d)), noise(d, 3 * d), false, act),
                          twins::trace(Square<T>(problem_of<T>(d)), noise(d, 3 * d), false, act));
}
template <class T>
void check_form() {
    using R = twins::Row<T>;
    check_operation<T>("discount", [](auto& f, R const&) { return discount(f, T(0.75)), 0; });
    check_operation<T>("inflate", [](auto& f, R const& row) { return inflate(f, T(0.25), Regressor<T>(row.psi)), 0; });
    check_operation<T>("reset", [](auto& f, R const& row) { return reset(f, T(4), Regressor<T>(row.psi)), 0; });
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
TEST(SymmetricInBlocks, IsAMultipleOfOneAfterAReset) {
    Symmetric<double> f(problem_of<double>(9));
    for (auto const& row : noise(9, 20)) f.update(row.psi, row.y);
    reset(f, 4.0, Vector<double>(Vector<double>::Ones(9)));
    EXPECT_EQ(f.stored().F, Matrix<double>(4 * Matrix<double>::Identity(9, 9)));
}

/// Rows of which some are outliers, some no numbers, and from the middle on some zero along one parameter, so that P
/// winds up.
template <class T>
void check_compositions() {
    for (Index d : {4, 8, 9, 17}) {
        twins::Rows rows = noise(d, 600);
        for (auto& row : rows) {
            if (row.k % 97 == 96) row.y = 1e6;
            if (row.k % 151 == 150) row.psi[d - 1] = std::numeric_limits<double>::quiet_NaN();
            if (row.k > 300) row.psi[d / 2] = 0;
        }
        Problem<T> const problem = problem_of<T>(d);
        constexpr GuardPolicy rebuilding{.breakdown = Action::rebuild};
        twins::expect_one("guarded", twins::trace(Guarded<Symmetric<T>>(problem), rows),
                          twins::trace(Guarded<Square<T>>(problem), rows));
        twins::expect_one("rebuilding", twins::trace(Guarded<Symmetric<T>, rebuilding>(problem), rows),
                          twins::trace(Guarded<Square<T>, rebuilding>(problem), rows));
    }
}
TEST(SymmetricInBlocks, IsGuardedAsASquareIs) {
    check_compositions<double>();
    check_compositions<float>();
}
TEST(SymmetricInBlocks, IsRemovedFromAWindowAsASquareIs) {
    for (Index d : {4, 8, 9, 17}) {
        Problem<double> const problem = problem_of<double>(d);
        twins::expect_one("window",
                          twins::trace(Windowed<Symmetric<double>>(problem, {.rows = 3 * d}), noise(d, 12 * d)),
                          twins::trace(Windowed<Square<double>>(problem, {.rows = 3 * d}), noise(d, 12 * d)));
    }
}
/// States are the square's, byte for byte, and go both ways.
TEST(SymmetricInBlocks, IsSavedAndLoadedAsASquareIs) {
    for (Index d : {1, 4, 7, 8, 9, 16, 17, 40}) {
        Symmetric<double> blocks(problem_of<double>(d)), loaded({.size = d});
        Square<double> square(problem_of<double>(d)), from_blocks({.size = d});
        for (auto const& row : noise(d, 20)) blocks.update(row.psi, row.y), square.update(row.psi, row.y);
        auto const bytes = state_of(square);
        ASSERT_EQ(state_of(blocks), bytes) << d;
        EXPECT_EQ(load(loaded, bytes), StateFault::none) << d;
        EXPECT_EQ(load(from_blocks, bytes), StateFault::none) << d;
        twins::expect_one("loaded", twins::trace(loaded, noise(d, 5)), twins::trace(square, noise(d, 5)));
        twins::expect_one("loaded", twins::trace(blocks, noise(d, 5)), twins::trace(from_blocks, noise(d, 5)));
    }
}

}  // namespace
}  // namespace rlslab
