// Rows that are known in advance: while P is changed for one row, its product with the next row is computed in the same
// pass over memory.
//
// For updates that begin with f = P psi, or with S'psi for an upper triangle S, and end with a change of P or of S.
// Sizes are d and d x d.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/sweeps.hpp>

namespace rlslab {

/// The next row's regressor and its product with the P or S' that Pass leaves. It knows them only while `update_rows`
/// runs; otherwise `multiply` and the functions below do what those without a NextRow do. The product has the bits that
/// `multiply` gives it.
template <class Pass, int N>
class NextRow {
    using T = std::remove_pointer_t<decltype(Pass::A)>;
    T const* psi_ = nullptr;
    bool (*run_and_multiply_)(NextRow&, Pass const&) = nullptr;
    bool multiplied_ = false;
    StateVector<T, N> product_;

    /// Runs the pass with the product and returns true; or does nothing and returns false, where two passes are faster.
    static bool run_and_multiply(NextRow& next, Pass const& pass) {
        next.multiplied_ = kernels::one_pass_is_faster<Pass>(kernels::isa, pass.d);
        if (next.multiplied_) run_kernel<T, N>(kernels::ThenMultiply<Pass>{pass, next.psi_, next.product_.data()});
        return next.multiplied_;
    }

    /// Not inlined, and with a copy whose address alone is handed on: the pass stays in registers where it is called.
    [[gnu::noinline]] bool run_announced(Pass const& pass) {
        Pass const copy = pass;
        return run_and_multiply_(*this, copy);
    }

public:
    explicit NextRow(Index size) : product_(size) {}
    /// psi: d numbers that stay as they are until the next call, or nullptr. Only who calls this compiles the pass with
    /// the product: row by row it is not needed.
    void announce(T const* psi) {
        psi_ = psi;
        run_and_multiply_ = psi == nullptr ? nullptr : &run_and_multiply;
    }

    [[gnu::always_inline]] void run(Pass const& pass) {
        if (psi_ == nullptr || !run_announced(pass)) run_kernel<T, N>(pass);
    }
    /// Moves the product to f, if it has been computed.
    bool move_product(StateVector<T, N>& f) {
        if (!multiplied_) return false;
        std::swap(f, product_);
        multiplied_ = false;
        return true;
    }
};
/// Without registers, at the smallest fixed sizes and where every operation draws a random number, one row is computed
/// after another.
template <class Pass, int N>
    requires(!Hardware<std::remove_pointer_t<decltype(Pass::A)>> || (N != Dynamic && N < 16))
class NextRow<Pass, N> {
    using T = std::remove_pointer_t<decltype(Pass::A)>;

public:
    explicit NextRow(Index) {}
    void announce(T const*) {}
    [[gnu::always_inline]] void run(Pass const& pass) { run_kernel<T, N>(pass); }
    bool move_product(StateVector<T, N>&) { return false; }
};

/// f = A x, or the product that `next` has computed already. x is the row that was announced before the last change of
/// A.
template <Scalar T, int N, class Pass>
void multiply(StateMatrix<T, N> const& A, T const* x, StateVector<T, N>& f, NextRow<Pass, N>& next) {
    if (!next.move_product(f)) multiply(A, x, f);
}
/// A = (A - x f') / r, and next's product with it. x and f may be the same.
template <Scalar T, int N>
void subtract_rank_one(StateMatrix<T, N>& A, StateVector<T, N> const& x, StateVector<T, N> const& f,
                       DivisorNearOne<RealOf<T>> const& by_r, NextRow<kernels::SubtractRankOne<T>, N>& next) {
    next.run(kernels::SubtractRankOne<T>{A.size(), A.stride(), A.column(0), x.data(), f.data(), by_r.correction()});
}

/// out = S'x, S upper triangular, or the product that `next` has computed already, of x and S as for `multiply`.
template <Scalar T, int N, class Pass>
void multiply_upper_transposed(StateMatrix<T, N> const& S, T const* x, StateVector<T, N>& out, NextRow<Pass, N>& next) {
    if (!next.move_product(out)) multiply_upper_transposed(S, x, out);
}
/// f.update for each column of psi (d x B) with its number of y (B), the oldest first; B >= 1. Returns the last step.
/// Throws std::invalid_argument for other shapes, before any row is processed. Where psi is a view of f's theta or
/// gain, which each row changes, no product is computed ahead.
template <Scalar T, int N, class Pass, class F>
Step<T> update_rows(F& f, NextRow<Pass, N>& next, RowsOf<T> psi, OutputsOf<T> y) {
    auto const theta = f.theta(), gain = f.gain();
    Index const d = theta.size();
    expects(d >= 1 && psi.rows() == d && psi.cols() == y.size() && y.size() >= 1,
            "a block of d x B regressors and B outputs");
    Index const numbers = (psi.cols() - 1) * psi.outerStride() + d;
    bool const stay =
        detail::disjoint(psi.data(), numbers, theta.data(), d) && detail::disjoint(psi.data(), numbers, gain.data(), d);
    for (Index k = 0;; ++k) {
        bool const last = k + 1 == y.size();
        next.announce(last || !stay ? nullptr : psi.col(k + 1).data());
        Step<T> const step = f.update({psi.col(k).data(), d}, y[k]);
        if (last) return step;
    }
}

}  // namespace rlslab
