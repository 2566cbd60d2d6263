// The gain of a block of rows, by products of matrices. Sizes are not checked.
#pragma once

#include <rlslab/linalg/finite.hpp>

namespace rlslab {

/// A matrix where it lies: its first number, and the steps from one row and from one column to the next.
template <class T>
struct Strided {
    T* at;
    Index row, column;
    T& operator()(Index i, Index j) const { return at[i * row + j * column]; }
    Strided turned() const { return {at, column, row}; }
    Strided from(Index i, Index j) const { return {at + i * row + j * column, row, column}; }
    operator Strided<T const>() const
        requires(!std::is_const_v<T>)
    {
        return {at, row, column};
    }
};
template <class T, int N>
Strided<T> strided(StateMatrix<T, N>& A) {
    return {A.column(0), 1, A.stride()};
}

/// The gain of k rows psi_j, the columns of X, and what it makes of P and of the thetas of m outputs, the columns of
/// Theta; Y is k x m:
///
///   (1) G = P X,  E = Y - X'Theta     (2) S = Lambda + X'G,  Lambda = diag(lambda, lambda^2, ..., lambda^k)
///   (3) S = L D L'     (4) K = G S^-1     (5) F = G - K S / 2     (6) P = (P - (K F' + F K')) / lambda^k
///   (7) Theta += K E
///
/// D_j is lambda^(j-1) s_j, s_j of row j alone after the rows before it; K's last column is the last row's gain. (6) is
/// ((I - K X')P(I - K X')' + K Lambda K') / lambda^k for any K. Sums are kernels::SubtractProduct's; (3) and (4) go by
/// panels of 16 columns. P is read in full; (6) computes its lower triangle. 2 d^2 k + 3 d k^2 + k^3 / 6 + 2 d k m
/// multiplications, (3 d + k + m) k numbers of workspace. Allocates where no block was as large.
template <Field T>
class BlockGain {
    static constexpr Index panel = 16;
    StateVector<T> memory_{0};
    Index d_ = 0, k_ = 0, outputs_ = 0;

    Index ld() const { return column_stride<T, Dynamic>(d_); }
    Index ld_of_rows() const { return column_stride<T, Dynamic>(k_); }
    Strided<T> G() { return {memory_.data(), 1, ld()}; }
    Strided<T> F() { return G().from(0, 2 * k_); }
    Strided<T> S() { return {G().from(0, 3 * k_).at, 1, ld_of_rows()}; }  // below the diagonal L after (3)
    T* D() { return S().from(0, k_).at; }
    T* diagonal() { return S().from(0, k_ + 1).at; }  // of S
    T* scaled() { return S().from(0, k_ + 2 + outputs_).at; }  // D L' of a panel, a column k numbers
    T* room() { return S().from(0, k_ + 2 + outputs_ + panel).at; }

    /// C -= A B.
    void subtract(Strided<T const> A, Strided<T const> B, Strided<T> C, Index rows, Index columns, Index depth,
                  bool lower = false) {
        run_kernel<T, Dynamic>(kernels::SubtractProduct<T>{rows, columns, depth, A.at, A.row, A.column, B.at, B.row,
                                                           B.column, C.at, C.column, room(), lower});
    }
    /// C = -C.
    static void negate(Strided<T> C, Index rows, Index columns) {
        for (Index j = 0; j < columns; ++j)
            for (Index i = 0; i < rows; ++i) C(i, j) = -C(i, j);
    }
    /// C = A B.
    void multiply(Strided<T const> A, Strided<T const> B, Strided<T> C, Index rows, Index columns, Index depth) {
        for (Index j = 0; j < columns; ++j) std::fill_n(&C(0, j), rows, T(0));
        subtract(A, B, C, rows, columns, depth);
        negate(C, rows, columns);
    }

public:
    /// Of the rows that were looked at.
    Strided<T> K() { return G().from(0, k_); }              ///< after (4): d x k
    Strided<T> innovations() { return S().from(0, k_ + 2); }  ///< k x m; after (7) the opposite

