// Recursions as written; roots for people to look at.
#include <rlslab/model/difference.hpp>

#include <rlslab/arithmetic/multiprecision.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace rlslab {

DifferenceEquation DifferenceEquation::of(Arx const& model, Vector<double> const& theta) {
    expects(theta.size() == model.size(), "a parameter for each regressor");
    DifferenceEquation out;
    out.delay = model.delay;
    out.a.assign(theta.data(), theta.data() + model.na);
    out.b.emplace_back(theta.data() + model.na, theta.data() + model.na + model.nb + 1);
    if (model.intercept) out.c = theta[theta.size() - 1];
    return out;
}

namespace {

/// The right-hand side but for xi, on whatever y holds so far.
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
    for (Index k = 0; k < Index(y.size()); ++k) out[size_t(k)] = k < lead ? y[size_t(k)] : predicted(model, inputs, out, k);
    return out;
}

std::vector<std::complex<double>> roots(std::vector<double> const& p) {
    Index const n = Index(p.size());
    if (n == 0) return {};
    Matrix<double> companion = Matrix<double>::Zero(n, n);
    for (Index i = 0; i < n; ++i) companion(0, i) = -p[size_t(i)];
    for (Index i = 1; i < n; ++i) companion(i, i - 1) = 1;
    Eigen::VectorXcd const first = companion.eigenvalues();
    struct Complex {
        Quad re, im;
    };
    auto const times = [](Complex const& a, Complex const& b) { return Complex{a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; };
    std::vector<std::complex<double>> out;
    for (Index i = 0; i < n; ++i) {
        Complex z{Quad(first[i].real()), Quad(first[i].imag())};
        for (int step = 0; step < 8; ++step) {
            Complex value{1, 0}, slope{0, 0};
            for (double const c : p) {
                slope = times(slope, z);
                slope.re += value.re, slope.im += value.im;
                value = times(value, z);
                value.re += Quad(c);
            }
            Quad const size = slope.re * slope.re + slope.im * slope.im;
            if (size == 0) break;    // a multiple root: as it is
            Complex const move{(value.re * slope.re + value.im * slope.im) / size, (value.im * slope.re - value.re * slope.im) / size};
            if (Quad(move.re * move.re + move.im * move.im) > Quad(0.01) * (z.re * z.re + z.im * z.im) + Quad(1e-12)) break;
            z.re -= move.re, z.im -= move.im;
        }
        out.emplace_back(static_cast<double>(z.re), static_cast<double>(z.im));
    }
    std::ranges::sort(out, [](auto const& a, auto const& b) {
        double const x = std::abs(a), y = std::abs(b);
        return std::abs(x - y) > 1e-12 * (x + y) ? x > y : a.imag() > b.imag();
    });
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

DifferenceEquation random_stable(int order, Seed seed) {
    expects(order >= 1, "an order of at least 1");
    std::vector<double> a{1};
    auto const times = [&a](std::vector<double> const& factor) {
        std::vector<double> product(a.size() + factor.size() - 1, 0.0);
        for (size_t i = 0; i < a.size(); ++i)
            for (size_t j = 0; j < factor.size(); ++j) product[i + j] += a[i] * factor[j];
        a = product;
    };
    for (int left = order; left > 0; left -= 2) {
        double const radius = 0.3 + 0.65 * seed.uniform();
        if (left == 1)
            times({1, seed.uniform() < 0.5 ? radius : -radius});
        else    // a pair at radius, cos of its angle uniform
            times({1, -2 * radius * (2 * seed.uniform() - 1), radius * radius});
    }
    DifferenceEquation out{.a = {a.begin() + 1, a.end()}, .b = {{}}, .delay = 0, .c = 0};
    for (int i = 0; i <= order; ++i) out.b[0].push_back(2 * seed.uniform() - 1);
    if (std::abs(out.b[0][0]) < 0.1) out.b[0][0] = 0.5;
    return out;
}

}  // namespace rlslab
