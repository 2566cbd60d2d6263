// compare judges the record in its own order: a plant at rest when the filter is switched on, draws of the roundings,
// and rows whose sums are exact.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/prior_law.hpp"
#include "src/lab/compare/words.hpp"
#include "tests/common/message.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/input/csv.hpp>
#include <rlslab/model/regression.hpp>

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>
#include <tuple>

namespace rlslab {
using namespace compare;
namespace {

using testing::HasSubstr;
using testing::Not;

/// Four taps of an input that stands at 1 but for 1e-6 for 50 rows, then is white. Noise 1.
Records at_rest(Seed seed, double jitter = 1e-6, Index rows = 1000) {
    Records out{.psi = Matrix<double>::Zero(4, rows), .y = Vector<double>(rows), .names = {"b0", "b1", "b2", "b3"}};
    std::vector<double> u;
    for (Index k = -3; k < rows; ++k) {
        double const w = seed.bell();
        u.push_back(k < 50 ? 1 + jitter * w : w);
    }
    for (Index k = 0; k < rows; ++k) {
        double sum = seed.bell();
        for (Index i = 0; i < 4; ++i) {
            out.psi(i, k) = u[size_t(k + 3 - i)];
            sum += double(i + 1) * out.psi(i, k);
        }
        out.y[k] = sum;
    }
    return out;
}

Comparison compared(Records const& r, std::optional<double> p0, std::vector<std::string> const& variants,
                    double forgetting = 1, std::string const& arithmetic = "double") {
    Comparison c = compare::compare(
        r, {.forgetting = forgetting, .p0 = p0, .variants = variants, .arithmetics = {arithmetic}, .timings = false});
    c.start_costs = start_costs(r, c);
    return c;
}
Result const& of(Comparison const& c, std::string_view variant) {
    return *std::ranges::find_if(c.results, [&](Result const& r) { return r.entry->variant == variant; });
}
std::string named(Comparison const& c) { return c.recommendations.front().variant; }

TEST(OwnOrder, APlantAtRestIsNotJudgedByShuffledRows) {
    for (std::uint64_t const seed : {3, 5, 11})
        for (double const p0 : {1e8, 1e12}) {
            Comparison const c = compared(at_rest(Seed{seed}), p0, {"ud_delta", "gentleman"});
            EXPECT_EQ(named(c), "gentleman") << seed << " " << p0;
            Result const &delta = of(c, "ud_delta"), &gentleman = of(c, "gentleman");
            EXPECT_GE(gentleman.spread->theta.low, 14) << "in the record's order";
            EXPECT_LE(delta.spread->theta.low, p0 == 1e8 ? 14.2 : 12.5) << "in the record's order";
            ASSERT_TRUE(delta.others.spread);
            EXPECT_EQ(delta.others.runs, 3);
            EXPECT_GE(delta.others.spread->theta.median, 14.5) << "where the white rows come first";
            std::string const beside = other_orders_text(c, "double");
            EXPECT_THAT(beside, HasSubstr("reordered, double: gentleman "));
            EXPECT_THAT(beside, HasSubstr("ud_delta"));
            Spread const& spread = delta.others.spread->theta;
            EXPECT_THAT(as_page(c), HasSubstr(fmt::format("<td>{} ({} to {})</td>", tenths(spread.median),
                                                          tenths(spread.low), tenths(spread.high))));
            EXPECT_THAT(as_page(c), HasSubstr("In 3 other orders of the rows:"));
        }
}

TEST(OwnOrder, ThetaBeyondBinary64IsPrintedWithSixDigits) {
    Comparison c = compared(at_rest(Seed{3}), 1e8, {"ud_delta"});
    c.least_squares = {"1.23456789012345678901234567890e+400", "-9.99999999999999999999999999999e-321", "0", "nan"};
    std::string const text = as_table(c, false);
    for (char const* printed : {" 1.23457e+400 ", " -1e-320 ", " 0 ", " nan "}) EXPECT_THAT(text, HasSubstr(printed));
    EXPECT_THAT(text, Not(HasSubstr("1.234567")));
}

/// No constant is fitted: docs/theory.md 105. One run scatters by tenths of a digit, so that five are averaged.
TEST(OwnOrder, WhatTheStartCostsIsForetold) {
    for (double const p0 : {0x1p14, 1e8, 1e12}) {
        double apart = 0;
        bool const costs = p0 != 0x1p14;
        for (std::uint64_t const seed : {3, 5, 11, 12, 13}) {
            Comparison const c = compared(at_rest(Seed{seed}), p0, {"ud_delta"});
            ASSERT_EQ(c.start_costs.size(), 1u);
            StartCost const& cost = c.start_costs.front();
            apart += (cost.digits - *of(c, "ud_delta").last.theta) / 5;
            if (p0 == 1e8) continue;  // half a digit to one and a half
            EXPECT_EQ(cost.loss > 0.5, costs) << cost.loss;
            EXPECT_EQ(!start_cost_text(c).empty(), costs);
            EXPECT_EQ(cost.best_c2.has_value(), costs);
            if (!costs) continue;
            EXPECT_THAT(warnings(c), testing::Contains(start_cost_text(c)));
            EXPECT_THAT(start_cost_text(c), Names("double digits theta qr gentleman deviations noise"));
        }
        EXPECT_NEAR(apart, 0, 0.5) << p0;
    }
    EXPECT_TRUE(compared(at_rest(Seed{3}), 1e12, {"ud_delta"}, 0.99).start_costs.empty()) << "a law for lambda = 1";
}

// --- draws -----------------------------------------------------------------------------------------------------------

TEST(Draws, HaveTheSameThetaAndOtherRoundings) {
    Records const r = at_rest(Seed{1}, 1, 100);
    std::set<double> first;
    for (size_t i = 0; i < 16; ++i) {
        Records const one = drawn(r, i);
        double const factor = one.psi(0, 0) / r.psi(0, 0);
        first.insert(factor);
        EXPECT_TRUE(i == 0 ? factor == 1 : (factor < 1 && factor > 0.8)) << factor;
        EXPECT_NEAR(std::ldexp(factor, 7), std::round(std::ldexp(factor, 7)), 1e-9) << "seven bits";
        EXPECT_NEAR(one.y[7] / r.y[7], factor, 1e-15);
    }
    EXPECT_EQ(first.size(), 16u);
}
TEST(Draws, AreFewerForLongRecords) {
    for (auto const& [rows, most] : {std::pair<Index, size_t>{1, 16}, {1 << 13, 16}, {1 << 15, 4}, {(1 << 16) + 1, 1}})
        EXPECT_EQ(most_draws(rows), most);
    EXPECT_EQ(most_draws(1, {.composition = {.window = 9}}), 1u);
}
TEST(Draws, AreTakenUntilWhatIsNamedIsClear) {
    for (double const lambda : {1.0, 0.98}) {
        Comparison const far = compared(at_rest(Seed{2}, 1, 300), {}, {"conventional", "ud"}, lambda);
        EXPECT_EQ(named(far), "ud");
        EXPECT_EQ(of(far, "ud").runs, 4) << "digits apart: no more are needed";
        Comparison const near = compared(at_rest(Seed{2}, 1, 300), {}, {}, lambda);
        for (Result const& r : near.results)
            if (r.entry->block == 1 && r.operations) {
                EXPECT_TRUE(r.runs == 1 || r.runs % 4 == 0) << r.runs;
            }
        EXPECT_EQ(of(near, named(near)).ends.size(), size_t(of(near, named(near)).runs) + (lambda == 1 ? 3 : 0));
    }
}
/// Four runs each, of medians a and b in turn.
TEST(Draws, AreSettledWhereTheMeanLackAndTwoErrorsAreHalfADigit) {
    auto const runs_with = [](std::vector<double> const& digits) {
        Runs out;
        for (double const x : digits)
            out.own.push_back({.digits = {{x, x, x}}, .factor = true, .theta = Vector<Reference>(1)});
        return out;
    };
    CatalogueEntry const &ud = *find_entry("ud"), &qr = *find_entry("qr");
    auto const result = [](CatalogueEntry const& e, double median) {
        Spread const one{median, median, median};
        return Result{.entry = &e, .spread = PerMeasure<Spread>{one, one, one}, .operations = 1};
    };
    Result const a = result(ud, 10), b = result(qr, 10.3);
    Runs const one = runs_with({10, 10, 10, 10}), near = runs_with({10.3, 10.4, 10.2, 10.3}),
               wide = runs_with({10.9, 9.9, 10.3, 10.1});
    EXPECT_TRUE(settled({&a, &b}, {&one, &near}, {2}, "ud", ""));
    EXPECT_FALSE(settled({&a, &b}, {&one, &wide}, {2}, "ud", "")) << "0.3 +- 0.5";
    EXPECT_TRUE(settled({&a, &b}, {&one, &wide}, {2}, "ud", "ud")) << "named twice";
    EXPECT_TRUE(settled({&a, &b}, {&one, &wide}, {2}, "", "")) << "none is named";
}

// --- exact sums ------------------------------------------------------------------------------------------------------

/// Whole numbers from 0 to 2^bits - 1, and y of them.
Records counts(Index rows, int bits, Seed seed, Index d = 4) {
    Records out{.psi = Matrix<double>(d, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        double sum = 0;
        for (Index i = 0; i < d; ++i) {
            out.psi(i, k) = std::floor(std::ldexp(seed.uniform(), bits));
            sum += (i % 2 ? -0.5 : 0.7) * out.psi(i, k);
        }
        out.y[k] = std::round(sum + seed.bell());
    }
    return out;
}
std::optional<Index> rows_in(Records const& r, std::string_view arithmetic, double P0 = 0x1p14, double lambda = 1) {
    return exact_rows(r, {.size = r.parameters(), .forgetting = lambda, .prior = Prior<double>{.variance = P0}},
                      *std::ranges::find(arithmetics(), arithmetic, &Arithmetic::name));
}

TEST(ExactSums, HaveTheBoundOnRows) {
    Records signs = counts(100, 1, Seed{1});
    for (double& x : signs.psi.reshaped()) x = 2 * x - 1;
    for (Index k = 0; k < 100; ++k) signs.y[k] = signs.psi(0, k);
    // 2^24 sums of 1 in units of 1, and 2^10 in units of the prior's 2^-14
    EXPECT_EQ(rows_in(signs, "float", 1), Index(1 << 24) - 1);
    EXPECT_EQ(rows_in(signs, "float"), Index(1 << 10) - 1);
    EXPECT_EQ(rows_in(signs, "float", 3), std::nullopt) << "1/3 is no power of two";
    EXPECT_EQ(rows_in(signs, "float", 1, 0.99), std::nullopt);
    EXPECT_EQ(rows_in(signs, "bfloat16", 1), Index(1 << 8) - 1);
    EXPECT_EQ(rows_in(signs, "bfloat16-stochastic", 1), std::nullopt);
    Records adc = counts(200, 12, Seed{2});
    adc.psi(0, 7) = 4095, adc.psi(1, 8) = 4095, adc.psi(2, 9) = 4095, adc.psi(3, 10) = 4095;
    Index const bound = rows_in(adc, "double", 1).value_or(0);
    double const y = std::max(4095.0, adc.y.cwiseAbs().maxCoeff());
    EXPECT_NEAR(double(bound) * 4095 * y, 0x1p53, 0x1p53 * 1e-6);
    EXPECT_EQ(rows_in(adc, "float", 1), std::nullopt) << "24 bits a product";
    adc.psi(2, 3) += 0x1p-20;
    EXPECT_EQ(rows_in(adc, "double", 1), std::nullopt) << "20 bits more, twice";
}
/// The bound is right: P is that of the exact normal equations, to the last bit, and is not where it does not hold.
TEST(ExactSums, LeaveInformationWithoutAnError) {
    for (bool const exact : {true, false}) {
        Records r = counts(3000, 12, Seed{3});
        if (!exact) r.psi.row(1) /= 3;
        Comparison const c = compared(r, {}, {"information", "ud_delta", "ud", "gentleman"});
        EXPECT_EQ(c.exact.size(), size_t(exact));
        Spread const P = of(c, "information").spread->covariance;
        if (exact) {
            EXPECT_EQ(P.low, 16.0);
            EXPECT_EQ(named(c), "information");
            EXPECT_GE(c.recommendations.front().exact_rows, 1 << 20);
            EXPECT_THAT(verdict(c), Names("information exact rows"));
        } else {
            EXPECT_LT(P.low, 15.8);
            EXPECT_EQ(c.recommendations.front().exact_rows, 0);
        }
    }
}

// --- steadiness: the recommendation on real records hardly depends on the last row. When lambda or the length of the
// record changes a little, the variant that was recommended before stays within a digit of the one that is now, or the
// spread printed shows why. -------------------------------------------------------------------------------------------

struct Source {
    char const *file, *input, *output;
    int order;
};

Comparison compared(Records const& all, Index rows, double lambda) {
    Records const some{.psi = all.psi.leftCols(rows), .y = all.y.head(rows), .names = all.names};
    return compare::compare(some, {.forgetting = lambda, .arithmetics = {"float", "double"}, .timings = false});
}
Result const& result_of(Comparison const& c, std::string const& arithmetic, std::string const& variant) {
    return *std::ranges::find_if(c.results, [&](Result const& r) {
        return r.entry->arithmetic->name == arithmetic && r.entry->variant == variant;
    });
}
double loss(Comparison const& c, std::string const& arithmetic, std::string const& variant) {
    std::vector<Result const*> sound;
    for (Result const& r : c.results)
        if (r.entry->arithmetic->name == arithmetic && takes_single_rows(r) && is_sound(r)) sound.push_back(&r);
    return loss_of(result_of(c, arithmetic, variant), sound).digits;
}
/// Whether the printed spreads of the two variants lie apart in one of the three measures, or one of them broke down.
bool told_apart(Comparison const& c, std::string const& arithmetic, std::string const& a, std::string const& b) {
    Result const &x = result_of(c, arithmetic, a), &y = result_of(c, arithmetic, b);
    if (x.broken > 0 || y.broken > 0 || !x.spread || !y.spread) return x.broken + y.broken > 0;
    return std::ranges::any_of(PerMeasure<Spread>::all(), [&](auto const m) {
        return ((*x.spread).*m).high < ((*y.spread).*m).low || ((*y.spread).*m).high < ((*x.spread).*m).low;
    });
}
void expect_steady(Comparison const& one, Comparison const& other, std::string const& what) {
    for (size_t i = 0; i < one.recommendations.size(); ++i) {
        auto const& [arithmetic, before] = std::tie(one.recommendations[i].arithmetic, one.recommendations[i].variant);
        std::string const& now = other.recommendations[i].variant;
        EXPECT_TRUE(arithmetic != "double" || !before.empty()) << what;
        if (before == now || before.empty() || now.empty() || told_apart(one, arithmetic, before, now) ||
            told_apart(other, arithmetic, before, now))
            continue;
        // A digit: from low to high the spreads are about as wide, and such a part of it their medians move.
        EXPECT_LT(loss(other, arithmetic, before) - loss(other, arithmetic, now), 0.95)
            << what << ": in " << arithmetic << " " << before << ", then " << now
            << ", and the spread does not show why";
    }
}

class Steadiness : public testing::TestWithParam<Source> {
protected:
    Records record;
    void SetUp() override {
        auto const& [file, input, output, order] = GetParam();
        std::string const path = std::string(RLSLAB_SOURCE_DIR "/") + file;
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "left out: " << file << " is not here";
        record = arx_records(read_columns(path, {input, output}), input, output, arx_of_order(order));
    }
};
TEST_P(Steadiness, InStepsOfFiveThousandthsInLambdaAndOverOnePercentOfTheRecord) {
    Index const rows = record.rows();
    std::optional<Comparison> before;
    for (double const lambda : {0.97, 0.975, 0.98, 0.985, 0.99, 0.995, 1.0}) {
        Comparison now = compared(record, rows, lambda);
        std::string const what = fmt::format("lambda = {}", lambda);
        if (before) expect_steady(*before, now, what);
        for (double const part : {0.99, 0.998})
            if (lambda == 0.98 || lambda == 1)
                expect_steady(now, compared(record, Index(part * double(rows)), lambda),
                              fmt::format("{}, {} of {} rows", what, part, rows));
        before = std::move(now);
    }
}
INSTANTIATE_TEST_SUITE_P(Records, Steadiness,
                         testing::Values(Source{"studies/data/sales.csv", "lead", "sales", 2},
                                         Source{"../shared/data/gas_furnace.csv", "u", "y", 4},
                                         Source{"../shared/data/hair_dryer.csv", "u", "y", 4},
                                         Source{"../shared/data/heat_exchanger.csv", "u", "y", 2}),
                         [](auto const& source) { return std::filesystem::path(source.param.file).stem().string(); });

}  // namespace
}  // namespace rlslab
