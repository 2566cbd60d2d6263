// Poles, zeros, gains, modes and responses with their standard deviations: derivatives against the covariance of theta.
#include "src/lab/identify/validate.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/model/response.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <numbers>

namespace rlslab::identify {
namespace {

using Point = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;
using std::numbers::pi;

/// A root of z^n p_0 + ... + p_n, and d root / d theta where theta_i is the coefficient p_(at[i]); at[i] < 0: theta_i
/// is none of them.
struct Root {
    Point value;
    ComplexVector gradient;
    double separation;  ///< half the distance to the next root; 0: the error is not known to first order
};

/// z^n by products alone.
Point power(Point z, int n) {
    Point out = 1;
    for (int i = 0; i < n; ++i) out *= z;
    return out;
}

std::vector<Root> roots_of(std::vector<double> const& p, std::vector<int> const& at, std::vector<Point> const& values) {
    int const n = int(p.size()) - 1;
    std::vector<Root> out;
    for (size_t r = 0; r < values.size(); ++r) {
        Point const z = values[r];
        Point slope = 0;
        for (int i = 0; i < n; ++i) slope = slope * z + double(n - i) * p[size_t(i)];
        ComplexVector gradient = ComplexVector::Zero(Index(at.size()));
        for (size_t i = 0; i < at.size(); ++i)
            if (at[i] >= 0) gradient[Index(i)] = -power(z, n - at[i]) / slope;  // (1)
        double separation = INFINITY;
        for (size_t s = 0; s < values.size(); ++s)
            if (s != r) separation = std::min(separation, std::abs(values[s] - z) / 2);
        out.push_back({z, std::move(gradient), separation});
    }
    return out;
}

/// Of g'theta for a complex gradient g.
Spread spread(ComplexVector const& g, Uncertainty const& e) {
    Spread out;
    Index const d = e.sd.size();
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) {
            if (g[i] == 0.0 || g[j] == 0.0) continue;
            double const c = e.sd[i] * e.correlation(i, j) * e.sd[j];
            out.rr += g[i].real() * c * g[j].real(), out.ri += g[i].real() * c * g[j].imag(),
                out.ii += g[i].imag() * c * g[j].imag();
        }
    return out;
}

/// (3) in the quantile's units: q, and the degrees of freedom.
std::pair<double, double> distance(Point delta, Spread const& S, bool real) {
    if (real) return {delta.real() * delta.real() / S.rr, 1};
    double const det = S.rr * S.ii - S.ri * S.ri;
    if (!(det > 1e-12 * (S.rr + S.ii) * (S.rr + S.ii)))
        return {std::norm(delta) / (S.rr + S.ii), 1};  // they move along a line
    return {(delta.real() * delta.real() * S.ii - 2 * delta.real() * delta.imag() * S.ri +
             delta.imag() * delta.imag() * S.rr) /
                det,
            2};
}

struct Pair {
    size_t pole, at;  ///< at: of the zero
    Point zero;
    double q, sd;
};

/// For each pole at most one zero, nearest (by q) first.
std::vector<Pair> paired(std::vector<Root> const& poles, std::vector<Root> const& zeros, Uncertainty const& e,
                         double confidence) {
    std::vector<Pair> all, out;
    for (size_t i = 0; i < poles.size(); ++i)
        for (size_t j = 0; j < zeros.size(); ++j) {
            Root const &p = poles[i], &z = zeros[j];
            bool const real = p.value.imag() == 0;
            if (real != (z.value.imag() == 0) || p.value.imag() < 0 || z.value.imag() < 0) continue;
            if (!(spread(p.gradient, e).sd() < p.separation && spread(z.gradient, e).sd() < z.separation)) continue;
            Spread const S = spread(ComplexVector(p.gradient - z.gradient), e);  // (2)
            auto const [q, freedom] = distance(p.value - z.value, S, real);
            if (correctly::chi_squared_tail(freedom, q) >= 1 - confidence) all.push_back({i, j, z.value, q, S.sd()});
        }
    std::ranges::stable_sort(all, {}, &Pair::q);
    for (Pair const& p : all)
        if (std::ranges::none_of(out, [&](Pair const& o) { return o.pole == p.pole || o.at == p.at; }))
            out.push_back(p);
    return out;
}

/// A coefficient larger than this many standard deviations may divide the others to first order.
constexpr double surely = 3;

std::vector<Root> pole_roots(DifferenceEquation const& model, std::vector<Term> const& terms) {
    std::vector<double> a{1};
    a.insert(a.end(), model.a.begin(), model.a.end());
    std::vector<int> at;
    for (Term const& t : terms) at.push_back(t.input == -1 ? t.lag : -1);
    return roots_of(a, at, poles(model));
}

std::vector<Root> zero_roots(DifferenceEquation const& model, std::vector<Term> const& terms,
                             Uncertainty const& uncertainty, size_t j) {
    std::vector<double> b = model.b[j];
    int const lead = int(std::ranges::find_if(b, [](double x) { return x != 0; }) - b.begin());
    b.erase(b.begin(), b.begin() + lead);
    if (b.empty()) return {};
    bool leads =
        true;  // the first coefficient is surely not 0; otherwise a zero may lie anywhere: its sd means nothing
    std::vector<int> at(terms.size(), -1);
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input == int(j)) at[i] = terms[i].lag - model.delay - lead;
        if (at[i] == 0 && !(std::abs(b[0]) > surely * uncertainty.sd[Index(i)])) leads = false;
    }
    std::vector<Root> out = roots_of(b, at, zeros(model, j));
    for (Root& r : out)
        if (!leads) r.separation = 0;
    return out;
}

