// Short formats that are compiled in: binary16, bfloat16, tf32, or any that double can emulate.
#pragma once

#include <rlslab/arithmetic/rounded.hpp>

namespace rlslab {

/// The name as on the command line. A format without a name is "chopped".
constexpr std::string_view name_of(Format format, Rounding rounding) {
    constexpr std::string_view names[][3] = {{"binary16", "binary16-zero", "binary16-stochastic"},
                                             {"bfloat16", "bfloat16-zero", "bfloat16-stochastic"},
                                             {"tf32", "tf32-zero", "tf32-stochastic"},
                                             {"chopped", "chopped-zero", "chopped-stochastic"}};
    int const row = format == binary16 ? 0 : format == bfloat16 ? 1 : format == tf32 ? 2 : 3;
    return names[row][static_cast<int>(rounding)];
}

namespace detail {
/// Rounding to nearest needs only double's result (see round_to_nearest).
template <Format F, Rounding R>
struct InFormat {
    static_assert(fits_in_double(F));
    static constexpr std::string_view name = name_of(F, R);
    static constexpr Format widest = F;
    static constexpr Format format() { return F; }

    template <class Tail>
    static double round(double head, Tail tail) {
        if constexpr (R == Rounding::nearest) return round_to_nearest(head, F);
        else if constexpr (R == Rounding::toward_zero) return round_toward_zero(head, tail(), F);
        else return round_stochastically(head, tail(), F, &StochasticStream::uniform);
    }
    static double of(double x) {
        return round(x, [] { return 0.0; });
    }
    static double nearest(double x) { return round_to_nearest(x, F); }
    static bool is_number(double x) { return x != x || nearest(x) == x; }

    static constexpr bool may_draw = R == Rounding::stochastic;
    static constexpr bool draws() { return may_draw; }
    struct Setting {};
    struct Scope {
        explicit Scope(Setting) {}
    };
    static Setting setting() { return {}; }
};
}  // namespace detail

/// A number of the format F.
template <Format F, Rounding R = Rounding::nearest>
using Chopped = Rounded<detail::InFormat<F, R>>;

using Half = Chopped<binary16>;
using HalfZero = Chopped<binary16, Rounding::toward_zero>;
using HalfStochastic = Chopped<binary16, Rounding::stochastic>;
using BFloat16 = Chopped<bfloat16>;
using BFloat16Zero = Chopped<bfloat16, Rounding::toward_zero>;
using BFloat16Stochastic = Chopped<bfloat16, Rounding::stochastic>;
using Tf32 = Chopped<tf32>;
using Tf32Zero = Chopped<tf32, Rounding::toward_zero>;
using Tf32Stochastic = Chopped<tf32, Rounding::stochastic>;

}  // namespace rlslab
