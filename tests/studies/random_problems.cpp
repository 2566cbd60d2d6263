// The random problems of study random_problems: their ranges, their spectrum, what two realisations share; and the
// digits of P that compare predicts of them.
#include "studies/published/naming.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <map>

namespace rlslab::studies {
namespace {

std::vector<DrawnProblem> problems(Index count, Seed seed, DrawnProblem (*draw)(Index number, Seed seed)) {
    std::vector<DrawnProblem> out;
    for (Index number = 1; number <= count; ++number) out.push_back(draw(number, Seed{seed.next()}));
    return out;
}
std::vector<DrawnProblem> drawn(Index count) { return problems(count, Seed{7}, &drawn_problem); }

TEST(RandomProblems, KeepTheStatedRanges) {
    std::map<std::string, int> words;
    for (DrawnProblem const& p : drawn(400)) {
        ++words[p.word];
        EXPECT_TRUE((1 <= p.size && p.size <= 16) || p.size == 32);
        EXPECT_TRUE(2 * p.size <= p.rows && p.rows <= 2000);
        EXPECT_TRUE(1 <= p.kappa && p.kappa <= 1e8);
        EXPECT_TRUE(p.offset == 0 || (1 <= p.offset && p.offset <= 1e3));
        EXPECT_TRUE(p.noise == 0 || (1e-6 <= p.noise && p.noise <= 10));
        EXPECT_TRUE(p.forgetting == 1 || (0.9 <= p.forgetting * 1.000001 && p.forgetting <= 0.9999 * 1.000001));
        EXPECT_EQ(p.p0.has_value(), p.prior != "proposed");
        EXPECT_FALSE(p.intercept && p.size == 1);
        EXPECT_GT(p.theta.cwiseAbs().maxCoeff(), 0);
    }
    EXPECT_EQ(words["float"] + words["double"], 360);
    EXPECT_EQ(words["binary16"], 20);
    EXPECT_EQ(words["bfloat16"], 20);
}

TEST(RandomProblems, TakeEveryKind) {
    std::map<std::string, int> kinds;
    for (DrawnProblem const& p : drawn(600))
        for (std::string const& kind : {p.regressors, p.spectrum, "theta " + p.direction, "prior " + p.prior,
                                        std::string(p.forgetting == 1 ? "lambda = 1" : "less"),
                                        std::string(p.noise == 0 ? "without noise" : "with noise")})
            ++kinds[kind];
    EXPECT_EQ(kinds.size(), 3u + 4u + 4u + 3u + 2u + 2u);
    EXPECT_NEAR(kinds["lambda = 1"], 300, 5 * std::sqrt(600 / 4.0));
    EXPECT_NEAR(kinds["without noise"], 75, 5 * std::sqrt(75));
    for (char const* third : {"rotated", "units", "delay line", "prior proposed", "prior default", "prior given"})
        EXPECT_NEAR(kinds[third], 200, 5 * std::sqrt(200)) << third;
    for (char const* quarter : {"geometric", "clustered", "theta v_1", "theta v_d", "theta generic", "theta sparse"})
        EXPECT_NEAR(kinds[quarter], 150, 5 * std::sqrt(150)) << quarter;
}

TEST(RandomProblems, HaveTheirSpectrumAndTheta) {
    for (DrawnProblem const& p : drawn(100)) {
        auto const [least, greatest] = std::ranges::minmax(p.sigma);
        EXPECT_NEAR(greatest / least, p.size == 1 ? 1 : p.kappa, 1e-9 * p.kappa);
        EXPECT_LT((p.V.transpose() * p.V - Eigen::MatrixXd::Identity(p.size, p.size)).cwiseAbs().maxCoeff(), 1e-14);
        if (p.regressors == "delay line") continue;
        if (p.direction == "v_1") {
            EXPECT_EQ(p.theta, p.V.col(0));
        } else if (p.direction == "v_d") {
            EXPECT_EQ(p.theta, p.V.col(p.size - 1));
        }
    }
}

TEST(RandomProblems, RealisationsShareTheSystemAlone) {
    for (DrawnProblem const& p : drawn(60)) {
        Records const one = realisation(p, Seed{1}, Seed{2}), again = realisation(p, Seed{1}, Seed{3}),
                      other = realisation(p, Seed{4}, Seed{3});
        EXPECT_EQ(one.psi, again.psi);
        EXPECT_NE(one.psi, other.psi);
        EXPECT_EQ(one.y == again.y, p.noise == 0);
        EXPECT_EQ(one.rows(), p.rows);
        EXPECT_EQ((one.psi.row(p.size - 1).array() == 1).all(), p.intercept);
        Eigen::VectorXd const residual = one.y - one.psi.transpose() * p.theta;
        double const share = residual.norm() / (one.psi.transpose() * p.theta).norm();
        EXPECT_NEAR(share, p.noise, 1e-12 + (p.noise == 0 ? 0 : p.noise * 5 / std::sqrt(double(p.rows))));
        if (p.regressors != "delay line" || p.intercept) continue;
        for (Index k = 1; k < p.rows; ++k)
            for (Index i = 1; i < p.size && p.offset == 0; ++i) ASSERT_EQ(one.psi(i, k), one.psi(i - 1, k - 1));
    }
}

// --- the second distribution -----------------------------------------------------------------------------------------

std::vector<DrawnProblem> everyday(Index count) { return problems(count, Seed{8}, &everyday_problem); }

TEST(EverydayProblems, KeepTheStatedRangesAndTakeTurns) {
    std::map<std::string, int> turns;
    for (DrawnProblem const& p : everyday(240)) {
        ++turns[p.kind], ++turns[p.word], ++turns[p.forgetting == 1 ? "lambda = 1" : "less"], ++turns[p.prior];
        EXPECT_TRUE(2 <= p.size && p.size <= 8);
        EXPECT_TRUE(40 * p.size <= p.rows && p.rows <= 4000);
        EXPECT_TRUE(1e-3 <= p.noise && p.noise <= 1);
        EXPECT_TRUE(p.forgetting == 1 ||
                    (1 / (1 - p.forgetting) <= 2001 && 1 / (1 - p.forgetting) >= 9.9 * double(p.size)));
        EXPECT_EQ(p.p0.has_value(), p.prior == "given");
        EXPECT_TRUE(!p.p0 || (1e4 <= *p.p0 && *p.p0 <= 1e12));
        for (Index i = 0; i < p.size; ++i) {
            double const theta = std::abs(p.theta[i]) * p.sigma[size_t(i)];
            EXPECT_TRUE(0.316 <= theta && theta <= 3.163) << theta;
        }
        EXPECT_EQ(!p.later.empty(), p.kind == "changes");
    }
    for (char const* kind : everyday_kinds) EXPECT_EQ(turns[kind], 40) << kind;
    for (char const* half : {"float", "double", "lambda = 1", "less"}) EXPECT_NEAR(turns[half], 120, 12) << half;
    EXPECT_NEAR(turns["given"], 60, 5 * std::sqrt(240 * 3 / 16.0));
}

TEST(EverydayProblems, HaveTheRowsOfTheirKinds) {
    for (DrawnProblem const& p : everyday(120)) {
        Records const r = realisation(p, Seed{1}, Seed{2}), other = realisation(p, Seed{3}, Seed{4});
        ASSERT_EQ(r.rows(), p.rows);
        EXPECT_NE(r.psi, other.psi) << p.kind;
        Index const last = p.size - 1;
        if (p.kind == "rest") {
            EXPECT_GE(p.rest, 1);
            for (Index k = 0; k < p.rest; ++k)
                for (Index i = 0; i <= last; ++i) ASSERT_NEAR(r.psi(i, k), 1, 6 * p.jitter);
        }
        for (Index k = p.period; p.kind == "periodic" && k < p.rows; ++k)
            ASSERT_EQ(r.psi.col(k), r.psi.col(k - p.period)) << k;
        if (p.kind == "counts") {
            for (double const x : r.psi.reshaped()) ASSERT_TRUE(x == std::round(x) && std::abs(x) <= 4095);
            for (double const y : r.y) ASSERT_EQ(y, std::round(y));
        }
        if (p.kind == "units") {
            for (Index i = 0; i < p.size; ++i)
                EXPECT_NEAR(r.psi.row(i).norm() / std::sqrt(double(p.rows)) / p.sigma[size_t(i)], p.offset > 0 ? 10 : 1,
                            0.6);
        }
        if (p.kind == "levels") {
            Index steps = 0;
            for (Index k = 1; k < p.rows; ++k) steps += r.psi(last - 1, k) != r.psi(last - 1, k - 1);
            EXPECT_EQ(steps, (p.rows - 1) / p.level);
            EXPECT_EQ(r.psi.row(last).minCoeff(), 1);
        }
    }
}

/// Over problems of both distributions: how many predictions of P are within half a digit of the median, and how many
/// of those that say "at least" stand.
void judge_predictions(Index problems) {
    std::map<std::string, std::pair<int, int>> found;
    for (bool const everyday : {false, true})
        for (Index number = 1; number <= problems; ++number) {
            Seed seed{std::uint64_t(910000 + 2 * number + everyday)};
            Seed const drawn{seed.next()}, rows{seed.next()}, noise{seed.next()};
            DrawnProblem const p = everyday ? everyday_problem(number, drawn) : drawn_problem(number, drawn);
            auto const c = naming::compared(realisation(p, rows, noise), p, seed.next());
            if (!c || (p.word != "float" && p.word != "double")) continue;
            for (compare::Result const& r : c->results) {
                if (!r.predicted || !r.spread || r.broken > 0) continue;
                double const more = r.spread->covariance.median - r.predicted->digits;
                bool const holds = r.predicted->at_least ? more > -0.05 : std::abs(more) <= 0.5;
                bool const rests = p.kind == "rest";
                for (std::string const& name :
                     {std::string(r.entry->variant) + (rests ? ", start at rest" : ""),
                      std::string(r.predicted->at_least ? "P stored" : "factors") + (rests ? ", start at rest" : "")})
                    found[name].first += holds, ++found[name].second;
            }
        }
    for (auto const& [name, of] : found)
        std::cout << name << ": " << of.first << " of " << of.second << ", " << 100.0 * of.first / of.second << " %\n";
    auto const share = [&](char const* name) { return double(found[name].first) / double(found[name].second); };
    EXPECT_GT(share("factors"), 0.9);
    EXPECT_GT(share("P stored"), 0.98);
}
TEST(PredictedDigits, AreWithinHalfADigit) { judge_predictions(12); }
TEST(PredictedDigits, DISABLED_OfManyProblems) { judge_predictions(200); }

}  // namespace
}  // namespace rlslab::studies
