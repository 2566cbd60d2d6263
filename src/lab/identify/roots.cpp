// Standard deviations of poles, zeros and gains.
#include "src/lab/identify/roots.hpp"

#include <rlslab/reference/distributions.hpp>

#include <algorithm>

namespace rlslab::identify {
namespace {

using Point = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;

/// A root of z^n p_0 + ... + p_n, and d root / d theta where theta_i is the coefficient p_(at[i]); at[i] < 0: theta_i
/// is none of them.
struct Root {
    Point value;
    ComplexVector gradient;
    double separation;  ///< half the distance to the next root
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
    size_t pole;
    Point zero;
    double q, sd;
};

/// For each pole at most one zero, nearest (by q) first.
std::vector<Pair> paired(std::vector<Root> const& poles, std::vector<Root> const& zeros, Uncertainty const& e,
                         double confidence) {
    struct Candidate {
        size_t pole, zero;
        double q, sd;
    };
    std::vector<Candidate> all;
    for (size_t i = 0; i < poles.size(); ++i)
        for (size_t j = 0; j < zeros.size(); ++j) {
            Root const &p = poles[i], &z = zeros[j];
            bool const real = p.value.imag() == 0;
            if (real != (z.value.imag() == 0) || p.value.imag() < 0 || z.value.imag() < 0) continue;
            if (!(spread(p.gradient, e).sd() < p.separation && spread(z.gradient, e).sd() < z.separation)) continue;
            Spread const S = spread(ComplexVector(p.gradient - z.gradient), e);  // (2)
            auto const [q, freedom] = distance(p.value - z.value, S, real);
            if (correctly::chi_squared_tail(freedom, q) >= 1 - confidence) all.push_back({i, j, q, S.sd()});
        }
    std::ranges::stable_sort(all, {}, &Candidate::q);
    std::vector<Pair> out;
    std::vector<bool> used(zeros.size(), false);
    for (Candidate const& c : all)
        if (!used[c.zero] && std::ranges::none_of(out, [&](Pair const& p) { return p.pole == c.pole; }))
            used[c.zero] = true, out.push_back({c.pole, zeros[c.zero].value, c.q, c.sd});
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

/// leads: the first coefficient is surely not 0. Otherwise a zero may lie anywhere, and its sd means nothing.
struct ZeroRoots {
    std::vector<Root> roots;
    bool leads = true;
};
ZeroRoots zero_roots(DifferenceEquation const& model, std::vector<Term> const& terms, Uncertainty const& uncertainty,
                     size_t j) {
    std::vector<double> b = model.b[j];
    int const lead = int(std::ranges::find_if(b, [](double x) { return x != 0; }) - b.begin());
    b.erase(b.begin(), b.begin() + lead);
    if (b.empty()) return {};
    ZeroRoots out;
    std::vector<int> at(terms.size(), -1);
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input == int(j)) at[i] = terms[i].lag - model.delay - lead;
        if (at[i] == 0 && !(std::abs(b[0]) > surely * uncertainty.sd[Index(i)])) out.leads = false;
    }
    out.roots = roots_of(b, at, zeros(model, j));
    return out;
}

RootSpread spread_of(Root const& r, Uncertainty const& e) {
    Spread const S = spread(r.gradient, e);
    return {r.value, S, S.sd() < r.separation};
}

}  // namespace

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

std::vector<Cancellation> cancellations(DifferenceEquation const& model, std::vector<Term> const& terms,
                                        Uncertainty const& uncertainty, double confidence) {
    std::vector<Root> const ps = pole_roots(model, terms);
    std::vector<std::vector<Pair>> pairs;
    for (size_t j = 0; j < model.b.size(); ++j) {
        ZeroRoots const zeros = zero_roots(model, terms, uncertainty, j);
        pairs.push_back(paired(ps, zeros.leads ? zeros.roots : std::vector<Root>{}, uncertainty, confidence));
    }
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
    std::vector<RootSpread> out;
    for (Root const& r : pole_roots(model, terms)) out.push_back(spread_of(r, uncertainty));
    return out;
}

std::vector<RootSpread> spreads_of_zeros(DifferenceEquation const& model, std::vector<Term> const& terms,
                                         Uncertainty const& uncertainty, size_t input) {
    ZeroRoots const zeros = zero_roots(model, terms, uncertainty, input);
    std::vector<RootSpread> out;
    for (Root const& r : zeros.roots) out.push_back(spread_of(r, uncertainty)), out.back().first_order &= zeros.leads;
    return out;
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

}  // namespace rlslab::identify
