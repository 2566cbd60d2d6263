// What the digests are of, how they are printed, and by which verbs: digest.cpp.
#pragma once

#include <rlslab/adapt/outputs.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/many/output_fleet.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <cstdio>
#include <fstream>
#include <map>
#include <string>

namespace rlslab::digests {

inline constexpr Index d = 5;

/// Each file of the program adds its own, with what it does in a folder; the exit status.
using Verbs = std::map<std::string, int (*)(std::string const& folder)>;
inline Verbs verbs;

struct Numbers {
    std::uint32_t s = 1;
    double next() {
        s = 1664525 * s + 1013904223;
        return (s >> 8) / 8388608.0 - 1;
    }
};
struct Hash {
    std::uint64_t first = 1, second = 1;
    void add(std::byte byte) {
        first = (257 * first + std::uint64_t(byte)) % 4294967291;
        second = (65599 * second + std::uint64_t(byte)) % 4294967291;
    }
    void add(double x) {
        std::uint64_t const bits = detail::bits_of(x == x ? x : std::numeric_limits<double>::quiet_NaN());
        for (int i = 0; i < 8; ++i) add(std::byte(bits >> (8 * i) & 255));
    }
    template <class Derived>
    void add(Eigen::DenseBase<Derived> const& A) {
        for (Index j = 0; j < A.cols(); ++j)
            for (Index i = 0; i < A.rows(); ++i) add(static_cast<double>(A(i, j)));
    }
    void print(std::string const& what) const {
        std::printf("%s %08llx%08llx\n", what.c_str(), static_cast<unsigned long long>(first),
                    static_cast<unsigned long long>(second));
    }
};
template <class F>
std::string name_of_type() {
    return std::string(F::name) + " " + std::string(ArithmeticTraits<typename F::scalar>::name);
}

template <class F>
void take(F& filter, int rows, Numbers& numbers) {
    using T = typename F::scalar;
    for (int k = 0; k < rows; ++k) {
        Vector<T> psi(d);
        for (T& x : psi) x = T(numbers.next());
        filter.update(psi, T(numbers.next()));
    }
}
inline void save_in(std::string const& path, auto const& filter) {
    auto const state = state_of(filter);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<char const*>(state.data()), std::streamsize(state.size()));
}
/// Two outputs, where P is reported: else one. Real ones with weights.
template <class F>
void output_fleet() {
    using Fleet = OutputFleet<F>;
    using N = typename Fleet::number;
    using T = typename Fleet::real;
    Index const M = 11, m = ReportsCovariance<F> ? 2 : 1;
    Fleet fleet(M, {.size = d, .forgetting = T(0.9921875)}, m);
    Numbers numbers;
    std::vector<N> psi(size_t(M * d)), y(size_t(M * m));
    std::vector<T> w(static_cast<size_t>(M));
    auto const draw = [&](std::vector<N>& to) {
        for (N& x : to) {
            if constexpr (ComplexScalar<N>) x.re = T(numbers.next()), x.im = T(numbers.next());
            else x = T(numbers.next());
        }
    };
    for (int k = 0; k < 60; ++k) {
        draw(psi), draw(y);
        for (int i = 0; i < M; ++i) w[size_t(i)] = T((k + i) % 5) / 2;
        fleet.update(psi.data(), y.data(), ComplexScalar<N> ? nullptr : w.data(), nullptr);
    }
    Hash hash;
    for (Index i = 0; i < M; ++i) {
        Matrix<N> const theta = fleet.theta(i).transpose();
        for (N const& x : theta.reshaped()) {
            hash.add(double(real_part(x)));
            if constexpr (ComplexScalar<N>) hash.add(double(x.im));
        }
    }
    for (std::byte const byte : state_of(fleet)) hash.add(byte);
    hash.print(std::string(F::name) + (ComplexScalar<N> ? " complex " : " fleet ") +
               std::string(ArithmeticTraits<T>::name));
}
/// The output fleets of all variants that have lanes: of complex numbers, of real ones where P is reported.
template <class... C>
int output_fleets(std::string const&) {
    auto const left_by = []<class F>() {
        if constexpr (InLockstep<F> && (ComplexScalar<typename F::scalar> || ReportsCovariance<F>)) output_fleet<F>();
    };
    (for_each(Variants<C>{}, left_by), ...);
    return 0;
}
template <class F>
void everything(Index size) {
    using T = typename F::scalar;
    F filter(problem_as<T>({.size = size, .forgetting = 0.98}));
    Seed seed{std::uint64_t(size)};
    Hash out;
    for (int k = 0; k < 300; ++k) {
        Vector<T> psi(size);
        for (T& x : psi) x = round_to<T>(seed.bell());
        Step<T> const step = filter.update(psi, round_to<T>(seed.bell() + static_cast<double>(psi[0])));
        for (T const& x : {step.innovation, step.residual, step.gamma}) out.add(static_cast<double>(x));
    }
    auto const stored = filter.stored();
    out.add(Vector<T>(filter.theta()));
    out.add(Vector<T>(filter.gain()));
    out.add(stored.F);
    out.add(stored.D);
    for (std::byte const byte : state_of(filter)) out.add(byte);
    out.print(name_of_type<F>() + " " + std::to_string(size));
}
/// Three outputs: 20 rows, then blocks of 40 rows where F takes them.
template <class F>
void three_outputs() {
    using T = typename F::scalar;
    MultiOutput<F> filter(problem_as<T>({.size = 24, .forgetting = 0.98}), 3);
    Seed seed{3};
    auto const drawn = [&](Index rows, Index columns) {
        Matrix<T> out(rows, columns);
        for (T& x : out.reshaped()) x = round_to<T>(seed.bell());
        return out;
    };
    for (int k = 0; k < 20; ++k) {
        Vector<T> const psi = drawn(24, 1), y = drawn(3, 1);
        filter.update(psi, y);
    }
    if constexpr (requires { filter.update_block(drawn(24, 40), drawn(40, 3)); })
        for (int k = 0; k < 2; ++k) {
            Matrix<T> const X = drawn(24, 40), Y = drawn(40, 3);
            filter.update_block(X, Y);
        }
    Hash out;
    for (std::byte const byte : state_of(filter)) out.add(byte);
    out.print(name_of_type<F>() + " outputs");
}
template <class T>
void everything_in() {
    for_each(Variants<T>{}, []<class F>() {
        for (Index const size : {1, 3, 5, 10, 24}) everything<F>(size);
        if constexpr (requires { typename MultiOutput<F>; }) three_outputs<F>();
    });
}

}  // namespace rlslab::digests
