// Several outputs by the C interface: the bytes of rlslab::MultiOutput by its type, and what is refused.
#include "tests/capi/filters.hpp"

#include <rlslab/adapt/outputs.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::c {
namespace {

using testing::HasSubstr;

constexpr std::size_t d = 4, m = 3, alone = 9, rows = 600;  // in blocks the last one is shorter

using Handle = std::unique_ptr<rlslab_outputs, Free>;
Handle made(char const* variant, char const* arithmetic, double prior = 16384, std::size_t outputs = m) {
    rlslab_options options = options_of(d, 0.98);
    options.prior_variance = prior;
    rlslab_outputs* out = nullptr;
    rlslab_outputs_new(variant, arithmetic, outputs, &options, &out);
    return Handle(out);
}

/// What is to be taken: rows apart from one another, the same in float and double.
struct Given {
    static constexpr std::size_t X_stride = d + 2, Y_stride = m + 1;
    std::vector<double> X = numbers(rows * X_stride, 3), Y = numbers(rows * Y_stride, 4);
    std::vector<float> X_floats{X.begin(), X.end()}, Y_floats{Y.begin(), Y.end()};
};
/// Rows [from, to) at once.
rlslab_status take(rlslab_outputs* f, Given const& given, std::size_t from = 0, std::size_t to = rows,
                   int leave_out = 0) {
    return rlslab_outputs_update_many(f, &given.X[from * Given::X_stride], Given::X_stride,
                                      &given.Y[from * Given::Y_stride], Given::Y_stride, to - from, leave_out);
}
/// What a type of C++ leaves of it.
struct Left {
    std::string variant, arithmetic;
    std::vector<std::byte> state;
    std::vector<double> theta, matrix;
};
template <class F>
Left left_by(Given const& given) {
    using T = typename F::scalar;
    MultiOutput<F> filter({.size = Index(d), .forgetting = T(0.98)}, Index(m));
    auto const at = [](auto const& numbers, std::size_t stride, std::size_t from, std::size_t count, std::size_t n) {
        Matrix<T> out{Index(n), Index(count)};
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 0; i < n; ++i) out(Index(i), Index(k)) = T(numbers[(from + k) * stride + i]);
        return out;
    };
    auto const row = [&](std::size_t k) {
        filter.update(at(given.X, Given::X_stride, k, 1, d).col(0), at(given.Y, Given::Y_stride, k, 1, m).col(0));
    };
    for (std::size_t k = 0; k < alone; ++k) row(k);
    std::size_t at_once = 64;
    if constexpr (TakesBlocks<F>) at_once = F::block;
    for (std::size_t k = 0; k < rows; k += at_once)
        if constexpr (requires(Matrix<T> A) { filter.update_block(A, A); }) {
            std::size_t const count = std::min(at_once, rows - k);
            filter.update_block(at(given.X, Given::X_stride, k, count, d),
                                at(given.Y, Given::Y_stride, k, count, m).transpose());
        } else {
            for (std::size_t i = k; i < std::min(k + at_once, rows); ++i) row(i);
        }
    Left out{std::string(F::name), std::string(ArithmeticTraits<T>::name), rlslab::state_of(filter), {}, {}};
    Matrix<double> const theta = filter.theta().transpose().template cast<double>();
    out.theta.assign(theta.data(), theta.data() + theta.size());
    Matrix<T> P;
    if constexpr (ReportsCovariance<F>) P = filter.covariance();
    else P = filter.filter().information();
    out.matrix.assign(P.data(), P.data() + P.size());
    return out;
}
std::vector<Left> left_by_types(Given const& given) {
    std::vector<Left> out;
    auto const add = [&]<class F>() {
        if constexpr (requires { typename MultiOutput<F>; }) out.push_back(left_by<F>(given));
    };
    for_each(Variants<float>{}, add);
    for_each(Variants<double>{}, add);
    return out;
}

