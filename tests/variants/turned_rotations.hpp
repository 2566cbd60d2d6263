// One update of `inverse_qr` and of `qr` in which the angle of one rotation is wrong (docs/theory.md 35).
#pragma once

#include <rlslab/core/matrices.hpp>

#include <utility>
#include <vector>

namespace rlslab {

/// The new S of P = S S', S upper triangular, and b_1 ... b_d. Rotation `wrong` turns by phi more; -1: none.
template <class T>
std::pair<Matrix<T>, std::vector<T>> turned_inverse_qr(Matrix<T> S, Vector<T> const& psi, T const& lambda, Index wrong,
                                                       T const& phi) {
    Index const d = psi.size();
    S /= sqrt(lambda);
    Vector<T> const a = S.transpose().lazyProduct(psi);
    Vector<T> g = Vector<T>::Zero(d);
    T b = T(1);
    std::vector<T> all;
    for (Index j = 0; j < d; ++j) {
        T const next = sqrt(T(b * b + a[j] * a[j]));
        T cosine = b / next, sine = a[j] / next;
        if (j == wrong) {
            T const turned = cosine * cos(phi) - sine * sin(phi);
            sine = sine * cos(phi) + cosine * sin(phi);
            cosine = turned;
        }
        for (Index i = 0; i <= j; ++i) {
            T const t = S(i, j), before = g[i];
            g[i] = cosine * before + sine * t;
            S(i, j) = cosine * t - sine * before;
        }
        b = next;
        all.push_back(b);
    }
    return {S, all};
}

/// The new R of P^-1 = R'R, R upper triangular, and the running row after rotation `wrong`, which turns by phi more.
template <class T>
std::pair<Matrix<T>, Vector<T>> turned_qr(Matrix<T> R, Vector<T> const& psi, T const& lambda, Index wrong,
                                          T const& phi) {
    Index const d = psi.size();
    R *= sqrt(lambda);
    Vector<T> x = psi, after = Vector<T>::Zero(d);
    for (Index i = 0; i < d; ++i) {
        T const r = sqrt(T(R(i, i) * R(i, i) + x[i] * x[i])), cosine = R(i, i) / r, sine = x[i] / r;
        auto const turn = [&](T const& with_cosine, T const& with_sine) {
            for (Index k = i; k < d; ++k) {
                T const t = R(i, k);
                R(i, k) = with_cosine * t + with_sine * x[k];
                x[k] = with_cosine * x[k] - with_sine * t;
            }
            x[i] = T(0);  // as the variant has it: what it does not store
        };
        turn(cosine, sine);
        if (i == wrong) {
            after = x;
            turn(cos(phi), sin(phi));
        }
    }
    return {R, after};
}

}  // namespace rlslab