    /// (1) to (3), which change nothing. Returns the worst health of the rows: nonfinite for a number that is not, in
    /// the rows, in Y or on the way; indefinite for s_j < lambda.
    Health look(Strided<T const> P, Strided<T const> X, Strided<T const> theta, Strided<T const> Y, Index d, Index k,
                Index outputs, T const& lambda) {
        d_ = d, k_ = k, outputs_ = outputs;
        Index const numbers = 3 * ld() * k + ld_of_rows() * (k + 2 + outputs + panel) +
                              (Hardware<T> ? kernels::SubtractProduct<T>::room_of : 0);
        if (memory_.size() < numbers) memory_ = StateVector<T>(numbers);
        multiply(P, X, G(), d, k, d);
        for (Index j = 0; j < outputs; ++j)
            for (Index i = 0; i < k; ++i) innovations()(i, j) = Y(i, j);
        subtract(X.turned(), theta, innovations(), k, outputs, d);  // (1)
        multiply(X.turned(), G(), S(), k, k, d);
        T weight = lambda;
        for (Index j = 0; j < k; ++j, weight *= lambda) diagonal()[j] = S()(j, j) += weight;  // (2)
        for (Index j = 0; j < k; ++j)  // one number above and below the diagonal: L is written below
            for (Index i = 0; i < j; ++i) S()(i, j) = S()(j, i);
        factor();  // (3)
        Health out = Health::sound;
        weight = lambda;
        for (Index j = 0; j < k; ++j, weight *= lambda) {
            if (!(weight <= D()[j])) out = worse(out, Health::indefinite);
            if (!is_finite(D()[j])) out = Health::nonfinite;
        }
        for (Index j = 0; j < outputs; ++j)
            for (Index i = 0; i < k; ++i)
                if (!is_finite(innovations()(i, j))) out = Health::nonfinite;
        return out;
    }
    /// (4) to (7) after look(), once; by_weight(x) = x / lambda^k. `perturb(K)` changes K after (4).
    template <class ByWeight, class Perturb>
    void commit(Strided<T> P, Strided<T> theta, ByWeight const& by_weight, Perturb&& perturb) {
        std::copy_n(G().at, k_ * ld(), K().at);
        divide_by_factors();  // (4)
        perturb(K());
        for (Index j = 0; j < k_; ++j)
            for (Index i = 0; i <= j; ++i) S()(j, i) = S()(i, j) = (i < j ? S()(i, j) : diagonal()[j]) / T(2);
        std::copy_n(G().at, k_ * ld(), F().at);
        subtract(K(), S(), F(), d_, k_, k_);  // (5)
        subtract(K(), F().turned(), P, d_, d_, k_, true);
        subtract(F(), K().turned(), P, d_, d_, k_, true);
        constexpr Index side = 32;  // of squares that fit a cache
        for (Index J = 0; J < d_; J += side)
            for (Index I = J; I < d_; I += side)
                for (Index j = J; j < std::min(J + side, d_); ++j)
                    for (Index i = std::max(I, j); i < std::min(I + side, d_); ++i)
                        P(i, j) = P(j, i) = by_weight(P(i, j));  // (6)
        negate(innovations(), k_, outputs_);
        subtract(K(), innovations(), theta, d_, outputs_, k_);  // (7)
    }

    /// After commit(): (1) and (7) of further outputs; E begins as Y, and is overwritten.
    void take_outputs(Strided<T const> X, Strided<T> theta, Strided<T> E, Index outputs) {
        subtract(X.turned(), theta, E, k_, outputs, d_);
        negate(E, k_, outputs);
        subtract(K(), E, theta, d_, outputs, k_);
    }

private:
    void factor() {
        for (Index from = 0; from < k_; from += panel) {
            Index const to = std::min(from + panel, k_);
            for (Index j = from; j < to; ++j) {
                T* const column = &S()(0, j);
                D()[j] = column[j];
                for (Index i = j + 1; i < to; ++i) add_scaled(&S()(i, i), T(-(column[i] / D()[j])), column + i, k_ - i);
                std::copy(column + to, column + k_, scaled() + (j - from) * k_ + to);
                for (Index i = j + 1; i < k_; ++i) column[i] /= D()[j];
            }
            subtract(S().from(to, from), Strided<T>{scaled() + to, k_, 1}, S().from(to, to), k_ - to, k_ - to, to - from,
                     true);
        }
    }
    void divide_by_factors() {  // K = ((K L^-T) D^-1) L^-1
        Strided<T> const L = S(), X = K();
        for (Index from = 0; from < k_; from += panel) {
            Index const to = std::min(from + panel, k_);
            subtract(X, L.from(from, 0).turned(), X.from(0, from), d_, to - from, from);
            for (Index j = from; j < to; ++j)
                for (Index i = from; i < j; ++i) add_scaled(&X(0, j), T(-L(j, i)), &X(0, i), d_);
        }
        for (Index j = 0; j < k_; ++j)
            for (Index i = 0; i < d_; ++i) X(i, j) /= D()[j];
        for (Index to = k_, from; to > 0; to = from) {
            from = (to - 1) / panel * panel;
            subtract(X.from(0, to), L.from(to, from), X.from(0, from), d_, to - from, k_ - to);
            for (Index j = to; j-- > from;)
                for (Index i = j + 1; i < to; ++i) add_scaled(&X(0, j), T(-L(i, j)), &X(0, i), d_);
        }
    }
};

}  // namespace rlslab
