// The half-power law (docs/theory.md 128, 129): one step, the metric and N steps in rationals, where half of each
// constant is reached; N steps of float filters, drawn and by climbing over rows.
#include <rlslab/studies/half_power.hpp>
#include <rlslab/studies/rationals.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

namespace rlslab {
namespace {

using namespace studies::rationals;

M product(M const& A, M const& B) { return A.lazyProduct(B); }
/// The step of item 12.
M stepped(M const& P, V const& psi, Q const& lambda) {
    V const f = P.lazyProduct(psi);
    return (P - outer(f, f) / Q(lambda + dot(psi, f))) / lambda;
}

/// A root FF' of P, f = F'psi, and what one step of a sweep leaves: per row i the squares of the lengths of N_i, M_i of
/// the page over a_i^2 = (P_+)_ii, times gamma (N) or gamma / (1 - gamma)^2 (M). The theorem: at most 1.
struct Sweep {
    Q gamma, rows = 0, running = 0;
    Sweep(M const& F, V const& f, Q const& lambda) {
        Index const d = f.size();
        V s(d + 1);
        s[0] = lambda;
        for (Index j = 0; j < d; ++j) s[j + 1] = s[j] + f[j] * f[j];
        gamma = lambda / s[d];
        V const v = F.lazyProduct(f);
        M const next = (product(F, F.transpose()) - outer(v, v) / s[d]) / lambda;
        for (Index i = 0; i < d; ++i) {
            Q n = 0, m = 0, sum = 0;
            for (Index j = 0; j < d; ++j) {
                n += F(i, j) * F(i, j) * s[j] / (lambda * s[j + 1]);
                m += f[j] * f[j] * sum * sum / (lambda * s[j] * s[j + 1]);
                sum += abs(F(i, j) * f[j]);
            }
            if (next(i, i) == 0) continue;
            rows = std::max<Q>(rows, gamma * n / next(i, i));
            running = std::max<Q>(running, gamma * m / ((1 - gamma) * (1 - gamma) * next(i, i)));
        }
    }
};
TEST(HalfPower, OfOneStepIsSharpToAFactorOfTwo) {
    Seed seed{11};
    for (int n = 0; n < 300; ++n) {
        Index const d = 2 + n % 4;
        M F = M::Zero(d, d);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) F(i, j) = Q(int(seed.next() % 19) - 9) / (n % 2 ? 1 : 1 + int(i + 4 * j));
        for (Index j = 0; j < d; ++j) F(j, j) += 20;
        V f = integers(d, seed, 9);
        f[0] += 10;
        if (n % 3 == 0) F.row(0) = f.transpose();  // P_+ is least along the row
        Sweep const step(F, f, n % 2 ? Q(1) : Q(9) / 10);
        EXPECT_LE(std::max(step.rows, step.running), 1) << n;
    }
    // d = 2 and a new F_12 of 0: half a length is reached.
    M F(2, 2);
    V f(2);
    f << 99, 99;
    F << 3, 3 * f[0] * f[1] / (1 + f[0] * f[0]), 0, 5;
    EXPECT_EQ(Sweep(F, f, 1).running, Q(1) / 4);
    // Sums s_j that grow by a factor, and a row of F along f: near 1.
    Index const d = 24;
    M wide = M::Identity(d, d);
    V grown(d);
    Q s = 1;
    for (Index j = 0; j < d; ++j) {
        grown[j] = Q(std::round(std::sqrt(std::pow(1.7, double(j + 1)) * 0.7 / 1.7) * 64)) / 64;
        s += grown[j] * grown[j];
    }
    wide.row(0) = grown.transpose();
    Sweep const near(wide, grown, 1);
    EXPECT_GT(std::min(near.rows, near.running), Q(1) / 4);
    EXPECT_LE(std::max(near.rows, near.running), 1);
}

/// Whether A >= 0, by exact elimination of a symmetric A.
bool is_semidefinite(M A) {
    for (Index j = 0; j < A.rows(); ++j) {
        if (A(j, j) < 0) return false;
        for (Index i = j + 1; i < A.rows(); ++i) {
            if (A(j, j) == 0 && A(i, j) != 0) return false;
            if (A(j, j) == 0) continue;
            Q const m = A(i, j) / A(j, j);
            for (Index k = j + 1; k < A.rows(); ++k) A(i, k) -= m * A(j, k);
        }
    }
    return true;
}
/// A number of `bits` bits at or below (above) the root of x.
Q root(Q const& x, bool above) {
    Q out = Q(std::sqrt(double(x)) * (above ? 1 + 0x1p-40 : 1 - 0x1p-40));
    EXPECT_TRUE(above ? out * out >= x : out * out <= x);
    return out;
}
/// A number at or below the least eigenvalue of P's correlation matrix.
Q least(M const& P) {
    M const diagonal = P.diagonal().asDiagonal();
    Q low = 0, high = 1;
    for (int n = 0; n < 40; ++n) {
        Q const middle = (low + high) / 2;
        (is_semidefinite(P - middle * diagonal) ? low : high) = middle;
    }
    return low;
}
/// Rows of delta F at most eps a_i long: -2x P <= error <= (2x + x^2) P, x^2 = eps^2 d / mu. An error of P itself of
/// eps a a' needs the whole power: it breaks the half one.
TEST(HalfPower, OfTheMetricHoldsForAFactorAndNotForAStoredP) {
    Seed seed{12};
    for (int n = 0; n < 60; ++n) {
        Index const d = 2 + n % 3;
        bool const extreme = d == 2 && n % 2 == 0;
        M F = M::Zero(d, d), error = F, stored = F;
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) F(i, j) = i == j ? Q(1) / (1 + n % 9) : Q(int(seed.next() % 19) - 9) / 9;
        if (extreme) F << Q(1) / 60, 1, 0, 1;
        M const P = product(F, F.transpose());
        Q const mu = least(P), eps = Q(1) / (n % 2 ? 7 : 4000);
        for (Index i = 0; i < d; ++i) {
            V row(d);
            for (Index j = 0; j < d; ++j) row[j] = j < i ? Q(0) : Q(int(seed.next() % 9) - 4);
            if (extreme) row[0] = i == 0, row[1] = i == 0 ? Q(0) : Q(-1);
            Q const length = dot(row, row);
            if (length != 0) row = V(row * root(eps * eps * P(i, i) / length, false));
            error.row(i) = row.transpose();
            for (Index j = 0; j < d; ++j) stored(i, j) = (i + j) % 2 ? -1 : 1;
        }
        M const change =
            product(error, F.transpose()) + product(F, error.transpose()) + product(error, error.transpose());
        Q const x = root(eps * eps * int(d) / mu, true);
        EXPECT_TRUE(is_semidefinite((2 * x + x * x) * P - change)) << n;
        EXPECT_TRUE(is_semidefinite(2 * x * P + change)) << n;
        if (!extreme) continue;
        EXPECT_FALSE(is_semidefinite(x * P - change)) << "half of the constant is reached";
        for (Index i = 0; i < d; ++i)
            for (Index j = 0; j < d; ++j) stored(i, j) *= eps * root(P(i, i), false) * root(P(j, j), false);
        EXPECT_FALSE(is_semidefinite((2 * x + x * x) * P - stored)) << "a stored P pays the whole power";
        EXPECT_TRUE(is_semidefinite(eps * int(d) / mu * P - stored));
        EXPECT_FALSE(is_semidefinite(eps * int(d) / (2 * mu) * P - stored)) << "half of it is reached";
    }
}
/// -eps_k Q_k <= Phat_k - Q_k <= eps_k Q_k at each row, Q_k the exact step from Phat_(k-1): (1 - eta) P_N <= Phat_N <=
/// (1 + eta) P_N with eta = sum eps_k tau_k, tau_k^-1 Phat_N^-1 >= lambda^(N-k) Phat_k^-1. No order is neglected.
TEST(HalfPower, OfNRowsAddsUpExactly) {
    for (int n = 0; n < 24; ++n) {
        Seed seed{std::uint64_t(100 + n)};
        Index const d = 1 + n % 3, N = 4;
        Q const lambda = n % 2 ? Q(1) : Q(4) / 5;
        bool const shrinks = n % 4 < 2;
        M P = M::Identity(d, d) * Q(3), exact = P;
        std::vector<M> after;
        std::vector<Q> eps;
        for (Index k = 0; k < N; ++k) {
            V const psi = integers(d, seed, 3);
            M const image = stepped(P, psi, lambda);
            exact = stepped(exact, psi, lambda);
            eps.push_back(Q(1 + int(seed.next() % 9)) / 40);
            P = image * (shrinks ? 1 - eps.back() : 1 + eps.back());
            if (n >= 12) {  // a change of rank one, of that size in the metric of the image
                V const x = image.lazyProduct(integers(d, seed, 5));
                Q const size = form(x, inverse(image));
                if (size != 0) P = image + (shrinks ? -1 : 1) * eps.back() / size * outer(x, x);
            }
            after.push_back(P);
        }
        M const last = inverse(P);
        Q eta = 0, power = 1;
        for (Index k = N - 1; k >= 0; --k) {
            M const then = power * inverse(after[size_t(k)]);
            Q low = 0, high = 64;
            for (int step = 0; step < 30; ++step) {
                Q const middle = (low + high) / 2;
                (is_semidefinite(middle * last - then) ? high : low) = middle;
            }
            eta += eps[size_t(k)] * high, power *= lambda;
        }
        EXPECT_TRUE(is_semidefinite((1 + eta) * exact - P)) << n;
        EXPECT_TRUE(is_semidefinite(P - (1 - eta) * exact)) << n;
        if (d == 1) {
            EXPECT_FALSE(shrinks ? is_semidefinite(P - (1 - eta / 2) * exact)
                                 : is_semidefinite((1 + eta / 2) * exact - P))
                << "half is reached: " << n;
        }
    }
}