TEST(Outputs, AreThoseOfTheTypes) {
    Given const given;
    std::vector<Left> const all = left_by_types(given);
    EXPECT_EQ(all.size(), 32u);  // 18 variants less kalman and extended_qr
    for (Left const& expected : all) {
        SCOPED_TRACE(expected.variant + " " + expected.arithmetic);
        Handle const filter = made(expected.variant.c_str(), expected.arithmetic.c_str());
        ASSERT_TRUE(filter) << rlslab_message();
        rlslab_outputs* const f = filter.get();
        EXPECT_EQ(rlslab_outputs_size(f), d);
        EXPECT_EQ(rlslab_outputs_count(f), m);
        for (std::size_t k = 0; k < alone; ++k)
            rlslab_outputs_update(f, &given.X[k * Given::X_stride], &given.Y[k * Given::Y_stride], nullptr);
        rlslab_outputs* copied = nullptr;
        ASSERT_EQ(rlslab_outputs_copy(f, &copied), RLSLAB_OK);
        Handle const copy(copied);
        ASSERT_EQ(take(f, given), RLSLAB_OK);
        EXPECT_EQ(state_of(f), expected.state);
        std::vector<double> theta(d * m), matrix(d * d);
        ASSERT_EQ(rlslab_outputs_theta(f, theta.data()), RLSLAB_OK);
        EXPECT_EQ(theta, expected.theta);
        if (rlslab_outputs_covariance(f, matrix.data()) == RLSLAB_ABILITY) {
            EXPECT_THAT(rlslab_message(), HasSubstr(expected.variant));
            ASSERT_EQ(rlslab_outputs_information(f, matrix.data()), RLSLAB_OK);
        } else {
            EXPECT_EQ(rlslab_outputs_information(f, matrix.data()), RLSLAB_ABILITY);
        }
        EXPECT_EQ(matrix, expected.matrix);
        EXPECT_EQ(rlslab_outputs_health(f), 0);
        // Rows of float are the same rows; a number that is another leaves another state.
        ASSERT_EQ(rlslab_outputs_update_many_f32(copied, given.X_floats.data(), Given::X_stride, given.Y_floats.data(),
                                                 Given::Y_stride, rows, 0),
                  RLSLAB_OK);
        EXPECT_EQ(state_of(copied), expected.state);
        Given other = given;
        other.Y[(rows - 1) * Given::Y_stride + m - 1] += 0.5;
        Handle const saboteur = made(expected.variant.c_str(), expected.arithmetic.c_str());
        ASSERT_EQ(rlslab_outputs_load(saboteur.get(), expected.state.data(), expected.state.size()), RLSLAB_OK);
        EXPECT_EQ(state_of(saboteur.get()), expected.state);
        take(f, given), take(saboteur.get(), other);
        EXPECT_NE(state_of(saboteur.get()), state_of(f));
    }
}

TEST(Outputs, AnUnusableRowIsRefusedWithAllOrLeftOut) {
    Given given;
    for (char const* const variant : {"qr_block", "joseph_rank_two", "ud", "information"}) {
        SCOPED_TRACE(variant);
        std::vector<double> X, Y;
        Given holed = given;
        for (std::size_t const k : {3, 257, 599}) holed.X[k * Given::X_stride + 1] = nan;
        holed.Y[300 * Given::Y_stride + 2] = HUGE_VAL;
        for (std::size_t k = 0; k < rows; ++k) {
            if (k == 3 || k == 257 || k == 599 || k == 300) continue;
            X.insert(X.end(), &given.X[k * Given::X_stride], &given.X[k * Given::X_stride] + d);
            Y.insert(Y.end(), &given.Y[k * Given::Y_stride], &given.Y[k * Given::Y_stride] + m);
        }
        Handle const filter = made(variant, "double"), cleaned = made(variant, "double");
        std::vector<std::byte> const before = state_of(filter.get());
        EXPECT_EQ(take(filter.get(), holed), RLSLAB_INVALID);
        EXPECT_THAT(rlslab_message(), HasSubstr("row 3,"));
        EXPECT_EQ(state_of(filter.get()), before);
        EXPECT_EQ(take(filter.get(), holed, 0, rows, 1), RLSLAB_OK);
        EXPECT_EQ(rlslab_outputs_left_out(filter.get()), 4);
        ASSERT_EQ(rlslab_outputs_update_many(cleaned.get(), X.data(), 0, Y.data(), 0, rows - 4, 0), RLSLAB_OK);
        EXPECT_EQ(state_of(filter.get()), state_of(cleaned.get()));
    }
}

