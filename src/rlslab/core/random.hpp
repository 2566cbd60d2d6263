// Randomness as a value: passed, stored, copied, replayed; the same bits with any compiler and any standard library.
#pragma once

#include <cstdint>

namespace rlslab {

/// SplitMix64 (Steele, Lea & Flood 2014). Equal seeds give equal streams; a copy continues where the original stands.
struct Seed {
    std::uint64_t state;

    std::uint64_t next() {
        std::uint64_t z = state += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }

    /// Uniform in [0, 1): 53 bits, so the conversion and the scaling are exact.
    double uniform() { return double(next() >> 11) * 0x1p-53; }

    /// Nearly normal, mean 0 and variance 1: the sum of twelve 48-bit uniforms, minus six. The sum is below 2^52 in
    /// units of 2^-48, hence exact in integers and in its one conversion. Never beyond 6 in magnitude.
    double bell() {
        std::int64_t sum = -(std::int64_t{6} << 48);
        for (int i = 0; i < 12; ++i) sum += std::int64_t(next() >> 16);
        return double(sum) * 0x1p-48;
    }

    friend bool operator==(Seed const&, Seed const&) = default;
};

}  // namespace rlslab
