// What the tests of complex scalars share: rows of complex numbers, and a plain filter in which a conjugation can be
// left out.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <vector>

namespace rlslab::complex_tests {

struct ComplexRows {
    std::vector<std::vector<std::complex<double>>> psi;
    std::vector<std::complex<double>> y;
};

/// White rows, y = psi'(1 + i, -2 + i/2, 3, ...) + noise; `real`: without imaginary parts. Multiples of 2^-20: short as
/// rationals.
inline ComplexRows complex_rows(Index size, Index rows, std::uint64_t from, double scale = 1, bool real = false) {
    ComplexRows out;
    Seed seed{from};
    auto const number = [&](double by) {
        auto const part = [&] { return std::ldexp(std::round(std::ldexp(seed.bell(), 20)), -20) * by * scale; };
        double const re = part(), im = part();
        return std::complex<double>{re, real ? 0.0 : im};
    };
    for (Index k = 0; k < rows; ++k) {
        std::complex<double> y = number(0.125);
        out.psi.emplace_back();
        for (Index i = 0; i < size; ++i) {
            std::complex<double> const psi = number(1);
            out.psi.back().push_back(psi);
            y += std::conj(psi) *
                 std::complex<double>(i % 2 ? -double(i + 1) : double(i + 1), real ? 0 : 1 - double(i) / 2);
        }
        out.y.push_back({std::ldexp(std::round(std::ldexp(y.real(), 20)), -20),
                         real ? 0 : std::ldexp(std::round(std::ldexp(y.imag(), 20)), -20)});
    }
    return out;
}

template <class T>
T as(std::complex<double> const& x) {
    if constexpr (ComplexScalar<T>) return T(RealOf<T>(x.real()), RealOf<T>(x.imag()));
    else return T(x.real());
}
template <class T>
std::vector<T> as(std::vector<std::complex<double>> const& x) {
    std::vector<T> out;
    for (auto const& number : x) out.push_back(as<T>(number));
    return out;
}

template <class T>
Problem<T> problem(Index d, double forgetting = 0.9375, double variance = 16) {
    return {.size = d, .forgetting = RealOf<T>(forgetting), .prior = Prior<T>{.variance = RealOf<T>(variance)}};
}
template <class A, class B>
bool equal(A const& a, B const& b) {
    for (Index j = 0; j < a.cols(); ++j)
        for (Index i = 0; i < a.rows(); ++i)
            if (!(a(i, j) == b(i, j))) return false;
    return true;
}

/// The textbook's recursion, every sum from the first term to the last. What it leaves unconjugated, the laws have to
/// find.
enum class Broken { nothing, innovation, innovation_variance, covariance, gain };
template <ComplexScalar T, Broken broken>
class Plain {
    RealOf<T> lambda_;
    StateVector<T, Dynamic> theta_, K_;
    StateMatrix<T, Dynamic> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "plain";
    explicit Plain(Problem<T> const& problem)
        : lambda_(problem.forgetting), theta_(start_theta<T, Dynamic>(problem)), K_(problem.size),
          P_(start_covariance<T, Dynamic>(problem)) {}
    Step<T> update(Regressor<T> psi, T y) {
        auto const prime = [](T const& x, Broken where) { return broken == where ? x : conj(x); };
        Index const d = psi.size();
        StateVector<T, Dynamic> f(d);
        T e = y, s = T(lambda_);
        for (Index j = 0; j < d; ++j) e -= prime(psi[j], Broken::innovation) * theta_[j];
        for (Index i = 0; i < d; ++i)
            for (Index j = 0; j < d; ++j) f[i] += P_(i, j) * prime(conj(psi[j]), Broken::gain);
        for (Index j = 0; j < d; ++j) s += prime(psi[j], Broken::innovation_variance) * f[j];
        for (Index i = 0; i < d; ++i) K_[i] = f[i] / s.re;
        for (Index i = 0; i < d; ++i)
            for (Index j = 0; j < d; ++j) P_(i, j) = (P_(i, j) - K_[i] * prime(f[j], Broken::covariance)) / lambda_;
        for (Index i = 0; i < d; ++i) theta_[i] += K_[i] * e;
        return step_of(e, lambda_, s.re, theta_);
    }
    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
};

template <ComplexScalar T>
using BrokenFilters = TypeList<Plain<T, Broken::innovation>, Plain<T, Broken::innovation_variance>,
                               Plain<T, Broken::covariance>, Plain<T, Broken::gain>>;

/// The variant over the real numbers.
template <template <Scalar, int> class F, Scalar T, int N>
std::type_identity<F<RealOf<T>, Dynamic>> real_twin(std::type_identity<F<T, N>>, int);
template <template <RootedScalar, int> class F, RootedScalar T, int N>
std::type_identity<F<RealOf<T>, Dynamic>> real_twin(std::type_identity<F<T, N>>, long);
template <ComplexScalar T, Broken broken>
std::type_identity<Conventional<RealOf<T>>> real_twin(std::type_identity<Plain<T, broken>>, int);
template <class F>
using RealTwin = typename decltype(real_twin(std::type_identity<F>{}, 0))::type;

}  // namespace rlslab::complex_tests
