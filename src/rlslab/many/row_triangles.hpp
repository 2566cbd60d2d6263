// Triangles of rows [psi y], which take rows and are merged, and from which no row is taken back.
#pragma once

#include <rlslab/linalg/reflector.hpp>

#include <algorithm>
#include <vector>

namespace rlslab::detail {

/// The triangle of the rows [psi y] that it took, and their weights: R'R = sum w [psi y]'[psi y]. By rows, full.
///
///   R = [ R_x  z   ]      R_x theta = z,   rho^2 = sum w (y - psi'theta)^2, by no difference
///       [ 0    rho ]
///
/// Beside a constant column, k in each row, which is then the first, the other columns and y are taken less a row `at`,
/// the first that came: that changes R's first row alone, by at_j R_11 / k, and offsets cost no digits.
struct RowTriangle {
    double *R, *at;
    double weights = 0, share = 0,  // N = sum w, r = sum w^2 / N
        wear = 1;                   // root of the next row's weight where rows come backwards
    Index taken = 0;
};

/// Triangles of D = d + 1 columns. N: D where it is known, so that the loops are unrolled; else 0. The bits are the
/// same.
template <int N>
class RowTriangles {
    Index D_;
    double constant_;  // k; 0: there is none
    std::vector<double> column_, row_, sums_;

public:
    RowTriangles(Index columns, double constant)
        : D_(columns), constant_(constant), column_(size_t(columns)), row_(column_), sums_(column_) {}
    Index columns() const { return N > 0 ? N : D_; }
    Index numbers() const { return columns() * (columns() + 1); }
    void place(RowTriangle& t, double* numbers) const {
        t.R = numbers;
        t.at = numbers + columns() * columns();
    }
    void clear(RowTriangle& t) const {
        std::fill_n(t.R, numbers(), 0.0);
        t.weights = t.share = 0;
        t.wear = 1;
        t.taken = 0;
    }
    void copy(RowTriangle const& from, RowTriangle& to) const {
        double* const R = to.R;
        std::copy_n(from.R, numbers(), R);
        to = from;
        place(to, R);
    }
    /// What the first row of R would be, without `at`.
    double unmoved(RowTriangle const& t, Index j) const {
        return constant_ == 0 || j == 0 ? t.R[j] : t.R[j] + t.at[j] * (t.R[0] / constant_);
    }
    void move(RowTriangle& t, Index j, double to) const {
        t.R[j] += (t.at[j] - to) * (t.R[0] / constant_);
        t.at[j] = to;
    }
    /// To the mean, where `at` may be long forgotten.
    void centre(RowTriangle& t) const {
        if (constant_ == 0 || t.R[0] == 0) return;
        for (Index j = 1; j < columns(); ++j) move(t, j, t.at[j] + t.R[j] * (constant_ / t.R[0]));
    }
    /// Each w times root^2, `lambda` = root^2.
    void scale(RowTriangle& t, double root, double lambda) const {
        for (Index k = 0; k < columns() * columns(); ++k) t.R[k] *= root;
        t.weights *= lambda;
        t.share *= lambda;
    }
    /// The row [psi y], times root.
    void take(RowTriangle& t, double const* row, double root) {
        if (constant_ != 0 && t.taken == 0) std::copy(row + 1, row + columns(), t.at + 1);
        for (Index j = 0; j < columns(); ++j) row_[size_t(j)] = root * (row[j] - t.at[j]);
        reflect<false>(t.R, row_.data());
        double const w = root * root;
        t.share = (t.share * t.weights + w * w) / (t.weights + w);
        t.weights += w;
        ++t.taken;
    }
    /// Those of b, whose triangle is destroyed.
    void merge(RowTriangle& t, RowTriangle& b) {
        for (Index j = 1; constant_ != 0 && j < columns(); ++j) move(t, j, b.at[j]);
        reflect<true>(t.R, b.R);
        t.share = (t.share * t.weights + b.share * b.weights) / (t.weights + b.weights);
        t.weights += b.weights;
        t.taken += b.taken;
    }

private:
    /// R of (R; B) by one reflection a column. B: one row, or a triangle. Each sum is in the order of B's rows.
    template <bool triangle>
    void reflect(double* R, double* B) {
        Index const D = columns();
        double *const x = column_.data(), *const sum = sums_.data();
        for (Index r = 0; r < D; ++r) {
            Index const rows = triangle ? r + 1 : 1;
            double squares = 0;
            for (Index i = 0; i < rows; ++i) {
                x[i] = B[i * D + r];
                squares += x[i] * x[i];
            }
            double* const R_r = R + r * D;
            Reflector<double> const turn(R_r[r], norm(R_r[r], squares, x, rows));
            R_r[r] = turn.r;
            if (turn.tau == 0) continue;
            for (Index j = r + 1; j < D; ++j) sum[j] = R_r[j];
            for (Index i = 0; i < rows; ++i) {
                x[i] /= turn.pivot;
                for (Index j = r + 1; j < D; ++j) sum[j] += x[i] * B[i * D + j];
            }
            for (Index j = r + 1; j < D; ++j) {
                sum[j] *= turn.tau;
                R_r[j] -= sum[j];
            }
            for (Index i = 0; i < rows; ++i)
                for (Index j = r + 1; j < D; ++j) B[i * D + j] -= x[i] * sum[j];
        }
    }
};

}  // namespace rlslab::detail
