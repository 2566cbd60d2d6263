// What a prior costs: the law against certified minimisers (against filters: the study prior_any), its units, the ends
// of its range, and the sentence that compare makes of it. What is predicted of P.
#include "src/lab/compare/prior_law.hpp"
#include "src/lab/compare/words.hpp"
#include "tests/common/message.hpp"

#include <rlslab/core/random.hpp>

#include <cmath>

namespace rlslab {
using namespace compare;
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Rows near a plane: the last direction has 2^-`thin` of the others. Noise 2^-10.
Records rows_near_a_plane(int thin, Seed seed, Index rows = 40, Index d = 4) {
    Records out{.psi = Matrix<double>(d, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        double sum = 0;
        for (Index i = 0; i + 1 < d; ++i) sum += out.psi(i, k) = seed.bell();
        out.psi(d - 1, k) = sum + std::ldexp(seed.bell(), -thin);
        out.y[k] = sum - 2 * out.psi(d - 1, k) + std::ldexp(seed.bell(), -10);
    }
    return out;
}
CertifiedSolution solution(Records const& r, std::optional<Prior<double>> const& prior = std::nullopt) {
    return certified({.size = r.parameters(), .prior = prior}, r, {r.rows()}, 50).front();
}
PriorLaw law_of(Records const& r) { return prior_law(r, solution(r)); }

TEST(PriorLaw, HasTheBiasOfCertifiedMinimisers) {
    Records const r = rows_near_a_plane(5, Seed{1});
    CertifiedSolution const free = solution(r);
    PriorLaw const law = prior_law(r, free);
    ASSERT_EQ(law.points.size(), 14u);
    for (PriorPoint const& at : law.points)
        EXPECT_NEAR(relative_change(solution(r, Prior<double>{.variance = at.c2}), free) / at.bias, 1, 1e-12) << at.c2;
}

/// docs/theory.md 105, with the state after j rows as the prior of the others: -P_N M_j deltaP s_j,
/// s_j = M_j (theta_j - theta_N).
TEST(PriorLaw, AnErrorOfPMovesTheMinimiserByTheFormula) {
    Records const r = rows_near_a_plane(3, Seed{6});
    Prior<double> prior{.theta = Vector<double>{{3, -1, 2, 5}}, .covariance = Matrix<double>::Zero(4, 4)};
    prior.covariance->diagonal() << 0.25, 0.0625, 0.5, 0.125;
    Prior<double> wrong = prior;
    (*wrong.covariance)(1, 2) = (*wrong.covariance)(2, 1) = 0x1p-40;
    CertifiedSolution const exact = solution(r, prior), moved = solution(r, wrong);
    Vector<Reference> const theta = exact.theta(), now = moved.theta();
    Matrix<Reference> const P = exact.covariance();
    auto const M_delta = [&](Index a) {  // of M_j (theta_j - theta_N)
        return Reference(((*prior.theta)[a] - theta[a]) / (*prior.covariance)(a, a));
    };
    for (Index i = 0; i < 4; ++i) {
        Reference const said =
            -(P(i, 1) / (*prior.covariance)(1, 1) * M_delta(2) + P(i, 2) / (*prior.covariance)(2, 2) * M_delta(1)) *
            0x1p-40;
        EXPECT_NEAR(static_cast<double>(Reference((now[i] - theta[i]) / said)), 1, 1e-9) << i;
    }
}

TEST(PriorLaw, TakesEachColumnInItsUnits) {
    Records const r = rows_near_a_plane(5, Seed{2});
    Records scaled = r;
    Vector<double> s(4);
    for (Index i = 0; i < 4; ++i) s[i] = std::ldexp(1.0, int(60 * i) - 90), scaled.psi.row(i) *= s[i];
    PriorLaw const one = law_of(r), other = prior_law(scaled, solution(scaled), s);
    ASSERT_EQ(other.points.size(), one.points.size());
    for (size_t i = 0; i < one.points.size(); ++i) {
        EXPECT_EQ(one.points[i].c2, other.points[i].c2);
        EXPECT_NEAR(one.points[i].bias / other.points[i].bias, 1, 1e-12);
        EXPECT_NEAR(one.points[i].stored / other.points[i].stored, 1, 1e-12);
        EXPECT_NEAR(one.points[i].products / other.points[i].products, 1, 1e-12);
    }
}
TEST(PriorLaw, TheBestIsTheLeastOfItsRegion) {
    PriorLaw const law = law_of(rows_near_a_plane(8, Seed{3}));
    for (double const u : {0x1p-8, 0x1p-24, 0x1p-53})
        for (PriorForm const form : {PriorForm::stored, PriorForm::products}) {
            PriorPoint const best = law.best(form, u);
            EXPECT_LE(u * best.c2 * law.trace, 1);
            for (PriorPoint const& at : law.points)
                if (u * at.c2 * law.trace <= 1) {
                    EXPECT_LE(best.total(form, u), at.total(form, u) * (1 + 1e-12));
                }
        }
}
TEST(PriorLaw, IsEmptyWhereThereIsNone) {
    Records r = rows_near_a_plane(5, Seed{4});
    r.y.setZero();
    EXPECT_TRUE(law_of(r).empty()) << "theta = 0";
    r = rows_near_a_plane(5, Seed{4});
    r.psi.row(1) = r.psi.row(0);
    EXPECT_TRUE(law_of(r).empty()) << "rank 3";
    EXPECT_TRUE(law_of(rows_near_a_plane(5, Seed{4}, 3)).empty()) << "3 rows";
    EXPECT_TRUE(law_of(rows_near_a_plane(5, Seed{4}, 40, 33)).empty()) << "33 parameters";
    r = rows_near_a_plane(5, Seed{4});
    for (int const e : {-1000, -400, 400, 1000}) {
        Records far = r;
        far.psi *= std::ldexp(1.0, e);
        for (PriorPoint const& at : law_of(far).points) {
            EXPECT_TRUE(std::isfinite(at.bias + at.stored + at.products)) << e;
        }
    }
}
TEST(PriorLaw, OneRowOfOneParameter) {
    Records r{.psi = Matrix<double>{{3}}, .y = Vector<double>{{6}}, .names = {"x"}};
    PriorLaw const law = law_of(r);
    ASSERT_FALSE(law.empty());
    EXPECT_EQ(law.trace, 9);
    for (PriorPoint const& at : law.points) EXPECT_NEAR(at.bias, 1 / (1 + 9 * at.c2), 1e-15);
    EXPECT_LE(law.at(0x1p-1000).bias, 1);
    EXPECT_TRUE(std::isfinite(law.at(0x1p1000).stored));
}

// --- what compare says of it -----------------------------------------------------------------------------------------

Comparison compared(Records const& r, std::optional<double> p0, double forgetting = 1) {
    Comparison c = compare::compare(r, {.forgetting = forgetting,
                                        .p0 = p0,
                                        .variants = {"ud"},
                                        .arithmetics = {"float", "double", "quad", "bfloat16-stochastic"},
                                        .timings = false});
    c.prior_costs = prior_costs(r, c);
    return c;
}
TEST(PriorCosts, AreThoseOfTheLawInEachArithmeticThatRoundsToNearest) {
    Records const r = rows_near_a_plane(8, Seed{5});
    PriorLaw const law = law_of(r);
    Comparison const c = compared(r, 1e3);
    ASSERT_EQ(c.prior_costs.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        PriorCost const& cost = c.prior_costs[i];
        PriorForm const form = i % 2 == 0 ? PriorForm::stored : PriorForm::products;
        double const u = i < 2 ? 0x1p-24 : 0x1p-53;
        EXPECT_EQ(cost.arithmetic, i < 2 ? "float" : "double");
        EXPECT_EQ(cost.form, i % 2 == 0 ? "symmetric" : "joseph");
        EXPECT_EQ(cost.best_c2, law.best(form, u).c2);
        EXPECT_NEAR(cost.digits, -std::log10(law.best(form, u).total(form, u)), 1e-12);
        EXPECT_NEAR(cost.loss, std::log10(law.at(1e3).total(form, u) / law.best(form, u).total(form, u)), 1e-12);
    }
}
TEST(PriorCosts, AtTheEndsOfTheRangeAreAllDigitsAndNotKnownForForgettingAndForAThetaOfZero) {
    Records r = rows_near_a_plane(8, Seed{5});
    for (double const p0 : {0x1p-1000, 0x1p1000}) {
        Comparison const c = compared(r, p0);
        ASSERT_FALSE(c.prior_costs.empty());
        for (PriorCost const& cost : c.prior_costs) EXPECT_NEAR(cost.loss, cost.digits, 1e-9) << p0;
        EXPECT_THAT(prior_cost_text(c), testing::Not(testing::AnyOf(HasSubstr("nan"), HasSubstr("inf"))));
    }
    EXPECT_THAT(compared(r, 1e3, 0.99).prior_costs, IsEmpty());
    r.y.setZero();
    EXPECT_THAT(compared(r, 1e3).prior_costs, IsEmpty());
    EXPECT_EQ(prior_cost_text(compared(r, 1e3)), "");
}
TEST(PriorCosts, AreASentenceFromHalfADigitOn) {
    Comparison c{};
    c.options.p0 = 1e8;
    c.prior_costs = {{"float", "symmetric", 7.25e4, 3, 0.44},
                     {"float", "joseph", 2e4, 2.5, 0.46},
                     {"double", "symmetric", 3e11, 9, 3.61},
                     {"double", "joseph", 1e10, 8, 1.04}};
    EXPECT_EQ(
        prior_cost_text(c),
        "against least squares --p0 100000000 costs forms that store P, in float joseph about 0.5 digits (best c^2 "
        "2e+04); in double symmetric about 3.6 digits (best c^2 3e+11), joseph about 1.0 (best c^2 1e+10); "
        "symmetric stands for all that update P by a difference");
    EXPECT_THAT(warnings(c), testing::Contains(prior_cost_text(c)));
    c.options.p0.reset();
    EXPECT_EQ(prior_cost_text(c), "") << "the prior scaled to the data is compare's own";
}

/// One parameter, rows of 1, four of them: P_k M_j = M_j / M_k, M_j = j lambda^... + lambda^j / c^2.
TEST(PowerLaw, OfOneParameterIsASumByHand) {
    for (double const lambda : {1.0, 0.75}) {
        Records const rows{.psi = Matrix<double>::Ones(1, 4), .y = Vector<double>::Ones(4), .names = {}};
        RoundedProblem const problem{
            {.size = 1, .forgetting = lambda, .prior = Prior<double>{.variance = 4}}, rows, true, {{}}};
        std::vector<double> M{0.25};
        for (int k = 0; k < 4; ++k) M.push_back(lambda * M.back() + 1);
        double factor = 0, stored = 0, bias = 0;
        for (size_t j = 1; j <= 4; ++j) {
            double const left = std::pow(lambda, double(4 - j)), carried = left * M[j] / M[4];
            factor += carried * carried, bias += carried;
            double const before = carried * M[j] / M[j - 1] / lambda;
            stored += before * before;
        }
        PowerLaw::Sizes const at = power_law(problem).at.at(0);
        EXPECT_NEAR(at.triangle, std::sqrt(factor), 1e-12);
        EXPECT_NEAR(at.information, std::sqrt(factor), 1e-12);
        EXPECT_NEAR(at.difference, std::sqrt(stored), 1e-12);
        EXPECT_NEAR(at.bias, lambda < 1 ? bias : 0, 1e-12);
    }
}
TEST(PowerLaw, IsForFormsAndWordsThatItIsTrueOf) {
    Comparison const c = compared(rows_near_a_plane(6, Seed{5}), 1e3);
    double last = 0;
    for (Result const& r : c.results) {
        std::string_view const form = r.entry->variant;
        bool const none = form == "conventional" || form == "kalman" || form == "information";
        if (none || r.entry->arithmetic->stochastic || r.entry->arithmetic->digits > 53) {
            EXPECT_FALSE(r.predicted) << form;
        }
        if (form != "ud" || !r.predicted) continue;
        EXPECT_GT(r.predicted->digits, last) << "a longer word has more";
        last = r.predicted->digits;
    }
    EXPECT_GT(last, 10);
}
/// The rows in which the scale jumps make nearly all of the error of a stored P.
TEST(PowerLaw, KnowsTheRowsInWhichTheScaleJumps) {
    for (Index const jump : {140, 200}) {
        Records r = rows_near_a_plane(0, Seed{9}, 400);
        r.psi.rightCols(400 - jump) *= 1000;
        Comparison const c = compare::compare(r, {.variants = {"symmetric", "joseph", "joseph_rank_two", "ud"},
                                                  .arithmetics = {"float", "double"},
                                                  .timings = false});
        int judged = 0;
        for (Result const& one : c.results) {
            if (!one.predicted || !one.spread) continue;
            ++judged;
            double const more = one.spread->covariance.median - one.predicted->digits;
            EXPECT_GE(more, one.predicted->at_least ? 0 : -0.5) << one.entry->variant << jump;
            if (!one.predicted->at_least) {
                EXPECT_LE(more, 0.5) << jump;
            }
        }
        EXPECT_EQ(judged, 8);
    }
}

}  // namespace
}  // namespace rlslab
