// The native layer has the bits of the C++ types, takes rows in place, and exchanges states with them.
#include <rlslab/catalogue/native/filter.hpp>
#include "tests/common/composed.hpp"

#include <rlslab/core/process.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

namespace rlslab {
namespace {

using namespace composed_laws;
using native::Filter;
using native::Options;

using Bits = std::vector<std::uint64_t>;
void add(Bits& to, double x) { to.push_back(x != x ? 0 : std::bit_cast<std::uint64_t>(x)); }
Bits bits_of(std::vector<double> const& x) {
    Bits out;
    for (double const v : x) add(out, v);
    return out;
}

/// Everything that a filter reports, and its state.
Bits answers_of(Filter const& f) {
    std::vector<double> numbers(std::size_t(f.size() * (f.size() + 2)));
    f.theta(numbers.data());
    f.gain(numbers.data() + f.size());
    if (f.reports_covariance()) f.covariance(numbers.data() + 2 * f.size());
    else f.information(numbers.data() + 2 * f.size());
    return bits_of(numbers);
}
template <class F>
Bits answers_of(F const& f) {
    std::vector<double> numbers;
    auto const add_all = [&](auto const& x) {
        for (auto const v : x.reshaped()) numbers.push_back(double(v));
    };
    using T = typename F::scalar;
    add_all(Vector<T>(f.theta()));
    add_all(Vector<T>(f.gain()));
    if constexpr (ReportsCovariance<F>) add_all(Matrix<T>(f.covariance()));
    else add_all(Matrix<T>(f.information()));
    return bits_of(numbers);
}
std::vector<std::byte> state_bytes_of(Filter const& f) {
    std::vector<std::byte> out(f.state_size());
    f.save(out);
    return out;
}
template <class F>
std::vector<std::byte> state_bytes_of(F const& f) {
    std::vector<std::byte> out(state_size(f));
    save(f, std::span(out));
    return out;
}
template <class Step>
Bits numbers_of(Step const& s) {
    Bits out = bits_of({double(s.innovation), double(s.residual), double(s.gamma)});
    out.push_back(std::uint64_t(s.health));
    return out;
}

template <class T>
struct Rows {
    Matrix<T> psi;  // d x N
    Vector<T> y;
};
template <class T>
Rows<T> rows_in(Records const& records) {
    return {records.psi.cast<T>(), records.y.cast<T>()};
}
Records const& records() {
    static Records const all = rows_of(300, 100, 250, Seed{3});
    return all;
}
constexpr Options some{.size = d, .forgetting = 0.98, .prior_variance = 64};
template <class T>
Problem<T> some_problem() {
    return {.size = d, .forgetting = T(0.98), .prior = Prior<T>{.variance = T(64)}};
}

template <class T>
class Native : public testing::Test {};
using Both = testing::Types<float, double>;
TYPED_TEST_SUITE(Native, Both);

template <class T, class Check>
void for_each_variant(Check check) {
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (std::same_as<typename F::scalar, T>) {
            SCOPED_TRACE(std::string(F::name));
            check.template operator()<F>(F(some_problem<T>()), native::make(F::name, ArithmeticTraits<T>::name, some));
        }
    });
}

