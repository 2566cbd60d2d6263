// Where health is easily misjudged: underflow, zeros at a start without prior, weights that vanish, products that
// overflow; steps whose health is known by hand.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/compare/compare.hpp"
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/model/order_recursive_qr.hpp>
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

using Row = Vector<double>;

CatalogueEntry const& entry_of(std::string_view variant, std::string_view arithmetic) {
    return *find_entry(variant, arithmetic);
}

/// Rows whose s leaves double's range while its root does not: gamma underflows, and nothing is wrong with the factors.
TEST(Health, AnUnderflowOfGammaIsSound) {
    Problem<double> const p = laws::problem(2, 1, 1e150);
    for (char const* variant : {"inverse_qr", "extended_qr", "qr", "gentleman"}) {
        auto const f = entry_of(variant, "double").make(p, Seed{1});
        Step<double> const step = f->update(Row{{1e90, 0.0}}, 1.0);
        EXPECT_EQ(definiteness(f->stored()), Health::sound) << variant;
        EXPECT_EQ(name_of(step.health), "sound") << variant;
    }
    auto const little = entry_of("conventional", "double").make(laws::problem(1, 1e-100, 1e250), Seed{1});
    Step<double> const step = little->update(Row{{1.0}}, 1.0);
    EXPECT_TRUE(step.gamma == 0 && step.health == Health::sound);
    auto const conventional = entry_of("conventional", "double").make(p, Seed{1});
    EXPECT_EQ(name_of(conventional->update(Row{{1e90, 0.0}}, 1.0).health), "nonfinite");  // s itself overflows
}

/// compare() calls broken what is stored, whatever a step reported.
TEST(Health, AFormWhoseStoredFactorsAreDefiniteIsNotCalledBroken) {
    Records records = laws::noise_records(2, 20, Seed{4});
    records.psi.row(0) *= 200;
    records.psi.row(1) *= 100;
    records.y *= 10;
    records.names = {"a", "b"};
    Comparison const c = compare::compare(records, {.p0 = 60000, .arithmetics = {"binary16"}, .timings = false});
    int factors = 0;
    for (Result const& r : c.results) {
        bool const factor = r.entry->make(laws::problem(2), Seed{1})->stored().form == Stored<Reference>::Form::factor;
        factors += factor;
        if (factor && r.breakdown) {
            auto const f = r.entry->make(
                {.size = 2, .prior = Prior<double>{.variance = r.entry->arithmetic->round(60000)}}, Seed{1});
            Records const rounded = as_stored(records, *r.entry->arithmetic);
            bool definite = true;
            for (Index k = 0; k < r.breakdown->step; ++k) {
                f->update(rounded.sample(k), rounded.y[k]);
                definite = definite && definiteness(f->stored()) == Health::sound;
            }
            EXPECT_FALSE(definite) << r.entry->variant;
        }
        if (r.entry->variant == "qr" || r.entry->variant == "inverse_qr") {
            EXPECT_FALSE(r.breakdown) << r.entry->variant;
        }
    }
    EXPECT_GE(factors, 7);
}

/// Without a prior: rows that teach nothing new leave theta undefined, and say so for as long as they do.
TEST(Health, DependentAndZeroFirstRowsAreUndetermined) {
    Problem<double> p = laws::problem(2);
    p.prior.reset();
    for (CatalogueEntry const& entry : catalogue()) {
        if (!entry.starts_without_prior || entry.arithmetic->name != "double") continue;
        auto const f = entry.make(p, Seed{1});
        EXPECT_EQ(name_of(f->update(Row{{0.0, 0.0}}, 1.0).health), "undetermined") << entry.variant << ": a zero row";
        for (int k = 1; k <= 3; ++k)
            EXPECT_EQ(name_of(f->update(Row{{2.0 * k, 0.0}}, 1.0).health), "undetermined")
                << entry.variant << ": " << k;
        EXPECT_EQ(name_of(f->update(Row{{1.0, 1.0}}, 1.0).health), "undetermined")
            << entry.variant << ": the determining row";
        EXPECT_EQ(name_of(f->update(Row{{1.0, -1.0}}, 2.0).health), "sound") << entry.variant;
    }
}

