// limit/read/BYTES and limit/read_modify_write/BYTES: one pass over the size^2 doubles of a full P, as fast as this
// machine can in a plain loop: the unit of times, and in the caches a bound, for updates that read P or change it.
#include "bench/rows.hpp"

namespace rlslab::bench {
namespace {

#if defined(__AVX512F__)
constexpr int width = 8;
#elif defined(__AVX__)
constexpr int width = 4;
#else
constexpr int width = 2;
#endif
using Lanes = double __attribute__((vector_size(width * sizeof(double))));
constexpr Index unrolled = 8;  // independent accumulators: an addition's latency times the additions in a cycle

/// Small integers, so that their sums are exact in any order; aligned to a cache line.
class Numbers {
    struct alignas(64) Line {
        double values[8];
    };
    std::vector<Line> lines_;

public:
    explicit Numbers(Index count) : lines_(size_t(count / 8)) {
        for (Index i = 0; i < count; ++i) data()[i] = double(i % 16);
    }
    double* data() { return lines_.front().values; }
    Lanes* lanes() { return reinterpret_cast<Lanes*>(data()); }  // GCC's vector types may alias their elements
};

[[gnu::noinline]] double sum(Lanes const* x, Index count) {
    Lanes part[unrolled] = {};
    for (Index i = 0; i < count / width; i += unrolled)
#pragma GCC unroll 8
        for (Index j = 0; j < unrolled; ++j) part[j] += x[i + j];
    double total = 0;
    for (Lanes const& lanes : part)
        for (int c = 0; c < width; ++c) total += lanes[c];
    return total;
}

[[gnu::noinline]] void increase(Lanes* y, double by, Index count) {
    Lanes const a = Lanes{} + by;
    for (Index i = 0; i < count / width; i += unrolled)
#pragma GCC unroll 8
        for (Index j = 0; j < unrolled; ++j) y[i + j] += a;
}

/// Passes in one iteration.
int passes_over(Index count) { return int(std::clamp<Index>(64 * 256 * 256 / count, 2, 64)); }

/// The answer is exact or the loop has left something out.
Answer exact_or_none(double found, double expected) {
    return {found == expected ? std::numeric_limits<double>::digits * std::log10(2.0) : 0, std::isfinite(found)};
}

void read(benchmark::State& state, Index count) {
    Numbers x(count);
    int const passes = passes_over(count);
    double total = 0;
    time_rows(
        state, passes, [&] { total = 0; },
        [&] {
            return nanoseconds_of([&] {
                for (int k = 0; k < passes; ++k) {
                    total += sum(x.lanes(), count);
                    do_not_optimize(total);
                }
            });
        },
        [&] { return exact_or_none(total, passes * 7.5 * double(count)); });
}

void read_modify_write(benchmark::State& state, Index count) {
    Numbers y(count);
    int const passes = passes_over(count);
    double before = 0;
    time_rows(
        state, passes, [&] { before = sum(y.lanes(), count); },
        [&] {
            return nanoseconds_of([&] {
                for (int k = 0; k < passes; ++k) {
                    increase(y.lanes(), 1, count);
                    do_not_optimize(y);
                }
            });
        },
        [&] { return exact_or_none(sum(y.lanes(), count) - before, passes * double(count)); });
}

Rows const added([] {
    for (Index size : {32, 64, 128, 256, 512, 1024, 2048, 4096}) {
        Index const count = size * size;
        std::string const bytes = std::to_string(count * Index(sizeof(double)));
        add_row("limit/read/" + bytes, [=](benchmark::State& state) { read(state, count); });
        add_row("limit/read_modify_write/" + bytes, [=](benchmark::State& state) { read_modify_write(state, count); });
    }
});

}  // namespace
}  // namespace rlslab::bench
