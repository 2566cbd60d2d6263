// Fixed-size filters never touch the heap; dynamic ones only when they are made.
#include "tests/alone/counted_heap.hpp"

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/fast/fast.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Heap allocations of making the filter and of fifty updates.
template <class F>
std::pair<long, long> allocations_of() {
    Problem<double> const problem{.size = 4, .forgetting = 0.99};
    double psi[4];
    Seed seed{1};
    long const before = allocations;
    F filter(problem);
    long const made = allocations;
    for (int k = 0; k < 50; ++k) {
        for (double& x : psi) x = seed.bell();
        filter.update({psi, 4}, seed.bell());
    }
    return {made - before, allocations - made};
}

/// Those of a block of rows known in advance, of as many parameters as it takes for one pass.
template <class F>
long allocations_of_a_block() {
    Index const size = 400;
    F filter(Problem<double>{.size = size});
    Matrix<double> const psi = Matrix<double>::Identity(size, 5);
    Vector<double> const y = Vector<double>::Ones(5);
    long const before = allocations;
    rows_at_once(filter, psi, y);
    return allocations - before;
}

/// A window of so many rows; what is made anew in fifty of them is counted with them.
template <Index rows, class F>
struct RowsOf : Windowed<F> {
    explicit RowsOf(Problem<double> const& problem) : Windowed<F>(problem, {.rows = rows}) {}
};

TEST(Allocation, NoneForFixedSizesAndNoneInUpdates) {
    for_each(Variants<double>{}, []<class F>() {
        using Fixed = AtSize<F, 4>;
        if constexpr (!std::is_void_v<Fixed>) {
            auto const [making, updating] = allocations_of<Fixed>();
            // The block of a form that takes blocks lives on the heap whatever N is.
            if (!TakesBlocks<F>) {
                EXPECT_EQ(making, 0) << F::name;
            }
            EXPECT_EQ(updating, 0) << F::name;
            EXPECT_GT(allocations_of<F>().first, 0) << "the count works";
            EXPECT_EQ(allocations_of<F>().second, 0) << F::name;
        }
    });
}

/// Heap allocations of making a fast form and of fifty updates.
template <class F>
std::pair<long, long> allocations_of_a_fast_form() {
    Seed seed{1};
    long const before = allocations;
    F form({.size = 4, .forgetting = 0.96875});
    long const made = allocations;
    for (int k = 0; k < 50; ++k) form.update(seed.bell(), 1);
    return {made - before, allocations - made};
}
TEST(Allocation, NoneInFastForms) {
    std::pair<long, long> const none{0, 0};
    EXPECT_EQ((allocations_of_a_fast_form<Transversal<double, 4>>()), none);
    EXPECT_EQ((allocations_of_a_fast_form<StabilisedTransversal<double, 4>>()), none);
    EXPECT_EQ((allocations_of_a_fast_form<Lattice<double, 4>>()), none);
    EXPECT_EQ((allocations_of_a_fast_form<ErrorFeedbackLattice<double, 4>>()), none);
    EXPECT_EQ((allocations_of_a_fast_form<QrLattice<double, 4>>()), none);
    for_each(FastForms<double>{}, []<class F>() { EXPECT_EQ(allocations_of_a_fast_form<F>().second, 0) << F::name; });
}
TEST(Allocation, NoneInRowsThatAreKnownInAdvance) {
    for_each(Variants<double>{}, []<class F>() {
        if constexpr (TakesRowsAtOnce<F>) {
            EXPECT_EQ(allocations_of_a_block<F>(), 0) << F::name;
        }
    });
}

TEST(Allocation, NoneByWhatIsComposedAroundAFilter) {
    auto const none = [](auto const& made_and_updated, char const* what) {
        EXPECT_EQ(made_and_updated.first, 0) << what;
        EXPECT_EQ(made_and_updated.second, 0) << what;
    };
    none(allocations_of<Forgetting<Ud<double, 4>, Fortescue<double>>>(), "fortescue");
    none(allocations_of<Forgetting<Qr<double, 4>, Kulhavy<double>>>(), "kulhavy");
    none(allocations_of<Forgetting<Ud<double, 4>, RotatingRidge<double>>>(), "ridge");
    none(allocations_of<Guarded<Ud<double, 4>>>(), "guarded");
    none(allocations_of<Guarded<Qr<double, 4>>>(), "guarded qr");
    EXPECT_EQ((allocations_of<Guarded<Ud<double, 4>, rebuilding>>().second), 0);
    EXPECT_EQ((allocations_of<Guarded<Ud<double>>>().second), 0);
    auto const window = allocations_of<RowsOf<20, Ud<double>>>();
    EXPECT_GT(window.first, 0);
    EXPECT_EQ(window.second, 0);
    EXPECT_EQ((allocations_of<RowsOf<20, Qr<double, 4>>>().second), 0);
    none(allocations_of<Weighted<Assessed<Guarded<Ud<double, 4>>>>>(), "weighted, assessed, guarded");
    EXPECT_EQ((allocations_of<Guarded<RowsOf<20, Ud<double>>>>().second), 0);
}

