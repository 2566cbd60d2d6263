// Recursion in model order: the estimates of all orders 0 ... n in one pass, by bordering the inverse of the Gram
// matrix.
#pragma once

#include <rlslab/core/family.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// The result of appending one column x. The pivot is the squared residual of x on the columns before it; relative to
/// x'x it shows how much of x these columns do not contain.
template <Field T>
struct AppendedColumn {
    T pivot, relative;  ///< 1/beta and (1/beta) / x'x
    Health health;      ///< sound; indefinite: pivot <= 0, which only rounding can cause if x is no combination of the
                        ///< others; nonfinite
};

/// For Y = Phi theta + xi, with columns X_1 ... X_d of Phi appended one after another, propagates P_d = (Phi'Phi)^-1,
/// theta_d and J_d. An ARX order takes two columns: the y-column gives P~_n, the u-column P_{n+1}. A column x borders
/// P:
///
///   (1) c = Phi'x,  g = P c                     (2) 1/beta = x'x - c'g
///   (3) P = [ P + beta g g'   -beta g ]         (4) t = beta x'(Y - Phi theta),  theta = [theta - t g; t]
///           [    -beta g'       beta  ]         (5) J = J - t^2 / beta
///
/// (4) uses the residual of the order before: x'Y - g'Phi'Y is the same number, with cancellation. After a border that
/// is not sound theta and P are NaN. Storage N d + d^2; 2 N d + 3 d^2 + O(N + d) multiplications for a column, N d^2
/// for a new fit. Loses digits as a power from 2 to 4 of the condition number of the columns, scaled to length 1
/// (docs/theory.md 46); OrderRecursiveQr as the first.
/// Source: bordering (Frobenius); Söderström & Stoica 1989, complement C4; docs/theory.md 10.
template <Field T>
class OrderRecursive {
    Vector<T> Y_, residual_, theta_;
    Matrix<T> Phi_, P_;
    T J_;
    Index size_ = 0;

    static T inner(Eigen::Ref<Vector<T> const> a, Eigen::Ref<Vector<T> const> b) {
        return dot(a.data(), b.data(), a.size());
    }

public:
    using scalar = T;
    static constexpr std::string_view name = "order_recursive";
    static constexpr Family family{Family::other};

    /// For at most `most` columns of Y's length N.
    OrderRecursive(Vector<T> Y, Index most)
        : Y_(std::move(Y)), residual_(Y_), theta_(most), Phi_(Y_.size(), most), P_(most, most), J_(inner(Y_, Y_)) {}

    /// Appends column x (N numbers). Throws std::invalid_argument for a column of another length, or one too many.
    AppendedColumn<T> append(Vector<T> const& x) {
        Index const d = size_;
        expects(x.size() == Y_.size() && d < theta_.size(), "a column of Y's length, no more than were announced");
        Vector<T> c(d), g(d);
        for (Index i = 0; i < d; ++i) c[i] = inner(Phi_.col(i), x);  // (1)
        for (Index i = 0; i < d; ++i) g[i] = dot(P_.col(i).data(), c.data(), d);
        T const square = inner(x, x), pivot = square - (d > 0 ? inner(c, g) : T(0));  // (2)
        bool const sound = T(0) < pivot && is_finite(pivot);
        T const beta = sound ? T(1) / pivot : undefined<T>();
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) P_(i, j) += beta * (g[i] * g[j]);  // (3)
            P_(j, d) = P_(d, j) = -(beta * g[j]);
        }
        P_(d, d) = beta;
        T const t = beta * inner(x, residual_);  // (4)
        for (Index i = 0; i < d; ++i) theta_[i] -= t * g[i];
        theta_[d] = t;
        J_ -= t * t * pivot;  // (5)
        Phi_.col(d) = x;
        ++size_;
        for (Index k = 0; k < Y_.size(); ++k) {
            T sum = Y_[k];
            for (Index i = 0; i < size_; ++i) sum -= Phi_(k, i) * theta_[i];
            residual_[k] = sum;
        }
        return {pivot, pivot / square,
                sound              ? Health::sound
                : is_finite(pivot) ? Health::indefinite
                                   : Health::nonfinite};
    }

    Index size() const { return size_; }  ///< columns so far
    auto theta() const { return theta_.head(size_); }
    auto covariance() const { return P_.topLeftCorner(size_, size_); }
    auto residuals() const { return Vector<T>(residual_); }
    T J() const { return J_; }
};

}  // namespace rlslab
