// The gain of a block of rows, by products of matrices. Sizes are not checked.
#pragma once

#include <rlslab/linalg/finite.hpp>
#include <rlslab/linalg/team.hpp>

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
template <Scalar T>
class BlockGain {
    using Seat = detail::Seat;
    static constexpr Index panel = 16;
    StateVector<T> memory_{0};
    Index d_ = 0, k_ = 0, outputs_ = 0, threads_ = 1;

    Index ld() const { return column_stride<T, Dynamic>(d_); }
    Index ld_of_rows() const { return column_stride<T, Dynamic>(k_); }
    Strided<T> G() { return {memory_.data(), 1, ld()}; }
    Strided<T> F() { return G().from(0, 2 * k_); }
    Strided<T> S() { return {G().from(0, 3 * k_).at, 1, ld_of_rows()}; }  // below the diagonal L after (3)
    T* D() { return S().from(0, k_).at; }
    T* diagonal() { return S().from(0, k_ + 1).at; }           // of S
    T* scaled() { return S().from(0, k_ + 2 + outputs_).at; }  // D L' of a panel, a column k numbers
    /// Room for a product of each thread.
    static constexpr Index room_of = Hardware<T> ? kernels::SubtractProduct<T>::room_of : 0;
    T* room(Seat const& seat) { return S().from(0, k_ + 2 + outputs_ + panel).at + seat.i * room_of; }

    /// C -= A B.
    void subtract(Strided<T const> A, Strided<T const> B, Strided<T> C, Index rows, Index columns, Index depth,
                  Seat const& seat, bool lower = false) {
        if (rows > 0 && columns > 0)
            run_kernel<T, Dynamic>(kernels::SubtractProduct<T>{rows, columns, depth, A.at, A.row, A.column, B.at, B.row,
                                                               B.column, C.at, C.column, room(seat), lower});
    }
    /// C's lower triangle of n columns.
    void subtract_from_triangle(Strided<T const> A, Strided<T const> B, Strided<T> C, Index n, Index depth,
                                Seat const& seat) {
        auto const [from, to] = seat.share_of_triangle(n);
        subtract(A.from(from, 0), B.from(0, from), C.from(from, from), n - from, to - from, depth, seat, true);
    }
    /// C = -C.
    static void negate(Strided<T> C, Index rows, Index columns) {
        for (Index j = 0; j < columns; ++j)
            for (Index i = 0; i < rows; ++i) C(i, j) = -C(i, j);
    }
    static void clear(Strided<T> C, Index rows, Index columns) {
        for (Index j = 0; j < columns; ++j) std::fill_n(&C(0, j), rows, T(0));
    }
    /// Work that threads share where it is for hardware.
    template <class Work>
    void in_team(Work const& work) {
        detail::in_team(threads_, double(d_) * double(d_) * double(k_), work);
    }

public:
    /// Of the rows that were looked at.
    Strided<T> K() { return G().from(0, k_); }                ///< after (4): d x k
    Strided<T> innovations() { return S().from(0, k_ + 2); }  ///< k x m; after (7) the opposite

