// A random generator that is a value: it can be passed, stored, copied and replayed. Any compiler and standard library
// give the same bits.
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <cstdint>

namespace rlslab {

/// SplitMix64 (Steele, Lea & Flood 2014). Equal seeds give equal streams. A copy continues the stream from where the
/// original is.
struct Seed {
    std::uint64_t state;

    std::uint64_t next() {
        std::uint64_t z = state += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }

    /// Uniform in [0, 1), a multiple of 2^-53: the conversion and the scaling are exact.
    double uniform() { return double(next() >> 11) * 0x1p-53; }

    /// Nearly normal, mean 0 and variance 1, magnitude at most 6: the sum of twelve 48-bit uniforms, minus six. In
    /// units of 2^-48 the sum is an integer below 2^52, so that its one conversion is exact.
    double bell() {
        std::int64_t sum = -(std::int64_t{6} << 48);
        for (int i = 0; i < 12; ++i) sum += std::int64_t(next() >> 16);
        return double(sum) * 0x1p-48;
    }

    friend bool operator==(Seed const&, Seed const&) = default;
};

}  // namespace rlslab