/// Data that are not finite say so before theta is determined, too; and a form with a prior is never undetermined.
TEST(Health, ANanIsNotALackOfRows) {
    Problem<double> p = laws::problem(2);
    p.prior.reset();
    for (CatalogueEntry const& entry : catalogue()) {
        if (!entry.starts_without_prior || entry.arithmetic->name != "double") continue;
        auto const f = entry.make(p, Seed{1});
        EXPECT_EQ(name_of(f->update(Row{{std::nan(""), 1.0}}, 1.0).health), "nonfinite") << entry.variant;
        for (int k = 1; k <= 3; ++k)
            EXPECT_EQ(name_of(f->update(Row{{1.0, double(k)}}, 1.0).health), "nonfinite") << entry.variant << k;
    }
    Information<float> broken({.size = 2});
    for (int k = 0; k < 4; ++k)
        EXPECT_NE(name_of(broken.update(Vector<float>{{1e4f, 1e4f + float(k)}}, 1.0f).health), "undetermined") << k;
}

/// A prior so large that the row's weight vanishes behind the first column: theta is defined all along.
TEST(Health, AWeightThatVanishesIsNotALackOfRows) {
    Gentleman<float> f({.size = 2, .prior = Prior<float>{.variance = 1e30f}});
    EXPECT_EQ(name_of(f.update(Vector<float>{{1e12f, 1.0f}}, 1.0f).health), "sound");
    EXPECT_EQ(name_of(f.update(Vector<float>{{0.0f, 1.0f}}, 3.0f).health), "sound");
    EXPECT_NEAR(f.theta()[1], 3, 1e-5);
}

/// s_{j-1} s_j leaves float's range long before s does.
TEST(Health, CarlsonKeepsItsFactorUnderALargePrior) {
    CatalogueEntry const& entry = entry_of("carlson", "float");
    laws::Errors const e = laws::errors(entry, laws::problem(3, 1, 0x1p80), laws::noise_records(3, 30, Seed{3}));
    EXPECT_LE(e.theta, 1e4);
    EXPECT_LE(e.covariance, 1e4);
}

/// docs/theory.md 44: P stays semidefinite, but one row of a scalar problem leaves 0, and no report says so. A product
/// of positive numbers does not (112).
TEST(Health, PottersRootMayBecomeSingularUnderALargePrior) {
    auto const after_two_rows = []<class F>(std::type_identity<F>, Index bits) {
        using T = typename F::scalar;
        F f(Problem<T>{.size = 1, .prior = Prior<T>{.variance = std::ldexp(T(1), int(2 * bits))}});
        for (int k = 0; k < 2; ++k) {
            Step<T> const step = f.update(Vector<T>{{T(1)}}, T(1));
            EXPECT_TRUE(step.health == Health::sound && T(0) < step.gamma && step.gamma <= T(1)) << F::name;
        }
        return f.covariance()(0, 0);
    };
    for (Index c : {24, 25, 40}) EXPECT_EQ(after_two_rows(std::type_identity<Potter<float>>{}, c), 0);
    for (Index c : {53, 54, 200}) EXPECT_EQ(after_two_rows(std::type_identity<Potter<double>>{}, c), 0);
    EXPECT_NEAR(after_two_rows(std::type_identity<Potter<double>>{}, 20), 0.5, 1e-6);
    EXPECT_NEAR(after_two_rows(std::type_identity<Carlson<double>>{}, 200), 0.5, 1e-15);
}