// --- floats ----------------------------------------------------------------------------------------------

using Rows = std::vector<Vector<float>>;
Rows drawn_rows(char const* basis, Index d, double kappa, Seed& seed) {
    Rows out;
    Matrix<double> const rows = studies::half_power_rows(basis, d, kappa, 60, seed);
    for (auto const& row : rows.colwise()) out.emplace_back(row.cast<float>());
    return out;
}
/// eta of F over u = 2^-24.
template <class F>
double error_of(studies::HalfPowerLaw const& law, Rows const& rows, double lambda, double c2) {
    F filter(Problem<float>{
        .size = law.root.rows(), .forgetting = float(lambda), .prior = Prior<float>{.variance = float(c2)}});
    for (auto const& row : rows) filter.update(row, 1);
    Matrix<double> const P = multiplied_out(filter.stored().template mapped<double>([](float x) { return double(x); }));
    return law.eta(P) / 0x1p-24;
}
/// Errors over their bounds: ud, ud_delta, symmetric, joseph; and ud_delta over the guide.
std::array<double, 5> shares(Rows const& rows, double lambda, double c2) {
    Matrix<double> columns(rows[0].size(), Index(rows.size()));
    for (size_t k = 0; k < rows.size(); ++k) columns.col(Index(k)) = rows[k].cast<double>();
    studies::HalfPowerLaw const law(columns, lambda, c2);
    double const delta = error_of<UdDelta<float>>(law, rows, lambda, c2);
    return {error_of<Ud<float>>(law, rows, lambda, c2) / law.ud, delta / law.ud_delta,
            error_of<Symmetric<float>>(law, rows, lambda, c2) / law.symmetric,
            error_of<Joseph<float>>(law, rows, lambda, c2) / law.joseph, delta / law.half};
}
TEST(HalfPower, OfNRowsIsNotExceededInFloat) {
    Seed seed{126};
    std::array<double, 4> most{};
    std::vector<double> guides;
    for (std::string const basis : {"rotated", "units", "line", "start"})
        for (Index const d : {2, 5})
            for (double const lambda : {1.0, 0x1.f6p-1, 0x1.e8p-1})
                for (double const kappa : {10.0, 100.0, 1000.0})
                    for (double const c2 : {1.0, 256.0, 65536.0}) {
                        auto const found = shares(drawn_rows(basis.c_str(), d, kappa, seed), lambda, c2);
                        for (size_t i = 0; i < 4; ++i) {
                            EXPECT_LE(found[i], 1);
                            most[i] = std::max(most[i], found[i]);
                        }
                        if (basis != "start") guides.push_back(found[4]);
                    }
    std::sort(guides.begin(), guides.end());
    double const low = guides[guides.size() / 20], high = guides[guides.size() - 1 - guides.size() / 20];
    std::cout << "largest shares: ud " << most[0] << ", ud_delta " << most[1] << ", symmetric " << most[2]
              << ", joseph " << most[3] << "; guide " << low << ", " << guides[guides.size() / 2] << ", " << high
              << "\n";
    EXPECT_GT(low, 0.01);
    EXPECT_LT(high, 0.12);
}
/// What climbing finds of an error over its bound: numbers are scaled, turned round, moved by some units.
TEST(HalfPower, OfNRowsIsNotExceededByClimbing) {
    for (size_t const form : {0u, 1u, 2u, 3u}) {
        Seed seed{form + 1};
        double most = 0;
        for (int start = 0; start < 6; ++start) {
            Index const d = 2 + start % 2;
            double const lambda = start < 3 ? 1 : 0.875, c2 = std::ldexp(1, 2 * start);
            Rows rows(size_t(d + 4), Vector<float>(d));
            for (auto& row : rows)
                for (float& x : row) x = float(seed.bell() * std::exp(2 * seed.bell()));
            double here = 0;
            for (int n = 0; n < 800; ++n) {
                Rows other = rows;
                float& x = other[seed.next() % rows.size()][Index(seed.next() % unsigned(d))];
                switch (seed.next() % 3) {
                    case 0: x *= float(std::exp(seed.bell())); break;
                    case 1: x = -x; break;
                    default: x *= 1 + 0x1p-22f * float(seed.bell());
                }
                if (std::abs(x) > 1e4 || std::abs(x) < 1e-4) continue;
                if (double const found = shares(other, lambda, c2)[form]; found >= here) here = found, rows = other;
            }
            most = std::max(most, here);
        }
        EXPECT_LE(most, 1) << form;
        std::cout << "climbing, form " << form << ": " << most << "\n";
    }
}

}  // namespace
}  // namespace rlslab
