// The dense kernels by name: what each computes. Their texts are in kernels/*.hpp; dispatch.hpp compiles and runs them.
//
// A kernel is a struct that holds its arguments. d: numbers of a vector, and order of a matrix; ld: numbers from one
// column of a matrix to the next, padded as in storage.hpp. Pointers are to the first number. Nothing is checked,
// allocated or thrown. An output may be an input only where the struct says so. For float and double all vectors must
// be padded as StateVector is, except those marked "d numbers": the padding is read and overwritten, but enters no
// result.
#pragma once

#include <rlslab/linalg/block_kernel_types.hpp>
#include <rlslab/linalg/dot.hpp>
#include <rlslab/linalg/reflector.hpp>
#include <rlslab/linalg/storage.hpp>

#include <type_traits>

namespace rlslab::kernels {

/// The rows [first, last) of a block: those that exist. The other rows are padding.
struct RowRange {
    Index first, last;
};

// --- elementwise: out = x ... over d numbers -------------------------------------------------------------------------

/// What elementwise kernels have in common: they read x, write out, and go from the first number to the last. out may
/// be x or any other operand.
template <class T>
struct OverColumn {
    Index d;
    T const* x;
    T* out;
};
/// out_i = x_i / s.
template <class T>
struct DivideByOne : OverColumn<T> {
    T s;
};
/// out_i = x_i / y_i.
template <class T>
struct Divide : OverColumn<T> {
    T const* y;
};
/// out_i = x_i y_i.
template <class T>
struct Scale : OverColumn<T> {
    T const* y;
};
/// out_i = sqrt(x_i); NaN for x_i < 0.
template <class T>
struct SquareRoots : OverColumn<T> {};
/// out_i = x_i + a y_i.
template <class T>
struct AddScaled : OverColumn<T> {
    T const* y;
    T a;
};
/// out_i = a x_i.
template <class T>
struct ScaleByOne : OverColumn<T> {
    T a;
};
/// out_i = x_i + y_i.
template <class T>
struct Add : OverColumn<T> {
    T const* y;
};
/// out_i = x_i + y_i z_i.
template <class T>
struct AddProduct : OverColumn<T> {
    T const *y, *z;
};
/// before_j = *s, *s += x_j, out_j = *s, summed within blocks of eight first. before must not be out.
template <class T>
struct PrefixSums : OverColumn<T> {
    T* before;
    T* s;
};
/// *finite = whether every x_i is finite. out is not used.
template <class T>
struct AllFinite : OverColumn<T> {
    Truth<T>* finite;
};
template <class K>
concept Elementwise = requires(K k) { []<class T>(OverColumn<T> const&) {}(k); };

// --- products --------------------------------------------------------------------------------------------------------

enum class Shape { full, upper };

/// out_j = sum_i A_ij x_i, over all i or, for an upper triangle, over i <= j: a dot product in eight lanes. x: d
/// numbers.
template <class T, Shape>
struct MultiplyTransposed {
    Index d, ld;
    T const *A, *x;
    T* out;
};
/// out_ij = sum_n A_in B_nj, n ascending, where B_nj = B[n row + j column]: the strides (1, ld) give A B, (ld, 1) give
/// A B'.
template <class T>
struct MultiplySquares {
    static constexpr int registers = 8;
    Index d, ld;
    T const *A, *B;
    Index row, column;  // strides of B
    T* out;
};

// --- sweeps over columns ---------------------------------------------------------------------------------------------

/// A sweep goes through the columns j of A and keeps a block of a vector w, which runs along the rows, in registers.
///   registers    how many registers' worth of rows go through the columns together
///   upper        A is an upper triangle: column j has the rows i <= j
///   writes       A is changed
///   starts       the first value of w: zero, the vector w itself, or the product of column 0 with x_0
///   at(j)        the scalars that step j needs
enum class Start { zero, column, first_product };

/// w_i = sum_j A_ij x_j, j ascending. x: d numbers.
template <class T>
struct Multiply {
    static constexpr int registers = 8;
    static constexpr bool upper = false, writes = false;
    static constexpr Start starts = Start::first_product;
    Index d, ld;
    T const* A;
    T* w;
    T const* x;
    T const& at(Index j) const { return x[j]; }
};
/// A_ij = t + t correction, t = A_ij - w_i f_j'; correction = (1 - r) / r divides by r (DivisorNearOne). w is only
/// read.
template <class T>
struct SubtractRankOne {
    static constexpr int registers = 8;
    static constexpr bool upper = false, writes = true;
    static constexpr Start starts = Start::column;
    Index d, ld;
    T* A;
    T const *w, *f;
    RealOf<T> correction;
    T at(Index j) const { return conjugate(f[j]); }
};
/// A_ij += w_i w_j. w is only read.
template <class T>
struct AddSquare {
    static constexpr int registers = 8;
    static constexpr bool upper = false, writes = true;
    static constexpr Start starts = Start::column;
    Index d, ld;
    T* A;
    T const* w;
    T at(Index j) const { return w[j]; }
};
/// A_ij = A_ji' = t + t correction, t = A_ij - w_i f_j', for i <= j; A is symmetric (Hermitian: its diagonal stays
/// real). For the arithmetics whose A is a StateMatrix; float and double do the same OnBlocks.
template <class T>
struct SubtractMirrored {
    Index d, ld;
    T* A;
    T const *w, *f;
    RealOf<T> correction;
};
/// S on a SymmetricMatrix, whose blocks are ld x ld: a Multiply, a SubtractRankOne, which takes w_i f_j for i <= j and
/// mirrors it, or an AddSquare.
template <class S>
struct OnBlocks : S {};
/// The pass of S over A and a product with the A that it leaves, that of the next update: A is read once for both. S is
/// a SubtractRankOne, out_i = sum_j A_ij x_j, j ascending; or a sweep over an upper triangle, and out is that of
/// MultiplyTransposed. x: d numbers. out differs from S's vectors.
template <class S>
struct ThenMultiply : S {
    static constexpr int registers = 4;
    using T = std::remove_const_t<std::remove_pointer_t<decltype(S::A)>>;
    T const* x;
    T* out;
};
/// A_ij = t + t correction, t = A_ij - (x_i g_j' + g_i x_j'); A is symmetric (Hermitian).
template <class T>
struct SubtractRankTwo {
    static constexpr int registers = 4;
    Index d, ld;
    T* A;
    T const *x, *g;
    RealOf<T> correction;
};
/// What sweeps over an upper triangle A have in common: w is an output and starts from zero. The zeros of A below the
/// diagonal, as far as blocks of rows reach, are written again as zeros.
template <class T>
struct OverTriangle {
    static constexpr int registers = 4;
    static constexpr bool upper = true, writes = true;
    static constexpr Start starts = Start::zero;
    Index d, ld;
    T *A, *w;
};
/// A_ij = t - w_i mu_j', w_i += t g_j, t the old A_ij, i <= j.
template <class T>
struct SweepUd : OverTriangle<T> {
    struct At {
        T g, mu;
    };
    T const *g, *mu;
    At at(Index j) const { return {g[j], conjugate(mu[j])}; }
};
/// A_ij = q + q correction, q = t keep_j - w_i mix_j'; w_i += t f_j, t the old A_ij, i <= j.
template <class T>
struct SweepCarlson : OverTriangle<T> {
    struct At {
        T f;
        RealOf<T> keep;
        T mix;
    };
    T const* f;
    RealOf<T> const* keep;
    T const* mix;
    RealOf<T> correction;
    At at(Index j) const { return {f[j], keep[j], conjugate(mix[j])}; }
};
/// (w_i, A_ij) = (c_j w_i + s_j q, c_j q - s_j' w_i), q = t + t correction, t the old A_ij, i <= j.
template <class T>
struct SweepRotations : OverTriangle<T> {
    struct At {
        RealOf<T> c;
        T s;
    };
    RealOf<T> const* c;
    T const* s;
    RealOf<T> correction;
    At at(Index j) const { return {c[j], s[j]}; }
};
/// A_ij = t keep_j - (t less_j + w_i mix_j'), w_i += t f_j, t the old A_ij, i <= j.
template <class T>
struct SweepCarlsonDelta : OverTriangle<T> {
    struct At {
        T f;
        RealOf<T> keep, less;
        T mix;
    };
    T const* f;
    RealOf<T> const *keep, *less;
    T const* mix;
    At at(Index j) const { return {f[j], keep[j], less[j], conjugate(mix[j])}; }
};
/// A_ij = t keep_j - (t less_j + w_i mix_j'), w_i = c_j w_i + s_j t, t the old A_ij, i <= j.
template <class T>
struct SweepRotationsDelta : OverTriangle<T> {
    struct At {
        RealOf<T> c;
        T s;
        RealOf<T> keep, less;
        T mix;
    };
    RealOf<T> const* c;
    T const* s;
    RealOf<T> const *keep, *less;
    T const* mix;
    At at(Index j) const { return {c[j], s[j], keep[j], less[j], conjugate(mix[j])}; }
};
template <class K>
concept ByRows = requires { K::registers; };
template <class K>
concept Sweep = ByRows<K> && requires { K::starts; };
template <class K>
concept UpperSweep = Sweep<K> && K::upper;

// --- panels of a lower triangle --------------------------------------------------------------------------------------

// A row of R = L' is a column of L. Rows go from the first to the last; each acts on the new row x to the right of its
// diagonal.
//   writes     L is changed
//   corners    the rows within a block depend on one another: its corner on the diagonal is computed in scalars first

/// x_j -= x_i L_ji for i = 0, 1, ... and j > i. L is unit lower triangular; its diagonal is not read.
template <class T>
struct Eliminate {
    static constexpr bool writes = false, corners = true;
    Index d, ld;
    T const* L;
    T* x;
};
/// x_i /= L_ii, then x_j -= x_i L_ji for i = 0, 1, ... and j > i.
template <class T>
struct SolveLower : Eliminate<T> {};
/// L_ji = c_i t + s_i' x_j, x_j -= e_i t for i = 0, 1, ... and j > i, t the old L_ji. The diagonal of L stays.
template <class T>
struct SweepGentleman {
    static constexpr bool writes = true;
    Index d, ld;
    T *L, *x;
    RealOf<T> const* c;
    T const *s, *e;
};
/// Eliminate, the weights and SweepGentleman in one pass over L, for real numbers and D_i > 0: with b_i = lambda D_i
/// and v = *inverse = 1/w
///   x_j -= x_i L_ji                                          for i = 0, 1, ... and j > i
///   s_i = x_i / v_i,  v_{i+1} = v_i + x_i^2 / b_i            summed as PrefixSums does
///   D_i = b_i + s_i x_i,  c_i = b_i / D_i,  s_i = s_i / D_i
///   L_ji = c_i t + s_i x_j,  x_j -= x_i t                    for j > i, t the old L_ji; (z_i, *eta) alike
template <class T>
struct FoldGentleman {
    static constexpr bool writes = true;
    Index d, ld;
    T *L, *x, *z, *eta, *D, *c, *s, *inverse;
    T lambda;
};
/// The rotations of a row x into root_lambda L, for real numbers, all of them before L changes:
///   u_i = x_i (1 / L_ii),  x_j -= u_i L_ji                   for i = 0, 1, ... and j > i
///   g_{i+1} = g_i + u_i^2                                    from *sum to *sum, as PrefixSums does
///   c_i = (sqrt(g_i) / sqrt(g_{i+1})) root_lambda,  s_i = u_i root_lambda / (sqrt(g_i) sqrt(g_{i+1}))
///   *eta -= u_i z_i
/// sqrt(g_0) is root_lambda. x_i keeps what was left of it when u_i was computed.
template <class T>
struct SolveRotations {
    static constexpr bool writes = false;
    Index d, ld;
    T *L, *x, *z, *eta, *c, *s, *u, *sum;  // L and z are read
    T root_lambda;
};
/// SolveRotations, and in the same pass over L
///   L_ji = c_i t + s_i x_j                                   for j >= i, t the old L_ji; (z_i, *eta) alike
/// x_j and *eta as u_i meets them. x is overwritten.
template <class T>
struct FoldQr : SolveRotations<T> {
    static constexpr bool writes = true;
};
/// For i = 0, 1, ...: the rotation (c_i, s_i) that makes x_i zero against root_lambda L_ii, applied to the pairs
/// (root_lambda L_ji, x_j) for j > i and, s_i conjugated, to (root_lambda z_i, *eta). Writes L, z, *eta, c and s; x is
/// overwritten. L's diagonal is real.
template <class T>
struct RotateIn {
    static constexpr bool writes = true, corners = true;
    Index d, ld;
    T *L, *x, *z, *eta;
    RealOf<T>* c;
    T* s;
    RealOf<T> root_lambda;
};
/// (L_ji, x_j) = (c_i t - s_i x_j, c_i x_j + s_i t) for i = d - 1, d - 2, ... and j >= i, t the old L_ji and x = 0 at
/// first; x is not kept. What is above the diagonal of L must be zeros, and stays so for finite c and s.
template <class T>
struct RotateOut {
    Index d, ld;
    T* L;
    T const *c, *s;
};
/// RotateIn by reflections, with weight for root_lambda: x_i becomes v_i, tau_i its coefficient, *ratio is multiplied
/// by |cosine|:
///   a = tau_i (weight L_ji + v_i' x_j),  L_ji = weight L_ji - a,   x_j -= a v_i       for j > i; for (z_i, *eta) alike
///   with v_i' for v_i
template <class T>
struct ReflectIn {
    static constexpr bool writes = true, corners = true;
    Index d, ld;
    T *L, *x, *z, *eta;
    RealOf<T>*tau, *ratio;
    RealOf<T> weight;
};
template <class K>
concept ByPanels = requires { K::corners; };

/// RotateIn for `together` rows, the first to the last: row r has x + r ld and eta[r]. Its rotations are written to c +
/// r ld and s + r ld. What is above the diagonal of L stays.
template <class T>
struct RotateInRows {
    static constexpr int together = 4;
    Index d, ld;
    T *L, *x, *z, *eta, *c, *s;
    T root_lambda;
};
template <class K>
concept Together = requires { K::together; };

// --- reflections: on columns of `rows` >= 1 numbers, stored one after another without padding ------------------------

/// *sum = v'v, a dot product in eight lanes.
template <class T>
struct SumOfSquares {
    Index rows;
    T const* v;
    T* sum;
};
/// v_k /= pivot.
template <class T>
struct Division {
    Index rows;
    T* v;
    T pivot;
};
/// For each of the `columns` columns a of A, ld apart: t = tau (r + v'a), r -= t, a -= t v. r is the column's entry in
/// the row of R that is above A: above[0], above[1], ..., but *last for the last column (the right-hand side).
template <class T>
struct Reflection {
    Index rows, columns, ld;  // of A
    T const* v;
    T tau;
    T *A, *above, *last;
};
template <class K>
concept OnColumns = requires(K k) { k.rows; };

}  // namespace rlslab::kernels
