// The recursions of the difference equation, in the order in which they are written.
#include <rlslab/model/difference.hpp>

#include <algorithm>
#include <limits>

namespace rlslab {

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
