// Letters are those of docs/theory.md 107 to 110.
#include "studies/maps/winner_laws.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rlslab::studies {
namespace {

constexpr double rounding = 0.4247;  // root mean square of one, in u: item 68

template <class... Terms>
double together(Terms... term) {
    return std::sqrt(((term * term) + ...));
}

/// What all laws share.
struct Sizes {
    double a, a2;         // one rounding of a number; of two where a division by lambda is the second
    double m, forgotten;  // memory, or N; weight of the start
    double d, total, t;   // sum of sigma^2, with and without the last
    double kappa2, g;     // N or m times the largest variance; its share of sigma_d^-2
    double kappa;         // of a transport from v_1 to v_d: g / sigma_d
    double n, h, q;       // sums over rows: of transports, of squared differences, of both
    double size, first;   // |theta_N|, its part along v_1
    double s;             // the noise in theta_N
    // What the correction changes: the weight of the start in P, the part of the terms with kappa, roundings of D, and
    // the errors with which definiteness ends.
    double start = 0, part = 1, part_late = 1, of_D = 1, end = 1.0 / 3;
    double gain = 0;  // the noise of theta with which errors of the gain are multiplied in a factor
};

Sizes sizes_of(MapCell const& at, Laws laws) {
    Sizes x{};
    bool const corrected = laws == Laws::corrected;
    bool const forgets = at.lambda < 1;
    x.a = rounding * at.u(), x.a2 = forgets ? std::sqrt(2) * x.a : x.a;
    x.m = forgets ? 1 / (1 - at.lambda) : at.rows;
    x.forgotten = forgets ? correctly::pow(at.lambda, at.rows) : 1;
    x.d = double(at.sigma.size());
    double mean = 0;
    auto const share = [&](double sigma) { return 1 / (1 + x.forgotten / (at.c2 * x.m * sigma * sigma)); };
    for (double const sigma : at.sigma) {
        double const g = share(sigma);
        x.total += sigma * sigma, mean += g * g / x.d;
        x.s += g * g / (sigma * sigma);
        if (corrected) x.kappa2 = std::max(x.kappa2, g / (sigma * sigma)), x.kappa = std::max(x.kappa, g / sigma);
    }
    double const last = at.sigma.back();
    x.t = x.total - last * last;
    double const g = share(last);
    if (!corrected) x.kappa2 = g / (last * last), x.kappa = g / last;
    x.g = x.kappa * x.kappa / x.kappa2;
    x.start = !corrected ? x.forgotten * x.forgotten : at.rotated ? 0.5 * x.forgotten : x.forgotten / x.d;
    if (corrected) x.part = 0.25, x.part_late = 0.0625, x.of_D = 2, x.end = 0.6;
    x.n = forgets ? 1 / std::sqrt(1 - at.lambda * at.lambda) : std::sqrt(at.rows / 3);
    x.h = (!forgets ? 0.577 : corrected ? 0.289 : 0.129) / std::sqrt(x.m);
    x.q = forgets && !corrected ? 0.224 : 0.408;
    x.s = at.noise * std::sqrt(x.s / (forgets ? 2 * x.m : x.m));
    x.gain = corrected ? x.kappa2 * at.noise / std::sqrt(forgets ? 2 * x.m : x.m) : x.kappa * x.s;
    double const along = at.theta == "v_1" ? share(at.sigma.front()) : at.theta == "v_d" ? g : std::sqrt(mean);
    x.size = together(along, x.s);
    double const generic = 1 / std::sqrt(x.d);
    x.first = at.rotated ? generic : (at.theta == "v_1" ? 1 : at.theta == "v_d" ? 0 : generic) * along / x.size;
    return x;
}

/// Of a form that corrects theta, without what its P does: item 109.
double own_theta(Sizes const& x) { return x.a * (x.n + x.kappa * std::sqrt(x.t) * x.q * x.first); }

/// Items 107 and 110.
MapLaw stored(std::string_view form, MapCell const& at, Sizes const& x) {
    bool const joseph = form == "joseph", conventional = form == "conventional";
    double const spread = std::sqrt(2) / x.d, steep = x.kappa * std::sqrt(x.t);
    // Joseph's products: longer sums in rotated directions; in units the first column cancels.
    double const total = joseph && !at.rotated ? x.total - 1 : x.total,
                 products = joseph && at.rotated ? 1 + steep / std::sqrt(x.d) : 1,
                 later = !joseph         ? x.h
                         : at.lambda < 1 ? x.h * (1 + steep / x.m)
                                         : together(x.h, steep / (x.m * std::sqrt(x.d)));
    double const weakest = at.rotated ? x.a2 * spread * x.t * x.kappa2 : 0,
                 start = x.a * std::sqrt(2) * at.c2 * total * products, early = start * x.d / x.m * x.start * x.g,
                 late = weakest * x.g * later, across = at.rotated ? 2 * x.a2 * spread * steep * x.q : 0;
    double own = x.a2 * x.n * (joseph ? std::sqrt(x.d) : 1);
    if (conventional)  // its antisymmetric part is never damped
        own = together(own, at.lambda < 1 ? x.a * (std::sqrt(x.m) + at.c2 * x.m / x.kappa2) / x.forgotten
                                          : x.a * (at.rows + at.c2 * at.rows / x.kappa2));
    double const theta = together(own_theta(x), x.part * weakest * x.q * x.s / x.size,
                                  start / std::sqrt(2) * x.s / (std::sqrt(x.m * x.d) * x.size) * x.forgotten);
    double const lost = std::max(weakest * x.n * (joseph ? 1 + steep / x.m : 1), start / std::sqrt(2));
    return {theta, together(own, early, late, across), lost > x.end};
}

/// Item 107, the last.
MapLaw information(MapCell const& at, Sizes const& x) {
    double const weakest = at.rotated ? x.a2 * std::sqrt(2) / x.d * x.t * x.kappa2 : 0,
                 P = together(x.a2 * x.n, weakest * x.n);
    return {together(own_theta(x), P), P, weakest * x.n > x.end};
}

/// Item 108: the drift of the plain forms.
double drift_of(std::string_view form, MapCell const& at, Sizes const& x) {
    double const u = at.u();
    bool const forgets = at.lambda < 1;
    // The share of rows whose x_j is below 2 sqrt(u), x_j = chi_1^2 / m.
    double const asleep = std::min(1.0, std::sqrt(4 / std::numbers::pi * std::sqrt(u) * x.m));
    Reference const root = round_to_bits(std::sqrt(at.lambda), 0, at.bits), wide = at.lambda;
    double const bias = std::abs(static_cast<double>((root * root - wide) / wide));
    double out = 0;
    if (form == "carlson" || form == "qr" || form == "extended_qr") out = u * x.m * asleep / (forgets ? 2 : 4);
    if (form == "inverse_qr") out = u * x.m * asleep / std::sqrt(x.d) / (forgets ? 1 : 2);
    if (forgets && (form == "ud" || form == "potter" || form == "gentleman"))
        out = u * x.m / 2 * std::min(1.0, u * x.m * std::sqrt(x.m));
    if (forgets && form != "ud" && form != "gentleman") out += bias * x.m;
    return out;
}

/// Items 108 and 109.
MapLaw factor(std::string_view form, MapCell const& at, Sizes const& x) {
    bool const delta = form.ends_with("_delta"), root = form != "ud" && form != "gentleman" && form != "ud_delta";
    double const n = form == "extended_qr" ? std::sqrt(at.rows) : x.n,
                 steep = at.rotated ? 2 * std::sqrt(2) * x.part * x.a * x.kappa * std::sqrt(x.t / x.d) * x.q : 0,
                 N = at.u() * at.rows,
                 drift = !delta          ? drift_of(form, at, x)
                         : at.lambda < 1 ? 0
                                         : (root ? 0.097 : 0.034) * N * std::sqrt(N),
                 start = form == "potter" ? 1.1 * at.u() * std::sqrt(at.c2 * x.total) * x.forgotten : 0;
    double const P = together(x.a * (root ? 2 : delta ? 1 : x.of_D) * n, drift, steep, start * x.d / x.m);
    double const theta =
        together(own_theta(x), steep * x.gain / (x.kappa * x.size), start * x.s / (std::sqrt(x.m * x.d) * x.size));
    return {theta, P};
}

}  // namespace

double MapCell::u() const { return std::ldexp(1, -bits); }

MapLaw law_of(std::string_view form, MapCell const& at, Laws laws) {
    Sizes const x = sizes_of(at, laws);
    std::string_view const family = family_in_map(form);
    if (family == "information") return information(at, x);
    return family == "factor" || family == "delta" ? factor(form, at, x) : stored(form, at, x);
}

std::string_view family_in_map(std::string_view form) {
    if (form.ends_with("_delta")) return "delta";
    if (form == "joseph" || form == "information") return form;
    for (std::string_view const P : {"conventional", "conventional_two_sided", "symmetric", "joseph_rank_two"})
        if (form == P) return "stored";
    return "factor";
}

}  // namespace rlslab::studies
