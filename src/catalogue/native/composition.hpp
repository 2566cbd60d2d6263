// What may be composed around a variant, named while the program runs: probes, a rule of forgetting, a window, a guard.
#pragma once

#include <rlslab/adapt/guard_policy.hpp>
#include <rlslab/adapt/rule_number.hpp>
#include <rlslab/core/problem.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace rlslab {

/// One number of a rule of forgetting, as the rule itself describes it (adapt/rules.hpp). `start` is NaN where the
/// number must be given or follows from the data.
struct ControlParameter {
    std::string_view name, member;
    bool whole;
    double start;
    RuleRange range;
};
/// A rule of adapt/rules.hpp by name.
struct Control {
    std::string_view name, what, type, header;
    bool below_one;  ///< wants Problem::forgetting < 1
    std::vector<ControlParameter> parameters;
};
std::vector<Control> const& controls();
/// Throws std::invalid_argument for another name.
Control const& control_named(std::string_view name);

/// The names of guard_policies.
std::vector<std::string_view> const& guard_names();

/// Most probes of a filter by name.
inline constexpr Index most_probes = 6;

/// Names that are empty, a window of 0 rows and 0 probes are not there. Throughout: probes stand next to the filter,
/// then a window, a guard outermost.
struct Composition {
    std::string control = "";
    std::vector<double> parameters = {};  ///< of the control, all of them
    Index window = 0;                     ///< rows
    std::string guard = "";
    Index certify = 0;  ///< probes (Certified), at most most_probes
    Index digits = 0;   ///< of P that the guard asks of the probes (GuardedDigits); 0: none

    bool empty() const { return control.empty() && window == 0 && guard.empty() && certify == 0 && digits == 0; }
    /// Whether theta and P minimise the J of some rows with constant lambda: no rule changes the forgetting.
    bool keeps_the_problem() const;
    /// What the guard does; that it reports where there is none. Throws std::invalid_argument for a name that is no
    /// policy's.
    GuardPolicy policy() const;
};
/// Why no variant can be composed so, or "".
std::string contradiction(Composition const& composition);
/// Whether the rule is this variant's own, and nothing is composed around it: the random walk of kalman.
bool is_its_own_rule(Composition const& composition, std::string_view variant);
/// Why this variant cannot, or "". The reason is the same in every arithmetic.
std::string obstacle(Composition const& composition, std::string_view variant);

/// What a composition did so far. Counts of what is not part of it stay 0.
struct CompositionCounts {
    Index refactored = 0;  ///< times that a window's kept rows were factored anew
    Index since = 0;       ///< rows since then, or since the start
    Index unusable = 0, outliers = 0, changes = 0, windups = 0,
          breakdowns = 0;  ///< as a guard counts them (GuardCounts)
};

}  // namespace rlslab
