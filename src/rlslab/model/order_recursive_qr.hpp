// Recursion in model order by appending columns to a QR factorisation: does what bordering does without squaring the
// condition number.
#pragma once

#include <rlslab/linalg/triangles.hpp>
#include <rlslab/model/order_recursive.hpp>

namespace rlslab {

/// For Y = Phi theta + xi, with columns of Phi appended one after another, propagates Q'[Phi Y] = [R z; 0 w], Q a
/// product of reflections:
///
///   (1) x = Q'x,  R_{1..d, d+1} = x_{1..d}          (2) one reflection of x_{d+1..N}: R_{d+1,d+1} = +-|x_{d+1..N}|
///   (3) z_{d+1} and w by the same reflection        (4) R theta = z on request,  J = |w|^2
///
/// R_{d+1,d+1}^2 is the pivot that bordering computes as a difference. Storage N d; 2 N d + O(N) multiplications for a
/// column. Source: Golub 1965; Golub & Van Loan 2013, 6.5.2 (appending a column); docs/theory.md 11.
template <Real T>
class OrderRecursiveQr {
    Matrix<T> V_, L_;  // reflections I - tau v v' with v_d = 1; R'
    Vector<T> tau_, w_;
    Index size_ = 0;

    void reflect(Vector<T>& x, Index j) const {
        Index const n = x.size() - j;
        T const t = tau_[j] * dot(V_.col(j).data() + j, x.data() + j, n);
        for (Index k = 0; k < n; ++k) x[j + k] -= t * V_(j + k, j);
    }

public:
    using scalar = T;
    static constexpr std::string_view name = "order_recursive_qr";

    OrderRecursiveQr(Vector<T> Y, Index most)
        : V_(Matrix<T>::Zero(Y.size(), most)), L_(Matrix<T>::Zero(most, most)), tau_(most), w_(std::move(Y)) {}

    /// Appends column x (N numbers). Throws std::invalid_argument for a column of another length, one too many, or more
    /// columns than rows. A column that is a combination of those before it (pivot 0) gives health indefinite: theta is
    /// then not determined.
    AppendedColumn<T> append(Vector<T> x) {
        Index const d = size_, N = w_.size();
        expects(x.size() == N && d < tau_.size() && d < N,
                "a column of Y's length, no more than were announced or fit");
        T const square = dot(x.data(), x.data(), N);
        for (Index j = 0; j < d; ++j) reflect(x, j);  // (1)
        for (Index j = 0; j < d; ++j) L_(d, j) = x[j];
        T const pivot = dot(x.data() + d, x.data() + d, N - d), length = square_root(pivot);  // (2)
        T const r = x[d] < T(0) ? length : T(-length);
        L_(d, d) = r;
        bool const sound = T(0) < pivot && is_finite(pivot);
        tau_[d] = sound ? (r - x[d]) / r : T(0);
        V_(d, d) = T(1);
        for (Index k = d + 1; k < N; ++k) V_(k, d) = sound ? x[k] / (x[d] - r) : T(0);
        reflect(w_, d);  // (3)
        ++size_;
        return {pivot, pivot / square,
                sound              ? Health::sound
                : is_finite(pivot) ? Health::indefinite
                                   : Health::nonfinite};
    }

    Index size() const { return size_; }
    Vector<T> theta() const {  // (4)
        StateMatrix<T> L(size_);
        for (Index j = 0; j < size_; ++j)
            for (Index i = j; i < size_; ++i) L(i, j) = L_(i, j);
        Vector<T> x = w_.head(size_);
        solve_lower_transposed(L, x);
        return x;
    }
    T J() const { return dot(w_.data() + size_, w_.data() + size_, w_.size() - size_); }
    Matrix<T> root() const { return L_.topLeftCorner(size_, size_).transpose(); }  ///< R
};

}  // namespace rlslab
