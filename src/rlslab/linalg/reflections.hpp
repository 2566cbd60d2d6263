// Householder reflections that fold a block of rows into a triangle. Sizes are not checked.
#pragma once

#include <rlslab/linalg/kernels.hpp>
#include <rlslab/linalg/reflector.hpp>
#include <rlslab/linalg/team.hpp>

#include <cstdint>
#include <span>

namespace rlslab {

namespace detail {
/// x^n by repeated squaring, n >= 0: for x = lambda the weight of a row that is n steps old.
template <Field T>
T power(T x, Index n) {
    T out = T(1);
    for (; n > 0; n /= 2, x *= x)
        if (n % 2 == 1) out *= x;
    return out;
}
/// [R z] times the weight: this seat's columns.
template <Scalar T, int N>
void apply_weight(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, std::span<T* const> others = {},
                  Seat const& seat = {}) {
    auto const [from, to] = seat.share(0, z.size(), 8);
    for (Index i = 0; i < to; ++i) {
        for (Index j = std::max(i, from); j < to; ++j) L(j, i) *= weight;
        if (i < from) continue;
        z[i] *= weight;
        for (T* const other : others) other[i] *= weight;
    }
}
/// A hint: the next block, where it lies behind this one in memory, is in cache after the reflections. Any address is
/// allowed.
inline void prefetch(std::uintptr_t address) { __builtin_prefetch(reinterpret_cast<void const*>(address)); }
}  // namespace detail

/// A block of rows, stored by columns: for float and double these begin on a cache line and are padded with zeros as a
/// StateMatrix's are. V is a thread's room for a ReflectPanel. Allocates if it was never as large.
template <Scalar T>
class RowBlock {
    Index rows_ = 0, columns_ = 0, threads_ = 1;
    StateVector<T> memory_{0};
    static Index room_of_V(Index rows) { return 8 * padded<T, Dynamic>(rows) + 64; }

public:
    void resize(Index rows, Index columns) {
        threads_ = Hardware<T> ? detail::threads_of_team() : 1;
        Index const room = Hardware<T> ? threads_ * room_of_V(rows) + 32 : 0, stride = column_stride<T, Dynamic>(rows),
                    numbers = stride * columns + room;
        expects(product_fits(size_t(stride), size_t(columns) + 8), "a block that memory could hold");
        if (memory_.size() < numbers) memory_ = StateVector<T>(numbers);
        else if (rows == rows_ && columns == columns_) return;
        rows_ = rows, columns_ = columns;
        for (Index j = 0; j < columns; ++j)
            for (Index k = rows; k < stride; ++k) memory_[j * stride + k] = T(0);
    }
    Index threads() const { return threads_; }  ///< that there is room for
    Index stride() const { return column_stride<T, Dynamic>(rows_); }
    T* kept(Index which) { return memory_.data() + stride() * columns_ + which * 16; }  ///< of 0 and 1: for all threads
    T* V(detail::Seat const& seat) { return kept(2) + seat.i * room_of_V(rows_); }
    auto view() {
        using Stride = Eigen::OuterStride<>;
        return Eigen::Map<Matrix<T>, 0, Stride>(memory_.data(), rows_, columns_, Stride(stride()));
    }
};

/// Further right-hand sides of a block: the outputs y of its rows, and a z of d numbers, each.
template <Scalar T>
struct FurtherSides {
    std::span<T const* const> y;
    std::span<T* const> z;
    /// z = y.
    void copy(Index d) const {
        for (std::size_t j = 0; j < z.size(); ++j) std::copy_n(y[j], d, z[j]);
    }
};

/// A (B x (d + 1)) becomes the rows [psi_k' y_k] root^(B-1-k), k = 0 ... B-1, the oldest first: psi is d x B, y has B
/// numbers, and root is sqrt(lambda). Returns root^B, the weight of what was before the block. This seat's columns.
template <Scalar T>
RealOf<T> weighted_rows(Eigen::Ref<Matrix<T> const> const& psi, Eigen::Ref<Vector<T> const> const& y,
                        RealOf<T> const& root, RowBlock<T>& block, FurtherSides<T> const& further,
                        detail::Seat const& seat) {
    auto const [left, d] = seat.share(0, psi.rows(), 8);
    Index const all = psi.rows(), others = seat.i == 0 ? Index(further.z.size()) : 0;
    auto A = block.view();
    RealOf<T> weight = RealOf<T>(1);
    // In hardware eight rows at once: they fill a cache line of a column, and columns lie a power of two apart.
    // Elsewhere one by one, as random bits are drawn.
    constexpr Index together = Hardware<T> ? 8 : 1;
    for (Index end = y.size(); end > 0;) {
        Index const first = std::max(end - together, Index(0));
        RealOf<T> weights[together];
        for (Index k = end - 1; k > first; --k) {
            weights[k - first] = weight;
            weight *= root;
        }
        weights[0] = weight;
        T const* from = psi.col(first).data();
        T* to = A.data() + first;
        Index const stride = psi.outerStride(), rows = A.rows(), ld = A.outerStride();
        Index i = left;
        if constexpr (Hardware<T>) {
            for (Index at = left; at < d; at += 8)
                for (Index k = 0; k < end - first; ++k)
                    detail::prefetch(std::uintptr_t(from + at) + size_t((k + rows) * stride) * sizeof(T));
            constexpr int side = 16 / int(sizeof(T));  // squares of numbers, where there are whole ones
            typedef T Part __attribute__((vector_size(16)));
            typedef T PartAnywhere __attribute__((vector_size(16), aligned(alignof(T)), may_alias));
            for (; end - first == together && i + side <= d; i += side)
#pragma GCC unroll 4
                for (Index k = 0; k < together; k += side) {
                    Part square[side];
#pragma GCC unroll 4
                    for (Index r = 0; r < side; ++r)
                        square[r] =
                            weights[k + r] * *reinterpret_cast<PartAnywhere const*>(from + (k + r) * stride + i);
                    kernels::portable::turn_square(square);
#pragma GCC unroll 4
                    for (Index r = 0; r < side; ++r)
                        *reinterpret_cast<PartAnywhere*>(to + (i + r) * ld + k) = square[r];
                }
        }
        for (; i < d; ++i)
            for (Index k = 0; k < end - first; ++k) to[i * ld + k] = weights[k] * from[k * stride + i];
        for (Index k = first; seat.i == 0 && k < end; ++k) A(k, all) = weights[k - first] * y[k];
        for (Index j = 0; j < others; ++j)
            for (Index k = first; k < end; ++k) A(k, all + 1 + j) = weights[k - first] * further.y[std::size_t(j)][k];
        weight *= root;
        end = first;
    }
    return weight;
}

/// Folds the B x (d + 1) block A = [psi' y] into weight [R z], R = L', one reflection for each column i:
///
///   (1) r = +-|(R_ii, A_i)|, away from R_ii's sign;   v = (1, A_i / (R_ii - r)),   tau = (r - R_ii) / r
///   (2) each later column (R_ij, A_j):  t = tau (R_ij + v'A_j),   R_ij -= t,  A_j -= t v
///
/// A is overwritten: its first d columns by the v, its last by eta. Returns the product of |R_ii / r|, which is
/// sqrt(gamma) for B = 1. A column of zeros is skipped.
/// Source: Golub 1965; Golub & Van Loan 2013, 5.1.
template <Real T, int N>
T reflect_block_into(T const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z,
                     std::type_identity_t<Eigen::Ref<Matrix<T>>> A, std::span<T* const> others = {}) {
    Index const d = z.size(), rows = A.rows();
    detail::apply_weight(weight, L, z, others);
    T ratio = T(1);
    for (Index i = 0; i < d; ++i) {
        T* const v = A.col(i).data();
        T const a = L(i, i);
        T squares = T(0);
        run_kernel<T, Dynamic>(kernels::SumOfSquares<T>{rows, v, &squares});
        Reflector<T> const turn(a, norm(a, squares, v, rows));  // (1)
        if (all(turn.tau == T(0))) continue;
        run_kernel<T, Dynamic>(kernels::Division<T>{rows, v, turn.pivot});
        L(i, i) = turn.r;
        ratio *= turn.cosine(a);
        Index const ld = A.outerStride();
        run_kernel<T, Dynamic>(
            kernels::Reflection<T>{rows, d - i, ld, v, turn.tau, v + ld, L.column(i) + i + 1, &z[i]});  // (2)
        for (std::size_t j = 0; j < others.size(); ++j)
            run_kernel<T, Dynamic>(kernels::Reflection<T>{rows, 1, ld, v, turn.tau, A.col(d + 1 + Index(j)).data(),
                                                          nullptr, others[j] + i});
    }
    return ratio;
}

/// The same R and z but for rounding, eight reflections at a time by products of matrices, as kernels::ReflectPanel
/// says, where `in_range` (ColumnLengths::products_in_range); elsewhere, and for complex numbers, reflect_block_into. A
/// is overwritten, its last column by eta. Source: Puglisi 1992 (cited, not read), for V'V in place of T.
///
/// `others` has the z of further right-hand sides, which stand in A behind the last column of one.
template <Real T, int N>
void reflect_panels_into(T const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, RowBlock<T>& block,
                         Truth<T> const& in_range, std::span<T* const> others, detail::Seat const& seat) {
    auto A = block.view();
    if (!any(in_range)) {
        if (seat.i == 0) reflect_block_into(weight, L, z, A, others);
        return;
    }
    if constexpr (!std::same_as<Truth<T>, bool>) {
        if (!all(in_range)) {  // lanes of either kind
            StateMatrix<T, N> other_L = L;
            StateVector<T, N> other_z = z;
            RowBlock<T> other = block;
            reflect_block_into(weight, other_L, other_z, other.view());
            reflect_panels_into(weight, L, z, block, Truth<T>(true), others, seat);
            for (Index i = 0; i < z.size(); ++i) {
                z[i] = select(in_range, z[i], other_z[i]);
                for (Index j = i; j < z.size(); ++j) L(j, i) = select(in_range, L(j, i), other_L(j, i));
            }
            for (Index k = 0; k < A.rows(); ++k)
                A(k, z.size()) = select(in_range, A(k, z.size()), other.view()(k, z.size()));
            return;
        }
    }
    Index const d = z.size(), all = d + 1 + Index(others.size());
    using Panel = kernels::ReflectPanel<T>;
    using Part = typename Panel::Part;
    constexpr Index most = Panel::most;
    detail::apply_weight(weight, L, z, others, seat);
    seat.wait();
    auto const panel_at = [&](Index i) {
        return Panel{A.rows(),   d + 1 - i, A.outerStride(), A.col(i).data(), L.column(i) + i,
                     L.stride(), &z[i],     block.V(seat),   all - d - 1,     others.data(),
                     i};
    };
    auto const run = [&](Panel panel, Part part, Index from, Index to) {
        panel.part = part, panel.from = from, panel.to = to, panel.kept = block.kept(panel.first / most % 2);
        run_kernel<T, Dynamic>(panel);
    };
    bool ahead = false;  // the panel's pivots were made with the one before it
    for (Index i = 0; i < d; i += most) {
        Panel const panel = panel_at(i);
        if (seat.count == 1) {
            run_kernel<T, Dynamic>(panel);
            continue;
        }
        if (!ahead) {
            if (seat.i == 0) run(panel, Part::pivots, 0, 0);
            seat.wait();
        }
        if (!panel.leaves_columns()) continue;
        Panel const next = panel_at(i + most);
        ahead = next.leaves_columns();
        bool const makes_next = ahead && seat.i == 0;
        if (makes_next) {
            run(panel, Part::columns, most, 2 * most);
            run(next, Part::pivots, 0, 0);
        }
        // Both cost the first thread about as much as 16 columns.
        Index const first = ahead ? 2 * most : most;
        auto const [from, to] = seat.share(ahead ? 0 : most, all - i, most);
        run(panel, makes_next ? Part::more_columns : Part::columns, std::max(from, first), std::max(to, first));
        seat.wait();
    }
}

/// The same for complex numbers. A holds psi as it came, and L is R': both are the rows conjugated. z and y are
/// conjugated for the time that this takes.
template <RootedScalar T, int N>
    requires ComplexScalar<T>
RealOf<T> reflect_block_into(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z,
                             std::type_identity_t<Eigen::Ref<Matrix<T>>> A) {
    using R = RealOf<T>;
    Index const d = z.size(), rows = A.rows();
    auto const exchange = [&] {
        for (Index i = 0; i < d; ++i) z[i] = conjugate(z[i]);
        for (Index k = 0; k < rows; ++k) A(k, d) = conjugate(A(k, d));
    };
    detail::apply_weight(weight, L, z);
    exchange();
    R ratio = R(1);
    for (Index i = 0; i < d; ++i) {
        T* const v = A.col(i).data();
        R const a = real_part(L(i, i)), squares = real_part(dot(v, v, rows));
        Reflector<R> const turn(a, norm(a, squares, v, rows));  // (1)
        if (all(turn.tau == R(0))) continue;
        for (Index k = 0; k < rows; ++k) v[k] /= turn.pivot;
        L(i, i) = T(turn.r);
        ratio *= turn.cosine(a);
        for (Index j = i + 1; j <= d; ++j) {  // (2)
            T& above = j < d ? L(j, i) : z[i];
            T const t = turn.tau * (above + dot(v, A.col(j).data(), rows));
            above -= t;
            for (Index k = 0; k < rows; ++k) A(k, j) -= t * v[k];
        }
    }
    exchange();
    return ratio;
}

template <RootedScalar T, int N>
    requires ComplexScalar<T>
void reflect_panels_into(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, RowBlock<T>& block,
                         Truth<T> const&, std::span<T* const>, detail::Seat const&) {
    reflect_block_into(weight, L, z, block.view());
}

namespace detail {
/// A's rows (`fill(seat)` makes them, this seat's columns, and returns the weight of what was before) into [R z], and
/// their squares into the lengths of R's columns. In the team's threads. Returns whether eta is finite.
template <Scalar T, int N, class Lengths>
Truth<T> fold(StateMatrix<T, N>& L, StateVector<T, N>& z, RowBlock<T>& block, Lengths& lengths, Index rows,
              std::span<T* const> others, auto const& fill) {
    Index const columns = z.size() + 1 + Index(others.size());
    block.resize(rows, columns);
    in_team(block.threads(), double(z.size()) * double(columns) * double(rows), [&](Seat const& seat) {
        RealOf<T> const weight = fill(seat);
        seat.wait();
        auto const [from, to] = seat.share(0, z.size() + 1, 8);
        lengths.add_rows(weight, block.view(), from, to);
        seat.wait();
        Truth<T> const in_range = lengths.products_in_range(weight, block.view(), others);
        seat.wait();
        reflect_panels_into<T, N>(weight, L, z, block, in_range, others, seat);
    });
    return all_finite<T>(block.view().col(z.size()));
}
}  // namespace detail

/// Folds weighted_rows of psi and y into [R z]. `block` is workspace. Returns whether eta is finite.
template <Scalar T, int N, class Lengths>
Truth<T> fold_rows(StateMatrix<T, N>& L, StateVector<T, N>& z, RowBlock<T>& block, Lengths& lengths,
                   Eigen::Ref<Matrix<T> const> const& psi, Eigen::Ref<Vector<T> const> const& y, RealOf<T> const& root,
                   FurtherSides<T> const& further) {
    return detail::fold<T, N>(L, z, block, lengths, y.size(), further.z, [&](detail::Seat const& seat) {
        return weighted_rows<T>(psi, y, root, block, further, seat);
    });
}
/// Folds the d rows of another [R z], which stand for `rows` rows, into root^rows [R z].
template <Scalar T, int N, class Lengths>
Truth<T> fold_triangle(StateMatrix<T, N>& L, StateVector<T, N>& z, RowBlock<T>& block, Lengths& lengths,
                       StateMatrix<T, N> const& other_L, StateVector<T, N> const& other_z, RealOf<T> const& root,
                       Index rows, FurtherSides<T> const& further) {
    Index const d = z.size();
    return detail::fold<T, N>(L, z, block, lengths, d, further.z, [&](detail::Seat const& seat) {
        if (seat.i == 0) {
            block.view().leftCols(d + 1) << Matrix<T>(other_L.view().transpose()), other_z.view();
            for (std::size_t j = 0; j < further.z.size(); ++j)
                std::copy_n(further.y[j], d, block.view().col(d + 1 + Index(j)).data());
        }
        return detail::power(root, rows);
    });
}

/// The same for the one row [x' eta], going along the rows of R. x becomes the v_i, tau the tau_i, eta the reflected
/// output. Returns sqrt(gamma). x, z and tau have d numbers and differ.
template <RootedScalar T, int N>
RealOf<T> reflect_row_into(RealOf<T> const& weight, StateMatrix<T, N>& L, StateVector<T, N>& z, StateVector<T, N>& x,
                           T& eta, StateVector<RealOf<T>, N>& tau) {
    RealOf<T> ratio = RealOf<T>(1);
    run_kernel<T, N>(
        kernels::ReflectIn<T>{z.size(), L.stride(), L.column(0), x.data(), z.data(), &eta, tau.data(), &ratio, weight});
    return ratio;
}

}  // namespace rlslab
