// Fixed-size filters never touch the heap; dynamic ones only when they are made.
#include <rlslab/adapt/state.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

namespace {
long allocations = 0;
}
// noinline: g++ otherwise sees malloc and delete meet and warns.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* p = std::malloc(size)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    size_t const unit = size_t(alignment);
    if (void* p = std::aligned_alloc(unit, (size + unit - 1) / unit * unit)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

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

template <template <class, int> class F>
void check() {
    auto const [making, updating] = allocations_of<F<double, 4>>();
    EXPECT_EQ(making, 0) << F<double, 4>::name;
    EXPECT_EQ(updating, 0) << F<double, 4>::name;
    EXPECT_GT((allocations_of<F<double, Dynamic>>().first), 0) << "the count works";
    EXPECT_EQ((allocations_of<F<double, Dynamic>>().second), 0) << F<double, Dynamic>::name;
}

TEST(Allocation, NoneForFixedSizesAndNoneInUpdates) {
    check<Conventional>();
    check<ConventionalTwoSided>();
    check<Symmetric>();
    check<Joseph>();
    check<JosephRankTwo>();
    check<Potter>();
    check<Carlson>();
    check<Ud>();
    check<InverseQr>();
    check<Information>();
    check<Qr>();
    check<Gentleman>();
    check<ExtendedQr>();
    EXPECT_EQ(allocations_of<QrBlock<double>>().second, 0);  // its block lives on the heap whatever N is
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
