// Rank and determinants of dyadic matrices, proven: modulo a prime where that suffices, in integers where it does not;
// whether the exact solution is zero.
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <cmath>
#include <flint/nmod_mat.h>
#include <flint/ulong_extras.h>
#include <stdexcept>
#include <vector>

namespace rlslab::balls {

namespace {

constexpr mp_limb_t prime = (mp_limb_t(1) << 61) - 1;

/// a b mod p for a, b < p: 2^61 = 1 mod p, so the product's upper and lower 61 bits are added.
mp_limb_t times(mp_limb_t a, mp_limb_t b) {
    mp_limb_t high, low;
    umul_ppmm(high, low, a, b);
    mp_limb_t const sum = (low & prime) + ((high << 3) | (low >> 61));
    return sum >= prime ? sum - prime : sum;
}

/// |x| = m 2^e; of 2^e only e mod 61 matters.
mp_limb_t residue(double x) {
    int exponent = 0;
    double const mantissa = std::ldexp(std::frexp(std::abs(x), &exponent), 53);
    long const shift = (((exponent - 53) % 61) + 61) % 61;
    mp_limb_t const positive = times(mp_limb_t(mantissa), mp_limb_t(1) << shift);
    return x < 0 ? n_negmod(positive, prime) : positive;
}

/// Rows reduced modulo p as they come: the number kept never exceeds the true rank.
class ModularEchelon {
    Index size_;
    std::vector<std::vector<mp_limb_t>> basis_;  ///< [j]: the row whose first nonzero entry, a 1, is at j
    std::vector<mp_limb_t> row_;
    Index rank_ = 0;

public:
    explicit ModularEchelon(Index size) : size_(size), basis_(size_t(size)), row_(size_t(size)) {}
    Index rank() const { return rank_; }

    void add(double const* psi) {
        for (size_t j = 0; j < size_t(size_); ++j) row_[j] = residue(psi[j]);
        for (size_t j = 0; j < size_t(size_); ++j) {
            if (row_[j] == 0) continue;
            if (basis_[j].empty()) {
                mp_limb_t const scale = n_invmod(row_[j], prime);
                for (mp_limb_t& x : row_) x = times(x, scale);
                basis_[j] = row_;
                ++rank_;
                return;
            }
            mp_limb_t const factor = n_negmod(row_[j], prime);
            for (size_t i = j; i < size_t(size_); ++i) row_[i] = n_addmod(row_[i], times(basis_[j][i], factor), prime);
        }
    }
};

/// The leading rows x cols block in integers, each column in its own unit: same rank, same sign of every minor.
void to_integers(IntegerMatrix& to, std::vector<std::vector<Float>> const& columns) {
    constexpr long widest = 1L << 20;
    std::vector<Integer> mantissa(size_t(to.rows())), exponent(size_t(to.rows()));
    for (Index j = 0; j < to.cols(); ++j) {
        Integer unit, top;
        bool some = false;
        for (size_t i = 0; i < size_t(to.rows()); ++i) {
            arf_get_fmpz_2exp(mantissa[i], exponent[i], columns[size_t(j)][i]);
            if (fmpz_is_zero(mantissa[i])) continue;
            if (!some || fmpz_cmp(exponent[i], unit) < 0) fmpz_set(unit, exponent[i]);
            if (!some || fmpz_cmp(exponent[i], top) > 0) fmpz_set(top, exponent[i]);
            some = true;
        }
        Integer spread;
        fmpz_sub(spread, top, unit);
        if (fmpz_cmp_si(spread, widest) > 0)
            throw std::range_error("exponents within one column differ by more than 2^20: no exact decision");
        for (size_t i = 0; i < size_t(to.rows()); ++i) {
            if (fmpz_is_zero(mantissa[i])) continue;
            fmpz_sub(spread, exponent[i], unit);
            fmpz_mul_2exp(to(Index(i), j), mantissa[i], fmpz_get_ui(spread));
        }
    }
}

bool full_rank_modulo_prime(IntegerMatrix const& A) {
    nmod_mat_t image;
    nmod_mat_init(image, A.rows(), A.cols(), prime);
    fmpz_mat_get_nmod_mat(image, A);
    bool const full = nmod_mat_rank(image) == A.rows();
    nmod_mat_clear(image);
    return full;
}

}  // namespace

std::vector<Index> proven_ranks(Records const& data, std::vector<Index> const& steps,
                                std::function<void()> const& pause) {
    Index const d = data.parameters();
    std::vector<Index> lower, upper;
    ModularEchelon echelon(d);
    Index row = 0;
    for (Index const k : steps) {
        for (; row < k && echelon.rank() < d; ++row) {
            echelon.add(data.psi.col(row).data());
            if (pause) pause();
        }
        lower.push_back(echelon.rank());
        upper.push_back(std::min(k, d));
    }
    // The rank never falls with k, so that one exact rank bounds every earlier one, and decides those whose lower bound
    // reaches it.
    Index ceiling = d;
    for (size_t s = steps.size(); s-- > 0;) {
        upper[s] = std::min(upper[s], ceiling);
        if (lower[s] < upper[s]) {
            IntegerGram gram(data, steps[s]);
            gram.advance(steps[s], pause);
            IntegerMatrix regressors(d, d);
            for (Index j = 0; j < d; ++j)
                for (Index i = 0; i < d; ++i) fmpz_set(regressors(i, j), gram.mantissas()(i, j));
            upper[s] = fmpz_mat_rank(regressors);
        }
        ceiling = upper[s];
    }
    return upper;
}

bool nonsingular(Matrix<Reference> const& A) {
    std::vector<std::vector<Float>> columns(size_t(A.cols()));
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.rows(); ++i) columns[size_t(j)].emplace_back(A(i, j));
    IntegerMatrix integers(A.rows(), A.cols());
    to_integers(integers, columns);
    return nonsingular(integers);
}

