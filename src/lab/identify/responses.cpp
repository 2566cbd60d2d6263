// Derivatives of response.hpp against the covariance of theta.
#include "src/lab/identify/responses.hpp"

#include "src/lab/identify/roots.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/model/response.hpp>

#include <algorithm>
#include <numbers>

namespace rlslab::identify {
namespace {

using Point = std::complex<double>;
using std::numbers::pi;
constexpr double degrees = 180 / pi, decibels = 8.685889638065037;  // 20 / ln 10

double in_db(double magnitude) { return magnitude > 0 ? 20 * correctly::log10(magnitude) : -INFINITY; }

/// sd of Re(c dp) for p's covariance S.
double sd_of_part(Point c, Spread const& S) {
    return std::sqrt(
        std::max(0.0, c.real() * c.real() * S.rr - 2 * c.real() * c.imag() * S.ri + c.imag() * c.imag() * S.ii));
}

void add(Band& band, double value, double sd, double lower, double upper) {
    band.value.push_back(value), band.sd.push_back(sd), band.lower.push_back(lower), band.upper.push_back(upper);
}

}  // namespace

std::vector<Mode> modes_of(std::vector<RootSpread> const& poles) {
    std::vector<Mode> out;
    for (RootSpread const& root : poles) {
        Point const p = root.value;
        if (!(p.imag() >= 0)) continue;
        Mode mode{.pole = p, .time_constant = {}, .natural_frequency = {}, .damping = {}};
        if (double const size = std::abs(p); size > 0) {
            Point const s{correctly::log(size), correctly::atan2(p.imag(), p.real())};
            double const sigma = s.real(), omega = s.imag(), length = correctly::hypot(sigma, omega);
            // dx = Re(c dp) with c = (dx/dsigma - i dx/domega) / p.
            auto const sd = [&](double by_sigma, double by_omega) {
                return root.first_order ? sd_of_part(Point(by_sigma, -by_omega) / p, root.spread) : NAN;
            };
            if (size < 1) mode.time_constant = {-1 / sigma, sd(1 / sigma / sigma, 0)};
            mode.natural_frequency = {length / (2 * pi), sd(sigma / length / (2 * pi), omega / length / (2 * pi))};
            mode.damping = {-sigma / length,
                            sd(-omega * omega / length / length / length, sigma * omega / length / length / length)};
        }
        out.push_back(mode);
    }
    return out;
}

Index response_length(std::vector<Point> const& poles, std::vector<Term> const& terms) {
    constexpr Index least = 20, most = 1000, of_an_integrator = 100;
    Index last = 0;
    for (Term const& t : terms)
        if (t.input >= 0) last = std::max<Index>(last, t.lag);
    double const size = poles.empty() ? 0 : std::abs(poles[0]),
                 wide = size > 0 && size != 1 ? 4.6051701859880914 / std::abs(correctly::log(size)) : 0;  // ln 100
    Index const length = size == 1 ? of_an_integrator : Index(std::min(wide, double(most)));
    return std::clamp<Index>(last + 2 + length, least, most + last);
}

std::vector<double> response_frequencies(std::vector<Point> const& poles,
                                         std::vector<std::vector<Point>> const& zeros) {
    constexpr int points = 200;
    double const size = poles.empty() ? 0 : std::abs(poles[0]),
                 corner = size > 0 ? std::abs(correctly::log(size)) / (2 * pi) : 0.5,
                 first = std::clamp(corner / 20, 1e-4, 0.01), doublings = correctly::log2(0.5 / first);
    std::vector<double> out;
    for (int i = 0; i <= points; ++i) out.push_back(0.5 * correctly::exp2(doublings * (double(i) / points - 1)));
    auto const angles = [&](std::vector<Point> const& roots) {
        for (Point const& z : roots)
            if (double const f = correctly::atan2(z.imag(), z.real()) / (2 * pi); z.imag() > 0 && f > first)
                out.push_back(f);
    };
    angles(poles);
    for (auto const& of_input : zeros) angles(of_input);
    std::ranges::sort(out);
    out.erase(std::ranges::unique(out).begin(), out.end());
    return out;
}

InputResponse response_of(DifferenceEquation const& model, std::vector<Term> const& terms, Vector<double> const& theta,
                          Uncertainty const& uncertainty, size_t input, double t, Index length,
                          std::vector<double> const& frequencies) {
    std::vector<EquationTerm> places;
    for (Term const& term : terms) places.push_back({term.input, term.lag});
    InputResponse out;
    Response<double> const g = step_response(places, theta, int(input), length);
    for (Index k = 0; k < length; ++k) {
        double const value = g.value[size_t(k)], sd = spread(g.gradient.col(k).cast<Point>(), uncertainty).sd();  // (1)
        add(out.step, value, sd, value - t * sd, value + t * sd);
    }
    Response<Point> const G = frequency_response(places, theta, int(input), frequencies);
    Signal const phase = continuous_phase(model, input, frequencies, G.value);
    for (size_t k = 0; k < frequencies.size(); ++k) {
        Point const at = G.value[k];
        double const size = correctly::hypot(at.real(), at.imag());
        Spread const S = spread(G.gradient.col(Index(k)), uncertainty);
        Point const direction = std::conj(at) / size;
        double const of_size = sd_of_part(direction, S),                          // (2)
            of_phase = degrees * sd_of_part(direction * Point(0, -1), S) / size;  // (3)
        bool const apart = size > t * S.sd();
        add(out.magnitude_db, in_db(size), decibels * of_size / size, apart ? in_db(size - t * of_size) : -INFINITY,
            in_db(size + t * of_size));
        double const value = degrees * phase[k];
        add(out.phase_deg, value, apart ? of_phase : NAN, apart ? value - t * of_phase : NAN,
            apart ? value + t * of_phase : NAN);
    }
    return out;
}

std::vector<Point> region_of(RootSpread const& root, double confidence, double quantile, double freedom) {
    Spread const& S = root.spread;
    if (!root.first_order) return {};
    if (root.value.imag() == 0) {
        double const reach = quantile * std::sqrt(S.rr);
        return {root.value - reach, root.value + reach};
    }
    double const q = freedom * (correctly::pow(1 - confidence, -2 / freedom) - 1);
    // S = L L': the ellipse is p + sqrt(q) L (cos, sin).
    double const l11 = std::sqrt(S.rr), l21 = l11 > 0 ? S.ri / l11 : 0,
                 l22 = std::sqrt(std::max(0.0, S.ii - l21 * l21));
    std::vector<Point> out;
    constexpr int points = 72;
    for (int i = 0; i <= points; ++i) {
        double const angle = 2 * pi * (i % points) / points, c = correctly::cos(angle), s = correctly::sin(angle);
        out.push_back(root.value + std::sqrt(q) * Point(l11 * c, l21 * c + l22 * s));
    }
    return out;
}

}  // namespace rlslab::identify
