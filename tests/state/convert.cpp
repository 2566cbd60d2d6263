// A filter converted into another variant or arithmetic, and two filters merged into one.
#include "tests/common/laws.hpp"

#include <rlslab/state/convert.hpp>
#include <rlslab/state/merge.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/variants/variants.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace rlslab {
namespace {

/// P, or its inverse, of what a filter stores, in 257 bits.
template <class F>
Matrix<Reference> exact_covariance(F const& f, bool inverse = false) {
    using T = typename F::scalar;
    Triangle<Reference> factor(f.stored().template mapped<Reference>([](T const& x) { return widen(x); }));
    factor.turn_into(!inverse, false);
    return outer(factor.F);
}
double relative(Matrix<Reference> const& a, Matrix<Reference> const& b) {
    Reference off = 0, all = 0;
    for (Index j = 0; j < a.cols(); ++j)
        for (Index i = 0; i < a.rows(); ++i) {
            off += (a(i, j) - b(i, j)) * (a(i, j) - b(i, j));
            all += b(i, j) * b(i, j);
        }
    return static_cast<double>(sqrt(Reference(off / all)));
}
template <class F>
Vector<Reference> exact_theta(F const& f) {
    using T = typename F::scalar;
    return Vector<T>(f.theta()).unaryExpr([](T const& x) { return widen(x); });
}

/// Rows whose last regressor is the first, but for 1/kappa of noise: cond(R) is about kappa.
Records nearly_collinear(Index rows, double kappa, Seed seed) {
    Records out = laws::noise_records(4, rows, seed);
    for (Index k = 0; k < rows; ++k) out.psi(3, k) = out.psi(0, k) + out.psi(3, k) / kappa;
    return out;
}
template <class F>
F fed(Records const& records, Index first, Index last, Problem<typename F::scalar> const& problem) {
    using T = typename F::scalar;
    F f(problem);
    for (Index k = first; k < last; ++k) {
        Vector<T> psi(records.parameters());
        for (Index i = 0; i < psi.size(); ++i) psi[i] = T(records.psi(i, k));
        f.update(psi, T(records.y[k]));
    }
    return f;
}
template <class T>
Problem<T> some_problem(double lambda = 0.96875, double variance = 64) {
    return {.size = 4, .forgetting = T(lambda), .prior = Prior<T>{.variance = T(variance)}};
}

/// A conversion sees of a variant what it stores: P, its inverse, or a factor of either, with D or without. Tried are
/// all pairs of one variant of each kind, and each other variant from two of these and to them.
constexpr bool stands_for_its_kind(std::string_view name) {
    for (std::string_view const one : {"symmetric", "carlson", "ud", "information", "qr", "gentleman"})
        if (name == one) return true;
    return false;
}
constexpr bool meets_all(std::string_view name) { return name == "ud" || name == "gentleman"; }
constexpr void pairs(auto visit) {
    for_each(Variants<double>{}, [&]<class From>() {
        for_each(Variants<double>{}, [&]<class To>() {
            if constexpr (meets_all(From::name) || meets_all(To::name) ||
                          (stands_for_its_kind(From::name) && stands_for_its_kind(To::name)))
                visit.template operator()<From, To>();
        });
    });
}
/// of is in epsilons.
void expect_at_most(double error, double of, std::string_view from, std::string_view to) {
    EXPECT_LE(error, of * epsilon<double>()) << from << " to " << to;
}

// --- laws ------------------------------------------------------------------------------------------------------------

/// d epsilons for each unit of cond(R), which is below 10 here: 40.
TEST(Conversion, KeepsThetaAndP) {
    Records const records = laws::noise_records(4, 50, Seed{91});
    pairs([&]<class From, class To>() {
        From const from = fed<From>(records, 0, 50, some_problem<double>());
        Converted<To> const to = convert<To>(from, 0.96875);
        if (!to) throw std::logic_error("no conversion to " + std::string(To::name));
        expect_at_most(relative(exact_covariance(*to), exact_covariance(from)), 40, From::name, To::name);
        bool const is_stored = !StartsWithoutPrior<From> && !StartsWithoutPrior<To>;
        expect_at_most(relative(exact_theta(*to), exact_theta(from)), is_stored ? 0 : 40, From::name, To::name);
    });
}
/// And it goes on as the other variant would have: the next rows' certified solution.
TEST(Conversion, GoesOnAsTheVariantItIs) {
    Records const records = laws::noise_records(4, 120, Seed{92});
    Problem<double> const problem = some_problem<double>();
    CertifiedSolution const exact = std::move(certified(problem, records, {120}, 40).front());
    pairs([&]<class From, class To>() {
        Converted<To> to = convert<To>(fed<From>(records, 0, 60, problem), 0.96875);
        bool sound = bool(to);
        for (Index k = 60; k < 120; ++k)
            sound = sound && to->update(records.sample(k), records.y[k]).health == Health::sound;
        double const error = sound ? std::pow(10, -exact.theta_digits(exact_theta(*to))) : 1;
        expect_at_most(error, 640, From::name, To::name);
    });
}
/// There and back to the bits: where both hold the same factor nothing is computed.
TEST(Conversion, BetweenTheSameFactorsCopies) {
    Records const records = laws::noise_records(4, 50, Seed{93});
    auto const same = [&]<class From, class To>() {
        From const from = fed<From>(records, 0, 50, some_problem<double>());
        EXPECT_EQ(convert<To>(from)->stored().F, from.stored().F) << From::name << " to " << To::name;
        EXPECT_EQ(convert<To>(from)->stored().D, from.stored().D) << From::name << " to " << To::name;
    };
    same.operator()<Ud<double>, Ud<double>>();
    same.operator()<Carlson<double>, InverseQr<double>>();
    same.operator()<InverseQr<double>, Potter<double>>();
    same.operator()<Gentleman<double>, Gentleman<double>>();
    same.operator()<Symmetric<double>, Conventional<double>>();
    Ud<float> const short_one = fed<Ud<float>>(records, 0, 50, some_problem<float>());
    EXPECT_EQ(convert<Ud<float>>(*convert<Ud<double>>(short_one))->stored().F, short_one.stored().F)
        << "a longer word and back";
}
TEST(Conversion, ToAnotherArithmeticRoundsOnce) {
    Records const records = laws::noise_records(4, 50, Seed{94});
    Qr<double> const from = fed<Qr<double>>(records, 0, 50, some_problem<double>());
    for_each(TypeList<Ud<float>, InverseQr<float>, Symmetric<float>, Ud<BFloat16>, Ud<Quad>, Carlson<Reference>>{},
             [&]<class To>() {
                 using T = typename To::scalar;
                 Converted<To> const to = convert<To>(from, T(0.96875));
                 ASSERT_TRUE(to) << To::name;
                 EXPECT_LE(relative(exact_covariance(*to), exact_covariance(from)),
                           16 * std::max(epsilon<T>(), epsilon<double>()))
                     << To::name;
                 EXPECT_LE(relative(exact_theta(*to), exact_theta(from)), std::max(epsilon<T>(), 8 * epsilon<double>()))
                     << To::name;
             });
    EXPECT_TRUE((convert<Ud<double>>(fed<Carlson<Quad>>(records, 0, 50, some_problem<Quad>()))));
    EXPECT_EQ((number_as<Quad>(Reference(1) / 3)), Quad(1) / Quad(3));
    EXPECT_EQ((number_as<Reference>(Quad(1) / Quad(3))), widen(Quad(Quad(1) / Quad(3))));
    EXPECT_EQ((convert<Ud<float, 4>>(from)->theta()), (convert<Ud<float>>(from)->theta()));
}
TEST(Conversion, SaysWhyThereIsNone) {
    Qr<double> const empty({.size = 3, .prior = std::nullopt});
    EXPECT_EQ(convert<Ud<double>>(empty).health, Health::undetermined);
    EXPECT_EQ(convert<Gentleman<double>>(Information<double>({.size = 3, .prior = std::nullopt})).health,
              Health::undetermined);
    Ud<double> spoilt({.size = 2});
    spoilt.update({1, std::numeric_limits<double>::quiet_NaN()}, 1);
    EXPECT_EQ(convert<Qr<double>>(spoilt).health, Health::nonfinite);
    Ud<double> const large({.size = 2, .prior = Prior<double>{.variance = 0x1p200}}),
        small({.size = 2, .prior = Prior<double>{.variance = 0x1p-200}});
    EXPECT_EQ(convert<Ud<float>>(large).health, Health::nonfinite) << "beyond the range of float";
    EXPECT_EQ(convert<Ud<float>>(small).health, Health::nonfinite);
    EXPECT_TRUE(convert<Carlson<float>>(Ud<double>({.size = 2, .prior = Prior<double>{.variance = 0x1p100}})));
    // A P that rounding made indefinite: collinear rows and a large prior (Verhaegen's example in short).
    Conventional<float> plain({.size = 2, .prior = Prior<float>{.variance = 0x1p30f}});
    for (int k = 0; k < 20; ++k) plain.update({1, 1.f + 0x1p-20f * float(k % 3)}, 1);
    EXPECT_EQ(convert<Ud<double>>(plain).health, Health::indefinite);
    EXPECT_THROW((void)convert<Ud<double>>(Ud<double>({.size = 2}), 1.5), std::invalid_argument);
    EXPECT_THROW((void)(convert<Ud<double, 3>>(Ud<double>({.size = 2}))), std::invalid_argument);
}

// --- what is lost ----------------------------------------------------------------------------------------------------

/// A filter whose P is, but for rounding, the inverse of rows with cond(R) about kappa.
template <class F>
F graded(double kappa, Seed seed) {
    Problem<Reference> const problem{.size = 4, .prior = Prior<Reference>{.variance = Reference(0x1p60)}};
    return *convert<F>(fed<Qr<Reference>>(nearly_collinear(40, kappa, seed), 0, 40, problem));
}
/// "P / its inverse": digits that a conversion of doubles loses, the median of 21 records: log10 of the relative error
/// in epsilons.
template <class From, class To>
std::string lost(double kappa) {
    std::vector<double> of_P, of_inverse;
    for (std::uint64_t seed = 1; seed <= 21; ++seed) {
        From const from = graded<From>(kappa, Seed{seed});
        Converted<To> const to = convert<To>(from);
        for (bool const inverse : {false, true}) {
            double const error =
                to ? relative(exact_covariance(*to, inverse), exact_covariance(from, inverse)) / epsilon<double>()
                   : 1e99;
            (inverse ? of_inverse : of_P).push_back(std::max(0.0, std::log10(error)));
        }
    }
    for (auto* digits : {&of_P, &of_inverse}) std::sort(digits->begin(), digits->end());
    return of_P[10] > 90 ? "none" : fmt::format("{:.1f} / {:.1f}", of_P[10], of_inverse[10]);
}
template <class From, class To>
std::string row() {
    return fmt::format("| `{}` to `{}` | {} | {} | {} |\n", From::name, To::name, lost<From, To>(1e2),
                       lost<From, To>(1e4), lost<From, To>(1e6));
}
/// The table of docs/state.md is what is measured here; on a difference the message has the new rows.
TEST(Conversion, LosesWhatTheTableSays) {
    using D = double;
    std::string const rows = row<Carlson<D>, Qr<D>>() + row<Qr<D>, Carlson<D>>() + row<Ud<D>, Gentleman<D>>() +
                             row<Gentleman<D>, Ud<D>>() + row<Ud<D>, Carlson<D>>() + row<Qr<D>, Ud<D>>() +
                             row<Ud<D>, Symmetric<D>>() + row<Qr<D>, Symmetric<D>>() + row<Symmetric<D>, Ud<D>>() +
                             row<Qr<D>, Information<D>>() + row<Information<D>, Qr<D>>() + row<Information<D>, Ud<D>>();
    std::ifstream file(std::string(RLSLAB_SOURCE_DIR) + "/docs/state.md");
    std::string const page{std::istreambuf_iterator<char>(file), {}};
    EXPECT_THAT(page, testing::HasSubstr(rows));
}

// --- merging ---------------------------------------------------------------------------------------------------------

template <class F>
Part<F> part(Records const& records, Index first, Index last, Problem<typename F::scalar> const& problem) {
    return {fed<F>(records, first, last, problem), last - first};
}
/// In rationals: the merged filter is the filter that took all rows, with ==.
TEST(MergingWithPrior, IsExactInRationals) {
    using Q = Rational;
    Records records = laws::noise_records(3, 12, Seed{95});
    records.psi = (records.psi * 64).array().round().matrix().eval();
    records.y = (records.y * 64).array().round().matrix().eval();
    using Forms = TypeList<Ud<Q>, Conventional<Q>, Joseph<Q>, Information<Q>, Gentleman<Q>>;
    auto const check = [&]<class F>(Q const& lambda) {
        Problem<Q> problem{.size = 3, .forgetting = lambda, .prior = Prior<Q>{.variance = 5}};
        problem.prior->theta = Vector<Q>{{Q(1), Q(-2), Q(1) / 3}};
        F const both = fed<F>(records, 0, 12, problem);
        auto const sum = merged(part<F>(records, 0, 7, problem), part<F>(records, 7, 12, problem), problem);
        ASSERT_TRUE(sum);
        EXPECT_EQ(sum->rows, 12);
        EXPECT_EQ(Vector<Q>(sum->filter.theta()), Vector<Q>(both.theta())) << F::name;
        EXPECT_EQ(outer(Triangle<Q>(sum->filter.stored()).turn_into(false, true).F),
                  outer(Triangle<Q>(both.stored()).turn_into(false, true).F));
        EXPECT_EQ(Triangle<Q>(sum->filter.stored()).turn_into(false, true).D.view(),
                  Triangle<Q>(both.stored()).turn_into(false, true).D.view());
    };
    for (Q const& lambda : {Q(1), Q(7) / 8})
        for_each(Forms{}, [&]<class F>() { check.template operator()<F>(lambda); });
}

/// A rule that lets the prior count twice.
template <class F>
Part<F> prior_twice(Part<F> const& a, Part<F> const& b, Problem<double> problem) {
    detail::InformationRows<double> sum(a.filter.stored(), a.filter.theta()),
        added(b.filter.stored(), b.filter.theta());
    double const mu = detail::power(problem.forgetting, b.rows);
    for (Index i = 0; i < problem.size; ++i) sum.D[i] *= mu;
    sum.add(added, 1);
    problem.prior->theta = solved_lower_transposed(sum.L, sum.z);
    problem.prior->stored =
        Stored<double>{Stored<double>::Quantity::information, Stored<double>::Form::factor, sum.L.view(), sum.D.view()};
    return {F(problem), a.rows + b.rows};
}
/// Digits that theta and P lack to the certified solution for all rows, in epsilons: the larger.
template <class F>
double merging_error(F const& f, CertifiedSolution const& exact) {
    auto const epsilons = [](double digits) { return std::pow(10.0, -digits) / epsilon<double>(); };
    Stored<Reference> const stored = f.stored().template mapped<Reference>([](double x) { return widen(x); });
    return std::max(epsilons(exact.theta_digits(exact_theta(f))), epsilons(exact.covariance_digits(stored)));
}
/// The battery's budget of a solution (60, or 300 where c^2 enters squared), once for each part and once for the sum;
/// of the two forms whose
/// antisymmetric part grows as lambda^-k one triangle is taken, and with it all that the part has done to it.
template <class F>
double budget() {
    bool const grows = F::name == "conventional" || F::name == "kalman";
    return grows ? 20000 : 900;
}
TEST(MergingWithPrior, EqualsTheFilterFedBothAndIsAssociative) {
    Records const records = laws::noise_records(4, 60, Seed{96});
    for (double const lambda : {1.0, 0.96875}) {
        Problem<double> const problem = some_problem<double>(lambda);
        CertifiedSolution const exact = std::move(certified(problem, records, {60}, 40).front());
        for_each(Variants<double>{}, [&]<class F>() {
            auto const a = part<F>(records, 0, 2, problem), b = part<F>(records, 2, 40, problem),
                       c = part<F>(records, 40, 60, problem);
            auto const left = merged(*merged(a, b, problem), c, problem),
                       right = merged(a, *merged(b, c, problem), problem);
            ASSERT_TRUE(left && right) << F::name;
            EXPECT_LE(merging_error(left->filter, exact), budget<F>()) << F::name << ", lambda = " << lambda;
            EXPECT_LE(merging_error(right->filter, exact), budget<F>()) << F::name << ", lambda = " << lambda;
            EXPECT_GT(merging_error(prior_twice(a, c, problem).filter,
                                    std::move(certified(problem, records, {60}, 40).front())),
                      1e6);
        });
    }
}
TEST(MergingWithPrior, AnEmptyPartChangesNoBit) {
    Records const records = laws::noise_records(4, 60, Seed{97});
    Problem<double> const problem = some_problem<double>();
    for_each(Variants<double>{}, [&]<class F>() {
        auto const some = part<F>(records, 0, 30, problem), none = part<F>(records, 0, 0, problem);
        for (auto const& sum : {*merged(some, none, problem), *merged(none, some, problem)}) {
            EXPECT_EQ(sum.filter.stored().F, some.filter.stored().F) << F::name;
            EXPECT_EQ(Vector<double>(sum.filter.theta()), Vector<double>(some.filter.theta())) << F::name;
            EXPECT_EQ(sum.rows, 30);
        }
    });
}
TEST(MergingWithPrior, WithoutOneNothingIsTakenOut) {
    Records const records = laws::noise_records(4, 60, Seed{98});
    Problem<double> problem = some_problem<double>(0.96875);
    problem.prior.reset();
    CertifiedSolution const exact = std::move(certified(problem, records, {60}, 40).front());
    for_each(TypeList<Qr<double>, Gentleman<double>, Information<double>, QrBlock<double>>{}, [&]<class F>() {
        auto const sum = merged(part<F>(records, 0, 30, problem), part<F>(records, 30, 60, problem), problem);
        ASSERT_TRUE(sum) << F::name;
        EXPECT_LE(merging_error(sum->filter, exact), budget<F>()) << F::name;
        auto const few = merged(part<F>(records, 0, 30, problem), part<F>(records, 30, 32, problem), problem);
        EXPECT_FALSE(few) << F::name;  // of information, rounding may make the zero pivot negative
        if (F::name != "information") {
            EXPECT_EQ(few.health, Health::undetermined) << F::name;
        }
    });
}
TEST(MergingWithPrior, IsRefusedOrSaysWhyThereIsNone) {
    Problem<double> const problem = some_problem<double>();
    Records const records = laws::noise_records(4, 60, Seed{99});
    auto const good = part<Ud<double>>(records, 0, 30, problem);
    Part<Ud<double>> spoilt = good;
    spoilt.filter.update({1, 2, 3, std::numeric_limits<double>::infinity()}, 1);
    EXPECT_EQ(merged(good, spoilt, problem).health, Health::nonfinite);
    EXPECT_EQ(merged(spoilt, good, problem).health, Health::nonfinite);
    Part<Ud<double>> const little{Ud<double>({.size = 2}), 3};
    EXPECT_THROW((void)merged(good, little, problem), std::invalid_argument);
    EXPECT_THROW((void)merged(Part<Ud<double>>{good.filter, -1}, good, problem), std::invalid_argument);
    // A part that never had this prior: less information than the prior alone, so nothing is left.
    Problem<double> vague = problem;
    vague.prior->variance = 0x1p40;
    Part<Ud<double>> const without{Ud<double>(vague), 1};
    EXPECT_EQ(merged(without, without, problem).health, Health::indefinite);
}

}  // namespace
}  // namespace rlslab
