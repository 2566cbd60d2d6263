// What the errors of N steps leave (docs/theory.md 114, 115): the transport exactly, the bounds of Joseph's products
// and of the symmetric form against exact steps, and the correlation of graded columns.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/studies/rationals.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rlslab {
namespace {

using namespace studies::rationals;

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

// Joseph's products and the units of the columns (docs/theory.md 119): scaling by powers of two changes no bit.

/// Scaled by powers of two, the prior along: every stored number is the other times its power of two.
template <class F>
void expect_units_change_no_bit(Index d, double lambda) {
    using T = typename F::scalar;
    Seed seed{7};
    Vector<T> size(d);
    for (Index i = 0; i < d; ++i) size[i] = T(std::ldexp(1.0, int(5 * i) - 7));
    Problem<T> const natural{.size = d, .forgetting = T(lambda), .prior = Prior<T>{.variance = T(4096)}};
    Problem<T> scaled = natural;
    scaled.prior->covariance = Matrix<T>::Zero(d, d).eval();
    for (Index i = 0; i < d; ++i) (*scaled.prior->covariance)(i, i) = T(4096) / (size[i] * size[i]);
    F a(natural), b(scaled);
    for (Index k = 0; k < 8 * d; ++k) {
        Vector<T> psi(d), times(d);
        double const common = seed.bell();
        for (Index i = 0; i < d; ++i) psi[i] = T(common + seed.bell() / 1024), times[i] = psi[i] * size[i];
        T const output = T(common + seed.bell() / 8);
        Step<T> const x = a.update(psi, output), y = b.update(times, output);
        EXPECT_TRUE(x.innovation == y.innovation && x.gamma == y.gamma && x.residual == y.residual) << F::name << k;
        Stored<T> const P = a.stored(), Q = b.stored();
        for (Index j = 0; j < d; ++j) {
            EXPECT_TRUE(a.theta()[j] == b.theta()[j] * size[j]) << F::name;
            for (Index i = 0; i < d; ++i)
                EXPECT_TRUE(P.F(i, j) == Q.F(i, j) * size[i] * size[j]) << F::name << k << i << j;
        }
    }
}
TEST(Units, OfPowersOfTwoChangeNoBitOfJosephsProducts) {
    for_each(TypeList<double, float, BFloat16>{}, []<class T>() {
        for (Index const d : {1, 2, 4, 9})
            for (double const lambda : {1.0, 0.96875}) {
                expect_units_change_no_bit<Joseph<T>>(d, lambda);
                expect_units_change_no_bit<JosephRankTwo<T>>(d, lambda);
                expect_units_change_no_bit<Symmetric<T>>(d, lambda);
            }
    });
}

}  // namespace
}  // namespace rlslab
