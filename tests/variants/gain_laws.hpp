// One step of recursive least squares with an error in what plays the gain: random cases, the errors, and what the laws
// say.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/stored.hpp>

#include <array>
#include <span>
#include <vector>

namespace rlslab::gain_laws {

template <class T>
T inner(Vector<T> const& a, Vector<T> const& b) {
    T sum = T(0);
    for (Index i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}
template <class T>
Matrix<T> outer(Vector<T> const& a, Vector<T> const& b) {
    return a.lazyProduct(b.transpose());
}
template <class T>
T largest(Matrix<T> const& A) {
    T out = T(0);
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.rows(); ++i)
            if (!(absolute(T(A(i, j))) <= out)) out = absolute(T(A(i, j)));
    return out;
}
template <class T>
T trace(Matrix<T> const& A) {
    T sum = T(0);
    for (Index i = 0; i < A.rows(); ++i) sum += A(i, i);
    return sum;
}
template <class T>
T determinant(Matrix<T> A) {  // elimination without pivoting: semidefinite matrices only
    T out = T(1);
    for (Index j = 0; j < A.rows(); ++j) {
        if (A(j, j) == T(0)) return T(0);
        out *= A(j, j);
        for (Index i = j + 1; i < A.rows(); ++i) {
            T const m = A(i, j) / A(j, j);
            for (Index k = j; k < A.rows(); ++k) A(i, k) -= m * A(j, k);
        }
    }
    return out;
}

template <class T>
Matrix<T> inverse(Matrix<T> A) {  // Gauss-Jordan without pivoting: definite matrices only
    Index const d = A.rows();
    Matrix<T> X = Matrix<T>::Identity(d, d);
    for (Index j = 0; j < d; ++j) {
        T const pivot = A(j, j);
        for (Index k = 0; k < d; ++k) A(j, k) /= pivot, X(j, k) /= pivot;
        for (Index i = 0; i < d; ++i)
            if (i != j) {
                T const m = A(i, j);
                for (Index k = 0; k < d; ++k) A(i, k) -= m * A(j, k), X(i, k) -= m * X(j, k);
            }
    }
    return X;
}

/// P, psi, lambda of small numbers, the exact step, and an error of the gain: of K itself up to twice its size.
template <class T>
struct Case {
    Index size;
    T lambda, s;
    Matrix<T> P, P_next;
    Vector<T> psi, f, K, delta;
    std::vector<T> s_after;             ///< s_0 = lambda ... s_d = s
    std::vector<Vector<T>> gain_after;  ///< K_(0) = 0 ... K_(d) = K