std::vector<RootSpread> spreads_of(std::vector<Root> const& roots, Uncertainty const& e) {
    std::vector<RootSpread> out;
    for (Root const& r : roots) {
        Spread const S = spread(r.gradient, e);
        out.push_back({r.value, S, S.sd() < r.separation});
    }
    return out;
}

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

std::vector<Cancellation> cancellations(DifferenceEquation const& model, std::vector<Term> const& terms,
                                        Uncertainty const& uncertainty, double confidence) {
    std::vector<Root> const ps = pole_roots(model, terms);
    std::vector<std::vector<Pair>> pairs;
    for (size_t j = 0; j < model.b.size(); ++j)
        pairs.push_back(paired(ps, zero_roots(model, terms, uncertainty, j), uncertainty, confidence));
    std::vector<Cancellation> out;
    for (Pair const& first : pairs.empty() ? std::vector<Pair>{} : pairs[0]) {
        auto const cancels = [&](std::vector<Pair> const& of) {
            return std::ranges::any_of(of, [&](Pair const& p) { return p.pole == first.pole; });
        };
        Point const p = ps[first.pole].value;
        if (std::ranges::all_of(pairs, cancels)) out.push_back({p, first.zero, std::abs(p - first.zero), first.sd});
    }
    return out;
}

std::vector<RootSpread> spreads_of_poles(DifferenceEquation const& model, std::vector<Term> const& terms,
                                         Uncertainty const& uncertainty) {
    return spreads_of(pole_roots(model, terms), uncertainty);
}

std::vector<RootSpread> spreads_of_zeros(DifferenceEquation const& model, std::vector<Term> const& terms,
                                         Uncertainty const& uncertainty, size_t input) {
    return spreads_of(zero_roots(model, terms, uncertainty, input), uncertainty);
}

std::pair<double, double> gain_of(DifferenceEquation const& model, std::vector<Term> const& terms, Uncertainty const& e,
                                  size_t input, double t) {
    double A = 1, B = 0;
    for (double const x : model.a) A += x;
    for (double const x : model.b[input]) B += x;
    ComplexVector of_A = ComplexVector::Zero(Index(terms.size())), of_gain = of_A;
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input == -1) of_A[Index(i)] = 1, of_gain[Index(i)] = -B / A / A;
        if (terms[i].input == int(input)) of_gain[Index(i)] = 1 / A;
    }
    if (!(std::abs(A) > t * spread(of_A, e).sd())) return {std::nan(""), std::nan("")};
    return {B / A, spread(of_gain, e).sd()};
}

double normal_quantile(double p) { return correctly::student_quantile(1e9, p); }

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
    out.erase(std::unique(out.begin(), out.end()), out.end());
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
