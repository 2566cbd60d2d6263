// By MPFR, at 53 bits: correctly rounded, subnormal results included.
#include <rlslab/arithmetic/elementary.hpp>

#include <mpfr.h>

namespace rlslab::correctly {

namespace {

class Number {
    mpfr_t x_;

public:
    explicit Number(double x = 0) {
        mpfr_init2(x_, 53);
        mpfr_set_d(x_, x, MPFR_RNDN);
    }
    ~Number() { mpfr_clear(x_); }
    Number(Number const&) = delete;
    Number& operator=(Number const&) = delete;
    operator mpfr_ptr() { return x_; }
};

/// f(arguments) rounded to 53 bits. A subnormal result has fewer bits: it is rounded again, with the direction of the
/// first rounding known.
template <class F, class... X>
double of(F* f, X... arguments) {
    Number out;
    int ternary = f(out, Number(arguments)..., MPFR_RNDN);
    mpfr_exp_t const least = mpfr_get_emin(), largest = mpfr_get_emax();
    mpfr_set_emin(-1073);  // binary64's, of 0.1f x 2^e
    mpfr_set_emax(1024);
    ternary = mpfr_check_range(out, ternary, MPFR_RNDN);
    mpfr_subnormalize(out, ternary, MPFR_RNDN);
    mpfr_set_emin(least);
    mpfr_set_emax(largest);
    return mpfr_get_d(out, MPFR_RNDN);
}

}  // namespace

double exp(double x) { return of(&mpfr_exp, x); }
double exp2(double x) { return of(&mpfr_exp2, x); }
double log(double x) { return of(&mpfr_log, x); }
double log2(double x) { return of(&mpfr_log2, x); }
double log10(double x) { return of(&mpfr_log10, x); }
double pow(double x, double y) { return of(&mpfr_pow, x, y); }
double hypot(double x, double y) { return of(&mpfr_hypot, x, y); }
double cos(double x) { return of(&mpfr_cos, x); }
double sin(double x) { return of(&mpfr_sin, x); }
double atan2(double y, double x) { return of(&mpfr_atan2, y, x); }

}  // namespace rlslab::correctly
