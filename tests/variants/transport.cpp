// What the errors of N steps leave (docs/theory.md 114, 115): the transport exactly, the bounds of Joseph's products
// and of the symmetric form against exact steps, and the correlation of graded columns; half a power of it (125, 126).
#include <rlslab/studies/rationals.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rlslab {
namespace {

using namespace studies::rationals;
using Doubles = Eigen::MatrixXd;

/// The step of item 12 from any nonsingular P, symmetric or not; Joseph's products are the same.
M stepped(M const& P, V const& psi, Q const& lambda) {
    V const f = P.lazyProduct(psi), row = P.transpose().lazyProduct(psi);
    Q const s = lambda + dot(psi, f);
    return (P - outer(f, row) / s) / lambda;
}
Q largest(M const& A) {
    Q out = 0;
    for (Q const& x : A.reshaped()) out = std::max<Q>(out, abs(x));
    return out;
}
TEST(Transport, OfTheErrorsOfNRowsIsExact) {
    for (int n = 0; n < 12; ++n) {
        Seed seed{std::uint64_t(n)};
        Index const d = 1 + n % 3, N = 4;
        Q const lambda = n % 2 ? Q(1) : Q(9) / 10;
        std::vector<V> rows;
        std::vector<M> errors;
        for (Index k = 0; k < N; ++k) {
            rows.push_back(integers(d, seed, 3));
            M E(d, d);
            for (Q& x : E.reshaped()) x = Q(int(seed.next() % 9) - 4) / 1000;
            errors.push_back(E);
        }
        M const P0 = M::Identity(d, d) * Q(3);
        auto const rest = [&](M P, Index from) {
            for (Index k = from; k < N; ++k) P = stepped(P, rows[size_t(k)], lambda);
            return P;
        };
        M P = P0, sum = M::Zero(d, d), first = sum, exact = P0;
        for (Index k = 0; k < N; ++k) {
            V const& psi = rows[size_t(k)];
            M const before = P, image = stepped(P, psi, lambda);
            V const f = before.lazyProduct(psi), K = f / (lambda + dot(psi, f));
            M const A = M::Identity(d, d) - outer(K, psi);
            EXPECT_EQ(largest(A.lazyProduct(M(before.lazyProduct(A.transpose()))) / lambda + outer(K, K) - image), 0)
                << "Joseph's products, P not symmetric";
            P = image + errors[size_t(k)];
            Q power = 1;
            for (Index i = k + 1; i < N; ++i) power *= lambda;
            M const left = rest(P, k + 1).lazyProduct(inverse(P)), right = inverse(image).lazyProduct(rest(before, k));
            sum += power * left.lazyProduct(M(errors[size_t(k)].lazyProduct(right)));
            // T_k A_k = lambda T_{k-1} and P_{k-1} T_{k-1}' = P_N of the exact run
            M const was = exact, last = rest(P0, 0);
            exact = stepped(exact, psi, lambda);
            V const g = was.lazyProduct(psi);
            M const A_exact = M::Identity(d, d) - outer(V(g / (lambda + dot(psi, g))), psi),
                    T = last.lazyProduct(inverse(exact)), T_before = last.lazyProduct(inverse(was));
            EXPECT_EQ(largest(T.lazyProduct(A_exact) - lambda * T_before), 0);
            EXPECT_EQ(largest(was.lazyProduct(T_before.transpose()) - last), 0);
            first += power * T.lazyProduct(M(errors[size_t(k)].lazyProduct(T.transpose())));
        }
        EXPECT_EQ(largest(P - rest(P0, 0) - sum), 0) << n;
        EXPECT_NE(largest(P - rest(P0, 0) - first), 0) << "the first order alone";
    }
}

// --- N rows in double against exact ones -----------------------------------------------------------------------------

Q half_to(int n) { return Q(std::ldexp(1.0, -n)); }
M sizes(M A) {
    for (Q& x : A.reshaped()) x = abs(x);
    return A;
}
M product(M const& A, M const& B) { return A.lazyProduct(B); }
/// A B A'.
M around(M const& A, M const& B) { return product(product(A, B), A.transpose()); }
M as_matrix(V const& x) { return x; }
template <class Stored>
M exactly(Stored const& A) {
    return A.unaryExpr([](double x) { return Q(x); });
}
/// The greatest |error| / bound over the entries.
double greatest(M const& error, M const& bound) {
    Q out = 0;
    for (Index j = 0; j < error.cols(); ++j)
        for (Index i = 0; i < error.rows(); ++i)
            if (error(i, j) != 0) out = std::max<Q>(out, abs(error(i, j)) / bound(i, j));
    return double(out);
}

/// Exact steps from P_0: P_0 ... P_N and their inverses.
struct Exact {
    std::vector<V> psi;
    Q lambda;
    std::vector<M> P, information;
    Exact(std::vector<V> rows, Q of, M const& P0) : psi(std::move(rows)), lambda(of), P{P0}, information{inverse(P0)} {
        for (V const& row : psi) {
            information.push_back(lambda * information.back() + outer(row, row));
            P.push_back(inverse(information.back()));
        }
    }
    Index size() const { return P[0].rows(); }
    /// T_k = P_N P_k^-1.
    M transport(size_t k) const { return product(P.back(), information[k]); }
    /// K_k, and A_k = I - K_k psi_k'.
    V gain(size_t k) const { return P[k].lazyProduct(psi[k - 1]); }
    M closed(size_t k) const { return M::Identity(size(), size()) - outer(gain(k), psi[k - 1]); }
    /// lambda^(N - k).
    Q power(size_t k) const {
        Q out = 1;
        for (; k < psi.size(); ++k) out *= lambda;
        return out;
    }
};
Q const u = half_to(53);
/// 20 rows of numbers of double in columns of units 1, kappa^-1/(d-1) ... or in mixtures of them.
Exact run_of(Index d, double lambda, int kappa, bool mixed, Seed seed) {
    std::vector<V> rows;
    for (int k = 0; k < 20; ++k) {
        V row(d);
        for (Index i = 0; i < d; ++i) row[i] = Q(std::ldexp(double(float(seed.bell())), -kappa * int(i) / int(d - 1)));
        if (mixed)
            for (Index i = 1; i < d; ++i) row[i] += row[0] * Q(int(i)) / 4, row[0] += row[i];
        for (Q& x : row) x = Q(double(x));
        rows.push_back(row);
    }
    return Exact(rows, Q(lambda), M::Identity(d, d) / half_to(2 * kappa));
}
Vector<double> as_doubles(V const& row) {
    return row.unaryExpr([](Q const& x) { return double(x); });
}
template <class F>
F filter_of(Exact const& run) {
    return F(Problem<double>{.size = run.size(),
                             .forgetting = double(run.lambda),
                             .prior = Prior<double>{.variance = double(run.P[0](0, 0))}});
}
template <class Test>
void each_run(Test const& test) {
    for (Index const d : {2, 3, 4})
        for (double const lambda : {1.0, 0.9375})
            for (bool const mixed : {false, true}) {
                SCOPED_TRACE(testing::Message() << d << " " << lambda << " " << mixed);
                test(run_of(d, lambda, 8, mixed, Seed{std::uint64_t(d)}));
            }
}

/// The bound of one row's errors in Joseph's products, in units of u, before it is transported.
M local_bound(Exact const& run, size_t k) {
    M const A = sizes(run.closed(k)), P = sizes(run.P[k]), K = sizes(as_matrix(run.gain(k)));
    M G = A;
    for (Index i = 0; i < run.size(); ++i) G(i, i) += abs(run.gain(k)[i] * run.psi[k - 1][i]);
    Q const d = int(run.size()), r = run.lambda == 1 ? 0 : 2;
    M const of_A = product(G, P), sums = product(P, A.transpose());
    return d / run.lambda * around(A, sizes(run.P[k - 1])) + d * M(sums) + of_A + M(of_A.transpose()) +
           (1 + r) * M(P + product(K, K.transpose()));
}
TEST(JosephBound, OfNRowsIsNotExceeded) {
    double most = 0;
    each_run([&](Exact const& run) {
        auto filter = filter_of<Joseph<double>>(run);
        M bound = M::Zero(run.size(), run.size());
        M const last = sizes(run.P.back());
        Q const d = int(run.size()), r = run.lambda == 1 ? 0 : 2;
        for (size_t k = 1; k <= run.psi.size(); ++k) {
            filter.update(as_doubles(run.psi[k - 1]), 0);
            M const T = sizes(run.transport(k)), before = sizes(run.transport(k - 1)), A = sizes(run.closed(k)),
                    P = sizes(run.P[k]), K = sizes(as_matrix(run.gain(k)));
            M G = A;
            for (Index i = 0; i < run.size(); ++i) G(i, i) += abs(run.gain(k)[i] * run.psi[k - 1][i]);
            M const of_A = product(product(T, G), last);
            M const sum = d * product(product(product(T, A), sizes(run.P[k - 1])), before.transpose()) +
                          d * product(product(T, P), product(A.transpose(), T.transpose())) + of_A +
                          M(of_A.transpose()) + (1 + r) * around(T, P + product(K, K.transpose()));
            bound += u * run.power(k) * sum;
        }
        double const ratio = greatest(exactly(filter.covariance()) - run.P.back(), bound);
        EXPECT_LE(ratio, 1);
        most = std::max(most, ratio);
    });
    EXPECT_GT(most, 0.02);
}
TEST(SymmetricBound, OfNRowsIsTheTransportOfItsParts) {
    double most = 0;
    each_run([&](Exact const& run) {
        auto filter = filter_of<Symmetric<double>>(run);
        M sum = M::Zero(run.size(), run.size()), P = run.P[0];
        Q const d = int(run.size()), r = run.lambda == 1 ? 0 : 2, first_order = 1 + half_to(30);
        for (size_t k = 1; k <= run.psi.size(); ++k) {
            V const& psi = run.psi[k - 1];
            auto const row = filter.look(as_doubles(psi), 0);
            V f(run.size());
            for (Index i = 0; i < run.size(); ++i) f[i] = Q(filter.form().f[i]);
            Q const s = Q(row.s);
            filter.commit(row);
            M const next = exactly(filter.covariance()), local = run.lambda * next - (P - outer(f, f) / s);
            V const of_f = f - P.lazyProduct(psi);
            Q const of_s = s - run.lambda - form(psi, P);
            M const rows = sizes(as_matrix(psi));
            double const ratio =
                greatest(local, first_order * u * ((1 + r) * sizes(P) + (3 + r) / s * sizes(outer(f, f))));
            EXPECT_LE(ratio, 1) << k;
            most = std::max(most, ratio);
            EXPECT_LE(greatest(of_f, first_order * d * u * product(sizes(P), rows)), 1);
            EXPECT_LE(abs(of_s),
                      first_order * (2 * d + 1) * u * (run.lambda + around(rows.transpose(), sizes(P))(0, 0)));
            M const T = run.transport(k);
            V const last = run.P.back().lazyProduct(psi), Tf = T.lazyProduct(of_f);
            sum += run.power(k) / run.lambda *
                   (around(T, local) - outer(Tf, last) - outer(last, Tf) + of_s * outer(last, last));
            P = next;
        }
        M const error = P - run.P.back();
        EXPECT_LE(largest(error - sum), largest(error) * half_to(26));
    });
    EXPECT_GT(most, 0.5);
}

// --- graded columns --------------------------------------------------------------------------------------------------

enum class Units { geometric, one_large, one_small };
/// d_1 >= ... >= d_d = 1/kappa, kappa = 2^(m (d - 1)).
int unit(Units units, int m, Index d, Index i) {
    switch (units) {
        case Units::geometric: return -m * int(i);
        case Units::one_large: return i == 0 ? 0 : -m * int(d - 1);
        default: return i + 1 < d ? 0 : -m * int(d - 1);
    }
}
/// From P_0 = kappa^2 I, whatever kappa: 1/mu_k is about beta_k^2, beta_k = kappa d_(k+1) for k < d and else 1, and an
/// error of one step, eps_k / mu_k, at most about beta_1^2.
TEST(JosephBound, OnGradedColumnsIsOneOfTheNextUnit) {
    for (Units const units : {Units::geometric, Units::one_large, Units::one_small})
        for (Index const d : {3, 4, 5}) {
            std::array<std::vector<double>, 2> inflation, loss;
            for (size_t n : {0u, 1u}) {
                int const m = n == 0 ? 10 : 20, kappa = m * int(d - 1);
                Seed seed{7};
                std::vector<V> rows;
                for (Index k = 0; k < d + 2; ++k) {
                    rows.push_back(integers(d, seed, 9));
                    for (Index i = 0; i < d; ++i) rows.back()[i] *= half_to(-unit(units, m, d, i));
                }
                Exact const run(rows, Q(1), M::Identity(d, d) / half_to(2 * kappa));
                auto const beta = [&](size_t k) {
                    return Index(k) < d ? std::ldexp(1.0, kappa + unit(units, m, d, Index(k))) : 1.0;
                };
                for (size_t k = 1; k <= rows.size(); ++k) {
                    M const local = local_bound(run, k);
                    double most = 0, entries = 0;
                    for (Index j = 0; j < d; ++j) {
                        most = std::max(most, double(Q(run.P[k](j, j) * run.information[k](j, j))));
                        for (Index i = 0; i < d; ++i)
                            entries = std::max(
                                entries,
                                std::sqrt(double(Q(local(i, j) * local(i, j) / (run.P[k](i, i) * run.P[k](j, j))))));
                    }
                    inflation[n].push_back(most / (beta(k) * beta(k)));  // 1/mu_k is this to d times this
                    loss[n].push_back(entries * most / (beta(1) * beta(1)));
                }
            }
            for (size_t k = 0; k < inflation[0].size(); ++k) {
                EXPECT_NEAR(inflation[1][k] / inflation[0][k], 1, 0.5) << int(units) << d << k;
                EXPECT_LE(loss[1][k] / loss[0][k], 1.5) << int(units) << d << k;
            }
        }
}

// --- half a power of the correlation (docs/theory.md 125, 126) -------------------------------------------------------

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

}  // namespace
}  // namespace rlslab
