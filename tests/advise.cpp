// What `advise` promises holds on the record: looked at by other means than those it was found by.
#include "advise/advise.hpp"
#include "catalogue/catalogue.hpp"
#include "tests/program.hpp"

#include <rlslab/reference/certified.hpp>

namespace rlslab {
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

/// Digits of the worst parameter of the advised filter, run here over the rows backwards too, against the certified least squares.
double digits_backwards(Advice const& advice, Records records, bool backwards) {
    if (backwards) {
        records.psi = records.psi.rowwise().reverse().eval();
        records.y = records.y.reverse().eval();
    }
    Comparison const& c = advice.chosen()->comparison;
    auto const filter = advice.choice()->entry->make(
        {.size = records.parameters(), .forgetting = c.options.forgetting, .prior = c.scaled_prior->prior()}, Seed{1});
    for (Index k = 0; k < records.rows(); ++k) filter->update(records.sample(k), records.y[k]);
    return certified({.size = records.parameters(), .forgetting = c.options.forgetting, .prior = std::nullopt}, records, {records.rows()})
        .front()
        .theta_digits_worst(filter->theta());
}

TEST(Advise, KeepsTheDigitsItPromises) {
    for (std::uint64_t const seed : {401, 402, 403})
        for (double const digits : {2.0, 3.5, 9.0}) {
            Records const rows = record(200, {1, 100, 0.01, 3}, 0.1, Seed{seed});
            Advice const advice = advise(rows, {.digits = digits});
            ASSERT_TRUE(advice.chosen()) << digits;
            EXPECT_GE(kept(*advice.chosen(), *advice.choice()), digits);
            EXPECT_GE(digits_backwards(advice, rows, false), digits - 0.05) << seed << " " << advice.choice()->entry->variant;
            EXPECT_GE(digits_backwards(advice, rows, true), digits - 0.5) << "an order that was not tried";
            EXPECT_EQ(advice.choice()->entry->arithmetic->name, digits < 5 ? "float" : "double") << digits;
            ASSERT_TRUE(advice.guard);
            EXPECT_EQ(advice.guard->counts.rows, 200);
            EXPECT_TRUE(advice.guard->same_bits) << "clean data";
        }
}

TEST(Advise, WeakensThePriorUntilItLeavesTheDigits) {
    Records const rows = record(60, {1, 1}, 0.5, Seed{404});
    Advice const few = advise(rows, {.digits = 1}), many = advise(rows, {.digits = 10});
    EXPECT_LT(few.chosen()->comparison.scaled_prior->c, many.chosen()->comparison.scaled_prior->c);
    EXPECT_GE(many.chosen()->from_prior, 10);
    EXPECT_LT(few.chosen()->from_prior, 10) << "and no more than it has to";
}

TEST(Advise, SaysThatNothingDoesAndWhatIsInTheWay) {
    Records const rows = record(100, {1, 1, 1}, 0.1, Seed{405});
    Advice const none = advise(rows, {.digits = 20});
    EXPECT_FALSE(none.chosen());
    EXPECT_FALSE(none.choice());
    std::string const text = as_text(none, false);
    EXPECT_THAT(text, HasSubstr("nothing tried keeps them"));
    EXPECT_THAT(text, HasSubstr("float: at most "));
    EXPECT_THAT(text, HasSubstr("double: at most 1"));
    EXPECT_THAT(text, Not(HasSubstr("filter(")));
}

/// binary16 ends at 65504: the columns are scaled where they have to be, and not where they need not.
TEST(Advise, ScalesColumnsWhereTheRangeIsInTheWay) {
    AdviseOptions const half{.digits = 0.5, .arithmetics = {"binary16"}};
    Advice const large = advise(record(200, {1e6, 1e-7}, 0.05, Seed{406}), half), fit = advise(record(200, {1, 1}, 0.05, Seed{406}), half);
    ASSERT_TRUE(large.chosen());
    ASSERT_EQ(large.chosen()->scaling.size(), 2);
    EXPECT_EQ(std::ldexp(1.0, std::ilogb(large.chosen()->scaling[0])), large.chosen()->scaling[0]) << "a power of two";
    ASSERT_TRUE(fit.chosen());
    EXPECT_EQ(fit.chosen()->scaling.size(), 0);
}

TEST_F(Program, AdvisesInTextAndJsonWithCodeThatSaysSo) {
    std::string const words = " --input lead --output sales --order 2 --detrend ";
    fs::copy_file(root + "/data/sales.csv", folder / "sales.csv");
    Outcome const text = shell("rlslab advise sales.csv" + words + "--digits 2"),
                  json = shell("rlslab advise sales.csv" + words + "--digits 2 --json");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("use "));
    EXPECT_THAT(text.out, HasSubstr("filter({.size = 5"));
    EXPECT_EQ(json.code, 0);
    EXPECT_THAT(json.out, HasSubstr("\"advice\": {"));
    EXPECT_EQ(shell("rlslab advise sales.csv" + words + "--digits 25").code, 1);
    refused("advise sales.csv" + words + "--digits 0", "--digits: expected a number from 0.5 to 30");
    refused("advise sales.csv" + words + "--arithmetic flaot", "did you mean \"float\"?");
    refused("advise sales.csv --output sales", "--input: expected");
}

}  // namespace
}  // namespace rlslab
