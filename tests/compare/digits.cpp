// What `compare --digits N` promises holds on the record: looked at by other means than those it was found by.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/compare/digits_answer.hpp"
#include "tests/common/program.hpp"

#include <rlslab/reference/certified.hpp>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

using testing::HasSubstr;
using testing::Not;

Records record(Index rows, std::vector<double> const& sizes, double noise, Seed seed) {
    Records out{.psi = Matrix<double>(Index(sizes.size()), rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        double y = noise * seed.bell();
        for (Index i = 0; i < out.parameters(); ++i) {
            double const x = seed.bell();
            out.psi(i, k) = sizes[size_t(i)] * x;
            y += x * double(i + 1);
        }
        out.y[k] = y;
    }
    for (size_t i = 0; i < sizes.size(); ++i) out.names.push_back("p" + std::to_string(i));
    return out;
}

/// In float and double, unless others are named.
DigitsAnswer answered(Records const& records, CompareOptions options) {
    if (options.arithmetics.empty()) options.arithmetics = {"float", "double"};
    return digits_answer(records, options);
}

/// Digits of the worst parameter of the filter in the answer, run here, against the certified least squares of the data
/// as given.
double digits_of(DigitsAnswer const& answer, Records const& records, bool backwards = false) {
    ArithmeticTrial const& t = *answer.chosen();
    Records taken = records;
    for (Index i = 0; i < records.parameters() && !t.exponents.empty(); ++i)
        for (Index k = 0; k < records.rows(); ++k)
            taken.psi(i, k) = std::ldexp(taken.psi(i, k), t.exponents[size_t(i)]);
    for (double& y : taken.y) y = std::ldexp(y, t.output_exponent);
    if (backwards) taken.psi = taken.psi.rowwise().reverse().eval(), taken.y = taken.y.reverse().eval();
    double const lambda = t.comparison.options.forgetting;
    auto const filter = answer.choice()->result->entry->make(
        {.size = taken.parameters(), .forgetting = lambda, .prior = t.comparison.scaled_prior->prior()}, Seed{1});
    for (Index k = 0; k < taken.rows(); ++k) filter->update(taken.sample(k), taken.y[k]);
    Vector<Reference> theta = filter->theta();  // of the columns as given
    for (Index i = 0; i < theta.size() && !t.exponents.empty(); ++i)
        theta[i] = ldexp(theta[i], t.exponents[size_t(i)] - t.output_exponent);
    return certified({.size = records.parameters(), .forgetting = lambda, .prior = std::nullopt}, records,
                     {records.rows()})
        .front()
        .theta_digits_worst(theta);
}

TEST(Digits, KeepsTheDigitsItPromises) {
    for (std::uint64_t const seed : {401, 402, 403})
        for (double const lambda : {1.0, 0.97})
            for (double const digits : {2.0, 3.5, 9.0}) {
                Records const rows = record(200, {1, 100, 0.01, 3}, 0.1, Seed{seed});
                DigitsAnswer const answer = answered(rows, {.forgetting = lambda, .digits = digits});
                ASSERT_TRUE(answer.chosen()) << digits;
                EXPECT_GE(answer.choice()->both(), digits);
                EXPECT_GE(digits_of(answer, rows), answer.choice()->at_end - 1e-9)
                    << seed << " " << answer.choice()->result->entry->variant;
                if (lambda == 1) {
                    EXPECT_GE(digits_of(answer, rows, true), digits - 0.5) << "an order that was not tried";
                }
                EXPECT_EQ(answer.chosen()->arithmetic, digits < 5 ? "float" : "double") << digits;
                ASSERT_TRUE(answer.guard);
                EXPECT_TRUE(answer.guard->same_bits) << "clean data";
            }
}

/// Four rows that determine b badly: what rounding them to float leaves of theta is no bound on what it leaves of b.
TEST(Digits, CountsTheWorstParameterOfTheDataAsGiven) {
    Records rows{.psi = Matrix<double>(2, 4), .y = Vector<double>(4), .names = {"a", "b"}};
    rows.psi << 0.1, 0.1, 0.1, 0.1, 0.7, -0.3, 0.7, -0.3;
    rows.y << 28306.873330732666, 28305.852155336153, 28306.85646161058, 28305.86612982623;
    DigitsAnswer const answer = answered(rows, {.arithmetics = {"float"}});
    if (answer.chosen()) {
        EXPECT_GE(digits_of(answer, rows), 3);
    }
    for (KeptDigits const& k : answer.trials.back().sound)
        EXPECT_LE(k.at_end, 3.2) << k.result->entry->variant << ": the data leave 2.97";
}

TEST(Digits, WeakensThePriorUntilItLeavesTheDigitsAndNoFurtherThanTheArithmeticGoes) {
    Records const rows = record(60, {1, 1}, 0.5, Seed{404});
    DigitsAnswer const few = answered(rows, {.digits = 1}), many = answered(rows, {.digits = 10});
    EXPECT_LT(few.chosen()->comparison.scaled_prior->c, many.chosen()->comparison.scaled_prior->c);
    for (char const* arithmetic : {"binary16", "bfloat16", "float"}) {
        DigitsAnswer const none = answered(rows, {.arithmetics = {arithmetic}, .digits = 30});
        EXPECT_FALSE(none.chosen());
        EXPECT_TRUE(none.trials.front().in_range) << arithmetic << ": c is not doubled beyond the range";
        EXPECT_TRUE(none.trials.front().most()) << arithmetic << ": nor does a digit too many break all";
    }
}

TEST(Digits, SaysThatNothingDoes) {
    Records const rows = record(100, {1, 1, 1}, 0.1, Seed{405});
    DigitsAnswer const none = answered(rows, {.digits = 20});
    EXPECT_FALSE(none.chosen());
    EXPECT_FALSE(none.choice());
    std::string const text = answer_text(none, false);
    EXPECT_THAT(text, Names("nothing"));
    EXPECT_THAT(text, HasSubstr("\nfloat: "));
    EXPECT_THAT(text, HasSubstr("\ndouble: "));
    EXPECT_THAT(text, Not(HasSubstr("filter(")));
    EXPECT_THROW(answered(rows, {.arithmetics = {"float", "flaot"}}), InputError);
    EXPECT_EQ(answered(rows, {.arithmetics = {"float", "float"}, .digits = 20}).trials.size(), 1u)
        << "named twice is tried once";
}

/// A parameter that is exactly zero has no digits; the others do.
TEST(Digits, LeavesOutAParameterThatIsZero) {
    Records rows = record(50, {1, 1, 1}, 0, Seed{407});
    rows.psi = rows.psi.unaryExpr([](double x) { return std::round(64 * x); }).eval();
    rows.y = (rows.psi.row(0) + 2 * rows.psi.row(1)).transpose();
    DigitsAnswer const answer = answered(rows, {});
    ASSERT_TRUE(answer.chosen());
    EXPECT_EQ(answer.chosen()->is_zero, (std::vector<bool>{false, false, true}));
    EXPECT_THAT(answer_text(answer, false), Names("p2 zero"));
}

/// Numbers near the ends of an arithmetic are scaled by powers of two; others are left alone.
TEST(Digits, ScalesColumnsWhereTheRangeIsInTheWay) {
    struct {
        std::vector<double> sizes;
        double output;
        std::vector<std::string> arithmetic;
        bool scaled;
    } const cases[] = {{{1e6, 1e-7}, 1, {"binary16"}, true},   {{3, 1, 0.3, 0.1}, 1, {"binary16"}, true},
                       {{1, 1}, 1, {"binary16"}, false},       {{1, 1}, 1e-42, {"float"}, true},
                       {{0x1p70, 1}, 0x1p70, {"float"}, true}, {{1, 1000}, 1, {"float"}, false},
                       {{0x1p-505, 1}, 1, {"double"}, true},   {{0x1p400, 1}, 1, {"double"}, true},
                       {{1e30, 1}, 1, {"double"}, false}};
    for (auto const& [sizes, output, arithmetic, scaled] : cases) {
        Records rows = record(200, sizes, 0.05, Seed{406});
        rows.y *= output;
        DigitsAnswer const answer = answered(rows, {.arithmetics = arithmetic, .digits = 0.5});
        ASSERT_TRUE(answer.chosen()) << arithmetic[0] << answer_text(answer, false);
        EXPECT_EQ(!answer.chosen()->exponents.empty(), scaled) << arithmetic[0];
        EXPECT_GE(digits_of(answer, rows), 0.5);
        if (answer.guard) {
            EXPECT_EQ(answer.guard->counts.unusable, 0);
        }
    }
}

/// Two outliers that a guard keeps out while they matter, and that lambda has forgotten by the last row.
TEST(Digits, KeepsTheGuardWhereItWorked) {
    Records rows = record(300, {1, 1}, 0.1, Seed{408});
    rows.y[150] += 500;
    rows.y[200] += 500;
    DigitsAnswer const answer = answered(rows, {.forgetting = 0.5});
    ASSERT_TRUE(answer.guard);
    EXPECT_EQ(answer.guard->counts.outliers, 2);
    EXPECT_FALSE(answer.guard->same_bits);
    EXPECT_THAT(answer_text(answer, false), HasSubstr("rlslab::Guarded<"));
    EXPECT_THAT(answer_text(answer, false), HasSubstr("2 outliers")) << "and what it did";
}

/// One rule for "use this": the first that keeps the digits, in the order of compare's recommendation for so many.
TEST(Digits, AreKeptByWhatCompareWouldRecommend) {
    Records const rows = record(200, {1, 100, 0.01, 3}, 0.1, Seed{409});
    for (double const digits : {2.0, 4.5, 9.0}) {
        DigitsAnswer const answer = answered(rows, {.digits = digits});
        ASSERT_TRUE(answer.chosen());
        ArithmeticTrial const& t = *answer.chosen();
        for (KeptDigits const* k = t.sound.data(); k != answer.choice(); ++k) EXPECT_LT(k->both(), digits);
        EXPECT_EQ(t.comparison.recommendations.front().variant, t.sound.front().result->entry->variant);
    }
}

/// Of all arithmetics the shortest that keeps them; a variant that exists in one arithmetic alone is tried there alone.
TEST(Digits, TryEveryArithmeticTheShortestFirst) {
    Records const rows = record(100, {1, 1}, 0.1, Seed{410});
    DigitsAnswer const all = digits_answer(rows, {.variants = {"ud"}, .digits = 9});
    ASSERT_TRUE(all.chosen());
    EXPECT_EQ(all.chosen()->arithmetic, "double");
    EXPECT_GE(all.trials.size(), 6u);
    EXPECT_EQ(all.choice()->result->entry->variant, "ud");
}

TEST_F(Program, AnswersDigitsInTextAndJsonWithCodeThatSaysSo) {
    std::string const words = " --input lead --output sales --order 2 --detrend ";
    fs::copy_file(root + "/studies/data/sales.csv", folder / "sales.csv");
    Outcome const text = shell("rlslab compare sales.csv" + words + "--digits 2"),
                  json = shell("rlslab compare sales.csv" + words + "--digits 2 --json");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("use "));
    EXPECT_THAT(text.out, HasSubstr("filter({.size = 5"));
    EXPECT_EQ(json.code, 0);
    EXPECT_THAT(json.out, HasSubstr("\"advice\": {"));
    EXPECT_THAT(json.out, HasSubstr("\n  \"results\": ["));
    EXPECT_THAT(text.out, Not(HasSubstr("\nin float  "))) << "one answer";
    EXPECT_THAT(text.out, HasSubstr("float, of 7.2"));
    EXPECT_EQ(std::count(text.out.begin(), text.out.end(), '*'), 1) << "the row of the answer";
    EXPECT_EQ(shell("rlslab compare sales.csv" + words + "--digits 25").code, 1);
    write("wide.csv", "a,y\n" + rows(40, [](int k) { return std::to_string(k * 5 % 13) + "e30"; }));
    Outcome const wide =
        shell("rlslab compare wide.csv --regressors a --output y --arithmetic float --detrend --digits 2");
    EXPECT_THAT(wide.out, HasSubstr("// then each regressor times (2^-1"));
    EXPECT_LT(wide.out.find("// the columns as the filter takes them"), wide.out.find("// then each regressor times"))
        << "means first";
    EXPECT_THAT(shell("rlslab compare ok.csv --regressors u --output y --arithmetic binary16 --digits 1").out,
                Not(HasSubstr("filter(")));
}

}  // namespace
}  // namespace rlslab
