// MPFR's numbers as bytes, whatever the length of GMP's limbs.
#pragma once

#include <rlslab/core/encoding.hpp>

#include <mpfr.h>

namespace rlslab::detail {

/// A kind (NaN, infinity, zero, regular; + 128 with a sign), an exponent e and the integer m of +-m 2^e, m of `bits`
/// bits.
template <int bits>
struct MpfrEncoding {
    static constexpr std::size_t integer = (bits + 7) / 8, size = 1 + 8 + integer;

    static void write(mpfr_srcptr x, std::byte* to) {
        std::fill(to, to + size, std::byte(0));
        int const kind = mpfr_nan_p(x) ? 0 : mpfr_inf_p(x) ? 1 : mpfr_zero_p(x) ? 2 : 3;
        to[0] = std::byte(kind + (mpfr_signbit(x) ? 128 : 0));
        if (kind < 3) return;
        mpz_t m;
        mpz_init(m);
        Encoding<std::int64_t>::write(std::int64_t(mpfr_get_z_2exp(m, x)), to + 1);
        mpz_export(to + 9, nullptr, -1, 1, 0, 0, m);
        mpz_clear(m);
    }
    /// x of `bits` bits. False where write() would have written otherwise.
    static bool read(std::byte const* from, mpfr_ptr x) {
        int const kind = int(from[0]) & 127, sign = from[0] >= std::byte(128) ? -1 : 1;
        std::int64_t exponent = 0;
        bool const in_range =
            Encoding<std::int64_t>::read(from + 1, exponent) && exponent == std::int64_t(mpfr_exp_t(exponent));
        if (kind == 0) mpfr_set_nan(x);
        else if (kind == 1) mpfr_set_inf(x, sign);
        else mpfr_set_zero(x, sign);
        if (kind == 3) {
            mpz_t m;
            mpz_init(m);
            mpz_import(m, integer, -1, 1, 0, 0, from + 9);
            mpfr_set_z_2exp(x, m, mpfr_exp_t(exponent), MPFR_RNDN);
            mpz_clear(m);
        }
        mpfr_setsign(x, x, sign < 0, MPFR_RNDN);
        return kind <= 3 && in_range && written_as(x, from);
    }
    static bool written_as(mpfr_srcptr x, std::byte const* from) {
        std::byte again[size];
        write(x, again);
        return std::equal(again, again + size, from);
    }
};

}  // namespace rlslab::detail