/// Of updates, theta and gain of a filter by name, over outliers, a change, silence, and rows of the other arithmetic.
long allocations_by_name(std::string_view variant, std::string_view arithmetic, native::Options options) {
    options.size = 4;
    auto const filter = native::make(variant, arithmetic, options);
    double psi[4], theta[4], gain[4];
    float short_psi[4];
    Seed seed{1};
    long const before = allocations;
    for (int k = 0; k < 300; ++k) {
        double y = 0.1 * seed.bell() + (k % 50 == 40 ? 100 : 0) + (k > 200 ? 5 : 0);
        for (double& x : psi) x = k / 50 == 3 ? 0 : seed.bell(), y += x;
        for (int i = 0; i < 4; ++i) short_psi[i] = float(psi[i]);
        filter->update(psi, y);
        filter->update(short_psi, float(y));
        filter->theta(theta);
        filter->gain(gain);
        filter->pass_time();
    }
    return allocations - before;
}
TEST(Allocation, NoneInFiltersByName) {
    double const walk[] = {0.001}, fortescue[] = {0.01};
    for (std::string_view const arithmetic : native::arithmetics())
        for (std::string_view const variant : native::variants()) {
            EXPECT_EQ(allocations_by_name(variant, arithmetic, {}), 0) << variant;
            std::vector<native::Options> compositions{{.control = "random_walk", .control_numbers = walk},
                                                      {.control = "fortescue", .control_numbers = fortescue},
                                                      {.forgetting = 0.99, .control = "ridge"},
                                                      {.window = 20},
                                                      {.window = 20, .guard = "reset"},
                                                      {.guard = "reset", .control = "kulhavy"}};
            for (std::string_view const guard : native::guards())
                compositions.push_back({.forgetting = 0.99, .guard = guard});
            for (native::Options const& options : compositions) {
                try {
                    EXPECT_EQ(allocations_by_name(variant, arithmetic, options), 0)
                        << variant << ' ' << options.control << ' ' << options.window << ' ' << options.guard;
                } catch (std::invalid_argument const&) {  // what the variant cannot carry
                }
            }
        }
}

TEST(Allocation, NoneByOutputsWhoseNumberIsFixed) {
    double const psi[4] = {1, 2, 3, 4};
    long const before = allocations;
    MultiOutput<Ud<double, 4>, 3> f({});
    f.update(psi, {1.0, 2.0, 3.0});
    EXPECT_EQ(allocations, before);
    MultiOutput<Ud<double>> dynamic({.size = 4}, 3);
    long const made = allocations;
    EXPECT_GT(made, before);
    dynamic.update(psi, {1.0, 2.0, 3.0});
    EXPECT_EQ(allocations, made);
}

TEST(Allocation, NoneInColouredNoise) {
    double const psi[3] = {1, 2, 3}, zeta[4] = {4, 3, 2, 1};
    long const before = allocations;
    ExtendedLeastSquares<Ud<double, 5>> f({}, 2);
    InstrumentalVariables<Ud<double, 3>, Ud<double, 4>, 2> g({}, {});
    InstrumentalVariables<Qr<double, 3>, Ud<double, 4>, 2> h({}, {});
    f.update(psi, 1), g.update(psi, zeta, 1), h.update(psi, zeta, 1);
    f.pass_time(), g.pass_time(), h.pass_time();
    EXPECT_EQ(allocations, before);
    ExtendedLeastSquares<Ud<double>> dynamic({.size = 5}, 2);
    InstrumentalVariables<Ud<double>> of_any({.size = 3}, {.size = 4}, 2);
    long const made = allocations;
    EXPECT_GT(made, before);
    dynamic.update(psi, 1), of_any.update(psi, zeta, 1);
    dynamic.pass_time(), of_any.pass_time();
    EXPECT_EQ(allocations, made);
}

TEST(Allocation, NoneForTheStateOfADenseFilter) {
    Ud<float, 5> f({.size = 5}), g({.size = 5, .forgetting = 0.5f});
    Qr<double> p({.size = 5}), q({.size = 5, .forgetting = 0.5});
    std::array<std::byte, 2000> room;
    long const before = allocations;
    StateFault const fixed = load(g, state_of(f));
    std::size_t const size = save(p, room);
    StateFault const dynamic = load(q, std::span(room).first(size));
    EXPECT_EQ(allocations, before);
    EXPECT_EQ(fixed, StateFault::none);
    EXPECT_EQ(dynamic, StateFault::none);
}

}  // namespace
}  // namespace rlslab
