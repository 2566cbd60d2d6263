// What is left of a guarded filter in float after ten million rows of abuse.
#include <rlslab/adapt/guard.hpp>

#include "tests/adapt.hpp"

#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <optional>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double lambda = 0.98;

/// Bursts, silence, collinear stretches, outliers of 1e6, data that are not finite, constant input, regressors out of scale and a true
/// change, in turn, each before a stretch of good rows.
class Abuse {
    enum Kind { burst, silence, collinear, outlier, not_finite, constant, one_in_twenty, scale, change, kinds };
    Seed seed_;
    int left_ = 400;
    Kind kind_ = Kind(0);
    double sign_ = 1;

public:
    bool good = true;
    int since = 0;  ///< good rows so far in this stretch

    explicit Abuse(Seed seed) : seed_(seed) {}
    double sign() const { return sign_; }
    template <int d>
    float next(float (&psi)[d]) {
        static constexpr int lengths[kinds] = {20, 3000, 2000, 1, 7, 1000, 300, 2, 1};
        if (left_-- == 0) {
            if (!good) kind_ = Kind((kind_ + 1) % kinds), since = 0;
            good = !good;
            left_ = good ? 399 : lengths[kind_] - 1;
            if (!good && kind_ == change) sign_ = -sign_;
        }
        double y = draw(seed_, psi, 0.1, sign_);
        if (good) {
            ++since;
            return float(y);
        }
        if (kind_ == burst) return scaled(psi, 1000);
        if (kind_ == silence) return scaled(psi, 0);
        if (kind_ == collinear || kind_ == constant) {
            float const all = kind_ == constant ? 1 : psi[0];
            for (float& x : psi) x = all;
            return scaled(psi, 1);
        }
        if (kind_ == outlier) y += 1e6;
        if (kind_ == not_finite) psi[left_ % d] = left_ % 2 ? NAN : INFINITY, y = left_ % 3 ? y : -INFINITY;
        if (kind_ == one_in_twenty && seed_.uniform() < 0.05) y += 10 * seed_.bell();
        if (kind_ == scale) psi[left_ % d] *= left_ % 2 ? 1e6f : 3e37f;
        return float(y);
    }

private:
    template <int d>
    float scaled(float (&psi)[d], float by) {
        double y = 0.1 * seed_.bell();
        for (int i = 0; i < d; ++i) psi[i] *= by, y += double(psi[i]) * sign_ * (i % 2 ? -(i + 1) : i + 1);
        return float(y);
    }
};
struct Survived {
    Index not_finite = 0, indefinite = 0, compared = 0, worse = 0;
};
/// Theta is compared with a fresh filter in double, five memory lengths after the last abuse.
template <class F>
Survived survive(F& g, int rows, unsigned seed) {
    constexpr int d = 5, later = 5 * 50;
    Survived out;
    Abuse abuse{Seed{seed}};
    std::optional<Ud<double, d>> fresh;
    float psi[d];
    for (int k = 0; k < rows; ++k) {
        float const y = abuse.next(psi);
        g.update(psi, y);
        for (int i = 0; i < d; ++i) out.not_finite += !std::isfinite(g.theta()[i]);
        if (abuse.good && abuse.since == 1) fresh.emplace(Problem<double>{.forgetting = lambda, .prior = Prior<double>{.variance = 100}});
        if (abuse.good && fresh) {
            double const exact[] = {psi[0], psi[1], psi[2], psi[3], psi[4]};
            fresh->update(exact, y);
        }
        if (!abuse.good || abuse.since != later) continue;
        double guarded = 0, free = 0;
        for (int i = 0; i < d; ++i) {
            double const theta = abuse.sign() * (i % 2 ? -(i + 1) : i + 1);
            guarded += std::pow(g.theta()[i] - theta, 2);
            free += std::pow(fresh->theta()[i] - theta, 2);
        }
        ++out.compared;
        out.worse += !(guarded <= 4 * free);
    }
    Stored<float> const stored = g.stored();
    for (Index j = 0; j < d; ++j) out.indefinite += !(stored.D[j] > 0) || !stored.F.col(j).allFinite();
    return out;
}
TEST(GuardedFilter, OutlivesTenMillionRowsOfAbuseInFloat) {
    Guarded<Ud<float, 5>> g({.forgetting = float(lambda), .prior = Prior<float>{.variance = 100}});
    Survived const s = survive(g, 10'000'000, 71);
    EXPECT_EQ(s.not_finite, 0);
    EXPECT_EQ(s.indefinite, 0);
    EXPECT_GT(s.compared, 5000);
    EXPECT_EQ(s.worse, 0);
    EXPECT_GT(g.counts().changes, 1000);
    EXPECT_GT(g.counts().unusable, 5000);
}
TEST(GuardedFilter, WhatItGuardsDoesNot) {
    Ud<float, 5> bare({.forgetting = float(lambda), .prior = Prior<float>{.variance = 100}});
    Survived const s = survive(bare, 100'000, 71);
    EXPECT_GT(s.not_finite, 0);
    EXPECT_GT(s.worse, 0);
    Guarded<Ud<float, 5>, reporting> watched({.forgetting = float(lambda), .prior = Prior<float>{.variance = 100}});
    EXPECT_GT(survive(watched, 100'000, 71).worse, 0);
}

}  // namespace
}  // namespace rlslab