/// A row without a report: theta and the gain are those of a row with one, though nothing has been solved yet.
TEST(Health, InformationAnswersAfterARowWithoutReport) {
    Records const rows = laws::noise_records(3, 20, Seed{5});
    Information<double> taken({.size = 3, .prior = std::nullopt}), reported = taken;
    for (Index k = 0; k < rows.rows(); ++k) {
        taken.accumulate(rows.sample(k), rows.y[k]);
        reported.update(rows.sample(k), rows.y[k]);
        EXPECT_TRUE(laws::identical(taken.theta(), reported.theta())) << k;
        EXPECT_TRUE(laws::identical(taken.gain(), reported.gain())) << k;
    }
}
/// Sums that would overflow decide nothing about data that are finite.
TEST(Health, LargeFiniteDataAreUndeterminedNotNonfinite) {
    using Half = Chopped<binary16>;
    Information<Half> filter({.size = 3, .prior = std::nullopt});
    std::vector<Half> const psi(3, Half(150));
    EXPECT_EQ(name_of(filter.update(psi, Half(1)).health), "undetermined");
}
/// A row of zeros leaves theta alone whatever y is; that y was not finite is said.
TEST(Health, AZeroRowWithANanSpoilsNothing) {
    QrBlock<double> filter({.size = 2});
    filter.update(Vector<double>{{1, 0.5}}, 1);
    filter.update(Vector<double>{{0.25, 1}}, 2);
    Vector<double> const theta = filter.theta();
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_EQ(name_of(filter.update(Vector<double>{{0, 0}}, bad).health), "nonfinite");
        EXPECT_EQ(filter.theta(), theta);
    }
}

/// Squares that went subnormal are not summed: the reflection's norm keeps its digits.
TEST(Health, ANormOfTinyNumbersKeepsItsDigits) {
    using Half = Chopped<binary16>;
    Half const x[2] = {Half(0x1p-11), Half(0x1.8p-11)};
    double const exact = 0x1p-11 * std::sqrt(1 + 2.25 + 1);
    EXPECT_NEAR(double(norm(Half(0x1p-11), Half(x[0] * x[0] + x[1] * x[1]), x, 2)) / exact, 1, 3 * 0x1p-11);
}

/// A full P0 that is no covariance is misuse in every variant.
TEST(Health, AnIndefiniteOrAsymmetricPriorIsRefused) {
    for (CatalogueEntry const& entry : catalogue()) {
        Problem<double> p = laws::problem(2);
        p.prior->covariance = Matrix<double>{{1.0, 2.0}, {2.0, 1.0}};
        EXPECT_THROW(entry.make(p, Seed{1}), std::invalid_argument) << entry.variant;
        p.prior->covariance = Matrix<double>{{1.0, 0.5}, {0.25, 1.0}};
        EXPECT_THROW(entry.make(p, Seed{1}), std::invalid_argument) << entry.variant;
    }
}

/// What compare says of a problem whose prior decides theta, and of an output that is zero.
TEST(Health, APriorThatDecidesThetaIsNotRecommendedFor) {
    Records records = laws::noise_records(3, 40, Seed{7});
    records.names = {"a", "b", "c"};
    records.psi /= 256;
    CompareOptions options{.p0 = 1, .arithmetics = {"double"}, .timings = false};
    Comparison const c = compare::compare(records, options);
    EXPECT_GT(c.prior_bias, 0.1);
    EXPECT_EQ(c.recommendations.front().variant, "");
    EXPECT_NE(as_table(c, false).find("leave out --p0"), std::string::npos);
    options.p0 = 1e9;
    EXPECT_NE(compare::compare(records, options).recommendations.front().variant, "");
    records.y.setZero();
    EXPECT_EQ(compare::compare(records, options).prior_bias, 0);
}

// --- one variant at a time, also for numbers that it stores separately -----------------------------------------------

