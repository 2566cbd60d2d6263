// Health of a stored matrix, decided exactly: balls first, integers where balls cannot; a cheap proof in double.
#include <rlslab/reference/definiteness.hpp>

#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace rlslab {

namespace {

using namespace balls;

/// Finite numbers. A triangle's determinant is its diagonal's product. 0: has a zero; 1: has none; -1: not a triangle.
template <class T>
int triangle_is_regular(Matrix<T> const& F) {
    if (!F.isUpperTriangular(T(0)) && !F.isLowerTriangular(T(0))) return -1;
    return int((F.diagonal().array() != T(0)).all());
}

/// F + F' = L D L' in place, one column at a time. The number of pivots shown positive before one that is not; that
/// one, in `stop`, either is shown <= 0 or contains zero.
Index positive_pivots(Matrix<Reference> const& F, long bits, Ball& stop) {
    Index const d = F.rows();
    BallMatrix A(d, d);
    BallMatrix const mirrored = exact(F.transpose());
    arb_mat_add(A, exact(F), mirrored, bits);
    for (Index j = 0; j < d; ++j) {
        if (!arb_is_positive(A(j, j))) {
            arb_set(stop, A(j, j));
            return j;
        }
        for (Index i = j + 1; i < d; ++i) {
            Ball l;
            arb_div(l, A(i, j), A(j, j), bits);
            for (Index k = j + 1; k <= i; ++k) arb_submul(A(i, k), l, A(k, j), bits);
        }
    }
    return d;
}

Health definiteness_of_plain(Matrix<Reference> const& F) {
    constexpr long patience = 512;  // bits; beyond, the determinant decides first: no precision would end an exact zero
    Index proven = 0;               // leading minors up to this size are known to be positive
    Ball stop;
    for (long bits = 128;; bits *= 2) {
        Index const j = positive_pivots(F, bits, stop);
        if (j == F.rows()) return Health::sound;
        if (arb_is_nonpositive(stop)) return Health::indefinite;
        if (bits < patience || j < proven) continue;
        // The pivots before are positive, so this one has the sign of its leading minor.
        if (sign_of_leading_minor(F, j + 1) <= 0) return Health::indefinite;
        proven = j + 1;
        if (proven == F.rows()) return Health::sound;
    }
}

}  // namespace

Health definiteness(Stored<Reference> const& stored) {
    expects(stored.F.rows() == stored.F.cols(), "a square F");
    expects(stored.D.size() == 0 || stored.D.size() == stored.F.rows(), "D of F's size");
    if (!stored.F.allFinite() || !stored.D.allFinite()) return Health::nonfinite;
    if (stored.form == Stored<Reference>::Form::plain) return definiteness_of_plain(stored.F);
    for (Reference const& d : stored.D)
        if (d <= 0) return Health::indefinite;
    int const regular = triangle_is_regular(stored.F);
    bool const yes = regular < 0 ? nonsingular(stored.F) : regular == 1;
    return yes ? Health::sound : Health::indefinite;
}

// --- a proof of definiteness in double: Cholesky of a shifted matrix, after Rump -------------------------------------