TYPED_TEST(Native, UpdatesHaveTheBitsOfTheTypes) {
    using T = TypeParam;
    Rows<T> const rows = rows_in<T>(records());
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        EXPECT_EQ(filter->variant(), F::name);
        EXPECT_EQ(filter->arithmetic(), ArithmeticTraits<T>::name);
        EXPECT_EQ(filter->size(), d);
        EXPECT_EQ(filter->reports_covariance(), ReportsCovariance<F>);
        for (Index k = 0; k < rows.y.size(); ++k) {
            auto const a = typed.update(rows.psi.col(k), rows.y[k]);
            auto const b = filter->update(rows.psi.col(k).data(), rows.y[k]);
            ASSERT_EQ(numbers_of(a), numbers_of(b)) << k;
            ASSERT_EQ(answers_of(typed), answers_of(*filter)) << k;
        }
        EXPECT_EQ(state_bytes_of(typed), state_bytes_of(*filter));
        EXPECT_EQ(filter->counts().rows, rows.y.size());
    });
}
TYPED_TEST(Native, RowsOfTheOtherArithmeticAreRoundedOnce) {
    using T = TypeParam;
    using Other = std::conditional_t<std::same_as<T, float>, double, float>;
    Rows<Other> const given = rows_in<Other>(records());
    Rows<T> const rows{given.psi.template cast<T>(), given.y.template cast<T>()};
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        auto const many = filter->clone();
        for (Index k = 0; k < rows.y.size(); ++k) {
            typed.update(rows.psi.col(k), rows.y[k]);
            filter->update(given.psi.col(k).data(), given.y[k]);
        }
        EXPECT_EQ(answers_of(typed), answers_of(*filter));
        F at_once(some_problem<T>());
        process(at_once, given.psi, given.y);
        many->update_many(given.psi.data(), given.y.size(), 0, given.y.data(), nullptr);
        EXPECT_EQ(answers_of(at_once), answers_of(*many));
    });
}
TYPED_TEST(Native, ManyRowsAreThoseOneByOne) {
    using T = TypeParam;
    Rows<T> const rows = rows_in<T>(records());
    Matrix<T> apart(d + 3, rows.y.size());
    apart.setConstant(std::numeric_limits<T>::quiet_NaN());
    apart.topRows(d) = rows.psi;
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        auto const with_steps = filter->clone(), strided = filter->clone();
        Step<T> const last = process(typed, rows.psi, rows.y);
        native::Step const step = filter->update_many(rows.psi.data(), rows.y.size(), 0, rows.y.data(), nullptr);
        EXPECT_EQ(numbers_of(last), numbers_of(step));
        EXPECT_EQ(answers_of(typed), answers_of(*filter));
        EXPECT_EQ(filter->health(), step.health);
        strided->update_many(apart.data(), rows.y.size(), d + 3, rows.y.data(), nullptr);
        EXPECT_EQ(answers_of(typed), answers_of(*strided));

        std::vector<native::Step> steps(std::size_t(rows.y.size()));
        with_steps->update_many(apart.data(), rows.y.size(), d + 3, rows.y.data(), steps.data());
        F row_by_row(some_problem<T>());
        for (Index k = 0; k < rows.y.size(); ++k)
            ASSERT_EQ(numbers_of(row_by_row.update(rows.psi.col(k), rows.y[k])), numbers_of(steps[std::size_t(k)]));
        EXPECT_EQ(answers_of(row_by_row), answers_of(*with_steps));

        EXPECT_TRUE(std::isnan(filter->update_many(rows.psi.data(), 0, 0, rows.y.data(), nullptr).gamma));
        EXPECT_THROW(filter->update_many(rows.psi.data(), 1, d - 1, rows.y.data(), nullptr), std::invalid_argument);
        EXPECT_THROW(filter->update_many(rows.psi.data(), -1, 0, rows.y.data(), nullptr), std::invalid_argument);
    });
}
TYPED_TEST(Native, TimePassesAsInARowOfZeros) {
    using T = TypeParam;
    Vector<T> const zeros = Vector<T>::Zero(d);
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        EXPECT_EQ(numbers_of(typed.update(zeros, T(0))), numbers_of(filter->pass_time()));
        EXPECT_EQ(answers_of(typed), answers_of(*filter));
    });
}
TYPED_TEST(Native, StatesGoToTheTypesAndBack) {
    using T = TypeParam;
    Rows<T> const rows = rows_in<T>(records());
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        process(typed, rows.psi, rows.y);
        auto const fresh = answers_of(*filter);
        filter->load(state_bytes_of(typed));
        EXPECT_NE(fresh, answers_of(*filter));
        EXPECT_EQ(answers_of(typed), answers_of(*filter));
        F back(some_problem<T>());
        std::vector<std::byte> const state = state_bytes_of(*filter);
        EXPECT_EQ(load(back, std::span(state)), StateFault::none);
        EXPECT_EQ(answers_of(typed), answers_of(back));

        std::vector<std::byte> damaged = state;
        damaged[damaged.size() / 2] ^= std::byte(1);
        EXPECT_THROW(filter->load(damaged), std::invalid_argument);
        EXPECT_THROW(filter->load(std::span(state).first(7)), std::invalid_argument);
        EXPECT_EQ(answers_of(typed), answers_of(*filter)) << "as it was";
    });
}
TYPED_TEST(Native, CopiesAreFiltersOfTheirOwnAndResetIsTheStart) {
    using T = TypeParam;
    Rows<T> const rows = rows_in<T>(records());
    for_each_variant<T>([&]<class F>(F typed, std::unique_ptr<Filter> filter) {
        filter->update(rows.psi.col(0).data(), rows.y[0]);
        auto const copy = filter->clone();
        Bits const before = answers_of(*copy);
        filter->update(rows.psi.col(1).data(), rows.y[1]);
        EXPECT_EQ(answers_of(*copy), before);
        filter->reset();
        EXPECT_EQ(answers_of(*filter), answers_of(typed));
        EXPECT_EQ(state_bytes_of(*filter), state_bytes_of(typed));
        EXPECT_EQ(filter->counts().rows, 0);
        copy->reset();
        EXPECT_EQ(answers_of(*copy), answers_of(typed));
    });
}