/// e, s and gamma are ordinary numbers: K = P psi / s = 9.9, and K e alone overflows.
TEST(HealthByHand, OfUdAThetaThatOverflowsIsNotSound) {
    Ud<double> f({.size = 1, .prior = Prior<double>{.variance = 0x1p14}});
    Step<double> const step = f.update(Row{{0.1}}, 1.7e308);
    EXPECT_TRUE(std::isfinite(step.innovation) && 0 < step.gamma && step.gamma < 1);
    EXPECT_FALSE(std::isfinite(f.theta()[0]));
    EXPECT_EQ(name_of(step.health), "nonfinite");
}

/// X falls to zero by forgetting and comes back with the next row: that row's innovation was against no theta, and it
/// is no start.
TEST(HealthByHand, OfInformationTheRowAfterABreakdownIsStillBroken) {
    Information<double> f({.size = 1, .forgetting = 0x1p-600, .prior = Prior<double>{.variance = 1}});
    EXPECT_EQ(name_of(f.update(Row{{0.0}}, 1.0).health), "sound");
    EXPECT_EQ(name_of(f.update(Row{{0.0}}, 1.0).health), "indefinite") << "X = 2^-1200";
    EXPECT_EQ(name_of(f.update(Row{{1.0}}, 1.0).health), "indefinite") << "X = 1 again";
    EXPECT_EQ(name_of(f.update(Row{{1.0}}, 1.0).health), "sound");
    Information<double> start({.size = 1, .prior = std::nullopt});
    EXPECT_EQ(name_of(start.update(Row{{0.0}}, 1.0).health), "undetermined");
    EXPECT_EQ(name_of(start.update(Row{{1.0}}, 1.0).health), "undetermined") << "the row that determines theta";
    EXPECT_EQ(name_of(start.update(Row{{1.0}}, 1.0).health), "sound");
}

/// Without a prior a parameter that no row has reached is NaN, not the zero it is stored as.
TEST(HealthByHand, OfGentlemanAParameterWithoutRowsIsNotANumber) {
    Gentleman<double> f({.size = 2, .prior = std::nullopt});
    EXPECT_TRUE(std::isnan(f.theta()[0]) && std::isnan(f.theta()[1]));
    f.update(Row{{2.0, 0.0}}, 6.0);
    EXPECT_EQ(f.theta()[0], 3);
    EXPECT_TRUE(std::isnan(f.theta()[1]));
    f.update(Row{{2.0, 1.0}}, 8.0);
    EXPECT_EQ(f.theta()[1], 2);
}

/// The root of two squares of 1.5e308 overflows: R is infinite from the second row on, while theta and W are not.
TEST(HealthByHand, OfExtendedQrAnInfinitePivotIsNotSound) {
    ExtendedQr<double> f({.size = 1, .prior = Prior<double>{.variance = 1}});
    EXPECT_EQ(name_of(f.update(Row{{1.5e308}}, 0.0).health), "sound");
    Step<double> const step = f.update(Row{{1.5e308}}, 0.0);
    EXPECT_EQ(f.theta()[0], 0);
    EXPECT_TRUE(std::isfinite(f.stored().F(0, 0)));
    EXPECT_EQ(name_of(step.health), "nonfinite");
}

/// A column that is a unit vector but for 2^-30: r away from its sign loses nothing, r towards it all of the
/// reflection.
TEST(OrderRecursiveQr, ReflectsAwayFromTheSign) {
    for (double const sign : {1.0, -1.0}) {
        Row const x{{sign, 0x1p-30, -0x1p-30, 0x1p-29}}, z{{0.5, 1, -2, 3}};
        OrderRecursiveQr<double> f(Row(2 * x - 3 * z), 2);
        f.append(x);
        EXPECT_NEAR(f.theta()[0], 2 - 3 * x.dot(z) / x.squaredNorm(), 1e-14) << sign;
        f.append(z);
        EXPECT_NEAR(f.theta()[0], 2, 1e-14) << sign;
        EXPECT_NEAR(f.theta()[1], -3, 1e-14) << sign;
    }
}

}  // namespace
}  // namespace rlslab
