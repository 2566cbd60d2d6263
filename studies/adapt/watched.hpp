// A filter with a guard around it, or with none: its variant, arithmetic and policy are names.
#pragma once

#include <rlslab/adapt/guard.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>

#include <memory>
#include <vector>

namespace rlslab::studies {

/// Data are binary64 and are rounded once to the filter's arithmetic. The catalogue's ComposedFilter does not do: it
/// reports no signal of a row, has no limit for the innovation, and has no counting arithmetic.
class Watched {
public:
    virtual ~Watched() = default;
    virtual std::unique_ptr<Watched> clone() const = 0;
    /// Returns the guard's signal for the row; none without a guard.
    virtual GuardSignal update(double const* psi, double y) = 0;
    virtual Vector<double> theta() const = 0;
    virtual double variance(Index j) = 0;  ///< that a guard holds down: P_jj, or 1/R_jj^2
    virtual Stored<Reference> stored() const = 0;
    virtual GuardCounts counts() const = 0;  ///< zeros without a guard
};

/// The policies by name: none, report, reset, rebuild.
std::vector<std::string> const& guard_policies_by_name();
/// conventional, symmetric, potter, carlson, ud, inverse_qr, qr, gentleman.
std::vector<std::string> const& guarded_variants();

/// In "float" or "double". Null if there is no such pair of variant and policy.
std::unique_ptr<Watched> watched(std::string_view variant, std::string_view arithmetic, std::string_view policy,
                                 Problem<double> const&, double innovation = 6);
/// The mean operations of a row over 20 d white rows, after a memory, with the guard armed and nothing wrong. In
/// double.
double operations_of_a_row(std::string_view variant, std::string_view policy, Index size);

using MakeWatched = std::unique_ptr<Watched> (*)(Problem<double> const&, double innovation);
/// Null for another name. Each arithmetic has a file of its own.
MakeWatched watched_in_float(std::string_view variant, std::string_view policy);
MakeWatched watched_in_double(std::string_view variant, std::string_view policy);
MakeWatched watched_counting(std::string_view variant, std::string_view policy);

}  // namespace rlslab::studies
