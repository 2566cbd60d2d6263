// No update through rlslab.h touches the heap. This program has its own malloc, which librlslab.so then calls, too.
#include "bindings/c/rlslab.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace {
std::atomic<long> allocations = 0;
}
extern "C" {
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
    ++allocations;
    return __libc_malloc(size);
}
}

namespace {

TEST(CAllocation, NoUpdateTouchesTheHeap) {
    constexpr std::size_t d = 4, rows = 50;
    std::vector<double> psi(rows * d), y(rows);
    std::vector<float> floats(rows * d);
    std::vector<rlslab_step> steps(rows);
    unsigned s = 1;
    for (double& x : psi) x = double((s = 1664525 * s + 1013904223) >> 8) / 8388608.0 - 1;
    for (std::size_t k = 0; k < rows; ++k) y[k] = psi[k * d] - psi[k * d + 1];
    floats.assign(psi.begin(), psi.end());
    long made = 0;
    for (char const* const guard : {static_cast<char const*>(nullptr), "reset"})
        for (std::size_t v = 0; char const* const variant = rlslab_name(RLSLAB_VARIANTS, v); ++v)
            for (std::size_t a = 0; char const* const arithmetic = rlslab_name(RLSLAB_ARITHMETICS, a); ++a) {
                rlslab_options options;
                rlslab_defaults(&options, sizeof options);
                options.size = d;
                options.forgetting = 0.99;
                options.guard = guard;
                long const before = allocations;
                rlslab_filter* filter = nullptr;
                if (rlslab_new(variant, arithmetic, &options, &filter) != RLSLAB_OK) continue;
                made += allocations - before;
                long const start = allocations;
                rlslab_step step;
                for (std::size_t k = 0; k < rows; ++k) {
                    rlslab_update(filter, &psi[k * d], y[k], &step);
                    rlslab_update_f32(filter, &floats[k * d], float(y[k]), nullptr);
                }
                rlslab_update_many(filter, psi.data(), rows, 0, y.data(), steps.data());
                rlslab_pass_time(filter, &step);
                for (double const weight : {0.5, 1.0, 0.0, -1.0}) {
                    rlslab_update_weighted(filter, psi.data(), y[0], weight, &step);
                    rlslab_update_weighted_f32(filter, floats.data(), float(y[0]), float(weight), &step);
                }
                rlslab_update(nullptr, nullptr, 0, nullptr);
                EXPECT_EQ(allocations - start, 0) << variant << " " << arithmetic << (guard ? " guarded" : "");
                rlslab_free(filter);
            }
    EXPECT_GE(made, 30);  // the count counts
}

}  // namespace