    /// (1) to (3), which change nothing. Returns the worst health of the rows: nonfinite for a number that is not, in
    /// the rows, in Y or on the way; indefinite for s_j < lambda.
    Health look(Strided<T const> P, Strided<T const> X, Strided<T const> theta, Strided<T const> Y, Index d, Index k,
                Index outputs, T const& lambda) {
        d_ = d, k_ = k, outputs_ = outputs, threads_ = Hardware<T> ? detail::threads_of_team() : 1;
        Index const numbers = 3 * ld() * k + ld_of_rows() * (k + 2 + outputs + panel) + threads_ * room_of;
        if (memory_.size() < numbers) memory_ = StateVector<T>(numbers);
        in_team([&](Seat const& seat) {
            auto const [from, to] = seat.share(0, k, 8);
            clear(G().from(0, from), d, to - from);
            subtract(P, X.from(0, from), G().from(0, from), d, to - from, d, seat);
            negate(G().from(0, from), d, to - from);
            for (Index j = 0; j < outputs; ++j)
                for (Index i = from; i < to; ++i) innovations()(i, j) = Y(i, j);
            subtract(X.from(0, from).turned(), theta, innovations().from(from, 0), to - from, outputs, d, seat);  // (1)
            auto const [left, right] = seat.share_of_triangle(k);
            clear(S().from(0, left), k, right - left);
            seat.wait();
            subtract_from_triangle(X.turned(), G(), S(), k, d, seat);
        });
        T weight = lambda;
        for (Index j = 0; j < k; ++j, weight *= lambda) {
            for (Index i = j; i < k; ++i) S()(j, i) = S()(i, j) = -S()(i, j);
            diagonal()[j] = S()(j, j) += weight;  // (2)
        }
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
        in_team([&](Seat const& seat) {
            auto const [top, bottom] = seat.share(0, d_, 8);  // rows of K and F
            for (Index j = 0; j < k_; ++j) {
                std::copy_n(&G()(top, j), bottom - top, &K()(top, j));
                std::copy_n(&G()(top, j), bottom - top, &F()(top, j));
            }
            divide_by_factors(top, bottom - top, seat);  // (4)
            seat.wait();
            if (seat.i == 0) {
                perturb(K());
                for (Index j = 0; j < k_; ++j)
                    for (Index i = 0; i <= j; ++i) S()(j, i) = S()(i, j) = (i < j ? S()(i, j) : diagonal()[j]) / T(2);
                negate(innovations(), k_, outputs_);
            }
            seat.wait();
            subtract(K().from(top, 0), S(), F().from(top, 0), bottom - top, k_, k_, seat);                    // (5)
            subtract(K().from(top, 0), innovations(), theta.from(top, 0), bottom - top, outputs_, k_, seat);  // (7)
            seat.wait();
            subtract_from_triangle(K(), F().turned(), P, d_, k_, seat);
            subtract_from_triangle(F(), K().turned(), P, d_, k_, seat);
            auto const [left, right] = seat.share_of_triangle(d_);
            constexpr Index side = 32;  // of squares that fit a cache
            for (Index J = left; J < right; J += side)
                for (Index I = J; I < d_; I += side)
                    for (Index j = J; j < std::min(J + side, right); ++j)
                        for (Index i = std::max(I, j); i < std::min(I + side, d_); ++i)
                            P(i, j) = P(j, i) = by_weight(P(i, j));  // (6)
        });
    }

    /// After commit(): (1) and (7) of further outputs; E begins as Y, and is overwritten.
    void take_outputs(Strided<T const> X, Strided<T> theta, Strided<T> E, Index outputs) {
        in_team([&](Seat const& seat) {
            auto const [from, to] = seat.share(0, k_, 8);
            subtract(X.from(0, from).turned(), theta, E.from(from, 0), to - from, outputs, d_, seat);
            negate(E.from(from, 0), to - from, outputs);
            seat.wait();
            auto const [top, bottom] = seat.share(0, d_, 8);
            subtract(K().from(top, 0), E, theta.from(top, 0), bottom - top, outputs, k_, seat);
        });
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
            subtract(S().from(to, from), Strided<T>{scaled() + to, k_, 1}, S().from(to, to), k_ - to, k_ - to,
                     to - from, {}, true);
        }
    }
    /// Rows of K, each by itself: K = ((K L^-T) D^-1) L^-1.
    void divide_by_factors(Index first, Index rows, Seat const& seat) {
        Strided<T> const L = S(), X = K().from(first, 0);
        for (Index from = 0; from < k_; from += panel) {
            Index const to = std::min(from + panel, k_);
            subtract(X, L.from(from, 0).turned(), X.from(0, from), rows, to - from, from, seat);
            for (Index j = from; j < to; ++j)
                for (Index i = from; i < j; ++i) add_scaled(&X(0, j), T(-L(j, i)), &X(0, i), rows);
        }
        for (Index j = 0; j < k_; ++j)
            for (Index i = 0; i < rows; ++i) X(i, j) /= D()[j];
        for (Index to = k_, from; to > 0; to = from) {
            from = (to - 1) / panel * panel;
            subtract(X.from(0, to), L.from(to, from), X.from(0, from), rows, to - from, k_ - to, seat);
            for (Index j = to; j-- > from;)
                for (Index i = j + 1; i < to; ++i) add_scaled(&X(0, j), T(-L(i, j)), &X(0, i), rows);
        }
    }
};

}  // namespace rlslab
