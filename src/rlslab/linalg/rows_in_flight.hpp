// Rows that are known in advance: several of them are rotated into a triangle at the same time.
//
// For updates whose rotations wait for one another. Sizes are d and d x d.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// `together` rows that are rotated into [r R  r z], R = L', with the bits of rotate_in for one after another: a
/// rotation waits for the one before it, and those of other rows fill the time. Holds their workspace.
template <RootedScalar T, int N>
class RowsInFlight {
    static constexpr Index parts = 3 * kernels::RotateInRows<T>::together;
    static constexpr int Capacity = N == Dynamic ? Dynamic : int(parts * column_stride<T, N>(N));
    Index stride_;
    detail::Buffer<T, Capacity> buffer_;  // of all rows the regressors, the cosines and the sines
    T eta_[size_t(kernels::RotateInRows<T>::together)];

    T* part(Index n) { return buffer_.values.data() + n * stride_; }

public:
    static constexpr Index together = kernels::RotateInRows<T>::together;

    explicit RowsInFlight(Index size) : stride_(column_stride<T, N>(size)), buffer_(parts * stride_, size) {}
    static bool are_faster(Index d) { return d >= kernels::together_from; }

    /// The rows from k on of psi (d x B) and y (B).
    void rotate_in(StateMatrix<T, N>& L, T const& r, StateVector<T, N>& z, RowsOf<T> psi, OutputsOf<T> y, Index k) {
        for (Index n = 0; n < together; ++n) {
            eta_[n] = y[k + n];
            std::copy_n(psi.col(k + n).data(), L.size(), part(n));
        }
        run_kernel<T, N>(kernels::RotateInRows<T>{L.size(), L.stride(), L.column(0), part(0), z.data(), eta_,
                                                  part(together), part(2 * together), r});
    }
    /// Row n's rotations, and what they leave of its y.
    T const& rotation(Index n, StateVector<T, N>& c, StateVector<T, N>& s) {
        std::copy_n(part(together + n), c.size(), c.data());
        std::copy_n(part(2 * together + n), s.size(), s.data());
        return eta_[n];
    }
};
/// Without registers, and at the smallest fixed sizes, one row is rotated in after another.
template <RootedScalar T, int N>
    requires(!Hardware<T> || (N != Dynamic && N <= 8))
class RowsInFlight<T, N> {
public:
    static constexpr Index together = 1;
    explicit RowsInFlight(Index) {}
    static bool are_faster(Index) { return false; }
    void rotate_in(auto const&...) {}
    T rotation(auto const&...) { return T(0); }
};

/// f.update for each column of psi (d x B) with its number of y (B), the oldest first; B >= 1. Returns the last step.
/// fold(k) is to do what the updates of `together` rows from k on do, but for their reports: the last row is never
/// among them. `shown` are the vectors that views of f's answers show. Where psi or y is such a view, a row changes
/// those behind it, and rows go one by one. Throws std::invalid_argument for other shapes, before any row is processed.
template <class Flight, class F, class Fold, class... Shown>
auto update_rows(F& f, Flight const&, Index d, RowsOf<typename F::scalar> psi, OutputsOf<typename F::scalar> y,
                 Fold fold, Shown const&... shown) {
    expects(d >= 1 && psi.rows() == d && psi.cols() == y.size() && y.size() >= 1,
            "a block of d x B regressors and B outputs");
    [[maybe_unused]] Index const numbers = (psi.cols() - 1) * psi.outerStride() + d;
    bool const stay = (... && (detail::disjoint(y.data(), y.size(), shown.data(), d) &&
                               detail::disjoint(psi.data(), numbers, shown.data(), d)));
    Index k = 0;
    if (stay && Flight::are_faster(d))
        for (; k + Flight::together < y.size(); k += Flight::together) fold(k);
    for (;; ++k) {
        auto const step = f.update({psi.col(k).data(), d}, y[k]);
        if (k + 1 == y.size()) return step;
    }
}

}  // namespace rlslab
