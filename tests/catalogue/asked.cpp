// Weights, removals, merging, variances, roots, draws and the least excited direction of filters by name: the bits of
// the C++ types.
#include "tests/catalogue/by_name.hpp"
#include "tests/common/same.hpp"

#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>

namespace rlslab {
namespace {

using namespace by_name;
using testing::HasSubstr;

constexpr Index rows = 150, stride = d + 2;

struct Rows {
    std::vector<double> psi, y, weights;
};
/// Weights of all kinds: 1, 0, none, and others.
Rows weighted_rows() {
    Seed seed{5};
    Rows out{std::vector<double>(size_t(rows * stride)), std::vector<double>(rows), std::vector<double>(rows)};
    for (double& x : out.psi) x = seed.bell();
    for (Index k = 0; k < rows; ++k) {
        out.y[size_t(k)] = out.psi[size_t(k * stride)] + 0.1 * seed.bell();
        double const kinds[] = {1, 0, seed.uniform(), 1e-6, -1, 40 * seed.uniform(), double(NAN), 1, 0.25, INFINITY};
        out.weights[size_t(k)] = kinds[seed.next() % 10];
    }
    out.y[7] = out.psi[size_t(7 * stride)] = NAN, out.weights[7] = 0;
    return out;
}
template <class X>
std::vector<X> in(std::vector<double> const& from) {
    return {from.begin(), from.end()};
}
bool same(native::Step const& a, native::Step const& b) {
    return rlslab::same(a.innovation, b.innovation) && rlslab::same(a.residual, b.residual) &&
           rlslab::same(a.gamma, b.gamma) && a.health == b.health && a.signal == b.signal;
}
std::vector<double> gain_of(native::Filter const& f) {
    std::vector<double> out(d);
    f.gain(out.data());
    return out;
}
template <class T, class X>
std::vector<double> widened(X const& x) {
    std::vector<double> out;
    for (T const& each : x) out.push_back(double(each));
    return out;
}

/// One by one as Weighted around the type; many at once, with steps and without, in either arithmetic, the same.
template <class F>
void expect_weights_alike(F const& inside, native::Options options) {
    using T = typename F::scalar;
    SCOPED_TRACE(std::string(F::name) + " " + std::string(ArithmeticTraits<T>::name));
    options.size = d, options.prior_variance = 64, options.forgetting = 0.98;
    auto const filter = native::make(F::name, ArithmeticTraits<T>::name, options);
    auto const start = filter->clone();
    Weighted<F> typed(inside, T(0.98));
    Rows const r = weighted_rows();
    auto const psi = in<T>(r.psi), y = in<T>(r.y), w = in<T>(r.weights);
    std::vector<native::Step> steps(rows);
    for (Index k = 0; k < rows; ++k) {
        Regressor<T> const row(&psi[size_t(k * stride)], d);
        Step<T> const step = typed.update(row, y[size_t(k)], w[size_t(k)]);
        steps[size_t(k)] = filter->update(row.data(), y[size_t(k)], w[size_t(k)]);
        native::Step const expected{double(step.innovation), double(step.residual), double(step.gamma),
                                    std::int32_t(step.health), steps[size_t(k)].signal};
        ASSERT_TRUE(same(steps[size_t(k)], expected)) << k;
        if constexpr (std::same_as<T, double>) {
            ASSERT_EQ(saved(*filter), state_of(typed.filter())) << k;
        }
        ASSERT_TRUE(rlslab::same(gain_of(*filter), widened<T>(typed.gain()))) << k;
        if (!(r.weights[size_t(k)] >= 0) || std::isinf(r.weights[size_t(k)])) {
            ASSERT_EQ(filter->health(), std::int32_t(Health::nonfinite));
            ASSERT_EQ(filter->signal(), 0);
        }
    }
    EXPECT_EQ(saved(*filter), state_of(typed.filter()));
    auto const many = start->clone(), blocks = start->clone(), floats = start->clone();
    std::vector<native::Step> others(rows);
    many->update_many(psi.data(), rows, stride, y.data(), w.data(), others.data());
    for (Index k = 0; k < rows; ++k) {
        ASSERT_TRUE(same(steps[size_t(k)], others[size_t(k)])) << k;
    }
    EXPECT_EQ(saved(*many), saved(*filter));
    EXPECT_EQ(many->counts().rows, rows);
    if (TakesBlocks<F>) return;
    native::Step const last = blocks->update_many(psi.data(), rows, stride, y.data(), w.data(), nullptr);
    EXPECT_TRUE(same(last, steps.back()));
    EXPECT_EQ(saved(*blocks), saved(*filter));
    EXPECT_EQ(gain_of(*blocks), gain_of(*filter));
    EXPECT_EQ(blocks->counts().rows, rows);
    using Other = std::conditional_t<std::same_as<T, double>, float, double>;
    auto const one_by_one = start->clone();
    auto const psi_o = in<Other>(r.psi), y_o = in<Other>(r.y), w_o = in<Other>(r.weights);
    floats->update_many(psi_o.data(), rows, stride, y_o.data(), w_o.data(), nullptr);
    for (Index k = 0; k < rows; ++k) one_by_one->update(&psi_o[size_t(k * stride)], y_o[size_t(k)], w_o[size_t(k)]);
    EXPECT_EQ(saved(*floats), saved(*one_by_one));
}
template <class F>
void expect_plain_bits_for_weights_of_one() {
    using T = typename F::scalar;
    native::Options const options{.size = d, .forgetting = 0.98};
    auto const plain = native::make(F::name, ArithmeticTraits<T>::name, options), weighted = plain->clone();
    Rows const r = weighted_rows();
    auto psi = in<T>(r.psi), y = in<T>(r.y);
    psi[size_t(7 * stride)] = y[7] = T(1);
    std::vector<T> const ones(rows, T(1));
    native::Step const a = plain->update_many(psi.data(), rows, stride, y.data(), static_cast<native::Step*>(nullptr)),
                       b = weighted->update_many(psi.data(), rows, stride, y.data(), ones.data(), nullptr);
    EXPECT_EQ(saved(*plain), saved(*weighted)) << F::name;
    EXPECT_TRUE(same(a, b)) << F::name;
    weighted->update(psi.data(), y[0], T(0.25));
    EXPECT_NE(saved(*plain), saved(*weighted));
    std::vector<std::byte> const state = saved(*weighted);
    std::vector<double> const gain = gain_of(*weighted);
    weighted->load(state);
    std::vector<double> const after = gain_of(*weighted);
    for (Index i = 0; i < d; ++i) EXPECT_EQ(after[size_t(i)], 2 * gain[size_t(i)]) << "K / sqrt(w) of the state";
}
template <class T>
void expect_weights_of_all() {
    for_each(Variants<T>{}, []<class F>() {
        expect_weights_alike(F(problem<T>(0.98)), {});
        expect_plain_bits_for_weights_of_one<F>();
    });
    auto const p = problem<T>(0.98);
    expect_weights_alike(Guarded<Ud<T>, resetting>(p), {.guard = "reset"});
    expect_weights_alike(Guarded<Qr<T>, reporting>(p), {.guard = "report"});
    expect_weights_alike(Windowed<Carlson<T>>(p, {.rows = 30}), {.window = 30});
    expect_weights_alike(Guarded<Windowed<Qr<T>>>(Windowed<Qr<T>>(p, {.rows = 30}), p),
                         {.window = 30, .guard = "reset"});
}
TEST(Asked, WeightsHaveTheBitsOfWeightedInFloat) { expect_weights_of_all<float>(); }
TEST(Asked, WeightsHaveTheBitsOfWeightedInDouble) { expect_weights_of_all<double>(); }

template <class F>
void expect_answers_alike() {
    using T = typename F::scalar;
    SCOPED_TRACE(std::string(F::name) + " " + std::string(ArithmeticTraits<T>::name));
    auto const filter =
        native::make(F::name, ArithmeticTraits<T>::name, {.size = d, .forgetting = 0.98, .prior_variance = 64});
    F typed(problem<T>(0.98));
    Rows const r = weighted_rows();
    auto const row = [&](Index k) { return in<T>({&r.psi[size_t(k * stride)], &r.psi[size_t(k * stride)] + d}); };
    for (Index k = 10; k < 60; ++k) {
        auto const psi = row(k);
        typed.update(Regressor<T>(psi.data(), d), T(r.y[size_t(k)]));
        filter->update(&r.psi[size_t(k * stride)], r.y[size_t(k)]);
    }
    auto const before = saved(*filter);
    double out[d * d];
    std::vector<double> along(20);
    auto const ask_variance = [&] { filter->variance(&r.psi[size_t(10 * stride)], 20, stride, along.data()); };
    if constexpr (ReportsVariances<F>) {
        ask_variance();
        for (Index k = 0; k < 20; ++k) {
            auto const psi = row(10 + k);
            EXPECT_EQ(along[size_t(k)], double(variance_along(typed, Regressor<T>(psi.data(), d))));
        }
    } else {
        EXPECT_THAT(refusal(ask_variance), HasSubstr("has psi'P psi not at hand"));
    }
    auto const stored = typed.stored();
    EXPECT_EQ(filter->stores_a_root(), stored.form == Stored<T>::Form::factor);
    if (stored.form == Stored<T>::Form::factor && stored.D.size() == 0) {
        filter->factor(out);
        EXPECT_EQ(std::vector<double>(out, out + d * d), widened<T>(stored.F.reshaped()));
    } else {
        EXPECT_THAT(refusal([&] { filter->factor(out); }), HasSubstr("stores no square root"));
    }
    std::vector<double> draws(3 * d);
    if (filter->stores_a_root()) {
        std::vector<T> expected(3 * d), u(d);
        sample(typed, 9, 3, T(0.5), expected.data());
        filter->sample(9, 3, 0.5, draws.data());
        EXPECT_EQ(draws, widened<T>(expected));
        auto const direction = least_excited(typed, u.data());
        native::Excitation const found = filter->least_excited(out);
        EXPECT_EQ(found.deviation, double(direction.deviation));
        EXPECT_EQ(found.ratio, double(direction.ratio));
        EXPECT_EQ(std::vector<double>(out, out + d), widened<T>(u));
    } else {
        EXPECT_THAT(refusal([&] { filter->sample(9, 3, 0.5, draws.data()); }), HasSubstr("stores no root"));
        EXPECT_THAT(refusal([&] { filter->least_excited(out); }), HasSubstr("stores no root"));
    }
    EXPECT_EQ(saved(*filter), before) << "asking changes nothing";
    double const* const psi = &r.psi[size_t(59 * stride)];
    EXPECT_EQ(filter->downdates(), Downdates<F>);
    if constexpr (Downdates<F>) {
        std::vector<double> const gain = gain_of(*filter);
        for (auto const& [y, w] : {std::pair(1.0, -1.0), std::pair(1.0, double(NAN)), std::pair(double(NAN), 1.0)}) {
            EXPECT_TRUE(filter->remove(psi, y, w).refused());
        }
        EXPECT_FALSE(filter->remove(psi, 1, 0).refused());
        EXPECT_TRUE(filter->remove(psi, 1, 1e9).refused()) << "nothing would remain";
        EXPECT_EQ(saved(*filter), before);
        auto const last = row(59);
        auto const expected = remove(typed, Regressor<T>(last.data(), d), T(r.y[59]), T(1));
        native::Removal const removal = filter->remove(psi, r.y[59]);
        EXPECT_EQ(removal.remaining, double(expected.remaining));
        EXPECT_EQ(removal.noise, double(expected.noise));
        EXPECT_FALSE(removal.refused());
        EXPECT_EQ(saved(*filter), state_of(typed));
        EXPECT_NE(saved(*filter), before);
        if (ReportsCovariance<F>) {
            EXPECT_EQ(gain_of(*filter), gain) << "stays";
        }
    } else {
        EXPECT_THAT(refusal([&] { filter->remove(psi, 1); }), HasSubstr("takes no row back"));
    }
    if constexpr (Merges<F>) {
        auto const make = [](double prior, double forgetting, Index size) {
            return native::make(F::name, ArithmeticTraits<T>::name,
                                {.size = size, .forgetting = forgetting, .prior_variance = prior});
        };
        auto const newer = make(0, 0.98, d);
        F part(Problem<T>{.size = d, .forgetting = T(0.98), .prior = std::nullopt});
        for (Index k = 70; k < 100; ++k) {
            auto const each = row(k);
            part.update(Regressor<T>(each.data(), d), T(r.y[size_t(k)]));
            newer->update(&r.psi[size_t(k * stride)], r.y[size_t(k)]);
        }
        filter->merge(*newer), typed.merge(part);
        EXPECT_EQ(saved(*filter), state_of(typed));
        EXPECT_EQ(filter->counts().rows, 80);
        EXPECT_EQ(gain_of(*filter), widened<T>(typed.gain()));
        auto const now = saved(*filter);
        newer->merge(*newer), part.merge(F(part));  // itself
        EXPECT_EQ(saved(*newer), state_of(part));
        EXPECT_THAT(refusal([&] { filter->merge(*make(1, 0.98, d)); }), HasSubstr("without a prior"));
        EXPECT_THAT(refusal([&] { filter->merge(*filter); }), HasSubstr("without a prior"));
        EXPECT_THAT(refusal([&] { filter->merge(*make(0, 0.5, d)); }),
                    HasSubstr("a part of forgetting 0.98, found 0.5"));
        EXPECT_THAT(refusal([&] { filter->merge(*make(0, 0.98, 2)); }), HasSubstr("with 2 parameters"));
        EXPECT_THAT(refusal([&] { filter->merge(*native::make("ud", "double", {.size = d})); }), HasSubstr("found ud"));
        EXPECT_EQ(saved(*filter), now);
    } else {
        EXPECT_THAT(refusal([&] { filter->merge(*filter); }), HasSubstr("does not merge; qr_block does"));
    }
}
TEST(Asked, AnswersAreThoseOfTheTypes) {
    for_each(Variants<float>{}, []<class F>() { expect_answers_alike<F>(); });
    for_each(Variants<double>{}, []<class F>() { expect_answers_alike<F>(); });
}
TEST(Asked, ACompositionAnswersAsWhatIsInside) {
    Rows const r = weighted_rows();
    for (native::Options options : {native::Options{.guard = "report"}, native::Options{.window = 500},
                                    native::Options{.certify = 3}, native::Options{.control = "kulhavy"}}) {
        options.size = d, options.forgetting = options.control.empty() ? 0.98 : 1;
        auto const filter = native::make("carlson", "double", options);
        for (Index k = 10; k < 60; ++k) filter->update(&r.psi[size_t(k * stride)], r.y[size_t(k)]);
        double F[d * d], P[d * d], draws[d];
        filter->factor(F);
        filter->covariance(P);
        for (Index i = 0; i < d; ++i) {
            double along = 0, e[d] = {}, sum = 0;
            e[i] = 1;
            filter->variance(e, 1, 0, &along);
            for (Index j = 0; j < d; ++j) sum += F[i + j * d] * F[i + j * d];
            EXPECT_NEAR(along / P[i * (d + 1)], 1, 1e-12);
            EXPECT_NEAR(sum / P[i * (d + 1)], 1, 1e-12);
        }
        filter->sample(1, 1, 1, draws);
        EXPECT_TRUE(std::isfinite(draws[0]));
        EXPECT_GE(filter->least_excited(draws).ratio, 1 - 1e-12);
        EXPECT_EQ(filter->downdates(), options.certify > 0);
        if (filter->downdates()) {
            double const bound = filter->certificate().bound;
            EXPECT_FALSE(filter->remove(&r.psi[size_t(59 * stride)], r.y[59]).refused());
            EXPECT_LT(filter->certificate().bound, 1e-6 + 100 * bound) << "the probes follow";
        } else {
            EXPECT_THAT(refusal([&] { filter->remove(&r.psi[0], 1); }), HasSubstr("takes no row back: it does alone"));
        }
    }
    auto const undetermined = native::make("qr", "float", {.size = d, .prior_variance = 0, .guard = "reset"});
    double out[d] = {};
    undetermined->sample(1, 1, 1, out);
    EXPECT_TRUE(std::isnan(out[0]));
    undetermined->variance(&r.psi[0], 1, 0, out);
    EXPECT_TRUE(std::isnan(out[0]));
}

}  // namespace
}  // namespace rlslab
