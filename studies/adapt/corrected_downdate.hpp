// R of a window's rows, from which a row is taken by the corrected semi-normal equations: small on purpose, sums in
// order.
#pragma once

#include <rlslab/linalg/rotations.hpp>

#include <deque>
#include <vector>

namespace rlslab::studies {

/// A = [I / c; the rows of the window], R'R = A'A, lambda = 1. A row comes by Givens rotations. The oldest, psi, leaves
/// so:
///
///   (1) R'q = psi, R t = q, r = e - A t        e has a 1 where A has psi
///   (2) R'h = A'r, R t = h, q += h, r -= A t   the corrected semi-normal equations
///   (3) alpha = |r|; rotations that take (q, alpha) to (0, 1), applied to [R; 0]
///
/// In exact arithmetic h = 0, and alpha^2 = 1 - q'q is what LINPACK's dchdd computes. Here q and alpha come from the
/// rows themselves, so that the error of R is rotated, not divided by alpha. (2) costs 3 W d + O(d^2). No y: P alone.
/// Source: Björck, Park & Eldén 1994; (2): Higham 2002, chapter 20 (both cited, not read).
template <Real T>
class CorrectedDowndate {
    Index d_, rows_;
    std::vector<T> R_;  // d x d by rows, upper
    T prior_;           // 1 / c
    std::deque<std::vector<T>> kept_;

    T& R(Index i, Index j) { return R_[size_t(i * d_ + j)]; }
    void solve_transposed(std::vector<T>& x) {
        for (Index i = 0; i < d_; ++i) {
            for (Index k = 0; k < i; ++k) x[size_t(i)] -= R(k, i) * x[size_t(k)];
            x[size_t(i)] /= R(i, i);
        }
    }
    void solve(std::vector<T>& x) {
        for (Index i = d_; i-- > 0;) {
            for (Index k = i + 1; k < d_; ++k) x[size_t(i)] -= R(i, k) * x[size_t(k)];
            x[size_t(i)] /= R(i, i);
        }
    }
    /// r -= A t, the prior's d numbers first; and A'r.
    void subtract_product(std::vector<T> const& t, std::vector<T>& r) {
        for (Index i = 0; i < d_; ++i) r[size_t(i)] -= prior_ * t[size_t(i)];
        for (size_t k = 0; k < kept_.size(); ++k)
            for (Index i = 0; i < d_; ++i) r[size_t(d_) + k] -= kept_[k][size_t(i)] * t[size_t(i)];
    }
    std::vector<T> transposed_product(std::vector<T> const& r) {
        std::vector<T> out(static_cast<size_t>(d_));
        for (Index i = 0; i < d_; ++i) {
            out[size_t(i)] = prior_ * r[size_t(i)];
            for (size_t k = 0; k < kept_.size(); ++k) out[size_t(i)] += kept_[k][size_t(i)] * r[size_t(d_) + k];
        }
        return out;
    }
    void rotate_in(std::vector<T> x) {
        for (Index i = 0; i < d_; ++i) {
            Rotation<T> const turn = givens(R(i, i), x[size_t(i)]);
            for (Index j = i; j < d_; ++j) {
                T const old = R(i, j);
                R(i, j) = turn.c * old + turn.s * x[size_t(j)];
                x[size_t(j)] = turn.c * x[size_t(j)] - turn.s * old;
            }
        }
    }
    void remove_oldest() {
        std::vector<T> q = kept_.front();
        solve_transposed(q);
        std::vector<T> t = q, r(size_t(d_) + kept_.size(), T(0));
        solve(t);
        r[size_t(d_)] = T(1);
        subtract_product(t, r);  // (1)
        std::vector<T> h = transposed_product(r);
        solve_transposed(h);
        t = h;
        solve(t);
        subtract_product(t, r);  // (2)
        T square = T(0);
        for (T const& x : r) square += x * x;
        T alpha = square_root(square);
        std::vector<T> row(static_cast<size_t>(d_), T(0));
        for (Index i = d_; i-- > 0;) {  // (3)
            Rotation<T> const turn = givens(alpha, T(q[size_t(i)] + h[size_t(i)]));
            alpha = turn.r;
            for (Index j = i; j < d_; ++j) {
                T const old = R(i, j);
                R(i, j) = turn.c * old - turn.s * row[size_t(j)];
                row[size_t(j)] = turn.c * row[size_t(j)] + turn.s * old;
            }
        }
        kept_.pop_front();
    }

public:
    CorrectedDowndate(Index size, Index rows, T const& prior_variance)
        : d_(size), rows_(rows), R_(size_t(size * size), T(0)), prior_(T(1) / square_root(prior_variance)) {
        for (Index i = 0; i < d_; ++i) R(i, i) = prior_;
    }
    void update(std::vector<T> const& psi) {
        rotate_in(psi);
        kept_.push_back(psi);
        if (Index(kept_.size()) > rows_) remove_oldest();
    }
    /// P^-1 = R'R.
    Stored<T> stored() const {
        Matrix<T> L = Matrix<T>::Zero(d_, d_);
        for (Index i = 0; i < d_; ++i)
            for (Index j = i; j < d_; ++j) L(j, i) = R_[size_t(i * d_ + j)];
        return {Stored<T>::Quantity::information, Stored<T>::Form::factor, L};
    }
};

}  // namespace rlslab::studies
