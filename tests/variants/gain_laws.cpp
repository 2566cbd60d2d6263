// The laws of an error in what plays the gain (docs/theory.md 16, 17, 29 to 34, 36): exactly in rationals where the
// form has no root, to 1e-60 in Reference where it has.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

#include <rlslab/studies/rationals.hpp>
#include "tests/common/laws.hpp"
#include "tests/common/message.hpp"
#include "tests/variants/gain_laws.hpp"

#include <gtest/gtest.h>

namespace rlslab {
using namespace studies;
namespace {

using namespace gain_laws;
using Subtracting = TypeList<Conventional<Rational>, ConventionalTwoSided<Rational>, Kalman<Rational>>;
using Josephs = TypeList<Joseph<Rational>, JosephRankTwo<Rational>>;
using UdSweeps = TypeList<Ud<Rational>, UdDelta<Rational>>;
using RootSweeps = TypeList<Carlson<Reference>, CarlsonDelta<Reference>, InverseQr<Reference>,
                            InverseQrDelta<Reference>, ExtendedQr<Reference>>;

Reference const tolerance("1e-60");  // of numbers up to some 1e4 in 77 digits
constexpr int cases = 60;

/// How far each law is from what F does, the worst of all cases; `law` has the error in P that it says.
template <class F, class Law>
auto worst(Law law, double along_K = 0) {
    using T = typename F::scalar;
    T out = T(0);
    for (int n = 0; n < cases; ++n) {
        Case<T> const c(Seed{std::uint64_t(n)}, along_K);
        out = std::max<T>(out, largest<T>(after<F>(c, AddToGain<T>{scaled_for<F>(c)}) - c.P_next - law(c)));
    }
    return out;
}

TEST(GainLaws, WhereKPsiPIsSubtractedDeltaPIsMinusDeltaKTimesTheRow) {
    for_each(Subtracting{}, []<class F>() { EXPECT_EQ(worst<F>(first_order<Rational>), 0) << F::name; });
    EXPECT_EQ(worst<Symmetric<Rational>>(mirrored<Rational>), 0);
}
TEST(GainLaws, InJosephsFormsDeltaPIsTheSquare) {
    for_each(Josephs{}, []<class F>() { EXPECT_EQ(worst<F>(second_order<Rational>), 0) << F::name; });
}
TEST(GainLaws, InPottersFormDeltaPLiesBetweenThem) {
    EXPECT_LE(worst<Potter<Reference>>(potter<Reference>), tolerance);
}

TEST(GainLaws, EachIsViolatedByTheOthersForms) {
    for_each(Subtracting{}, []<class F>() { EXPECT_GT(worst<F>(second_order<Rational>), 0) << F::name; });
    for_each(Josephs{}, []<class F>() { EXPECT_GT(worst<F>(first_order<Rational>), 0) << F::name; });
    EXPECT_GT(worst<Symmetric<Rational>>(first_order<Rational>), 0);
    EXPECT_GT(worst<Conventional<Rational>>(mirrored<Rational>), 0);
    EXPECT_GT(worst<Potter<Reference>>(nothing<Reference>),
              Reference(1e-3));  // "a factor is propagated, so nothing arrives"
    EXPECT_GT(worst<Potter<Reference>>(symmetrised<Reference>), Reference(1e-3));
    EXPECT_GT(worst<Potter<Reference>>(second_order<Reference>), Reference(1e-3));
}

/// The same of an error that enters after column j of a sweep, for every j.
template <class F, class Law>
auto worst_of_sweep(Law law) {
    using T = typename F::scalar;
    T out = T(0);
    for (int n = 0; n < cases; ++n) {
        Case<T> const c(Seed{std::uint64_t(n)});
        for (Index j = 1; j <= c.size; ++j) {
            Vector<T> delta_v = c.s * c.delta;
            for (Index i = j; i < c.size; ++i) delta_v[i] = T(0);  // rows that column j does not have
            Matrix<T> const P = after<F>(c, AddAfterColumn<T>{delta_v * running_scale<F>(c, j), j});
            out = std::max<T>(out, largest<T>(P - c.P_next - law(c, delta_v, j)));
        }
    }
    return out;
}

TEST(GainLaws, TheFourSweepsShareOne) {
    for_each(UdSweeps{}, []<class F>() { EXPECT_EQ(worst_of_sweep<F>(sweep<Rational>), 0) << F::name; });
    for_each(RootSweeps{}, []<class F>() { EXPECT_LE(worst_of_sweep<F>(sweep<Reference>), tolerance) << F::name; });
}
TEST(GainLaws, OfTheSweepsCanFail) {
    auto const at_the_start = [](auto const& c, auto const& delta_v, Index) { return sweep(c, delta_v, 0); };
    auto const linear = [](auto const& c, auto const& delta_v, Index j) { return sweep_to_first_order(c, delta_v, j); };
    auto const none = [](auto const& c, auto const&, Index) { return nothing(c); };
    EXPECT_GT(worst_of_sweep<Ud<Rational>>(at_the_start), 0);
    EXPECT_GT(worst_of_sweep<Ud<Rational>>(linear), 0);
    EXPECT_GT(worst_of_sweep<Ud<Rational>>(none), 0);
    for_each(RootSweeps{}, [&]<class F>() { EXPECT_GT(worst_of_sweep<F>(none), Reference(1e-3)) << F::name; });
}
TEST(GainLaws, AnErrorAfterTheLastColumnReachesThetaAlone) {
    auto const examine = []<class F>() {
        using T = typename F::scalar;
        Case<T> const c(Seed{3});
        F right(c.problem()), wrong(c.problem());
        right.update(c.psi, T(1));
        wrong.update(c.psi, T(1), AddAfterColumn<T>{c.delta, c.size});
        EXPECT_EQ(largest<T>(right.stored().F - wrong.stored().F), 0) << F::name;
        EXPECT_GT(largest<T>(right.theta() - wrong.theta()), 0) << F::name;
    };
    for_each(UdSweeps{}, examine);
    for_each(RootSweeps{}, examine);
}

/// K_i (1 + eps r_i) wherever the running gain is used: its odd part in eps is the first-order term, exactly.
TEST(GainLaws, ARelativeErrorOfTheRunningGain) {
    Rational of_the_other_sign = 0;
    for (int n = 0; n < cases; ++n) {
        Case<Rational> const c(Seed{std::uint64_t(n)});
        auto const P = [&](Rational const& eps) {
            return after<Ud<Rational>>(c, ScaleWhereverUsed<Rational>{eps * c.delta, {}});
        };
        Matrix<Rational> const odd = (P(Rational(1) / 8) - P(Rational(-1) / 8)) * Rational(4);  // over 2 eps
        EXPECT_EQ(largest<Rational>(odd - relative_in_sweep(c)), 0) << n;
        of_the_other_sign += largest<Rational>(odd + relative_in_sweep(c));  // 0 where psi has one number alone
    }
    EXPECT_GT(of_the_other_sign, 1);
}

TEST(GainLaws, OneStepsSizeIsATrace) {
    for (int n = 0; n < cases; ++n) {
        Case<Rational> const c(Seed{std::uint64_t(n)});
        EXPECT_EQ(c.s * inner<Rational>(c.K, c.K) / c.lambda,
                  trace<Rational>(c.P) / c.lambda - trace<Rational>(c.P_next))
            << n;
    }
}

// --- definiteness ----------------------------------------------------------------------------------------------------

/// (s/lambda) [psi'delta + sqrt(delta'P+^-1 delta (s - lambda)/s)] < 2, without the root.
bool keeps_definite(Case<Rational> const& c, Vector<Rational> const& delta) {
    Rational const room = 2 * c.lambda / c.s - inner<Rational>(c.psi, delta);
    Rational const square =
        inner<Rational>(delta, rationals::inverse(c.P_next).lazyProduct(delta)) * (c.s - c.lambda) / c.s;
    return room > 0 && square < room * room;
}
template <class F>
bool definite_after(Case<Rational> const& c, Vector<Rational> const& delta) {
    Matrix<Rational> const P = after<F>(c, AddToGain<Rational>{delta});
    return rationals::is_positive_definite(P + P.transpose());
}

TEST(GainLaws, WhereKPsiPIsSubtractedDefinitenessHasAThresholdInEveryDirection) {
    int definite = 0, indefinite = 0, by_the_half = 0;
    for (int n = 0; n < cases; ++n) {
        Case<Rational> c(Seed{std::uint64_t(n)});
        Rational below = 0, above = 1;  // times delta
        while (keeps_definite(c, above * c.delta)) above *= 2;
        for (int bits = 0; bits < 14; ++bits) {
            Rational const middle = (below + above) / 2;
            (keeps_definite(c, middle * c.delta) ? below : above) = middle;
        }
        for (Rational const& times :
             {Rational(below * 999 / 1000), below, above, Rational(above * 1001 / 1000), Rational(1)}) {
            Vector<Rational> const delta = times * c.delta;
            for_each(Subtracting{}, [&]<class F>() {
                EXPECT_EQ(definite_after<F>(c, delta), keeps_definite(c, delta)) << F::name << " " << n;
            });
            for_each(Josephs{}, [&]<class F>() { EXPECT_TRUE(definite_after<F>(c, delta)) << F::name << " " << n; });
            (keeps_definite(c, delta) ? definite : indefinite) += 1;
            bool const without_the_root = inner<Rational>(c.psi, delta) < 2 * c.lambda / c.s;  // a saboteur of the law
            by_the_half += without_the_root != definite_after<Conventional<Rational>>(c, delta);
        }
    }
    EXPECT_GE(definite, cases);
    EXPECT_GE(indefinite, cases);
    EXPECT_GE(by_the_half, cases);
}

/// det S+ = lambda^(-d/2) det S (rho - psi'delta_v / (s + sqrt(lambda s))): along v singular at eps = rho/(1 - rho) and
/// not beyond.
TEST(GainLaws, PottersRootIsSingularOnOneHyperplaneOnly) {
    for (int n = 0; n < cases; ++n) {
        Case<Reference> const c(Seed{std::uint64_t(n)}, 1);
        Reference const rho = square_root<Reference>(c.lambda / c.s), critical = rho / (1 - rho);
        Reference const whole =
            determinant<Reference>(after<Potter<Reference>>(c, AddToGain<Reference>{c.f * Reference(0)}));
        for (double const times : {-3.0, 0.5, 1.0, 1.5, 10.0}) {
            Reference const eps = times * critical,
                            P = determinant<Reference>(after<Potter<Reference>>(c, AddToGain<Reference>{eps * c.f}));
            Reference const law = (rho - eps * (c.s - c.lambda) / (c.s + square_root<Reference>(c.lambda * c.s))) / rho;
            EXPECT_LE(absolute<Reference>(P / whole - law * law), tolerance) << n << " " << times;
            if (times == 1.0) {
                EXPECT_LE(absolute<Reference>(P / whole), tolerance) << n;
            } else {
                EXPECT_GT(P / whole, Reference(1e-3)) << n << " " << times;
            }
        }
    }
}

/// The diagonals of the sweeps contain no v: the same bits with and without an error, in every arithmetic, however
/// large.
template <class F>
void expect_the_same_diagonal(Index d) {
    using T = typename F::scalar;
    Problem<T> const problem{.size = d, .forgetting = T(0.96875), .prior = Prior<T>{.variance = T(1)}};
    F right(problem);
    Seed seed{std::uint64_t(d)};
    for (int k = 0; k < 12; ++k) {
        Vector<T> psi(d);
        for (T& x : psi) x = T(std::ldexp(std::floor(seed.bell() * 64), -6));
        F wrong = right;
        wrong.update(psi, T(1), [&](std::span<T> v, T const&) {
            for (T& x : v) x += x * T(1024 * seed.bell());
        });
        right.update(psi, T(1));
        Stored<T> const a = right.stored(), b = wrong.stored();
        for (Index i = 0; i < d; ++i) EXPECT_EQ(a.F(i, i), b.F(i, i)) << F::name << " " << d;
        for (Index i = 0; i < a.D.size(); ++i) EXPECT_EQ(a.D[i], b.D[i]) << F::name << " " << d;
        EXPECT_EQ(a.F == b.F, d == 1) << F::name << " " << d;
    }
}
TEST(GainLaws, NoErrorReachesADiagonalOfTheSweeps) {
    for_each(TypeList<float, double, BFloat16>{}, []<class T>() {
        for (Index const d : {1, 2, 5, 11})
            for_each(TypeList<Carlson<T>, CarlsonDelta<T>, Ud<T>, UdDelta<T>, InverseQr<T>, InverseQrDelta<T>,
                              ExtendedQr<T>>{},
                     [d]<class F>() { expect_the_same_diagonal<F>(d); });
    });
}

/// A perturbation that changes nothing changes no bit, though the sweeps then run column by column.
template <class F>
void expect_the_same_bits(Index d) {
    using T = typename F::scalar;
    Problem<T> const problem{.size = d, .forgetting = T(0.96875), .prior = Prior<T>{.variance = T(1)}};
    F a(problem), b(problem);
    Seed seed{std::uint64_t(d)};
    int calls = 0;
    auto const inert = [&calls](auto&&...) { ++calls; };
    for (int k = 0; k < 40; ++k) {
        Vector<T> psi(d);
        for (T& x : psi) x = T(std::ldexp(std::floor(seed.bell() * 64), -6));
        a.update(psi, T(1));
        b.update(psi, T(1), inert);
    }
    EXPECT_TRUE(a.theta() == b.theta() && a.stored().F == b.stored().F && a.stored().D == b.stored().D)
        << F::name << " " << d;
    EXPECT_GE(calls, 40) << F::name;
}
TEST(GainLaws, AnInertPerturbationLeavesTheKernelsBits) {
    for_each(TypeList<float, double, BFloat16>{}, []<class T>() {
        for (Index const d : {1, 3, 4, 8, 19})
            for_each(TypeList<Conventional<T>, Kalman<T>, Joseph<T>, Potter<T>, Carlson<T>, CarlsonDelta<T>, Ud<T>,
                              UdDelta<T>, InverseQr<T>, InverseQrDelta<T>, ExtendedQr<T>>{},
                     [d]<class F>() { expect_the_same_bits<F>(d); });
    });
}

// --- errors of f and s: the formulas of the pages, because the pages offer K alone -----------------------------------

/// (4) and (5) of joseph_rank_two with any f and s, and K made from them.
Matrix<Rational> rank_two(Case<Rational> const& c, Vector<Rational> const& f, Rational const& s) {
    Vector<Rational> const K = f / s, g = f - s / 2 * K;
    return (c.P - outer<Rational>(K, g) - outer<Rational>(g, K)) / c.lambda;
}

TEST(GainLaws, JosephRankTwoIsFirstOrderInErrorsOfFAndS) {
    for (int n = 0; n < cases; ++n) {
        Case<Rational> const c(Seed{std::uint64_t(n)});
        EXPECT_EQ(largest<Rational>(rank_two(c, c.f, c.s) - after<JosephRankTwo<Rational>>(c, NoPerturbation{})),
                  0);  // the same formula
        Rational const eta = Rational(int(n % 7) - 3) / 8;
        Matrix<Rational> const KK = outer<Rational>(c.K, c.K);
        EXPECT_EQ(
            largest<Rational>(rank_two(c, c.f, c.s * (1 + eta)) - c.P_next - c.s / c.lambda * eta / (1 + eta) * KK), 0)
            << n;
        EXPECT_EQ(rationals::is_positive_definite(rank_two(c, c.f, c.s * (1 + eta))), c.s * (1 + eta) > c.s - c.lambda)
            << n;
        Case<Rational> const joseph =
            c.with_error(Vector<Rational>(-eta / (1 + eta) * c.K));  // which uses s in K alone
        EXPECT_EQ(largest<Rational>(after<Joseph<Rational>>(c, AddToGain<Rational>{joseph.delta}) - c.P_next -
                                    c.s / c.lambda * eta * eta / ((1 + eta) * (1 + eta)) * KK),
                  0)
            << n;
        // delta f: first order, less the square that is left.
        Vector<Rational> const f = c.f + c.delta;
        Rational const s = c.s + inner<Rational>(c.psi, c.delta);
        if (s == 0) continue;
        EXPECT_EQ(largest<Rational>(rank_two(c, f, s) - (c.P - outer<Rational>(f, f) / s) / c.lambda), 0) << n;
        auto const from_first_order = [&](Rational const& t) {  // over t
            Vector<Rational> const df = t * c.delta;
            Rational const ds = inner<Rational>(c.psi, df);
            Matrix<Rational> const law = -(outer<Rational>(df, c.K) + outer<Rational>(c.K, df) - ds * KK) / c.lambda;
            return Rational(largest<Rational>(rank_two(c, c.f + df, c.s + ds) - c.P_next - law) / t);
        };
        EXPECT_LT(from_first_order(Rational(1) / (1 << 30)) * (1 << 28),
                  from_first_order(Rational(1) / (1 << 20)) * (1 << 19))
            << n;
    }
}

// --- an error reaches a filter of the catalogue or is refused; it is never ignored silently --------------------------

/// theta and P after one row whose gain was `relative` off. Empty and the message where that is refused.
struct Answer {
    std::vector<double> numbers;
    std::string refusal;
};
Answer after(CatalogueEntry const& entry, double relative) {
    auto const f = entry.make(laws::problem(2), Seed{1});
    std::vector<double> const row{1.0, 2.0};
    Answer out;
    f->update(row, 1.0);
    try {
        f->update(std::vector<double>{2.0, -1.0}, 3.0, Vector<double>{{relative, -relative}});
    } catch (std::invalid_argument const& refused) {
        out.refusal = refused.what();
        return out;
    }
    for (Reference const& x : Vector<Reference>(f->theta())) out.numbers.push_back(double(x));
    Stored<double> const stored = f->stored_in_double();
    out.numbers.insert(out.numbers.end(), stored.F.reshaped().begin(), stored.F.reshaped().end());
    out.numbers.insert(out.numbers.end(), stored.D.begin(), stored.D.end());
    return out;
}

TEST(GainError, ReachesTheFilterOrIsRefused) {
    int taken = 0, refused = 0;
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double") continue;
        Answer const exact = after(entry, 0), off = after(entry, 0.25);
        if (entry.gain_perturbable) {
            ++taken;
            EXPECT_EQ(off.refusal, "") << entry.variant;
            EXPECT_NE(off.numbers, exact.numbers) << entry.variant << " dropped the error";
        } else {
            ++refused;
            EXPECT_THAT(off.refusal, Names(std::string(entry.variant))) << entry.variant;
            EXPECT_EQ(off.refusal, exact.refusal) << "an error of zero is refused like any other";
        }
    }
    EXPECT_EQ(taken, 14);   // all that form a gain, or the vector that plays it
    EXPECT_GE(refused, 4);  // information, and what rotates or reflects rows into R
}

TEST(GainError, OfTheLastColumnReachesPOnlyWhereTheGainIsComputedAtOnce) {
    Matrix<double> relative = Matrix<double>::Zero(2, 2);
    relative.col(1) << 0.25, -0.25;
    int nothing = 0;
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double" || !entry.gain_perturbable) continue;
        auto const right = entry.make(laws::problem(2), Seed{1}), wrong = entry.make(laws::problem(2), Seed{1});
        std::vector<double> const row{2.0, -1.0};
        right->update(row, 3.0);
        wrong->update(row, 3.0, relative);
        EXPECT_FALSE(laws::identical(right->theta(), wrong->theta())) << entry.variant;
        nothing += laws::identical(right->stored(), wrong->stored());
    }
    EXPECT_EQ(nothing, 7);  // carlson, ud, inverse_qr, their delta forms, extended_qr
}

TEST(GainError, OfAnotherShapeIsRefused) {
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double" || !entry.gain_perturbable) continue;
        auto const f = entry.make(laws::problem(3), Seed{1});
        for (auto const& [rows, columns] : {std::pair<Index, Index>{2, 1}, {4, 1}, {3, 2}, {3, 0}, {0, 0}, {1, 3}})
            EXPECT_THROW(
                f->update(std::vector<double>{1.0, 2.0, 3.0}, 1.0, Matrix<double>(Matrix<double>::Zero(rows, columns))),
                std::invalid_argument)
                << entry.variant << " " << rows << " x " << columns;
    }
}

}  // namespace
}  // namespace rlslab
