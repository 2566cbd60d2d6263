// A filter with a guard around it, or with none: its variant, arithmetic and policy are names.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/catalogue/native/compose.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/core/input_error.hpp>

#include <fmt/format.h>

#include <string>
#include <variant>

namespace rlslab::studies {

/// Data are binary64 and are rounded once to the arithmetic. The policy "none" is no guard. A value: copies are filters
/// of their own.
class GuardedFilter {
    std::variant<AnyAdaptive<float>, AnyAdaptive<double>> filter_;

    template <class T>
    static AnyAdaptive<T> made(std::string_view variant, std::string_view policy, Problem<double> const& problem,
                               double innovation) {
        return composed_around<T>({.guard = policy == "none" ? "" : std::string(policy)}, {.innovation = innovation},
                                  variant, problem_as<T>(problem));
    }
    static decltype(filter_) made(std::string_view variant, std::string_view arithmetic, std::string_view policy,
                                  Problem<double> const& problem, double innovation) {
        if (arithmetic == "float") return made<float>(variant, policy, problem, innovation);
        if (arithmetic == "double") return made<double>(variant, policy, problem, innovation);
        throw InputError(fmt::format("guarded filters exist here in float and double, not in {}", arithmetic));
    }

public:
    GuardedFilter(std::string_view variant, std::string_view arithmetic, std::string_view policy,
                  Problem<double> const& problem, double innovation = 6)
        : filter_(made(variant, arithmetic, policy, problem, innovation)) {}

    /// Returns the guard's signal for the row; none without a guard.
    GuardSignal update(Regressor<double> psi, double y) {
        return std::visit(
            [&]<class T>(AnyAdaptive<T>& f) {
                Vector<T> const row = Eigen::Map<Vector<double> const>(psi.data(), psi.size()).unaryExpr(&round_to<T>);
                f.update(row, round_to<T>(y));
                return f.signal();
            },
            filter_);
    }
    Vector<double> theta() const {
        return std::visit([](auto const& f) -> Vector<double> { return f.theta().template cast<double>(); }, filter_);
    }
    /// What a guard would hold down, of a filter without one: P_jj, or 1/R_jj^2.
    double variance(Index j) {
        return std::visit([j](auto& f) { return double(watched_variance(f, j)); }, filter_);
    }
    Stored<Reference> stored() const {
        return std::visit(
            [](auto const& f) { return f.stored().template mapped<Reference>([](auto const& x) { return widen(x); }); },
            filter_);
    }
    CompositionCounts counts() const {  ///< zeros without a guard
        return std::visit([](auto const& f) { return f.composition_counts(); }, filter_);
    }
};

}  // namespace rlslab::studies
