// A row of `qr`: its rotations from a substitution. The kernels have the bits of the formulas, what is looked at stays,
// and what is left is R'R + psi psi' as rotations one after another leave it.
#include "tests/common/each_isa.hpp"
#include "tests/linalg/known_rows.hpp"

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace rlslab {
using namespace known_rows;
namespace {

// --- the kernels -----------------------------------------------------------------------------------------------------

template <class T>
struct Operands {
    Index d, ld;
    std::vector<T, detail::Aligned<T>> L, x, z, c, s, u;
    T eta, sum, r;

    Operands(Index size, Kind kind, Seed& seed)
        : d(size), ld(column_stride<T, Dynamic>(size)), L(size_t(ld * d)), x(size_t(ld)), z(x), c(x), s(x), u(x) {
        for (auto* v : {&L, &x, &z, &c, &s, &u})
            for (T& a : *v) a = number<T>(seed, kind);
        eta = number<T>(seed, Kind::ordinary);
        r = seed.next() % 2 ? T(1) : T(0.9375);
        sum = r * r;
    }
    T& at(Index j, Index i) { return L[size_t(i * ld + j)]; }
    kernels::SolveRotations<T> kernel() {
        return {d, ld, L.data(), x.data(), z.data(), &eta, c.data(), s.data(), u.data(), &sum, r};
    }
    /// All but x, which the kernel that folds leaves undefined.
    std::vector<T> results(bool with_x) const {
        std::vector<T> out{eta, sum};
        for (auto const* v : {&z, &c, &s, &u}) out.insert(out.end(), v->begin(), v->begin() + d);
        if (with_x) out.insert(out.end(), x.begin(), x.begin() + d);
        for (Index i = 0; i < d; ++i)
            for (Index j = 0; j < d; ++j) out.push_back(L[size_t(i * ld + j)]);  // above the diagonal nothing changes
        return out;
    }
    /// The formulas, one number at a time.
    void plain(bool folds) {
        std::vector<T> left(x.begin(), x.begin() + d), g{sum};
        T block = sum, within = T(0);
        for (Index i = 0; i < d; ++i) {
            T const inverse = T(1) / at(i, i);
            u[size_t(i)] = left[size_t(i)] * inverse;
            T const square = u[size_t(i)] * u[size_t(i)];
            within = i % 8 == 0 ? square : within + square;
            g.push_back(block + within);
            if (i % 8 == 7) block += within;
            T const before = i == 0 ? r : std::sqrt(g[size_t(i)]), after = std::sqrt(g[size_t(i + 1)]);
            c[size_t(i)] = before / after * r;
            s[size_t(i)] = u[size_t(i)] * r / (before * after);
            x[size_t(i)] = left[size_t(i)];
            for (Index j = i; j < d; ++j) {
                T const t = at(j, i), kept = c[size_t(i)] * t, added = left[size_t(j)] * s[size_t(i)];
                if (folds) at(j, i) = kept + added;
                left[size_t(j)] -= t * u[size_t(i)];
            }
            T const t = z[size_t(i)], added = s[size_t(i)] * eta;
            if (folds) z[size_t(i)] = c[size_t(i)] * t + added;
            eta -= u[size_t(i)] * t;
        }
        sum = g.back();
    }
};

/// 10^5 rows of each arithmetic on each instruction set.
template <class T>
void check_kernels() {
    Seed seed{1};
    long cases = 0;
    for (Index d = 1; d <= 130; ++d)
        for (int n = 0; n < (d <= 33 ? 380 : 2); ++n)
            for (Kind kind : kinds)
                for (bool folds : {false, true}) {
                    Operands<T> const start(d, kind, seed);
                    Operands<T> formulas = start;
                    formulas.plain(folds);
                    auto const expected = formulas.results(!folds);
                    bool equal = true;
                    on_each_set<T>([&](char const*, auto evaluate) {
                        Operands<T> o = start;
                        if (folds) evaluate(kernels::FoldQr<T>{o.kernel()});
                        else evaluate(o.kernel());
                        equal = equal && same(expected, o.results(!folds));
                    });
                    ASSERT_TRUE(equal) << d << " parameters, kind " << int(kind) << ", folds " << folds;
                    ++cases;
                }
    EXPECT_GE(cases, 100000);
}
TEST(QrRows, OfTheKernelsHaveTheBitsOfTheFormulasInDouble) { check_kernels<double>(); }
TEST(QrRows, OfTheKernelsHaveTheBitsOfTheFormulasInFloat) { check_kernels<float>(); }

// --- the filter ------------------------------------------------------------------------------------------------------

/// In one pass, in two with a look between, and as a lane among others, some of which take another way: the same bits.
template <class T>
void check_ways(Kind kind) {
    using P = Pack<T, 4>;
    auto const in_two = [](Qr<T>& f, twins::Row<T> const& row) { return f.commit(f.look(row.psi, row.y)); };
    for (Index d = 1; d <= 33; ++d) {
        SCOPED_TRACE(testing::Message() << d << " parameters, kind " << int(kind));
        Seed seed{std::uint64_t(d)};
        Problem<double> problem{.size = d, .forgetting = 0.96875};
        if (d % 3 == 0) problem.prior.reset();
        Qr<T> const start(twins::in<T>(problem));
        std::vector<twins::Rows> rows;
        std::vector<twins::Trace> alone;
        for (int n = 0; n < 4; ++n) {
            rows.push_back(rows_of<T>(d, 2 * d + 5, n % 2 ? kind : Kind::mild, Seed{seed.next()}));
            for (auto& row : rows.back()) row.y = double(number<T>(seed, Kind::mild));
            alone.push_back(twins::trace(start, rows.back()));
            twins::expect_one("in two", twins::trace(start, rows.back(), false, in_two), alone.back());
        }
        twins::expect_one("lanes", twins::traces(Qr<P>(twins::in<P>(problem)), rows), alone);
    }
}
TEST(QrRows, HaveTheSameBitsEachWay) {
    on_each_isa([] {
        for (Kind kind : kinds) check_ways<double>(kind), check_ways<float>(kind);
    });
}

/// e and s are those of theta and P, and a row that is not committed leaves no trace.
TEST(QrRows, ShowEAndSBeforeAnythingChanges) {
    Index const d = 11;
    Seed seed{7};
    Qr<double> f(Problem<double>{.size = d, .forgetting = 0.96875});
    auto const row = [&] { return Vector<double>(Vector<double>::NullaryExpr(d, [&] { return seed.bell(); })); };
    for (int k = 0; k < 60; ++k) f.update(row(), seed.bell());
    Vector<double> const psi = row();
    auto const before = state_of(f);
    auto const [e, s] = f.look(psi, 0.75);
    EXPECT_EQ(before, state_of(f));
    EXPECT_NEAR(e, 0.75 - psi.dot(f.theta()), 1e-14);
    EXPECT_NEAR(s, 0.96875 + psi.dot(Vector<double>(f.information().llt().solve(psi))), 1e-13);
    Qr<double> g = f;
    f.look(row(), 1e9);
    EXPECT_EQ(before, state_of(f));
    Step<double> const step = f.update(psi, 0.75);
    EXPECT_EQ(step.innovation, e);
    EXPECT_EQ(step.gamma, 0.96875 / s);
    g.look(row(), -3.0);
    g.commit(g.look(psi, 0.75));
    EXPECT_EQ(state_of(f), state_of(g));
}

/// Without a prior, behind a pivot of zero, and where s overflows, R has the bits of rotations one after another.
TEST(QrRows, AreRotatedInOneByOneWhereTheyCannotBeSolvedFor) {
    auto const check = [](Problem<double> const& problem, int rows, double size) {
        Index const d = problem.size;
        Seed seed{3};
        Qr<double> f(problem);
        StateMatrix<double> L(d);
        StateVector<double> z(d), x(d), c(d), s(d);
        start_information_root(problem, L, z);
        double const r = square_root(problem.forgetting);
        for (int k = 0; k < rows; ++k) {
            Vector<double> psi = Vector<double>::NullaryExpr(d, [&] { return size * seed.bell(); });
            double eta = seed.bell();
            f.update(psi, eta);
            for (Index i = 0; i < d; ++i) x[i] = psi[i];
            rotate_in(L, x, r, z, eta, c, s);
        }
        for (Index i = 0; i < d; ++i)
            for (Index j = i; j < d; ++j) EXPECT_EQ(f.stored().F(j, i), L(j, i)) << j << ' ' << i;
    };
    for (Index d : {1, 4, 7, 20}) {
        Problem<double> problem{.size = d, .forgetting = 0.96875};
        problem.prior.reset();
        check(problem, int(d), 1);
    }
    // R_ii = 2^-500, so that u^2 = 2^1400 with this row
    check({.size = 6, .forgetting = 1, .prior = Prior<double>{.variance = 0x1p1000}}, 1, 0x1p200);
}

/// R'R after the row is lambda R'R + psi psi' to a few u d, and R theta = z, where rows are as ill-conditioned as the
/// rounding allows: neither is worse than with rotations one after another by more than 0.25 digits on average.
TEST(QrRows, AreAsAccurateAsRotationsOneByOne) {
    using Long = long double;
    Index const d = 16;
    for (double condition : {1e2, 1e5, 1e8, 1e11}) {
        double solved[2] = {}, rotated[2] = {}, worst = 0;
        int const trials = 20;
        for (int trial = 0; trial < trials; ++trial) {
            Seed seed{std::uint64_t(trial + 7)};
            Problem<double> const problem{.size = d, .forgetting = 1, .prior = Prior<double>{.variance = 10}};
            Qr<double> f(problem);
            Qr<Long> exact(Problem<Long>{.size = d, .forgetting = 1, .prior = Prior<Long>{.variance = 10}});
            StateMatrix<double> L(d);
            StateVector<double> z(d), x(d), c(d), s(d);
            start_information_root(problem, L, z);
            Matrix<double> const mix = Matrix<double>::NullaryExpr(d, d, [&] { return seed.bell(); });
            for (int k = 0; k < 300; ++k) {
                Vector<double> source = Vector<double>::NullaryExpr(
                    d, [&](Index i) { return seed.bell() * std::pow(condition, -double(i) / double(d - 1)); });
                Vector<double> const psi = mix * source;
                double y = 1e-3 * seed.bell();
                for (Index i = 0; i < d; ++i) y += psi[i] / double(i + 1);
                Matrix<Long> const R = f.stored().F.template cast<Long>();
                f.update(psi, y);
                Matrix<Long> const R_after = f.stored().F.template cast<Long>();
                Matrix<Long> const sum = R * R.transpose() + psi.cast<Long>() * psi.cast<Long>().transpose();
                worst = std::max(worst, double((R_after * R_after.transpose() - sum).norm() / sum.norm()));
                Vector<Long> const psi_long = psi.cast<Long>();
                exact.update(psi_long, Long(y));
                for (Index i = 0; i < d; ++i) x[i] = psi[i];
                rotate_in(L, x, 1.0, z, y, c, s);
            }
            auto const errors = [&](Matrix<double> const& R, Vector<double> const& theta, double(&to)[2]) {
                Matrix<Long> const wide = R.cast<Long>(), information = exact.information();
                to[0] += std::log10(double((wide * wide.transpose() - information).norm() / information.norm()));
                Vector<Long> const right = exact.theta();
                to[1] += std::log10(double((theta.cast<Long>() - right).norm() / right.norm()));
            };
            Matrix<double> kept = f.stored().F;
            errors(kept, f.theta(), solved);
            for (Index i = 0; i < d; ++i)
                for (Index j = 0; j < d; ++j) kept(j, i) = j < i ? 0 : L(j, i);
            solve_lower_transposed(L, z);
            errors(kept, z.view(), rotated);
        }
        for (int n : {0, 1})
            EXPECT_LE(solved[n], rotated[n] + 0.25 * trials)
                << (n ? "theta" : "R'R") << ", condition " << condition << ": " << solved[n] / trials << " and "
                << rotated[n] / trials;
        EXPECT_LE(worst, 6 * double(d) * epsilon<double>()) << condition;  // 2 d^2 products, of which each meets u
        RecordProperty("condition_" + std::to_string(int(std::log10(condition))),
                       std::to_string(solved[0] / trials) + " " + std::to_string(rotated[0] / trials) + " " +
                           std::to_string(solved[1] / trials) + " " + std::to_string(rotated[1] / trials) + " " +
                           std::to_string(worst / epsilon<double>()));
    }
}

}  // namespace
}  // namespace rlslab