TEST(Outputs, PartsMergeAndOutputsAreAdded) {
    Given const given;
    Handle const whole = made("qr_block", "double", 0), older = made("qr_block", "double", 0),
                 newer = made("qr_block", "double", 0);
    take(whole.get(), given), take(older.get(), given, 0, 300), take(newer.get(), given, 300);
    ASSERT_EQ(rlslab_outputs_merge(older.get(), newer.get()), RLSLAB_OK) << rlslab_message();
    std::vector<double> expected(d * m), theta(d * m), F(d * d), P(d * d);
    rlslab_outputs_theta(whole.get(), expected.data()), rlslab_outputs_theta(older.get(), theta.data());
    for (std::size_t i = 0; i < d * m; ++i) EXPECT_NEAR(theta[i], expected[i], 1e-13);  // some 100 epsilons of theta
    ASSERT_EQ(rlslab_outputs_factor(whole.get(), F.data()), RLSLAB_OK);
    ASSERT_EQ(rlslab_outputs_information(whole.get(), P.data()), RLSLAB_OK);
    Eigen::Map<Matrix<double>> const R(F.data(), d, d), information(P.data(), d, d);
    EXPECT_LE((R * R.transpose() - information).norm(), 1e-14 * information.norm());
    EXPECT_EQ(rlslab_outputs_factor(made("symmetric", "double").get(), F.data()), RLSLAB_ABILITY);
    EXPECT_EQ(rlslab_outputs_merge(made("ud", "double").get(), newer.get()), RLSLAB_ABILITY);
    std::vector<std::byte> const before = state_of(older.get());
    for (Handle const& other : {made("qr_block", "float", 0), made("qr_block", "double", 0, 2),
                                made("qr_block", "double"), made("qr", "double")})
        EXPECT_EQ(rlslab_outputs_merge(older.get(), other.get()), RLSLAB_INVALID);
    EXPECT_EQ(state_of(older.get()), before);

    // An output of zeros until now is one that is added now.
    for (char const* const variant : {"qr_block", "joseph_rank_two", "ud", "information"}) {
        Given zeros = given;
        for (std::size_t k = 0; k < 300; ++k) zeros.Y[k * Given::Y_stride + m - 1] = 0;
        Handle const all = made(variant, "double"), grown = made(variant, "double", 16384, m - 1);
        take(all.get(), zeros, 0, 300), take(grown.get(), zeros, 0, 300);
        ASSERT_EQ(rlslab_outputs_add(grown.get(), 1), RLSLAB_OK) << rlslab_message();
        take(all.get(), given, 300), take(grown.get(), given, 300);
        EXPECT_EQ(state_of(grown.get()), state_of(all.get())) << variant;
    }
}

TEST(Outputs, WhatIsRefusedHasOneLineAndChangesNothing) {
    rlslab_options options = options_of(d);
    rlslab_outputs* none = nullptr;
    EXPECT_EQ(rlslab_outputs_new("kalman", "double", m, &options, &none), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("kalman"));
    EXPECT_EQ(rlslab_outputs_new("udd", "double", m, &options, &none), RLSLAB_NAME);
    for (std::size_t const outputs : {std::size_t(0), most, most / 2})
        EXPECT_EQ(rlslab_outputs_new("ud", "double", outputs, &options, &none), RLSLAB_INVALID) << outputs;
#ifndef RLSLAB_SANITIZED  // which ends the program in place of std::bad_alloc
    EXPECT_EQ(rlslab_outputs_new("ud", "double", std::size_t(1) << 42, &options, &none), RLSLAB_MEMORY);
#endif
    options.guard = "reset";
    EXPECT_EQ(rlslab_outputs_new("ud", "double", m, &options, &none), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("no guard"));
    EXPECT_EQ(none, nullptr);

    Given const given;
    Handle const filter = made("qr_block", "double");
    rlslab_outputs* const f = filter.get();
    double const *X = given.X.data(), *Y = given.Y.data();
    double numbers[d * d];
    ASSERT_EQ(rlslab_outputs_update_many(f, X, 0, Y, 0, 20, 0), RLSLAB_OK);
    std::vector<std::byte> const before = state_of(f);
    EXPECT_EQ(rlslab_outputs_update_many(f, X, d - 1, Y, 0, 2, 0), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_outputs_update_many(f, X, 0, Y, m - 1, 2, 0), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_outputs_update_many(f, X, 0, Y, 0, most / 2, 0), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_outputs_update_many(f, X, most, Y, 0, 2, 0), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_outputs_add(f, 0), RLSLAB_INVALID);
    EXPECT_NE(rlslab_outputs_add(f, most / 2), RLSLAB_OK);
    EXPECT_EQ(rlslab_outputs_load(made("qr_block", "double", 16384, 2).get(), before.data(), before.size()),
              RLSLAB_STATE);
    EXPECT_EQ(rlslab_outputs_load(f, before.data(), before.size() - 1), RLSLAB_STATE);
    EXPECT_EQ(rlslab_outputs_save(f, numbers, 1), RLSLAB_ROOM);
    rlslab_filter* single = nullptr;
    EXPECT_EQ(rlslab_from_state(before.data(), before.size(), &single), RLSLAB_STATE);
    EXPECT_THAT(rlslab_message(), HasSubstr("several outputs"));
    EXPECT_EQ(rlslab_outputs_update_many(f, nullptr, 0, nullptr, 0, 0, 0), RLSLAB_OK);
    expect_null(
        rlslab_outputs_new("ud", "double", m, nullptr, &none), rlslab_outputs_new("ud", "double", m, &options, nullptr),
        rlslab_outputs_copy(nullptr, &none), rlslab_outputs_copy(f, nullptr), rlslab_outputs_reset(nullptr),
        rlslab_outputs_update(f, nullptr, Y, nullptr), rlslab_outputs_update(f, X, nullptr, nullptr),
        rlslab_outputs_update_f32(nullptr, nullptr, nullptr, nullptr),
        rlslab_outputs_update_many(nullptr, X, 0, Y, 0, 1, 0), rlslab_outputs_update_many(f, X, 0, nullptr, 0, 1, 0),
        rlslab_outputs_update_many_f32(f, nullptr, 0, nullptr, 0, 1, 0), rlslab_outputs_add(nullptr, 1),
        rlslab_outputs_merge(f, nullptr), rlslab_outputs_merge(nullptr, f), rlslab_outputs_theta(f, nullptr),
        rlslab_outputs_covariance(nullptr, numbers), rlslab_outputs_information(f, nullptr),
        rlslab_outputs_factor(nullptr, numbers), rlslab_outputs_save(f, nullptr, 1),
        rlslab_outputs_load(f, nullptr, 1));
    EXPECT_EQ(rlslab_outputs_size(nullptr) + rlslab_outputs_count(nullptr) + rlslab_outputs_state_size(nullptr), 0u);
    EXPECT_EQ(rlslab_outputs_health(nullptr), -1);
    EXPECT_EQ(rlslab_outputs_left_out(nullptr), -1);
    rlslab_outputs_free(nullptr);
    EXPECT_EQ(state_of(f), before);
    ASSERT_EQ(rlslab_outputs_reset(f), RLSLAB_OK);
    EXPECT_EQ(state_of(f), state_of(made("qr_block", "double").get()));
}

