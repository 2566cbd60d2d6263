// What a guard does about what it sees: actions, policies, and THE list of policies.
#pragma once

#include <rlslab/adapt/guard_signal.hpp>
#include <rlslab/core/matrices.hpp>
#include <rlslab/core/scalar.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace rlslab {

/// What a guard can do about a signal.
///   report    count it, and nothing else
///   skip      the row does not reach the filter, nor does its time pass; after a change for ever, unless a change
///             resets
///   cap       a proximal row on one coordinate: P_jj = largest_variance, theta as it is
///   reset     P = v I, v the largest variance at the start or what the rows at hand admit ((6) of guard.hpp), and
///   theta as it was last seen finite; without a prior as (7) there says
///   rebuild   reset, then the kept rows anew
enum class Action : unsigned char { report, skip, cap, reset, rebuild };

/// The action on each signal. Data that are not finite or out of range ((1) of guard.hpp) are skipped whatever the
/// policy.
struct GuardPolicy {
    Action outlier = Action::report;    ///< report or skip
    Action change = Action::report;     ///< report, reset
    Action windup = Action::report;     ///< report, cap
    Action breakdown = Action::report;  ///< report, reset, rebuild

    /// Whether it does more than count.
    constexpr bool intervenes() const { return outlier != Action::report || windup != Action::report || resets(); }
    constexpr bool resets() const { return change != Action::report || breakdown != Action::report; }
    constexpr bool rebuilds() const { return breakdown == Action::rebuild; }
    /// Rows that reached the filter.
    constexpr Index taken(GuardCounts const& n) const {
        Index const unseen = outlier != Action::skip ? 0 : n.outliers - (change == Action::reset ? n.changes : 0);
        return n.rows - n.unusable - unseen;
    }
    constexpr bool valid() const {
        return (outlier == Action::report || outlier == Action::skip) &&
               (change == Action::report || change == Action::reset) &&
               (windup == Action::report || windup == Action::cap) && breakdown != Action::skip &&
               breakdown != Action::cap;
    }
};
inline constexpr GuardPolicy reporting{};
inline constexpr GuardPolicy resetting{Action::skip, Action::reset, Action::cap, Action::reset};
inline constexpr GuardPolicy rebuilding{Action::skip, Action::reset, Action::cap, Action::rebuild};

/// Digits that P is asked to keep, and after how many rows that the filter took the probes are looked at again. 0
/// digits: never.
struct GuardedDigits {
    int wanted;
    Index every;
    constexpr GuardedDigits(int digits = 0, Index rows = 100) : wanted(digits), every(rows) {}
    /// Of d parameters in T with probes in L: refuses more than a bound can show, which is at least 10 sqrt(d) u of L,
    /// and hardly below 10 u of T.
    template <class T, class L>
    void check(Index d) const {
        expects(wanted >= 0 && every >= 1, "digits >= 0, of every row or more");
        double const of_T = std::ldexp(1.0, -significand_bits<T>()), of_L = std::ldexp(1.0, -significand_bits<L>());
        double bound = 10 * std::max(of_T, std::sqrt(double(d)) * of_L);
        int most = -1;
        for (; bound <= 1; bound *= 10) ++most;
        char what[64];
        std::snprintf(what, sizeof what, "digits <= %d, all that a bound in these words shows", most);
        expects(wanted <= most, what);
    }
};
/// In its place around a filter without probes: no number goes in.
struct NoProbes {};

/// certified: of a guard around probes (Guarded<Certified<F>>).
template <Field T, bool certified = false>
struct GuardOptions {
    T largest_variance = T(0);     ///< of p in (4), in units of the noise's; 0: 16 times the start's, or as (7) says
    T innovation = T(6);           ///< c of the innovation test, in standard deviations; 0: none
    T least_noise = T(0);          ///< a standard deviation below which the noise is not believed to be
    Index noise_memory = 200;      ///< rows that the noise's variance is averaged over, >= 1
    T asymmetry = T(1) / T(1024);  ///< |P_ij - P_ji| / sqrt(P_ii P_jj), of a P in full storage
    Index rebuild_rows = 0;        ///< kept for rebuilding; 0: 10 d
    std::conditional_t<certified, GuardedDigits, NoProbes> digits = {};  ///< of P, (8) of guard.hpp; not in the state
};

/// A policy by name. `what` follows the name in a sentence about guards.
struct NamedPolicy {
    std::string_view name, constant, what;
    GuardPolicy policy;
};
/// A new policy is its constant above and a line here; the program goes through the list.
inline constexpr NamedPolicy guard_policies[] = {
    {"report", "reporting", "counts outliers, changes, windup and breakdowns", reporting},
    {"reset", "resetting", "also skips outliers, restarts at a change, caps windup and resets at a breakdown",
     resetting},
    {"rebuild", "rebuilding", "as reset, but processes the last rows again after a breakdown", rebuilding},
};
/// Null for another name.
constexpr NamedPolicy const* find_policy(std::string_view name) {
    for (NamedPolicy const& named : guard_policies)
        if (named.name == name) return &named;
    return nullptr;
}

}  // namespace rlslab