TEST(Native, PriorsAreTheProblems) {
    double const theta[] = {1, -2}, P0[] = {4, 1, 1, 9};
    Prior<double> prior{.variance = 5, .theta = Vector<double>{{1, -2}}};
    auto filter = native::make("ud", "double", {.size = 2, .prior_variance = 5, .prior_theta = theta});
    EXPECT_EQ(answers_of(*filter), answers_of(Ud<double>({.size = 2, .prior = prior})));
    prior.covariance = Matrix<double>{{4, 1}, {1, 9}};
    filter =
        native::make("ud", "double", {.size = 2, .prior_variance = 5, .prior_theta = theta, .prior_covariance = P0});
    EXPECT_EQ(answers_of(*filter), answers_of(Ud<double>({.size = 2, .prior = prior})));
    filter = native::make("qr", "float", {.size = 2, .prior_variance = 0});
    double const psi[] = {1, 2};
    EXPECT_EQ(filter->update(psi, 1.0).health, std::int32_t(Health::undetermined));
    EXPECT_FALSE(native::make("qr", "float", {.size = 2, .prior_variance = 0})->update(psi, 1.0).sound());
}

std::string refusal_of(std::string_view variant, std::string_view arithmetic, Options const& options) {
    try {
        native::make(variant, arithmetic, options);
    } catch (std::invalid_argument const& error) {
        return error.what();
    }
    return "";
}
TEST(Native, WhatIsNoFilterIsRefusedInOneLine) {
    using testing::HasSubstr;
    double const numbers[] = {0.95, 0.5, 7}, theta[] = {0, 0}, lopsided[] = {1, 2, 3, 4};
    Options const two{.size = 2};
    auto const with = [&](auto change) {
        Options out = two;
        change(out);
        return out;
    };
    EXPECT_THAT(refusal_of("udd", "double", two), HasSubstr("no variant \"udd\"; there are conventional, "));
    EXPECT_THAT(refusal_of("qr_sparse", "double", two), HasSubstr("no variant"));
    EXPECT_THAT(refusal_of("ud", "half\n", two), HasSubstr("no arithmetic \"half\\x0a\"; there are float, double"));
    EXPECT_THAT(refusal_of("ud", "double", {}), HasSubstr("size >= 1"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.forgetting = 0; })), HasSubstr("0 < forgetting <= 1"));
    EXPECT_THAT(refusal_of("ud", "float", with([](auto& o) { o.forgetting = 1e-60; })), HasSubstr("forgetting"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.prior_variance = -1; })), HasSubstr("prior variance"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.prior_variance = 0; })), HasSubstr("prior"));
    EXPECT_THAT(refusal_of("qr", "double", with([&](auto& o) { o.prior_variance = 0, o.prior_theta = theta; })),
                HasSubstr("beside a prior theta"));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.prior_covariance = lopsided; })),
                HasSubstr("symmetric"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.window = -1; })), HasSubstr("window"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.guard = "rest"; })), HasSubstr("no guard \"rest\""));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.control = "?"; })), HasSubstr("no control \"?\""));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control_numbers = numbers; })), HasSubstr("control"));
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control = "kulhavy", o.control_numbers = numbers; })),
                HasSubstr("at most 2 numbers, found 3"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.control = "fortescue"; })), HasSubstr("VARIANCE"));
    double const beyond[] = {1.5};
    EXPECT_THAT(refusal_of("ud", "double", with([&](auto& o) { o.control = "kulhavy", o.control_numbers = beyond; })),
                HasSubstr("LAMBDA is out of its range"));
    EXPECT_THAT(refusal_of("extended_qr", "double", with([](auto& o) { o.window = 9; })), HasSubstr("shows no state"));
    EXPECT_THAT(refusal_of("qr_block", "double", with([](auto& o) { o.guard = "reset"; })),
                HasSubstr("shows no state"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.window = 9, o.control = "ridge"; })),
                HasSubstr("a window takes rows back"));
    EXPECT_THAT(refusal_of("ud", "double", with([](auto& o) { o.guard = "reset", o.asymmetry = -1; })),
                HasSubstr("options"));
    for (std::string_view const guard : native::guards())
        EXPECT_EQ(refusal_of("ud", "float", {.size = 2, .guard = guard}), "") << guard;
    for (std::string_view const variant : native::variants())
        for (std::string_view const arithmetic : native::arithmetics())
            EXPECT_EQ(refusal_of(variant, arithmetic, two), "") << variant;
    std::vector<std::string_view> listed;
    for_each(Variants<double>{}, [&]<class F>() { listed.push_back(F::name); });
    EXPECT_THAT(native::variants(), testing::ElementsAreArray(listed));
}
TEST(Native, ReportsWhatTheVariantPropagates) {
    double P[4];
    EXPECT_THROW(native::make("qr", "double", {.size = 2})->covariance(P), std::invalid_argument);
    EXPECT_THROW(native::make("ud", "double", {.size = 2})->information(P), std::invalid_argument);
}

TEST(Native, NamesOfHealthAndSignals) {
    EXPECT_EQ(native::name_of_health(2), "indefinite");
    EXPECT_EQ(native::name_of_signal(5), "windup");
}

}  // namespace
}  // namespace rlslab
