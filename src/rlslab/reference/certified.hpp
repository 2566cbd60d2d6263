// The certified reference: the exact minimiser for the same bits that a variant was given, enclosed by proven bounds.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>
#include <rlslab/core/stored.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab {

/// What is known of the exact solution after k rows.
///   certified    theta and P are enclosed to the digits required
///   singular     no unique minimiser: the regressors' rank, proven, is less than d and there is no prior
///   undefined    an infinity or a NaN among the data so far or in the prior, or P0 not positive definite
///   unresolved   the enclosure was still too wide at the largest working precision
enum class Status { certified, singular, undefined, unresolved };

constexpr std::string_view name_of(Status status) {
    constexpr std::string_view names[] = {"certified", "singular", "undefined", "unresolved"};
    return names[static_cast<int>(status)];
}

/// The solution of Problem after k rows, as balls (midpoint and proven radius, of any precision):
///
///   (1)  M_k = lambda^k P0^-1 + sum_i lambda^(k-i) psi_i psi_i'          P_k = M_k^-1
///   (2)  b_k = lambda^k P0^-1 theta0 + sum_i lambda^(k-i) psi_i y_i      theta_k = P_k b_k
///
/// A value: copies share the enclosure, which never changes, and any thread may call any member. Unless certified,
/// numbers are NaN, vectors and matrices hold NaN, and strings are "nan".
///
/// The digits that it measures are proven: -log10 of an upper bound of the error. If the estimate lies within the
/// enclosure, the result is about the digits that `certified` was called with; a call with more digits shows more.
/// +infinity: the estimate is equal, and the solution is known exactly. -infinity: an error, and the exact solution has
/// norm zero. NaN: the estimate has an infinity or a NaN. All throw std::invalid_argument when the estimate's size is
/// not d.
class CertifiedSolution {
public:
    struct Enclosure;

    CertifiedSolution(Index step, Index size, Index rank, Status status);
    CertifiedSolution(Index step, Index rank, std::shared_ptr<Enclosure const> enclosure);

    Index step() const { return step_; }  ///< k
    Index size() const { return size_; }  ///< d
    Index rank() const { return rank_; }  ///< of M_k, proven: d when certified; 0 when nothing is known
    Status status() const { return status_; }
    int bits() const;                  ///< working precision that certified it; 0: none did
    double radius() const;             ///< >= ||error of the midpoint||_2 / ||theta||_2
    double covariance_radius() const;  ///< the same for P, in the Frobenius norm

    Vector<Reference> theta() const;       ///< midpoints rounded to 257 bits
    Matrix<Reference> covariance() const;  ///< likewise P_k

    /// theta correctly rounded to `digits` significant digits, as "-1.2345e-4". A component whose enclosure does not
    /// determine that rounding has as many digits as it determines. A component whose enclosure contains zero is "0".
    std::vector<std::string> theta_strings(int digits = 30) const;

    /// -log10(||estimate - theta||_2 / ||theta||_2).
    double theta_digits(Vector<Reference> const& estimate) const;
    /// The least over the components of -log10(|x - c| / |c|), or of -log10|x - c| where c may be 0.
    double theta_digits_worst(Vector<Reference> const& estimate) const;
    /// -log10(||estimate - P||_F / ||P||_F). The estimate's P is computed from the stored numbers in balls at rising
    /// precision, so that this adds no rounding error to the variant's. A plain matrix is not symmetrised. NaN also
    /// when an information form is singular; if only integers of more than 2^20 bits could decide that, it throws
    /// std::range_error. Cost O(d^3).
    double covariance_digits(Stored<Reference> const& estimate) const;

    /// Whether these exact numbers lie inside the enclosure. For the true solution this must always hold.
    bool encloses(Vector<Rational> const& theta) const;
    bool encloses(Matrix<Rational> const& covariance) const;

    /// null unless certified. The type is complete only where enclosure.hpp is included, and Arb with it.
    Enclosure const* enclosure() const { return enclosure_.get(); }

private:
    Index step_, size_, rank_;
    Status status_;
    std::shared_ptr<Enclosure const> enclosure_;
};

/// The exact solutions after each of these steps (ascending, 1 <= k <= rows), from binary64 data taken at face value.
///
/// Certified means, for every component i and every pair (i, j),
///   rad theta_i <= 10^-digits max(|theta_i|, 10^-40 max|theta|)      rad P_ij <= 10^-digits max|P|
/// which is tested on the balls themselves, not taken from a return flag. With forgetting = 1 the sums in (1) and (2)
/// are exact integers. With less they are balls, and the whole recursion is repeated at doubled precision until it is
/// enough. A step is unresolved if 2^16 bits (4 times the digits required, if that is more) are not enough. If the
/// balls of all components of theta contain zero, whether theta = 0 is decided exactly, with numbers of at most 2^20
/// bits; if so, it is certified with radius 0.
///
/// Deterministic. Memory O(d^2) besides the data and the results. Cost per row: about d^2/2 multiplications of short
/// integers, with forgetting at the working precision; for each of the steps O(d^3).
/// Throws std::invalid_argument for a problem that is not well posed, data of another size, steps out of order or
/// range, a P0 that is not symmetric.
std::vector<CertifiedSolution> certified(Problem<double> const& problem, Records const& data,
                                         std::vector<Index> const& steps, int digits = 30);

/// kappa_2 of the data matrix whose row k is scaled by sqrt(lambda^(N-k)), to about 12 digits, from the certified
/// inverse of its Gram matrix. Infinity when it is singular (proven) or beyond double's range; NaN when the regressors
/// are not finite. Costs as much as `certified` for one step, and 40 products of d x d doubles.
double condition(Records const& data, double forgetting);

/// ||theta - theta_from||_2 / ||theta_from||_2 of two exact solutions, for example with and without a prior, or for the
/// given and for the rounded data. 0 for two zeros, infinity if only theta_from is zero, NaN unless both are certified.
double relative_change(CertifiedSolution const& theta, CertifiedSolution const& from);
/// The same in the norm |x|^2 = sum (s_i x_i)^2, s_i > 0: with s_i the size of regressor i it does not depend on units.
double relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s);
/// The largest change of a component, max_i |x_i - from_i| / max(|from_i|, t |from| / s_i), |from| in the same norm; t
/// = 2^-40, and 2^-20 where from_i may be 0. The second term of the maximum bounds the result for components that add
/// nearly nothing to the prediction.
double largest_relative_change(CertifiedSolution const& theta, CertifiedSolution const& from, Vector<double> const& s);

}  // namespace rlslab
