// Two recursions of A and their shifts; polynomials on the unit circle; the angles of their factors.
#include <rlslab/model/response.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <numbers>

namespace rlslab {
namespace {

using Point = std::complex<double>;
using std::numbers::pi;

void check(std::span<EquationTerm const> terms, Vector<double> const& theta, int input) {
    expects(Index(terms.size()) == theta.size() && input >= 0, "a parameter for each term, and an input");
    for (EquationTerm const& t : terms)
        expects(t.lag >= (t.signal == EquationTerm::output), "lags of 1 or more of the output, 0 or more of an input");
}

/// x_k = forced_k - sum a_l x_{k-l}.
template <class Forced>
Signal recursion(std::span<EquationTerm const> terms, Vector<double> const& theta, Index count, Forced forced) {
    Signal x(size_t(count), 0.0);
    for (Index k = 0; k < count; ++k) {
        double sum = forced(k);
        for (size_t i = 0; i < terms.size(); ++i)
            if (terms[i].signal == EquationTerm::output && k >= terms[i].lag)
                sum -= theta[Index(i)] * x[size_t(k - terms[i].lag)];
        x[size_t(k)] = sum;
    }
    return x;
}

/// e^(-2 pi i f l). The fraction of the turn is exact enough for any lag: f l is reduced first.
Point turned(double f, int lag) {
    double const turns = f * lag, angle = 2 * pi * (turns - std::floor(turns));
    return {correctly::cos(angle), -correctly::sin(angle)};
}

double argument(Point z) { return correctly::atan2(z.imag(), z.real()); }

/// phi(r) of the docstring.
double angle_of(Point r, double f) {
    Point const z = std::conj(turned(f, 1));
    return std::norm(r) < 1 ? argument(1.0 - r * std::conj(z)) : argument(-r) - 2 * pi * f + argument(1.0 - z / r);
}

}  // namespace

Response<double> step_response(std::span<EquationTerm const> terms, Vector<double> const& theta, int input,
                               Index count) {
    check(terms, theta, input);
    Signal const h = recursion(terms, theta, count, [](Index) { return 1.0; });  // (1)
    Response<double> out{Signal(size_t(count), 0.0), Matrix<double>::Zero(theta.size(), count)};
    for (size_t i = 0; i < terms.size(); ++i)  // (2)
        if (terms[i].signal == input)
            for (Index k = terms[i].lag; k < count; ++k)
                out.value[size_t(k)] += theta[Index(i)] * h[size_t(k - terms[i].lag)];
    Signal const v = recursion(terms, theta, count, [&](Index k) { return -out.value[size_t(k)]; });  // (3)
    for (size_t i = 0; i < terms.size(); ++i) {                                                       // (4)
        auto const [signal, lag] = terms[i];
        if (signal != input && signal != EquationTerm::output) continue;
        Signal const& of = signal == input ? h : v;
        for (Index k = lag; k < count; ++k) out.gradient(Index(i), k) = of[size_t(k - lag)];
    }
    return out;
}

Response<Point> frequency_response(std::span<EquationTerm const> terms, Vector<double> const& theta, int input,
                                   std::vector<double> const& frequencies) {
    check(terms, theta, input);
    Index const d = theta.size(), n = Index(frequencies.size());
    Response<Point> out{std::vector<Point>(frequencies.size()), Eigen::MatrixXcd::Zero(d, n)};
    for (Index k = 0; k < n; ++k) {
        Point A = 1, B = 0;
        Eigen::VectorXcd power(d);
        for (Index i = 0; i < d; ++i) {
            auto const [signal, lag] = terms[size_t(i)];
            if (signal != input && signal != EquationTerm::output) continue;
            power[i] = turned(frequencies[size_t(k)], lag);
            (signal == input ? B : A) += theta[i] * power[i];
        }
        Point const G = out.value[size_t(k)] = B / A;  // (1)
        for (Index i = 0; i < d; ++i) {                // (2)
            int const signal = terms[size_t(i)].signal;
            if (signal == input) out.gradient(i, k) = power[i] / A;
            else if (signal == EquationTerm::output) out.gradient(i, k) = -G * power[i] / A;
        }
    }
    return out;
}

Signal continuous_phase(DifferenceEquation const& model, size_t input, std::vector<double> const& frequencies,
                        std::vector<Point> const& G) {
    std::vector<double> const& b = model.b[input];
    auto const first = std::ranges::find_if(b, [](double x) { return x != 0; });
    if (first == b.end()) return Signal(frequencies.size(), NAN);
    std::vector<Point> const of_zeros = zeros(model, input), of_poles = poles(model);
    double const lag = double(model.delay + (first - b.begin()));
    auto const sum = [&](double f) {
        double out = (*first < 0 ? pi : 0) - 2 * pi * f * lag;
        for (Point const& r : of_zeros) out += angle_of(r, f);
        for (Point const& r : of_poles) out -= angle_of(r, f);
        return out;
    };
    constexpr double rounding = 1e-9;  // sum(0) is a multiple of pi but for rounding
    double const start = 2 * pi * std::ceil(sum(0) / (2 * pi) - 0.5 - rounding);
    Signal out;
    for (size_t k = 0; k < frequencies.size(); ++k) {
        double const principal = argument(G[k]), turns = (sum(frequencies[k]) - start - principal) / (2 * pi);
        out.push_back(principal + 2 * pi * std::floor(turns + 0.5));
    }
    return out;
}

}  // namespace rlslab
