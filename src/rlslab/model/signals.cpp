// Each signal is one loop in order, so that the result of a seed does not depend on the machine; then the recursions of
// difference.hpp.
#include <rlslab/model/signals.hpp>

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/model/difference.hpp>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <limits>

namespace rlslab {

Signal white_noise(Index n, Seed seed) {
    expects(n >= 0, "no negative number of samples");
    Signal out(size_t(n), 0.0);
    for (double& x : out) x = seed.bell();
    return out;
}

Signal coloured_noise(Index n, std::vector<double> const& a, Seed seed, Index burn_in) {
    expects(n >= 0 && burn_in >= 0, "no negative number of samples");
    Signal x(size_t(n + burn_in), 0.0);
    for (size_t k = 0; k < x.size(); ++k) {
        x[k] = seed.bell();
        for (size_t i = 1; i <= a.size() && i <= k; ++i) x[k] -= a[i - 1] * x[k - i];
    }
    return {x.begin() + burn_in, x.end()};
}

Signal prbs(int m, Index n, Index hold) {
    expects(2 <= m && m <= 20, "a register of 2 to 20 cells");
    expects(n >= 0 && hold >= 1, "a number of samples, and at least one to hold a level");
    // The cells whose sum is shifted in: a primitive polynomial for each m (tests count the periods).
    constexpr std::array<std::array<int, 4>, 21> taps{{{},
                                                       {},
                                                       {2, 1},
                                                       {3, 2},
                                                       {4, 3},
                                                       {5, 3},
                                                       {6, 5},
                                                       {7, 6},
                                                       {8, 6, 5, 4},
                                                       {9, 5},
                                                       {10, 7},
                                                       {11, 9},
                                                       {12, 6, 4, 1},
                                                       {13, 4, 3, 1},
                                                       {14, 5, 3, 1},
                                                       {15, 14},
                                                       {16, 15, 13, 4},
                                                       {17, 14},
                                                       {18, 11},
                                                       {19, 6, 2, 1},
                                                       {20, 17}}};
    unsigned cells = (1u << m) - 1;  // cell i is bit i - 1
    Signal out(size_t(n), 0.0);
    for (Index k = 0; k < n; ++k) {
        out[size_t(k)] = cells >> (m - 1) & 1 ? 1.0 : -1.0;
        if (k % hold != hold - 1) continue;
        unsigned in = 0;
        for (int const tap : taps[size_t(m)])
            if (tap > 0) in ^= cells >> (tap - 1) & 1;
        cells = (cells << 1 | in) & ((1u << m) - 1);
    }
    return out;
}

Signal multisine(Index n, int harmonics) {
    expects(harmonics >= 1 && 2 * Index(harmonics) < n, "at least one harmonic, and fewer than half the samples");
    using boost::math::constants::pi;
    Signal out(size_t(n), 0.0);
    Reference const scale = sqrt(Reference(2) / harmonics);  // n/2 is what each cosine squared sums to
    for (Index k = 0; k < n; ++k) {
        Reference sum = 0;
        for (Index h = 1; h <= harmonics; ++h)
            sum += cos(pi<Reference>() * (Reference(2 * h * k) / n - Reference(h * (h - 1)) / harmonics));
        out[size_t(k)] = static_cast<double>(scale * sum);
    }
    return out;
}

Signal random_steps(Index n, Index shortest, Index longest, Seed seed) {
    expects(n >= 0 && 1 <= shortest && shortest <= longest,
            "steps of at least one sample, the shortest no longer than the longest");
    Signal out(size_t(n), 0.0);
    Index left = 0;
    double level = 0;
    for (double& x : out) {
        if (left == 0) {
            left = shortest + Index(seed.next() % std::uint64_t(longest - shortest + 1));
            level = 2 * seed.uniform() - 1;
        }
        x = level;
        --left;
    }
    return out;
}

// --- the recursions of the difference equation, in the order in which they are written -------------------------------

DifferenceEquation DifferenceEquation::of(std::span<EquationTerm const> terms, Vector<double> const& theta,
                                          std::size_t inputs) {
    expects(Index(terms.size()) == theta.size(), "a parameter for each regressor");
    DifferenceEquation out;
    out.b.resize(inputs);
    out.delay = std::numeric_limits<int>::max();
    for (EquationTerm const& t : terms) {
        expects(
            t.signal >= EquationTerm::constant && t.signal < int(inputs) && t.lag >= (t.signal == EquationTerm::output),
            "terms of the inputs, of past outputs and the constant");
        if (t.signal >= 0) out.delay = std::min(out.delay, t.lag);
    }
    if (out.delay == std::numeric_limits<int>::max()) out.delay = 0;  // no input
    for (size_t i = 0; i < terms.size(); ++i) {
        auto const [signal, lag] = terms[i];
        double const value = theta[Index(i)];
        if (signal == EquationTerm::constant) {
            out.c = value;
            continue;
        }
        std::vector<double>& into = signal == EquationTerm::output ? out.a : out.b[size_t(signal)];
        size_t const at = size_t(signal == EquationTerm::output ? lag - 1 : lag - out.delay);
        if (into.size() <= at) into.resize(at + 1, 0.0);
        into[at] = value;
    }
    return out;
}

DifferenceEquation DifferenceEquation::of(Arx const& model, Vector<double> const& theta) {
    std::vector<EquationTerm> terms;
    for (int i = 1; i <= model.na; ++i) terms.push_back({EquationTerm::output, i});
    for (int j = 0; j < model.inputs; ++j)
        for (int i = 0; i <= model.nb; ++i) terms.push_back({j, model.delay + i});
    if (model.intercept) terms.push_back({EquationTerm::constant});
    return of(terms, theta, std::size_t(model.inputs));
}

namespace {

/// The right-hand side without xi, from the numbers that y holds so far.
double predicted(DifferenceEquation const& model, std::vector<Signal> const& inputs, Signal const& y, Index k) {
    double sum = model.c;
    for (size_t j = 0; j < model.b.size(); ++j)
        for (size_t i = 0; i < model.b[j].size(); ++i) {
            Index const at = k - model.delay - Index(i);
            if (at >= 0) sum += model.b[j][i] * inputs[j][size_t(at)];
        }
    for (size_t i = 1; i <= model.a.size(); ++i)
        if (k >= Index(i)) sum -= model.a[i - 1] * y[size_t(k) - i];
    return sum;
}

}  // namespace

Signal simulate(DifferenceEquation const& model, std::vector<Signal> const& inputs, Signal const& xi) {
    expects(inputs.size() == model.b.size(), "an input for each b-polynomial");
    for (Signal const& u : inputs) expects(u.size() == xi.size(), "inputs and noise of equal length");
    Signal y(xi.size(), 0.0);
    for (Index k = 0; k < Index(y.size()); ++k) y[size_t(k)] = predicted(model, inputs, y, k) + xi[size_t(k)];
    return y;
}

Signal simulate_from(DifferenceEquation const& model, std::vector<Signal> const& inputs, Signal const& y, Index lead) {
    expects(inputs.size() == model.b.size(), "an input for each b-polynomial");
    Signal out(y.size(), 0.0);
    for (Index k = 0; k < Index(y.size()); ++k)
        out[size_t(k)] = k < lead ? y[size_t(k)] : predicted(model, inputs, out, k);
    return out;
}

std::vector<std::complex<double>> poles(DifferenceEquation const& model) { return roots(model.a); }

std::vector<std::complex<double>> zeros(DifferenceEquation const& model, size_t input) {
    std::vector<double> const& b = model.b[input];
    auto const leading = std::ranges::find_if(b, [](double x) { return x != 0; });
    if (leading == b.end()) return {};
    std::vector<double> p(leading + 1, b.end());
    for (double& x : p) x /= *leading;
    return roots(p);
}

}  // namespace rlslab
