// Everything a variant computes, on rows that take every branch of a short arithmetic, as one number.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/variants/variants.hpp>

#include <bit>
#include <cstdint>

namespace rlslab::everything {

/// FNV-1a over the bits of doubles; every NaN is one NaN.
struct Digest {
    std::uint64_t value = 0xcbf29ce484222325;
    void add(double x) {
        std::uint64_t bits = x != x ? 0x7ff8000000000000 : std::bit_cast<std::uint64_t>(x);
        for (int i = 0; i < 8; ++i, bits >>= 8) value = (value ^ (bits & 255)) * 0x100000001b3;
    }
    template <class T>
    void add_all(T const& numbers) {
        for (auto const& x : numbers.reshaped()) add(double(x));
    }
};

/// Rows of noise, some of them zero, some so large or small that squares leave a short format.
template <class T>
T number(Seed& noise, int k) {
    double const scale = k % 7 == 3 ? 0x1p9 : k % 7 == 5 ? 0x1p-10 : 1;
    return T(static_cast<double>(Chopped<binary16>(k % 11 == 4 ? 0 : noise.bell() * scale)));
}

template <class F>
void reported(F const& f, Digest& digest) {
    using T = typename F::scalar;
    digest.add_all(Vector<T>(f.theta()));
    digest.add_all(Vector<T>(f.gain()));
    digest.add_all(f.stored().F);
    digest.add_all(f.stored().D);
    if constexpr (ReportsCovariance<F>) digest.add_all(Matrix<T>(f.covariance()));
    if constexpr (ReportsInformation<F>) digest.add_all(Matrix<T>(f.information()));
}

template <class F>
void run(Index d, bool prior, Seed noise, Digest& digest) {
    using T = typename F::scalar;
    Problem<T> problem{.size = d, .forgetting = T(0.96875)};
    if (!prior) problem.prior.reset();
    F f(problem);
    auto const row = [&](int k) {
        Vector<T> psi(d);
        for (T& x : psi) x = number<T>(noise, k);
        return psi;
    };
    for (int k = 0; k < 30; ++k) {
        Vector<T> const psi = row(k);
        T const y = number<T>(noise, k);
        if constexpr (Accumulates<F>)
            if (k % 3 == 0) {
                f.accumulate(psi, y);
                continue;
            }
        Step<T> const step = f.update(psi, y);
        for (T const& x : {step.innovation, step.residual, step.gamma}) digest.add(double(x));
        digest.add(double(int(step.health)));
        if (k % 10 == 5) reported(f, digest);
    }
    if constexpr (GainPerturbable<F>)
        f.update(row(0), T(1), [](auto&& K, auto const&...) {  // K itself, or the running gain of a sweep
            for (auto i = 0 * K.size(); i < K.size(); ++i) K[i] += K[i] * T(0.125);
        });
    if constexpr (TakesBlocks<F>) {
        Eigen::Matrix<T, Dynamic, Dynamic> psi(d, 13);
        for (int k = 0; k < 13; ++k) psi.col(k) = row(k);
        Vector<T> y(13);
        for (T& x : y) x = number<T>(noise, 0);
        f.update_block(psi, y);
    }
    if constexpr (Merges<F>) {
        problem.prior.reset();
        F newer(problem);
        for (int k = 0; k < 5; ++k) {
            Vector<T> const psi = row(k);
            newer.update(psi, number<T>(noise, k));
        }
        f.merge(newer);
    }
    reported(f, digest);
}

/// Every size up to twelve, with and without a prior.
template <class F>
Digest digest_of() {
    Digest digest;
    for (Index d = 1; d <= 12; ++d)
        for (bool prior : {true, false})
            if (prior || StartsWithoutPrior<F>) run<F>(d, prior, Seed{std::uint64_t(d)}, digest);
    return digest;
}

}  // namespace rlslab::everything
