// Roots of a polynomial by FLINT and Arb: what is multiple is divided out exactly, the rest isolated and enclosed. The same bits
// on every machine, as an eigenvalue solver in double would not give them.
#include <rlslab/model/difference.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/reference/balls.hpp>

#if __has_include(<flint/arb_fmpz_poly.h>)
#include <flint/arb_fmpz_poly.h>
#else
#include <arb_fmpz_poly.h>
#endif
#include <flint/fmpz_poly_factor.h>

#include <algorithm>
#include <functional>
#include <tuple>

namespace rlslab {

namespace {

/// p times the power of two that makes all its coefficients integers; p[0] is that of z^0.
class IntegerPolynomial {
    fmpz_poly_t p_;

public:
    explicit IntegerPolynomial(std::vector<double> const& p) {
        fmpz_poly_init(p_);
        balls::Integer mantissa, exponent, least;
        bool first = true;
        auto const take = [&](double x) { arf_get_fmpz_2exp(mantissa, exponent, balls::Float(x)); };
        for (double const x : p) {
            take(x);
            if (x != 0 && (first || fmpz_cmp(exponent, least) < 0)) fmpz_set(least, exponent), first = false;
        }
        for (size_t i = 0; i < p.size(); ++i) {
            if (p[i] == 0) continue;
            take(p[i]);
            fmpz_sub(exponent, exponent, least);
            fmpz_mul_2exp(mantissa, mantissa, fmpz_get_ui(exponent));
            fmpz_poly_set_coeff_fmpz(p_, long(i), mantissa);
        }
    }
    ~IntegerPolynomial() { fmpz_poly_clear(p_); }
    IntegerPolynomial(IntegerPolynomial const&) = delete;
    IntegerPolynomial& operator=(IntegerPolynomial const&) = delete;
    operator fmpz_poly_struct const*() const { return p_; }
};

/// p = c p_1 p_2^2 p_3^3 ..., no p_i with a root twice.
class Factors {
    fmpz_poly_factor_t f_;

public:
    explicit Factors(IntegerPolynomial const& p) {
        fmpz_poly_factor_init(f_);
        fmpz_poly_factor_squarefree(f_, p);
    }
    ~Factors() { fmpz_poly_factor_clear(f_); }
    Factors(Factors const&) = delete;
    Factors& operator=(Factors const&) = delete;
    long count() const { return f_->num; }
    fmpz_poly_struct const* factor(long i) const { return f_->p + i; }
    long multiplicity(long i) const { return f_->exp[i]; }
};

class Discs {
    acb_ptr z_;
    long n_;

public:
    explicit Discs(long n) : z_(_acb_vec_init(n)), n_(n) {}
    ~Discs() { _acb_vec_clear(z_, n_); }
    Discs(Discs const&) = delete;
    Discs& operator=(Discs const&) = delete;
    operator acb_ptr() { return z_; }
};

double nearest(arb_srcptr x) { return arf_get_d(arb_midref(x), ARF_RND_NEAR); }

}  // namespace

std::vector<std::complex<double>> roots(std::vector<double> const& p) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr long bits = 256;
    if (!std::ranges::all_of(p, [](double x) { return std::isfinite(x); })) return std::vector(p.size(), std::complex(nan, nan));
    std::vector<double> ascending(p.rbegin(), p.rend());
    ascending.push_back(1);
    Factors const factors{IntegerPolynomial(ascending)};
    std::vector<std::complex<double>> out;
    for (long i = 0; i < factors.count(); ++i) {
        long const n = fmpz_poly_degree(factors.factor(i));
        Discs z(n);
        arb_fmpz_poly_complex_roots(z, factors.factor(i), 0, bits);    // real ones have no imaginary part
        for (long k = 0; k < n * factors.multiplicity(i); ++k)
            out.emplace_back(nearest(acb_realref(z + k % n)), nearest(acb_imagref(z + k % n)));
    }
    auto const key = [](std::complex<double> z) { return std::tuple(correctly::hypot(z.real(), z.imag()), z.imag(), z.real()); };
    std::ranges::sort(out, std::greater(), key);
    return out;
}

}  // namespace rlslab
