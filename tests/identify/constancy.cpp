// The sums of the recursive residuals: what they are, how often they leave their lines without a reason, and with one.
#include "src/lab/identify/constancy.hpp"
#include "tests/identify/options.hpp"

#include <rlslab/model/fit.hpp>

#include <Eigen/Cholesky>

namespace rlslab {
using namespace identify;
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// P(1/2 - U > c) for one number; for five a count over 100000 draws, with four of its standard deviations.
TEST(SquaresLine, TailIsThatOfTheLargestExcess) {
    for (double const c : {0.1, 0.25, 0.49}) EXPECT_NEAR(tail_of_largest_excess(1, c), 0.5 - c, 1e-15);
    constexpr int draws = 100000, n = 5;
    Seed seed{3};
    for (double const c : {0.2, 0.4}) {
        int beyond = 0;
        for (int i = 0; i < draws; ++i) {
            std::array<double, n> U;
            for (double& u : U) u = seed.uniform();
            std::ranges::sort(U);
            bool is = false;
            for (int j = 0; j < n; ++j) is |= (j + 1) / double(n + 1) - U[size_t(j)] > c;
            beyond += is;
        }
        double const tail = tail_of_largest_excess(n, c);
        EXPECT_NEAR(double(beyond) / draws, tail, 4 * std::sqrt(tail * (1 - tail) / draws)) << c;
    }
}
TEST(SquaresLine, SolvesTheTailAndPassesIntoTheFormula) {
    for (double const tail : {0.025, 0.005}) {
        double before = 1;
        for (Index m = 6; m <= 1000; ++m) {
            double const c = squares_line(m, tail);
            EXPECT_LT(c, before) << m;
            before = c;
            if (m % 2 == 0 && m < 120) {
                EXPECT_NEAR(tail_of_largest_excess(m / 2 - 1, c), tail, 1e-12) << m;
            }
            if (m % 2 == 0 && m >= 122) {
                EXPECT_GT(tail_of_largest_excess(m / 2 - 1, c - 1e-4), tail) << m;
                EXPECT_LT(tail_of_largest_excess(m / 2 - 1, c + 1e-4), tail) << m;
            }
        }
    }
    EXPECT_THROW(squares_line(3, 0.025), std::invalid_argument);
    EXPECT_THROW(squares_line(100, 0.05), std::invalid_argument);
}

/// N rows of d regressors, with this theta up to row `change` and `after` from there on.
Records record(std::uint64_t seed, Index N, Index change, Vector<double> const& theta, Vector<double> const& after) {
    Index const d = theta.size();
    Signal const x = white_noise(N * d, Seed{seed}), e = white_noise(N, Seed{seed + 50000});
    Records out{.psi = Matrix<double>(d, N), .y = Vector<double>(N), .names = {}};
    for (Index k = 0; k < N; ++k) {
        for (Index i = 0; i < d; ++i) out.psi(i, k) = i == 0 ? 1 : x[size_t(k * d + i)];
        out.y[k] = out.psi.col(k).dot(k < change ? theta : after) + e[size_t(k)];
    }
    return out;
}
std::vector<Index> counted(Index N) {
    std::vector<Index> out;
    for (Index k = 0; k < N; ++k) out.push_back(k);
    return out;
}
Vector<double> const theta{{1, -0.5, 2}};

/// Each w from a batch fit of the rows before; J is that of all rows.
TEST(Constancy, ResidualsAreThoseOfFitsOfTheRowsBefore) {
    constexpr Index N = 40, d = 3;
    Records const rows = record(1, N, N, theta, theta);
    Constancy const c = constancy(rows, counted(N), 0);
    ASSERT_EQ(c.residuals.size(), size_t(N - d));
    EXPECT_EQ(c.samples.front(), d);
    double J = 0;
    for (Index k = d; k < N; ++k) {
        Records const before{.psi = rows.psi.leftCols(k), .y = rows.y.head(k), .names = {}};
        Matrix<double> const M = before.psi * before.psi.transpose();
        Vector<double> const at = M.ldlt().solve(before.psi * before.y), psi = rows.psi.col(k);
        double const f = 1 + psi.dot(M.ldlt().solve(psi)), w = (rows.y[k] - psi.dot(at)) / std::sqrt(f);
        EXPECT_NEAR(c.residuals[size_t(k - d)], w, 1e-10) << k;
        J += w * w;
    }
    EXPECT_NEAR(J, fit(rows).J, 1e-10);
    EXPECT_NEAR(c.squares.value.back(), 1, 1e-15);
    double const m = N - d;
    EXPECT_NEAR(c.cusum.upper.front(), 0.948 * std::sqrt(m) * (1 + 2 / m), 1e-12);
    EXPECT_NEAR(c.cusum.upper.back(), 3 * 0.948 * std::sqrt(m), 1e-12);
    EXPECT_NEAR(c.squares.upper[9] - 10 / m, c.c0, 1e-15);
    EXPECT_NEAR(c.squares.lower[9] - 10 / m, -c.c0, 1e-15);
}
/// A regressor that is 0 at first determines theta later; nothing counts before.
TEST(Constancy, BeginsWhereTheRowsDetermineTheta) {
    Records rows = record(1, 40, 40, theta, theta);
    for (Index k = 0; k < 10; ++k) rows.psi(2, k) = 0;
    Constancy const c = constancy(rows, counted(40), 0);
    EXPECT_EQ(c.samples.front(), 11) << "row 10 is the first with all three";
    EXPECT_TRUE(constancy(record(1, 6, 6, theta, theta), counted(6), 0).samples.empty()) << "three residuals";
    EXPECT_FALSE(constancy(record(1, 7, 7, theta, theta), counted(7), 0).samples.empty());
    EXPECT_TRUE(constancy(record(1, 40, 40, theta, theta), counted(40), 1e9).samples.empty()) << "rounding alone";
    rows.y[20] = INFINITY;
    EXPECT_TRUE(constancy(rows, counted(40), 0).samples.empty());
}
TEST(Constancy, UnitsChangeNothing) {
    Records const rows = record(1, 60, 60, theta, theta);
    Constancy const c = constancy(rows, counted(60), 0);
    for (int const e : {-400, 400}) {
        Records scaled = rows;
        scaled.y *= std::ldexp(1, e);
        Constancy const of = constancy(scaled, counted(60), 0);
        EXPECT_EQ(of.cusum.value, c.cusum.value) << e;
        EXPECT_EQ(of.squares.value, c.squares.value) << e;
    }
}
/// Without a change about 5 % of the paths leave their lines, and with one nearly all. 2000 records of 120 rows: a
/// share of 0.05 has the standard deviation 0.005, and the budget is four of these. The line of the sum is approximate;
/// the squares are looked at in each row, while their line is exact for each second one.
TEST(Constancy, LeavesItsLinesAsOftenAsTheirLevelSays) {
    constexpr int trials = 2000;
    constexpr Index N = 120;
    int sum = 0, squares = 0, sum_surely = 0, squares_surely = 0;
    for (int i = 0; i < trials; ++i) {
        Constancy const c = constancy(record(std::uint64_t(i), N, N, theta, theta), counted(N), 0);
        sum += c.cusum.crosses.has_value(), squares += c.squares.crosses.has_value();
        sum_surely += c.cusum.surely, squares_surely += c.squares.surely;
    }
    EXPECT_GT(double(sum) / trials, 0.02);
    EXPECT_LT(double(sum) / trials, 0.05 + 4 * 0.005);
    EXPECT_GT(double(squares) / trials, 0.05 - 4 * 0.005);
    EXPECT_LT(double(squares) / trials, 0.05 + 4 * 0.005 + 0.01) << "each row, not each second one";
    EXPECT_LT(double(sum_surely) / trials, 0.01 + 4 * 0.0022);
    EXPECT_LT(double(squares_surely) / trials, 0.01 + 4 * 0.0022 + 0.003);
    int of_mean = 0, of_slope = 0, near = 0;
    for (int i = 0; i < 200; ++i) {
        Constancy const mean =
            constancy(record(std::uint64_t(i), N, 60, theta, theta + Vector<double>{{2, 0, 0}}), counted(N), 0);
        Constancy const slope =
            constancy(record(std::uint64_t(i), N, 60, theta, theta + Vector<double>{{0, 3, 0}}), counted(N), 0);
        of_mean += mean.cusum.surely, of_slope += slope.squares.surely;
        near += std::abs(slope.samples[size_t(slope.squares.farthest)] - 60) <= 5;
    }
    EXPECT_GT(of_mean, 190);
    EXPECT_GT(of_slope, 190);
    EXPECT_GT(near, 160) << "the row of the change";
}

class Changing : public Options {
protected:
    /// y[k] = a y[k-1] + u[k-1] + e, a = 0.5, and from sample `change` on 0.9; so many rows, with sd 0.1 of e.
    std::string changing(size_t change) const {
        Signal const u = white_noise(600, Seed{1}), e = white_noise(600, Seed{2});
        Signal y(600, 0.0);
        for (size_t k = 1; k < 600; ++k) y[k] = (k < change ? 0.5 : 0.9) * y[k - 1] + u[k - 1] + 0.1 * e[k];
        return folder.file(csv({u, y}, "u,y"), "changing.csv");
    }
    IdentifyOptions const options{.inputs = {"u"}, .output = "y", .order = 1, .sample_time = 0.5};
};
TEST_F(Changing, IsARemarkWithTheRowAndTheNextStep) {
    Identified const m = identify::identify(changing(200), options);
    ASSERT_TRUE(m.constancy.squares.surely);
    Index const row = m.constancy.samples[size_t(m.constancy.squares.farthest)] + 1;
    EXPECT_NEAR(double(row), 201, 10);
    EXPECT_THAT(m.remarks,
                Contains(Says(Remark::Rank::constancy, fmt::format("parameters row {} {:.4g} --window --forgetting",
                                                                   row, 0.5 * double(row - 1)))));
    std::string const crossing = fmt::format("row {}", m.constancy.samples[size_t(*m.constancy.squares.crosses)] + 1);
    EXPECT_THAT(as_table(m), HasSubstr(crossing));
    EXPECT_THAT(as_page(m), HasSubstr("crosses at " + crossing));
    json const out = json::parse(as_json(m))["constancy"];
    EXPECT_EQ(out["cusum_of_squares"]["farthest_at_row"], row);
    EXPECT_EQ(out["cusum_of_squares"]["value"], json(m.constancy.squares.value));
    EXPECT_EQ(out["cusum"]["high"], json(m.constancy.cusum.upper));
    EXPECT_EQ(out["rows"].size(), out["recursive_residuals"].size());
}
TEST_F(Changing, NotWithoutAChangeOrWithForgetting) {
    auto const remarks = [&](size_t change, double lambda) {
        IdentifyOptions o = options;
        o.forgetting = lambda;
        return identify::identify(changing(change), o).remarks;
    };
    auto const any = testing::Field(&Remark::rank, Remark::Rank::constancy);
    EXPECT_THAT(remarks(600, 1), Not(Contains(any)));
    EXPECT_THAT(remarks(200, 0.98), Not(Contains(any)));
}
/// Nothing is left beyond rounding: no verdict, no line, no figure.
TEST_F(Changing, WithoutNoiseThereIsNoVerdict) {
    Signal const u = prbs(6, 100),
                 y = simulate({.a = {-0.5}, .b = {{0, 2}}, .delay = 0, .c = 0}, {u}, Signal(100, 0.0));
    Identified const m = identify::identify(folder.file(csv({u, y}, "u,y"), "clean.csv"), options);
    EXPECT_TRUE(m.constancy.samples.empty());
    EXPECT_TRUE(json::parse(as_json(m))["constancy"].is_null());
    EXPECT_THAT(as_table(m), Not(HasSubstr("constancy")));
    EXPECT_THAT(as_page(m), Not(HasSubstr("figure id=\"constancy\"")));
}

}  // namespace
}  // namespace rlslab
