// Delta forms that are no variants of the library: Potter's, QR-RLS by substitution, Gentleman's (docs/theory.md 91).
#pragma once

#include <rlslab/core/problem.hpp>
#include <rlslab/core/stored.hpp>

#include <cmath>

namespace rlslab::studies {

/// d parameters in the arithmetic T; P0 = variance I, theta0 = 0. theta() is in T, stored() is the factor.
template <class T>
class DeltaForm {
public:
    DeltaForm(Index d, T lambda, T variance)
        : lambda_(lambda), variance_(variance), d_(d), A_(Matrix<T>::Identity(d, d)), z_(d) {
        for (T& z : z_) z = T(0);
    }

protected:
    /// R^-1 z, R = A upper triangular.
    Vector<T> solved() const {
        Vector<T> out(d_);
        for (Index i = d_ - 1; i >= 0; --i) {
            T sum = z_[i];
            for (Index j = i + 1; j < d_; ++j) sum -= A_(i, j) * out[j];
            out[i] = sum / A_(i, i);
        }
        return out;
    }
    T lambda_, variance_;
    Index d_;
    Matrix<T> A_;  // S of potter, R of the others
    Vector<T> z_;  // theta of potter, R theta of the others
};

/// S_ij = t - (v_i f_j b - t w), w = 1 / sqrt(lambda) - 1, b = (1 + w) / (s + sqrt(lambda s)).
template <class T>
class PotterDelta final : public DeltaForm<T> {
    using DeltaForm<T>::lambda_, DeltaForm<T>::d_, DeltaForm<T>::A_, DeltaForm<T>::z_;

public:
    PotterDelta(Index d, T lambda, T variance) : DeltaForm<T>(d, lambda, variance) {
        using std::sqrt;
        for (Index i = 0; i < d; ++i) A_(i, i) = sqrt(variance);
    }
    void update(Vector<T> psi, T y) {
        using std::sqrt;
        Vector<T> f(d_), v(d_);
        T s = T(0), e = y;
        T const root = sqrt(lambda_), w = (T(1) - lambda_) / (T(1) + root) / root;
        for (Index j = 0; j < d_; ++j) {
            f[j] = v[j] = T(0);
            for (Index i = 0; i < d_; ++i) f[j] += A_(i, j) * psi[i];
            s += f[j] * f[j];
            e -= psi[j] * z_[j];
        }
        s += lambda_;
        T const b = (T(1) + w) / (s + sqrt(lambda_ * s));
        for (Index j = 0; j < d_; ++j)
            for (Index i = 0; i < d_; ++i) v[i] += A_(i, j) * f[j];
        for (Index j = 0; j < d_; ++j) {
            T const share = f[j] * b;
            for (Index i = 0; i < d_; ++i) A_(i, j) = A_(i, j) - (v[i] * share - A_(i, j) * w);
        }
        for (Index i = 0; i < d_; ++i) z_[i] += e * (v[i] / s);
    }
    Vector<T> theta() const { return z_; }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, A_}; }
};

/// R_ij = t + (g_i x_j - t h_i), h_i = 1 - c_i = (s_{i-1} (1 - lambda) + u_i^2) / (s_i (1 + c_i)); letters of qr.
template <class T>
class QrDelta final : public DeltaForm<T> {
    using DeltaForm<T>::lambda_, DeltaForm<T>::d_, DeltaForm<T>::A_, DeltaForm<T>::z_;

public:
    QrDelta(Index d, T lambda, T variance) : DeltaForm<T>(d, lambda, variance) {
        using std::sqrt;
        for (Index i = 0; i < d; ++i) A_(i, i) = T(1) / sqrt(variance);
    }
    void update(Vector<T> x, T y) {
        using std::sqrt;
        T before = lambda_;
        for (Index i = 0; i < d_; ++i) {
            T const u = x[i] / A_(i, i), square = u * u, after = before + square,
                    c = sqrt(lambda_) * sqrt(before / after), g = u * sqrt(lambda_ / before / after),
                    h = (before * (T(1) - lambda_) + square) / after / (T(1) + c);
            bool const small = c < T(0.5);
            auto const turn = [&](T& t, T& beside) {
                T const old = t;
                t = small ? T(c * old + g * beside) : T(old + (g * beside - old * h));
                beside -= u * old;
            };
            for (Index j = i; j < d_; ++j) turn(A_(i, j), x[j]);
            turn(z_[i], y);
            before = after;
        }
    }
    Vector<T> theta() const { return this->solved(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::factor, A_.transpose()}; }
};

/// D_i += w x_i^2 - D_i (1 - lambda), R_ij = t + s_i x_j' with the x_j' that is left; letters of gentleman.
template <class T>
class GentlemanDelta final : public DeltaForm<T> {
    using DeltaForm<T>::lambda_, DeltaForm<T>::d_, DeltaForm<T>::A_, DeltaForm<T>::z_;
    Vector<T> D_;

public:
    GentlemanDelta(Index d, T lambda, T variance) : DeltaForm<T>(d, lambda, variance), D_(d) {
        for (T& x : D_) x = T(1) / variance;
    }
    void update(Vector<T> x, T y) {
        T w = T(1);
        for (Index i = 0; i < d_; ++i) {
            T const worn = lambda_ * D_[i], weighted = w * x[i], square = weighted * x[i], sum = worn + square,
                    c = worn / sum, s = weighted / sum, head = x[i];
            bool const small = c < T(0.5);
            D_[i] = small ? sum : T(D_[i] + (square - D_[i] * (T(1) - lambda_)));
            auto const turn = [&](T& t, T& beside) {
                T const old = t, left = beside - head * old;
                t = small ? T(c * old + s * beside) : T(old + s * left);
                beside = left;
            };
            for (Index j = i + 1; j < d_; ++j) turn(A_(i, j), x[j]);
            turn(z_[i], y);
            w *= c;
        }
    }
    Vector<T> theta() const { return this->solved(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::information, Stored<T>::Form::factor, A_.transpose(), D_}; }
};

}  // namespace rlslab::studies
