// Whether the exact solution is zero in every component, decided with numbers that are as long as necessary.
#include <rlslab/reference/gram.hpp>

#include <vector>

namespace rlslab::balls {

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
