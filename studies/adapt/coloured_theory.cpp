// Random systems in coloured noise, and what theory says of their estimates, from their impulse responses.
#include "studies/adapt/coloured_theory.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/model/difference.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace rlslab::studies::coloured {
namespace {

constexpr size_t terms = 400;  // the largest root is 0.87
using M = Matrix<Reference>;
using V = Vector<Reference>;

/// A stationary signal by its responses to the input's white noise and to e.
struct Response {
    std::array<std::vector<double>, 2> of{std::vector<double>(terms), std::vector<double>(terms)};
    Response delayed(Index by) const {
        Response out;
        for (size_t s = 0; s < 2; ++s) std::copy(of[s].begin(), of[s].end() - by, out.of[s].begin() + by);
        return out;
    }
    /// This / (1 + p_1 q^-1 + ...).
    Response over(std::vector<double> const& p) const {
        Response out = *this;
        for (auto& h : out.of)
            for (size_t t = 0; t < terms; ++t)
                for (size_t i = 1; i <= std::min(t, p.size()); ++i) h[t] -= p[i - 1] * h[t - i];
        return out;
    }
    void add(double times, Response const& x) {
        for (size_t s = 0; s < 2; ++s)
            for (size_t t = 0; t < terms; ++t) of[s][t] += times * x.of[s][t];
    }
};
using Responses = std::vector<Response>;

double covariance(Response const& x, Response const& y) {
    double out = 0;
    for (size_t s = 0; s < 2; ++s)
        for (size_t t = 0; t < terms; ++t) out += x.of[s][t] * y.of[s][t];
    return out;
}
M covariances(Responses const& x, Responses const& y) {
    M out(Index(x.size()), Index(y.size()));
    for (size_t i = 0; i < x.size(); ++i)
        for (size_t j = 0; j < y.size(); ++j) out(Index(i), Index(j)) = covariance(x[i], y[j]);
    return out;
}
M product(M const& A, M const& B) { return A.lazyProduct(B); }
Vector<double> diagonal(M const& A) {
    Vector<double> out(A.rows());
    for (Index i = 0; i < A.rows(); ++i) out[i] = static_cast<double>(A(i, i));
    return out;
}
Vector<double> rounded(M const& column) {
    Vector<double> out(column.rows());
    for (Index i = 0; i < column.rows(); ++i) out[i] = static_cast<double>(column(i, 0));
    return out;
}

struct Signals {
    Response u, e, v, y, from_input;
    explicit Signals(System const& s) {
        double power = std::sqrt(1 - s.pole * s.pole);
        for (double& h : u.of[0]) h = power, power *= s.pole;
        e.of[1][0] = 1;
        v.add(s.sigma, e);
        for (size_t i = 0; i < nc; ++i) v.add(s.sigma * s.c[i], e.delayed(Index(i) + 1));
        Response input;
        for (size_t i = 0; i < nb; ++i) input.add(s.b[i], u.delayed(Index(i)));
        std::vector<double> const a(s.a.begin(), s.a.end());
        from_input = input.over(a);
        y = v.over(a);
        y.add(1, from_input);
    }
    /// psi = (-y_{k-1}, -y_{k-2}, u_k, u_{k-1}, u_{k-2}).
    Responses psi() const {
        Responses out;
        for (Index i = 1; i <= na; ++i) out.emplace_back().add(-1, y.delayed(i));
        for (Index i = 0; i < nb; ++i) out.push_back(u.delayed(i));
        return out;
    }
};

/// X of (A - I/2) X + X (A - I/2)' = W; NaN unless it is positive definite, that is, unless every eigenvalue of A has a
/// real part above 1/2.
M limit_of_recursion(M A, M const& W) {
    Index const n = A.rows();
    for (Index i = 0; i < n; ++i) A(i, i) -= Reference(1) / 2;
    M K = M::Zero(n * n, n * n);
    V w(n * n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
            w[i + n * j] = W(i, j);
            for (Index l = 0; l < n; ++l) K(i + n * j, l + n * j) += A(i, l), K(i + n * j, i + n * l) += A(j, l);
        }
    V const x = K.partialPivLu().solve(w);
    M X(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) X(i, j) = (x[i + n * j] + x[j + n * i]) / 2;
    if (X.llt().info() != Eigen::Success) X.setConstant(Reference(NAN));
    return X;
}

/// E u_k u_{k+lag}.
struct OfInput {
    std::vector<double> powers{1};
    explicit OfInput(System const& s) {
        while (powers.size() < terms + instruments) powers.push_back(powers.back() * s.pole);
    }
    double operator()(Index lag) const { return powers[size_t(std::abs(lag))]; }
};

/// sum_tau E[x_k x_{k+tau}] E[zeta_k zeta_{k+tau}'], zeta_k = (u_k ... u_{k-7}).
M long_run(System const& s, Response const& x) {
    OfInput const of_input(s);
    M out = M::Zero(instruments, instruments);
    for (Index tau = 0; tau < Index(terms); ++tau) {
        double const r = covariance(x, x.delayed(tau));
        for (Index i = 0; i < instruments; ++i)
            for (Index j = 0; j < instruments; ++j)
                out(i, j) += r * (of_input(tau + i - j) + (tau > 0 ? of_input(i - j - tau) : 0));
    }
    return out;
}

struct ByInstruments {
    M zeta, Pi, Q_inverse;
    Responses w;
    explicit ByInstruments(Signals const& signals) {
        Responses z, psi = signals.psi();
        for (Index i = 0; i < instruments; ++i) z.push_back(signals.u.delayed(i));
        zeta = covariances(z, z);
        M const cross = covariances(z, psi);
        Pi = product(zeta.inverse(), cross);
        Q_inverse = product(cross.transpose(), Pi).inverse();
        for (size_t i = 0; i < na; ++i) {
            w.push_back(psi[i]);
            for (size_t j = 0; j < z.size(); ++j) w[i].add(-static_cast<double>(Pi(Index(j), Index(i))), z[j]);
        }
    }
    Vector<double> variance(M const& S) const {
        return diagonal(product(product(Q_inverse, product(product(Pi.transpose(), S), Pi)), Q_inverse));
    }
};

constexpr std::array<std::string_view, 3> colours{"white", "positive real", "not positive real"};

/// With sigma for the noise's share of y.
System in_noise(System s, std::string_view name) {
    s.c = colour(name), s.sigma = 1;
    Signals const signals(s);
    Response noise = signals.y;
    noise.add(-1, signals.from_input);
    s.sigma = std::sqrt(0.25 * covariance(signals.from_input, signals.from_input) / covariance(noise, noise));
    return s;
}

}  // namespace

