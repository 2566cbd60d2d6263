// What every variant leaves after 1000 rows that each language can make exactly, from the C++ types: one line a variant
// and arithmetic, a hash of theta, K and P or its inverse. tests/python/test_bits.py has the rows in Python.
// `bits FOLDER`: states of compositions after 100 rows, and a hash of theta after 200.
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <bit>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

namespace rlslab {
namespace {

/// x = 1664525 x + 1013904223 mod 2^32; the number is (x >> 8) / 2^23 - 1.
struct Numbers {
    std::uint32_t x = 1;
    double next() {
        x = 1664525u * x + 1013904223u;
        return double(x >> 8) / 8388608 - 1;
    }
};

/// FNV-1a over the bytes of doubles, the least significant first; one NaN for all.
struct Hash {
    std::uint64_t value = 0xcbf29ce484222325;
    template <class Numbers>
    void add(Numbers const& numbers) {
        for (Index i = 0; i < numbers.size(); ++i) {
            double const x = double(numbers.data()[i]);
            std::uint64_t const bits = x == x ? std::bit_cast<std::uint64_t>(x) : 0x7ff8000000000000;
            for (int byte = 0; byte < 8; ++byte) value = (value ^ (bits >> (8 * byte) & 0xff)) * 0x100000001b3;
        }
    }
};

constexpr Index d = 5;

template <class F>
void take(F& filter, int rows, Numbers& numbers) {
    using T = typename F::scalar;
    for (int k = 0; k < rows; ++k) {
        double row[d];
        for (double& x : row) x = numbers.next();
        double const y = row[0] - row[1] / 2 + numbers.next() / 1024;
        Vector<T> psi(d);
        for (Index i = 0; i < d; ++i) psi[i] = T(row[i]);
        filter.update(psi, T(y));
    }
}
template <class T>
Problem<T> problem() {
    return {.size = d, .forgetting = T(0.99)};
}

template <class F>
void print_hash() {
    using T = typename F::scalar;
    F filter(problem<T>());
    Numbers numbers;
    take(filter, 1000, numbers);
    Hash hash;
    hash.add(Vector<T>(filter.theta()));
    hash.add(Vector<T>(filter.gain()));
    if constexpr (ReportsCovariance<F>) hash.add(Matrix<T>(filter.covariance()));
    else hash.add(Matrix<T>(filter.information()));
    std::printf("%s %s %016" PRIx64 "\n", F::name.data(), ArithmeticTraits<T>::name.data(), hash.value);
}

template <class F>
void save_half_way(F filter, std::string const& folder, char const* name) {
    using T = typename F::scalar;
    Numbers numbers;
    take(filter, 100, numbers);
    auto const state = state_of(filter);
    std::ofstream(folder + "/" + name, std::ios::binary)
        .write(reinterpret_cast<char const*>(state.data()), std::streamsize(state.size()));
    take(filter, 100, numbers);
    Hash hash;
    hash.add(Vector<T>(filter.theta()));
    std::printf("%s %016" PRIx64 "\n", name, hash.value);
}

}  // namespace
}  // namespace rlslab

int main(int count, char** words) {
    using namespace rlslab;
    if (count > 1) {
        using D = double;
        auto const f = problem<float>();
        auto const p = problem<D>();
        save_half_way(Guarded<Windowed<Ud<float>>>(Windowed<Ud<float>>(f, {.rows = 30}), f), words[1], "windowed");
        save_half_way(Guarded<Forgetting<Carlson<D>, Kulhavy<D>>, rebuilding>(p, {.innovation = 4, .rebuild_rows = 7}),
                      words[1], "ruled");
        save_half_way(Forgetting<Qr<D>, Fortescue<D>>(p, {.noise_variance = 1e-6}), words[1], "fortescue");
        return 0;
    }
    for_each(Variants<float>{}, []<class F>() { print_hash<F>(); });
    for_each(Variants<double>{}, []<class F>() { print_hash<F>(); });
}
