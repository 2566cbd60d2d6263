// What can be set on the page: THE list. The page makes its controls, its links and its worker's messages from it.
#pragma once

#include <rlslab/adapt/guard_policy.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

#include <iterator>

namespace rlslab::live {

struct Settings {
    double bits, exponents, rounding;       ///< exponents: bits of the exponent, or doubles_exponents for double's
    double parameters, rows, condition;     ///< condition: its log10
    double units, forgetting, prior;        ///< units: the condition comes from units; prior: log2 of P0's variance
    double noise, gain_error, seed;         ///< gain_error: its log2; least: none
    double outlier, silent, change, table;  ///< switches; table: rows of the table, not made ones
    double guard;                           ///< 0: none; i: guards[i - 1]
};
/// The policies that can be set; each skips outliers, as the reference does then.
inline constexpr NamedPolicy guards[] = {*find_policy("reset"), *find_policy("rebuild")};
struct Setting {
    char const* name;
    double Settings::*number;
    double least, most, step, start;
};
inline constexpr double doubles_exponents = 10, no_gain_error = -41;
inline constexpr Setting settings[] = {
    {"bits", &Settings::bits, 2, 53, 1, 16},
    {"exponents", &Settings::exponents, 4, doubles_exponents, 1, doubles_exponents},
    {"rounding", &Settings::rounding, 0, 2, 1, 0},
    {"parameters", &Settings::parameters, 2, 8, 1, 5},
    {"rows", &Settings::rows, 50, 2000, 10, 300},
    {"condition", &Settings::condition, 0, 10, 0.1, 1.5},
    {"units", &Settings::units, 0, 1, 1, 0},
    {"lambda", &Settings::forgetting, 0.9, 1, 0.001, 0.98},
    {"prior", &Settings::prior, 0, 40, 2, 14},
    {"noise", &Settings::noise, 0, 1, 0.01, 0.1},
    {"gain_error", &Settings::gain_error, no_gain_error, -1, 1, no_gain_error},
    {"seed", &Settings::seed, 1, 99, 1, 1},
    {"outlier", &Settings::outlier, 0, 1, 1, 0},
    {"silent", &Settings::silent, 0, 1, 1, 0},
    {"change", &Settings::change, 0, 1, 1, 0},
    {"guard", &Settings::guard, 0, std::size(guards), 1, 0},
    {"table", &Settings::table, 0, 1, 1, 0},
};
constexpr Settings starting_settings() {
    Settings out{};
    for (Setting const& s : settings) out.*s.number = s.start;
    return out;
}

/// Exponents of e bits are those of IEEE formats: 8 as in float. Only double's take more than 25 bits of significand,
/// and only others round otherwise than to nearest: then it is not valid().
inline RunTimeFormat format_of(Settings const& s) {
    int const greatest = s.exponents == doubles_exponents ? 1023 : (1 << (int(s.exponents) - 1)) - 1;
    return {{int(s.bits), 1 - greatest, greatest},
            s.rounding == 0   ? Rounding::nearest
            : s.rounding == 1 ? Rounding::toward_zero
                              : Rounding::stochastic};
}
inline double gain_error_of(Settings const& s) {
    return s.gain_error == no_gain_error ? 0 : detail::power_of_two(int(s.gain_error));
}

}  // namespace rlslab::live