std::array<double, 2> colour(std::string_view name) {
    if (name == "white") return {0, 0};
    if (name == "positive real") return {0.3, 0.1};
    if (name == "not positive real") return {1.5, 0.75};
    throw std::logic_error("no such colour");
}

System system_of(int number, std::string_view name, Seed seed) {
    for (;;) {
        DifferenceEquation const drawn = random_stable(2, Seed{seed.next()});
        System s{.a = {drawn.a[0], drawn.a[1]},
                 .c = {},
                 .b = {drawn.b[0][0], drawn.b[0][1], drawn.b[0][2]},
                 .pole = number % 2 ? 0 : 0.7,
                 .sigma = 1};
        bool good = true;
        for (std::complex<double> const& z : poles(drawn)) good = good && std::norm(z) <= 0.64;
        for (std::string_view const each : colours) {
            if (!good) break;
            System const in = in_noise(s, each);
            Signals const signals(in);
            Vector<double> const variance = ByInstruments(signals).variance(long_run(in, signals.v));
            for (Index i = 0; i < na; ++i) good = good && variance[i] <= 5;
        }
        if (good) return in_noise(s, name);
    }
}

Theory theory_of(System const& s) {
    Signals const signals(s);
    Theory out;
    Responses const psi = signals.psi();
    out.least_squares_bias = rounded(product(covariances(psi, psi).inverse(), covariances(psi, {signals.v})));

    Responses phi = psi, filtered;
    for (Index i = 1; i <= nc; ++i) phi.emplace_back().add(s.sigma, signals.e.delayed(i));
    for (Response const& x : phi) filtered.push_back(x.over({s.c[0], s.c[1]}));
    M const R_inverse = covariances(phi, phi).inverse(), G = covariances(phi, filtered),
            W = R_inverse * Reference(s.sigma * s.sigma);
    out.extended = diagonal(limit_of_recursion(product(R_inverse, G), W));

    ByInstruments const iv(signals);
    Response w_theta;
    for (size_t i = 0; i < na; ++i) w_theta.add(s.a[i], iv.w[i]);
    M const S_v = long_run(s, signals.v);
    out.by_instruments = iv.variance(S_v);
    out.plain = iv.variance(S_v + long_run(s, w_theta));
    M first = M::Zero(d, 1), later = M::Zero(d, 1);
    M const zeta_inverse = iv.zeta.inverse();
    OfInput const of_input(s);
    for (Index lag = 0; lag <= nc; ++lag) {
        M shifted(instruments, instruments);
        for (Index i = 0; i < instruments; ++i)
            for (Index j = 0; j < instruments; ++j) shifted(i, j) = of_input(lag + i - j);
        Reference const trace = product(zeta_inverse, shifted).trace();
        for (Index i = 0; i < na; ++i) {
            Reference const r = covariance(iv.w[size_t(i)].delayed(lag), signals.v);
            if (lag == 0) first(i, 0) += Reference(instruments * (1 + correctly::log(4))) * r;
            else later(i, 0) += trace * r;
        }
    }
    out.at_first = rounded(product(iv.Q_inverse, first)), out.with_log = rounded(product(iv.Q_inverse, later));
    return out;
}

Vector<double> Theory::instruments_bias(double rows) const {
    Vector<double> out(d);
    for (Index i = 0; i < d; ++i)
        out[i] = (at_first[i] + with_log[i] * correctly::log(rows / double(instruments))) / rows;
    return out;
}

}  // namespace rlslab::studies::coloured
