// The table of fast forms: where the regressors are a delay line, and only there.
#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/fast_score.hpp"
#include <rlslab/core/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab::compare {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// d samples of white noise, the newest first; the first line is full. y is their sum and noise.
Records line_of(Index d, Index rows, double scale = 1) {
    Seed seed{3};
    Records out{.psi = Matrix<double>(d, rows), .y = Vector<double>(rows), .names = {}};
    std::vector<double> u;
    for (Index k = 0; k < rows + d; ++k) u.push_back(scale * seed.bell());
    for (Index i = 0; i < d; ++i) out.names.push_back("b" + std::to_string(i));
    for (Index k = 0; k < rows; ++k) {
        for (Index i = 0; i < d; ++i) out.psi(i, k) = u[size_t(k + d - i)];
        out.y[k] = out.psi.col(k).sum() + 0.1 * scale * seed.bell();
    }
    return out;
}
CompareOptions options(double forgetting = 0.96875) {
    return {.forgetting = forgetting, .variants = {"ud"}, .arithmetics = {"float", "double"}, .timings = false};
}

TEST(FastTable, HasTheDigitsOfTheCertifiedPredictionErrors) {
    for (double const lambda : {0.99, 1.0}) {
        Comparison const c = compare(line_of(5, 200), options(lambda));
        ASSERT_EQ(c.fast.size(), 10u);
        for (FastResult const& r : c.fast) {
            bool const wide = r.arithmetic == "double", lattice = r.form.ends_with("lattice");
            ASSERT_TRUE(r.digits) << r.form;
            EXPECT_GT(*r.digits, lattice ? (wide ? 12 : 3.5) : 0) << r.form << ' ' << r.arithmetic;
            EXPECT_LT(*r.digits, wide ? 16 : 7.3) << r.form;
            if (lattice) {
                EXPECT_FALSE(r.breakdown) << r.form;
            }
        }
        EXPECT_EQ(c.fast.back().operations, 163);
        EXPECT_THAT(as_table(c, false), HasSubstr("fast forms in float"));
        EXPECT_THAT(as_json(c), HasSubstr("fast_forms"));
    }
}
/// The law can fail: with another prior, theta(k - 1) is another.
TEST(FastTable, DigitsOfAnotherProblemAreFew) {
    Records const records = line_of(5, 200);
    std::vector<FastResult> const right = score_fast_forms(records, 0.96875, 16, {"double"}, {20, 60});
    Records other = records;
    other.psi(0, 3) += 1;
    EXPECT_TRUE(is_delay_line(records));
    EXPECT_FALSE(is_delay_line(other));
    EXPECT_THAT(score_fast_forms(other, 0.96875, 16, {"double"}, {20, 60}), IsEmpty());
    EXPECT_GT(*right[4].digits, 12);
}
TEST(FastTable, IsAbsentWithoutADelayLine) {
    Records gap = line_of(3, 60);
    gap.psi.col(30).swap(gap.psi.col(31));
    Records constant = line_of(3, 60);
    constant.psi.row(2).setOnes();
    for (Records const& records : {gap, constant, line_of(1, 60)}) {
        Comparison const c = compare(records, options());
        EXPECT_THAT(c.fast, IsEmpty());
        EXPECT_THAT(as_table(c, false), Not(HasSubstr("fast forms")));
        EXPECT_THAT(as_json(c), Not(HasSubstr("fast_forms")));
    }
}
TEST(FastTable, WhatAnArithmeticCannotHoldIsNoError) {
    for (double const scale : {0x1p-500, 0x1p-70, 0x1p70, 0x1p500}) {
        Comparison const c = compare(line_of(3, 60, scale), options());
        EXPECT_THAT(c.fast, Not(IsEmpty()));
        for (FastResult const& r : c.fast)
            if (r.arithmetic == "double" && r.form == "error_feedback_lattice") {
                EXPECT_GT(r.digits.value_or(0), 12) << scale;
            }
    }
}

}  // namespace
}  // namespace rlslab::compare
