// What the tests of lanes and fleets share: the rows and the problem of each filter, and equality of bits.
//
// A pack is compiled anew for each variant, rule, policy and shape. What a shape (the number of lanes, float or double,
// a size that the compiler knows or not) does is the same text for all of them, and so is what a rule does to a shape:
// each variant with each rule or policy is tried in one shape, each other shape with one variant.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/state/lanes.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rlslab::lanes {

inline constexpr Index d = 3;

/// The numbers of a lane and of the scalar filter that has its rows. Compared here: no expectation is compiled once for
/// each pair of types.
class Twins {
    std::vector<double> lane_, alone_;

public:
    void add(double of_lane, double of_one) { lane_.push_back(of_lane), alone_.push_back(of_one); }
    void add(Health of_lane, Health of_one) { add(double(of_lane), double(of_one)); }
    template <class A, class B>
    void add_all(A const& of_lane, B const& of_one) {
        for (Index i = 0; i < Index(of_one.size()); ++i) add(double(of_lane[i]), double(of_one[i]));
        add(double(of_lane.size()), double(of_one.size()));
    }
    void add(detail::LaneRead const& of_lane, detail::LaneRead const& of_one) {
        lane_.insert(lane_.end(), of_lane.values.begin(), of_lane.values.end());
        alone_.insert(alone_.end(), of_one.values.begin(), of_one.values.end());
    }
    /// Where they part first, or nothing; NaN is one NaN. They are then forgotten.
    std::string parted() {
        std::vector<double> const a = std::move(lane_), b = std::move(alone_);
        lane_ = {}, alone_ = {};
        if (a.size() != b.size()) return std::to_string(a.size()) + " numbers and " + std::to_string(b.size());
        for (size_t i = 0; i < a.size(); ++i)
            if (a[i] != b[i] && !(std::isnan(a[i]) && std::isnan(b[i])))
                return "number " + std::to_string(i) + ": " + std::to_string(a[i]) + " and " + std::to_string(b[i]);
        return {};
    }
    /// Whether they are one; a failure of the test where they are not.
    bool agree(std::string_view name, Index row, Index filter) {
        std::string const where = parted();
        if (where.empty()) return true;
        ADD_FAILURE() << name << ", row " << row << ", filter or lane " << filter << ", " << where;
        return false;
    }
};
/// Everything that a lane and the scalar filter hold.
template <class Together, class One>
void add_states(Twins& twins, Together& together, int lane, One& one) {
    detail::LaneRead of_lane(lane), of_one(0);
    detail::walk(of_lane, together);
    detail::walk(of_one, one);
    twins.add(of_lane, of_one);
}
/// The step of a lane and that of the scalar filter.
template <class T, class P>
void add_steps(Twins& twins, Step<P> const& step, int lane, Step<T> const& one) {
    twins.add(step.health[lane], one.health);
    twins.add(step.innovation[lane], one.innovation);
    twins.add(step.residual[lane], one.residual);
    twins.add(step.gamma[lane], one.gamma);
}
template <class P, class T>
void add_lanes(Twins& twins, P const& of_pack, int lane, T const& of_one) {
    for (Index j = 0; j < of_one.size(); ++j) twins.add(of_pack[j][lane], of_one[j]);
}
/// Bounds that a filter of floats keeps in double, and a pack of them in float: no bit of the answers depends on them.
template <class F>
constexpr bool keeps_bounds = std::same_as<typename F::scalar, float> && requires(F f) { f.form().lengths; };

/// The rows of one filter: silent for long stretches, with outliers, changes for ever and rows out of range.
template <class T>
struct Rows {
    Seed seed;
    double sign = 1;
    int silent = 0;
    Vector<T> psi = Vector<T>::Zero(d);
    T y = T(0);

    void next(bool nan) {
        double const chance = seed.uniform();
        if (silent > 0) --silent;
        else if (chance < 0.004) silent = 250;
        else if (chance < 0.01) sign = -sign;
        double out = 0.125 * seed.bell();
        for (Index j = 0; j < d; ++j) {
            psi[j] = silent > 0 ? T(0) : T(seed.bell());
            out += sign * double(psi[j]) * double(j + 1);
        }
        if (seed.uniform() < 0.02) out += 100;
        y = T(out);
        double const odd = seed.uniform();
        T const beyond = T(sizeof(T) == 4 ? 1e30 : 1e200);
        if (odd < 0.01) y = beyond;
        else if (odd < 0.02) psi[1] = -beyond;
        else if (nan && odd < 0.03) psi[0] = std::numeric_limits<T>::quiet_NaN();
        else if (nan && odd < 0.04) y = std::numeric_limits<T>::infinity();
    }
};

template <class T>
Problem<T> some_problem(Index i) {
    Problem<T> p{.size = d, .forgetting = T(i % 2 ? 0.9 : 0.9375)};
    p.prior->variance = T(i % 3 ? 100 : 16384);
    if (i % 4 == 1) p.prior->theta = Vector<T>::Constant(d, T(0.5));
    return p;
}

}  // namespace rlslab::lanes