    explicit Case(Seed seed, double along_K = 0) : size(2 + Index(seed.next() % 3)) {
        std::array<T, 4> const factors{T(1), T(49) / T(50), T(9) / T(10), T(7) / T(10)};
        lambda = factors[seed.next() % 4];
        auto const fraction = [&seed] {
            T const above = T(int(seed.next() % 19) - 9);  // before the draw below, by every compiler
            return above / T(1 + int(seed.next() % 4));
        };
        Matrix<T> L(size, size);
        for (Index j = 0; j < size; ++j)
            for (Index i = 0; i < size; ++i) L(i, j) = fraction();
        P = L.lazyProduct(L.transpose()) / T(8) + Matrix<T>::Identity(size, size);
        psi = Vector<T>(size);
        for (T& x : psi) x = fraction() / T(2);
        psi[0] += T(int(psi.isZero(T(0))));  // a row of zeros has no gain
        f = P.lazyProduct(psi);
        s = lambda + inner(psi, f);
        K = f / s;
        P_next = (P - outer(f, f) / s) / lambda;
        delta = Vector<T>(size);
        for (Index i = 0; i < size; ++i) {
            delta[i] = along_K != 0 ? T(along_K) * K[i] : K[i] * fraction() / T(5);
            if (along_K == 0) delta[i] += fraction() / T(50);
        }
        // P = U D U' from the last column on, and the sweep's partial gains.
        Matrix<T> A = P, U = Matrix<T>::Identity(size, size);
        Vector<T> D(size), v = Vector<T>::Zero(size);
        for (Index j = size; j-- > 0;) {
            D[j] = A(j, j);
            for (Index i = 0; i < j; ++i) U(i, j) = A(i, j) / D[j];
            for (Index k = 0; k < j; ++k)
                for (Index i = 0; i < j; ++i) A(i, k) -= U(i, j) * D[j] * U(k, j);
        }
        s_after.push_back(lambda);
        gain_after.push_back(v);
        for (Index j = 0; j < size; ++j) {
            Vector<T> const column = U.col(j);
            T const f_j = inner(column, psi);
            v += column * T(D[j] * f_j);
            s_after.push_back(s_after.back() + f_j * D[j] * f_j);
            gain_after.push_back(v / s_after.back());
        }
    }
    Case with_error(Vector<T> error) const {
        Case out = *this;
        out.delta = std::move(error);
        return out;
    }
    Problem<T> problem() const {
        return {.size = size, .forgetting = lambda, .prior = Prior<T>{.variance = T(1), .covariance = P}};
    }
};

// --- perturbations ---------------------------------------------------------------------------------------------------

template <class T>
struct AddToGain {
    Vector<T> delta;
    void operator()(auto& K) const {
        for (Index i = 0; i < K.size(); ++i) K[i] += delta[i];
    }
};
template <class T>
struct AddAfterColumn {
    Vector<T> delta;
    Index column;
    void operator()(std::span<T> v, T const&) const {
        if (Index(v.size()) == column)
            for (size_t i = 0; i < v.size(); ++i) v[i] += delta[Index(i)];
    }
};
/// v_i (1 + r_i) in place of v_i in every column.
template <class T>
struct ScaleWhereverUsed {
    Vector<T> r;
    std::vector<T> left;
    void operator()(std::span<T> v, T const& kept) {
        left.resize(v.size(), T(0));
        for (size_t i = 0; i < v.size(); ++i) left[i] = v[i] += (v[i] - kept * left[i]) * r[Index(i)];
    }
};

/// P after one step of F with this perturbation, multiplied out.
template <class F, class Perturb>
auto after(Case<typename F::scalar> const& c, Perturb perturb) {
    using T = typename F::scalar;
    F filter(c.problem());
    filter.update(c.psi, T(1), perturb);
    return multiplied_out(Stored<T>(filter.stored()));
}
/// The error of K as one of what F uses: v = s K in Potter's form.
template <class F>
auto scaled_for(Case<typename F::scalar> const& c) {
    using T = typename F::scalar;
    return Vector<T>(F::name == "potter" ? Vector<T>(c.s * c.delta) : c.delta);
}
/// What F's running vector after j columns is of v.
template <class F>
auto running_scale(Case<typename F::scalar> const& c, Index j) {
    using T = typename F::scalar;
    if constexpr (F::name == "inverse_qr") return T(T(1) / square_root(T(c.lambda * c.s_after[size_t(j)])));
    else if constexpr (F::name == "inverse_qr_delta") return T(T(1) / square_root(c.s_after[size_t(j)]));
    else if constexpr (F::name == "extended_qr") return T(-square_root(T(c.lambda / c.s_after[size_t(j)])) / c.lambda);
    else return T(1);
}

// --- what the laws say of delta P ------------------------------------------------------------------------------------

template <class T>
Matrix<T> nothing(Case<T> const& c) {
    return Matrix<T>::Zero(c.size, c.size);
}
template <class T>
Matrix<T> first_order(Case<T> const& c) {
    return -outer(c.delta, c.f) / c.lambda;
}
template <class T>
Matrix<T> mirrored(Case<T> const& c) {
    Matrix<T> out = first_order(c);
    for (Index j = 0; j < c.size; ++j)
        for (Index i = 0; i < j; ++i) out(j, i) = out(i, j);
    return out;
}
template <class T>
Matrix<T> symmetrised(Case<T> const& c) {
    return (first_order(c) + first_order(c).transpose()) / T(2);
}
template <class T>
Matrix<T> second_order(Case<T> const& c) {
    return c.s / c.lambda * outer(c.delta, c.delta);
}
template <class T>
Matrix<T> potter(Case<T> const& c) {
    T const rho = square_root(T(c.lambda / c.s));
    return c.s / c.lambda *
           (-rho / (1 + rho) * (outer(c.delta, c.K) + outer(c.K, c.delta)) +
            (1 - rho) / (1 + rho) * outer(c.delta, c.delta));
}
template <class T>
Matrix<T> sweep_to_first_order(Case<T> const& c, Vector<T> const& delta_v, Index j) {
    Vector<T> const w = c.K - c.gain_after[size_t(j)];
    return -(outer(delta_v, w) + outer(w, delta_v)) / c.lambda;
}
template <class T>
Matrix<T> sweep(Case<T> const& c, Vector<T> const& delta_v, Index j) {
    return sweep_to_first_order(c, delta_v, j) +
           (T(1) / c.s_after[size_t(j)] - T(1) / c.s) / c.lambda * outer(delta_v, delta_v);
}
/// The derivative by eps of P where the running gain is v_i (1 + eps r_i) in every column, r = delta.
template <class T>
Matrix<T> relative_in_sweep(Case<T> const& c) {
    Matrix<T> Y = Matrix<T>::Zero(c.size, c.size);
    for (size_t k = 1; k < c.s_after.size(); ++k)
        Y += outer<T>(c.gain_after[k - 1] * c.s_after[k - 1], c.gain_after[k] - c.gain_after[k - 1]);
    Matrix<T> out(c.size, c.size);
    for (Index j = 0; j < c.size; ++j)
        for (Index i = 0; i < c.size; ++i) out(i, j) = -(c.delta[i] * Y(i, j) + Y(j, i) * c.delta[j]) / c.lambda;
    return out;
}

}  // namespace rlslab::gain_laws