bool nonsingular(IntegerMatrix const& A) { return full_rank_modulo_prime(A) || fmpz_mat_rank(A) == A.rows(); }

bool surely_nonsingular(Matrix<double> const& A) {
    ModularEchelon echelon(A.rows());
    for (Index j = 0; j < A.cols() && echelon.rank() == j; ++j) echelon.add(A.col(j).data());
    return echelon.rank() == A.rows();
}

int sign_of_leading_minor(Matrix<Reference> const& F, Index n) {
    std::vector<std::vector<Float>> columns(static_cast<size_t>(n));
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            // The exact sum of two numbers 2^s apart has s bits: to_integers' limit is checked on the parts first.
            Float const a(F(i, j)), b(F(j, i));
            Float sum;
            if (!arf_is_zero(a) && !arf_is_zero(b)) {
                Integer gap;
                fmpz_sub(gap, ARF_EXPREF(static_cast<arf_srcptr>(a)), ARF_EXPREF(static_cast<arf_srcptr>(b)));
                if (fmpz_cmpabs(gap, Integer(1L << 20)) > 0)
                    throw std::range_error("mirrored entries differ by more than 2^(2^20): no exact decision");
            }
            arf_add(sum, a, b, ARF_PREC_EXACT, ARF_RND_DOWN);
            columns[size_t(j)].push_back(sum);
        }
    IntegerMatrix integers(n, n);
    to_integers(integers, columns);
    Integer determinant;
    fmpz_mat_det(determinant, integers);
    return fmpz_sgn(determinant);
}

// --- whether the exact solution is zero in every component: numbers as long as necessary -----------------------------

namespace {

constexpr long longest = 1L << 20;  // bits

/// to += a b, exactly.
void add_product(Float& to, Float const& a, Float const& b) { arf_addmul(to, a, b, ARF_PREC_EXACT, ARF_RND_DOWN); }

}  // namespace

//   (1)  s = sum_i lambda^(k-i) psi_i y_i          (2)  P0 b = lambda^k theta0 + P0 s          without a prior: b = s
bool surely_vanishes(Problem<double> const& problem, Records const& data, Index k) {
    Index const d = problem.size;
    Float const lambda(problem.forgetting);
    Integer exponent, mantissa;
    arf_get_fmpz_2exp(mantissa, exponent, lambda);
    if (-fmpz_get_si(exponent) * k > longest) return false;  // the number of bits of lambda^k behind the point

    std::vector<Float> sum(static_cast<size_t>(d));
    Float power(1.0);
    for (Index i = 0; i < k; ++i) {  // (1)
        Float const y(data.y(i));
        arf_mul(power, power, lambda, ARF_PREC_EXACT, ARF_RND_DOWN);
        for (Index j = 0; j < d; ++j) {
            Float& s = sum[size_t(j)];
            arf_mul(s, s, lambda, ARF_PREC_EXACT, ARF_RND_DOWN);
            add_product(s, Float(data.psi(j, i)), y);
        }
    }
    for (Index i = 0; i < d; ++i) {  // (2)
        Float row;
        if (!problem.prior) arf_set(row, sum[size_t(i)]);
        if (problem.prior) {
            auto const& prior = *problem.prior;
            if (prior.theta) add_product(row, power, Float((*prior.theta)[i]));
            for (Index j = 0; j < d; ++j) {
                double const P0 = prior.covariance ? (*prior.covariance)(i, j) : i == j ? prior.variance : 0;
                if (P0 != 0) add_product(row, Float(P0), sum[size_t(j)]);
            }
        }
        if (!arf_is_zero(row)) return false;
    }
    return true;
}

}  // namespace rlslab::balls
