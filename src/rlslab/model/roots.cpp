// Roots of a polynomial by FLINT and Arb: what is multiple is divided out exactly, the rest isolated in discs. The same
// bits on every machine, as an eigenvalue solver in double would not give them.
#include <rlslab/model/difference.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/reference/balls.hpp>

#if __has_include(<flint/acb_poly.h>)
#include <flint/acb_poly.h>
#else
#include <acb_poly.h>
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
        auto const split = [&](double x) { arf_get_fmpz_2exp(mantissa, exponent, balls::Float(x)); };
        for (double const x : p) {
            split(x);
            if (x != 0 && (first || fmpz_cmp(exponent, least) < 0)) fmpz_set(least, exponent), first = false;
        }
        for (size_t i = 0; i < p.size(); ++i) {
            if (p[i] == 0) continue;
            split(p[i]);
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

/// The edges of the Newton polygon, the upper hull of (i, log2 |c_i|): as many roots as an edge is long lie near its
/// radius, however far apart these are. Logarithms to a bit are enough for a start.
void start(acb_ptr z, fmpz_poly_struct const* p) {
    struct Corner {
        long i, log;
    };
    std::vector<Corner> hull;
    for (long i = 0; i <= fmpz_poly_degree(p); ++i) {
        balls::Integer c;
        fmpz_poly_get_coeff_fmpz(c, p, i);
        if (fmpz_is_zero(c)) continue;
        Corner const next{i, long(fmpz_bits(c))};
        auto const below = [&](Corner const& a, Corner const& b) {
            return (b.log - a.log) * (next.i - a.i) <= (next.log - a.log) * (b.i - a.i);
        };
        while (hull.size() > 1 && below(hull[hull.size() - 2], hull.back())) hull.pop_back();
        hull.push_back(next);
    }
    long k = hull.front().i;  // a factor z, once: at zero
    for (size_t e = 0; e + 1 < hull.size(); ++e) {
        long const n = hull[e + 1].i - hull[e].i, fall = hull[e].log - hull[e + 1].log;
        for (long m = 0; m < n; ++m, ++k) {
            double const turn = 6.283185307179586 * double(m) / double(n) + 0.7 * double(e + 1);
            double const radius = correctly::exp2(double(fall % n) / double(n));
            arb_set_d(acb_realref(z + k), radius * correctly::cos(turn));
            arb_set_d(acb_imagref(z + k), radius * correctly::sin(turn));
            acb_mul_2exp_si(z + k, z + k, fall / n);
        }
    }
}

bool sharp(acb_srcptr z, long n) {
    for (long k = 0; k < n; ++k)
        if (!acb_is_zero(z + k) && acb_rel_accuracy_bits(z + k) < 128) return false;
    return true;
}

/// Simultaneous iteration until discs isolate all roots, and those on the real axis are proven to be: after 2^14 bits
/// as they are.
void enclose(acb_ptr z, fmpz_poly_struct const* p) {
    long const n = fmpz_poly_degree(p);
    acb_poly_t q;
    acb_poly_init(q);
    start(z, p);
    for (long bits = 256; bits <= 1 << 14; bits *= 2) {
        acb_poly_set_fmpz_poly(q, p, bits);
        if (acb_poly_find_roots(z, q, z, 0, bits) == n && sharp(z, n) && acb_poly_validate_real_roots(z, q, bits))
            break;
        for (long k = 0; k < n; ++k) acb_get_mid(z + k, z + k);
    }
    acb_poly_clear(q);
}

double nearest(arb_srcptr x) { return arb_contains_zero(x) ? 0.0 : arf_get_d(arb_midref(x), ARF_RND_NEAR); }

}  // namespace

std::vector<std::complex<double>> roots(std::vector<double> const& p) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    if (!std::ranges::all_of(p, [](double x) { return std::isfinite(x); }))
        return std::vector(p.size(), std::complex(nan, nan));
    std::vector<double> ascending(p.rbegin(), p.rend());
    ascending.push_back(1);
    Factors const factors{IntegerPolynomial(ascending)};
    std::vector<std::complex<double>> out;
    for (long i = 0; i < factors.count(); ++i) {
        long const n = fmpz_poly_degree(factors.factor(i));
        Discs z(n);
        enclose(z, factors.factor(i));
        for (long k = 0; k < n * factors.multiplicity(i); ++k)
            out.emplace_back(nearest(acb_realref(z + k % n)), nearest(acb_imagref(z + k % n)));
    }
    auto const key = [](std::complex<double> z) {
        return std::tuple(correctly::hypot(z.real(), z.imag()), z.imag(), z.real());
    };
    std::ranges::sort(out, std::greater(), key);
    return out;
}

}  // namespace rlslab