namespace {

// With u = 2^-53, Cholesky in floating point of a symmetric B, running to completion, gives R'R = B + E with
//   (1)  |E_ij| <= g/(1-g) sqrt(b_ii b_jj),  g = (d+1)u / (1 - (d+1)u),  so  ||E||_2 <= g/(1-g) trace(B)
// (Demmel, in Higham 2002, 10.1), whatever the order of the sums; gradual underflow adds at most
// (2d + 4) 2^-1074 to an entry. R'R is semidefinite, so with B = A - cI up to the rounding of the diagonal and the true
// matrix within e_ij of A,
//   (2)  least eigenvalue > 0  if  c > g/(1-g) trace(B) + u max a_ii + max_i sum_j e_ij + underflow.
// A is scaled by powers of two to a diagonal in [1/2, 2). This is exact, keeps a positive definite matrix positive
// definite, and makes c small when the columns differ in scale.
//
// Every bound below is itself evaluated in floating point: sums of at most a million positive terms, well within the
// factor 1 + 2^-10 they are enlarged by. 2^-160 covers underflow: with diagonals in 2^+-900 an absolute error
// of 2^-1074 before scaling is 2^-173 after it, and intermediate products lose less than 2^-600.
constexpr double u = 0x1p-53, enlarge = 1 + 0x1p-10, underflow = 0x1p-160;
constexpr double smallest = 0x1p-900, biggest = 0x1p900;
constexpr Index inline_size = 32, largest = 1000;  // d u enlarge and d^2 2^-160 stay far below 2^-10 u d

/// Whether B, lower triangle, d x d by columns, has a Cholesky factor in floating point. Overwrites B. Every entry's
/// square is taken off a pivot, so an infinity or a NaN anywhere means no.
bool cholesky_completes(double* B, Index d) {
    for (Index j = 0; j < d; ++j) {
        double* const column = B + j * d;
        if (!(column[j] > 0)) return false;
        double const pivot = std::sqrt(column[j]);
        for (Index i = j + 1; i < d; ++i) column[i] /= pivot;
        for (Index k = j + 1; k < d; ++k)
            for (Index i = k; i < d; ++i) B[k * d + i] -= column[k] * column[i];
    }
    return true;
}

bool plain_is_positive(Matrix<double> const& F, double rho) {
    Index const d = F.rows();
    if (d > largest) return false;
    std::array<double, inline_size * inline_size> inline_B;
    std::array<double, 2 * inline_size> inline_work;
    std::vector<double> heap_B, heap_work;
    if (d > inline_size) {
        heap_B.resize(size_t(d * d));
        heap_work.resize(size_t(2 * d));
    }
    double* const B = d > inline_size ? heap_B.data() : inline_B.data();
    double* const scale = d > inline_size ? heap_work.data() : inline_work.data();
    double* const row_error = scale + d;
    for (Index j = 0; j < d; ++j) {
        double const diagonal = F(j, j);
        if (!(diagonal >= smallest && diagonal < biggest)) return false;
        int const exponent = std::ilogb(diagonal);
        scale[j] = std::ldexp(1.0, -((exponent + 1) >> 1));
        row_error[j] = 0;
    }
    double const relative = rho / (1 - rho) / 2;
    double trace = 0;
    for (Index j = 0; j < d; ++j) {
        for (Index i = j; i < d; ++i) {
            double const below = F(i, j) * scale[i] * scale[j], above = F(j, i) * scale[i] * scale[j];
            double const mean = below == above ? below : (below + above) / 2;
            // e_ij: the perturbation of what is stored, and the rounding of the mean.
            double error = relative * (std::abs(below) + std::abs(above));
            if (below != above) error += u * std::abs(mean);
            B[j * d + i] = mean;
            row_error[i] += error;
            if (i != j) row_error[j] += error;
        }
        trace += B[j * d + j];
    }
    double perturbation = 0;
    for (Index j = 0; j < d; ++j) perturbation = std::max(perturbation, row_error[j]);
    double const shift = enlarge * (double(d + 1) * u * trace + 2 * u + perturbation + double(d) * underflow);  // (2)
    for (Index j = 0; j < d; ++j) B[j * d + j] -= shift;
    return cholesky_completes(B, d);
}

bool factor_is_positive(Matrix<double> const& F, Vector<double> const& D, double rho) {
    for (double const x : D)
        if (!(x > 0 && std::isfinite(x))) return false;
    if (!F.allFinite()) return false;
    if (int const regular = triangle_is_regular(F); regular >= 0) return regular == 1;
    return rho == 0 && balls::surely_nonsingular(F);
}

}  // namespace

bool surely_positive(Stored<double> const& stored, double relative_perturbation) {
    expects(stored.F.rows() == stored.F.cols(), "a square F");
    expects(stored.D.size() == 0 || stored.D.size() == stored.F.rows(), "D of F's size");
    if (!(relative_perturbation >= 0 && relative_perturbation < 0.5)) return false;
    return stored.form == Stored<double>::Form::plain ? plain_is_positive(stored.F, relative_perturbation)
                                                      : factor_is_positive(stored.F, stored.D, relative_perturbation);
}

}  // namespace rlslab