TEST(Outputs, AMissingOutputCostsItsRow) {
    Handle const filter = made("ud", "double");
    rlslab_step steps[m];
    double const psi[d] = {1, 2, 3, 4}, y[m] = {1, nan, 2};
    ASSERT_EQ(rlslab_outputs_update(filter.get(), psi, y, steps), RLSLAB_OK);
    double theta[d * m], P[d * d];
    rlslab_outputs_theta(filter.get(), theta), rlslab_outputs_covariance(filter.get(), P);
    EXPECT_THAT(theta, testing::Each(0));
    EXPECT_EQ(P[0], 16384 / 0.98);
    EXPECT_TRUE(std::isnan(steps[1].innovation));
}

TEST(Outputs, ThetaIsNanUntilTheRowsDetermineIt) {
    Given const given;
    for (char const* const variant : {"qr", "qr_block", "gentleman", "information"}) {
        Handle const filter = made(variant, "double", 0);
        double theta[d * m];
        rlslab_outputs_update_many(filter.get(), given.X.data(), 0, given.Y.data(), 0, d - 1, 0);
        rlslab_outputs_theta(filter.get(), theta);
        EXPECT_THAT(theta, testing::Each(testing::IsNan())) << variant;
        rlslab_outputs_update(filter.get(), &given.X[(d - 1) * d], &given.Y[(d - 1) * m], nullptr);
        rlslab_outputs_theta(filter.get(), theta);
        EXPECT_THAT(theta, testing::Each(testing::Not(testing::IsNan()))) << variant;
    }
}

TEST(Outputs, ThreadsDoNotChangeTheBits) {
    Given const given;
    std::vector<std::vector<std::byte>> states;
    for (std::size_t const threads : {1, 3}) {
        ASSERT_EQ(rlslab_use_threads(threads), RLSLAB_OK);
        Handle const filter = made("qr_block", "double");
        take(filter.get(), given);
        states.push_back(state_of(filter.get()));
    }
    EXPECT_EQ(states[0], states[1]);
    EXPECT_EQ(rlslab_use_threads(1), RLSLAB_OK);
    for (std::size_t const threads : {std::size_t(0), std::size_t(1025), most})
        EXPECT_EQ(rlslab_use_threads(threads), RLSLAB_INVALID);
}

}  // namespace
}  // namespace rlslab::c
