// The battery: every law of tests/common/laws.hpp over every variant in every arithmetic, and each law failing on a
// saboteur.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/erase.hpp>
#include "tests/common/laws.hpp"
#include "tests/common/on_a_square.hpp"

#include <rlslab/arithmetic/arithmetics.hpp>

#include <gtest/gtest.h>

namespace rlslab {

/// For GoogleTest's messages.
void PrintTo(CatalogueEntry const& entry, std::ostream* out);
void PrintTo(CatalogueEntry const& entry, std::ostream* out) {
    *out << entry.variant << " in " << entry.arithmetic->name;
}

namespace {

using namespace laws;

class Battery : public testing::TestWithParam<CatalogueEntry> {};

TEST_P(Battery, AZeroRegressorTeachesNothing) { EXPECT_TRUE(a_zero_regressor_teaches_nothing(GetParam())); }
TEST_P(Battery, ScalingTheOutputByTwoScalesThetaExactly) {
    EXPECT_TRUE(scaling_the_output_by_two_scales_theta_exactly(GetParam()));
}
TEST_P(Battery, RowsWithoutReportLeaveTheSameBits) { EXPECT_TRUE(rows_without_report_leave_the_same_bits(GetParam())); }
TEST_P(Battery, ACloneContinuesBitForBit) { EXPECT_TRUE(a_clone_continues_bit_for_bit(GetParam())); }
TEST_P(Battery, SameSeedSameBitsWhoeverLooks) { EXPECT_TRUE(same_seed_same_bits_whoever_looks(GetParam())); }
TEST_P(Battery, HealthyDataAreReportedSound) { EXPECT_TRUE(healthy_data_are_reported_sound(GetParam())); }
TEST_P(Battery, ANanIsReported) { EXPECT_TRUE(a_nan_is_reported(GetParam())); }

/// Budgets in epsilons of the arithmetic. A default for all; who needs more says why.
double residual_budget(CatalogueEntry const& entry) {
    // theta itself carries the filter's accumulated error; the information form squares the condition number.
    return entry.variant == "information" || entry.variant == "cholesky_sparse" ? 60 : 30;
}
TEST_P(Battery, ResidualIsGammaTimesInnovation) { EXPECT_LE(residual_error(GetParam()), residual_budget(GetParam())); }

double gain_budget(CatalogueEntry const& entry) {
    if (entry.variant == "conventional" || entry.variant == "kalman")
        return 400;                                  // the antisymmetric part of P grows as lambda^-k
    if (entry.variant == "extended_qr") return 100;  // K comes from the rotations, P from W: they drift apart
    return 60;
}
TEST_P(Battery, TheGainIsPTimesPsi) { EXPECT_LE(gain_error(GetParam()), gain_budget(GetParam())); }

double solution_budget(CatalogueEntry const& entry) {
    if (entry.variant == "conventional" || entry.variant == "kalman") return 600;  // as above
    if (entry.variant.starts_with("joseph") || entry.variant.starts_with("conv"))
        return 300;  // c^2 = 256 enters squared
    if (entry.variant == "information" || entry.variant == "symmetric") return 300;
    return 60;
}
TEST_P(Battery, AgreesWithTheCertifiedSolution) {
    CatalogueEntry const& entry = GetParam();
    for (double forgetting : {1.0, 0.96875}) {
        Errors const e = errors(entry, problem(4, forgetting), noise_records(4, 60, Seed{31}));
        EXPECT_LE(e.theta, solution_budget(entry)) << "lambda = " << forgetting;
        EXPECT_LE(e.covariance, solution_budget(entry)) << "lambda = " << forgetting;
    }
}
TEST_P(Battery, AgreesFromAFullPriorToo) {
    Problem<double> p = problem(3, 0.96875);
    p.prior->theta = Vector<double>{{1.0, -0.5, 2.0}};
    p.prior->covariance = Matrix<double>{{4.0, 1.0, 0.5}, {1.0, 3.0, 0.25}, {0.5, 0.25, 2.0}};
    Errors const e = errors(GetParam(), p, noise_records(3, 30, Seed{32}));
    EXPECT_LE(e.theta, solution_budget(GetParam()));
    EXPECT_LE(e.covariance, solution_budget(GetParam()));
}
TEST_P(Battery, StartsFromNothingWhereItSaysSo) {
    CatalogueEntry const& entry = GetParam();
    Problem<double> p = problem(3, 0.96875);
    p.prior.reset();
    if (!entry.starts_without_prior) {
        EXPECT_THROW(entry.make(p, Seed{1}), std::invalid_argument);
        return;
    }
    Records const records = as_stored(noise_records(3, 30, Seed{33}), *entry.arithmetic);
    auto const f = entry.make(p, Seed{1});
    for (Index k = 0; k < 3; ++k)
        EXPECT_EQ(name_of(f->update(records.sample(k), records.y[k]).health), "undetermined") << k;
    for (Index k = 3; k < 30; ++k) EXPECT_EQ(name_of(f->update(records.sample(k), records.y[k]).health), "sound") << k;
    Errors const e = errors(entry, p, noise_records(3, 30, Seed{33}));
    EXPECT_LE(e.theta, 2 * solution_budget(entry));
    EXPECT_LE(e.covariance, 2 * solution_budget(entry));
}
TEST_P(Battery, MisuseThrowsAtTheDoor) {
    auto const make = [](Problem<double> const& p) { return GetParam().make(p, Seed{1}); };
    EXPECT_THROW(make(problem(0)), std::invalid_argument);
    for (double lambda : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(make(problem(2, lambda)), std::invalid_argument) << lambda;
    for (double variance : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(make(problem(2, 1, variance)), std::invalid_argument) << variance;
    Problem<double> wrong_size = problem(2);
    wrong_size.prior->theta = Vector<double>(3);
    EXPECT_THROW(make(wrong_size), std::invalid_argument);
    EXPECT_THROW(make(problem(2))->update(Vector<double>(Vector<double>::Zero(3)), 1), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Battery, testing::ValuesIn(catalogue()),
                         [](auto const& of) { return laws::title(of.param); });

// --- saboteurs -------------------------------------------------------------------------------------------------------

/// What can go wrong in a filter, one thing at a time.
enum class Fault {
    learns_from_nothing,
    offset,
    takes_otherwise,
    shared_state,
    hidden_noise,
    cries_wolf,
    deaf,
    wrong_residual,
    wrong_gain,
    biased
};

template <Fault fault>
class Saboteur : public SymmetricOnASquare<double> {
    static inline int shared_ = 0;
    mutable int looks_ = 0;

public:
    static constexpr std::string_view name = "saboteur";
    static constexpr Family family{};
    using SymmetricOnASquare::SymmetricOnASquare;
    Step<double> update(Regressor<double> psi, double y) {
        auto row = look(psi, y);
        if (fault == Fault::offset) row.e += 1e-3;
        if (fault == Fault::shared_state) row.e += 1e-9 * ++shared_;
        if (fault == Fault::hidden_noise) row.e += 1e-9 * looks_;
        Step<double> step = commit(row);
        if (fault == Fault::learns_from_nothing) form().theta[0] += 1e-12 * y;
        if (fault == Fault::biased) form().theta[0] += 1e-13;
        if (fault == Fault::cries_wolf && step.gamma < 0.5) step.health = Health::indefinite;
        if (fault == Fault::deaf) step.health = Health::sound;
        if (fault == Fault::wrong_residual) step.residual = row.e;
        return step;
    }
    void accumulate(Regressor<double> psi, double y)
        requires(fault == Fault::takes_otherwise)
    {
        update(psi, y + 0x1p-40);
    }
    Vector<double> gain() const { return SymmetricOnASquare::gain() * (fault == Fault::wrong_gain ? 2 : 1); }
    Stored<double> stored() const {
        ++looks_;
        return SymmetricOnASquare::stored();
    }
};

template <Fault fault>
CatalogueEntry sabotaged() {
    static Arithmetic const in_double = arithmetic_of<double>();
    return entry_of<Saboteur<fault>>(&in_double);
}

TEST(BatterySaboteur, EveryLawCanFail) {
    EXPECT_FALSE(a_zero_regressor_teaches_nothing(sabotaged<Fault::learns_from_nothing>()));
    EXPECT_FALSE(scaling_the_output_by_two_scales_theta_exactly(sabotaged<Fault::offset>()));
    EXPECT_FALSE(rows_without_report_leave_the_same_bits(sabotaged<Fault::takes_otherwise>()));
    EXPECT_FALSE(a_clone_continues_bit_for_bit(sabotaged<Fault::shared_state>()));
    EXPECT_FALSE(same_seed_same_bits_whoever_looks(sabotaged<Fault::hidden_noise>()));
    EXPECT_FALSE(healthy_data_are_reported_sound(sabotaged<Fault::cries_wolf>()));
    EXPECT_FALSE(a_nan_is_reported(sabotaged<Fault::deaf>()));
    EXPECT_GT(residual_error(sabotaged<Fault::wrong_residual>()), 1000);
    EXPECT_GT(gain_error(sabotaged<Fault::wrong_gain>()), 1000);
    Errors const e = errors(sabotaged<Fault::biased>(), problem(4), noise_records(4, 60, Seed{31}));
    EXPECT_GT(e.theta, 600);
}
TEST(BatterySaboteur, AndTheHonestTwinPasses) {
    constexpr auto none = static_cast<Fault>(-1);
    CatalogueEntry const honest = sabotaged<none>();
    EXPECT_TRUE(a_zero_regressor_teaches_nothing(honest));
    EXPECT_TRUE(scaling_the_output_by_two_scales_theta_exactly(honest));
    EXPECT_TRUE(rows_without_report_leave_the_same_bits(honest));
    EXPECT_TRUE(a_clone_continues_bit_for_bit(honest));
    EXPECT_TRUE(same_seed_same_bits_whoever_looks(honest));
    EXPECT_TRUE(healthy_data_are_reported_sound(honest));
    EXPECT_TRUE(a_nan_is_reported(honest));
    EXPECT_LT(residual_error(honest), 30);
    EXPECT_LT(gain_error(honest), 60);
}

}  // namespace
}  // namespace rlslab
