// Sliding windows by name, and one that downdates with the rows at hand.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/stored.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rlslab::studies {

/// A window's variant and arithmetic are names. Data are binary64 and are rounded once to the filter's arithmetic. The
/// catalogue's ComposedFilter does not do: it has no schedule of refactoring and no predicted error.
class SlidingFilter {
public:
    virtual ~SlidingFilter() = default;
    virtual void update(double const* psi, double y) = 0;
    virtual Vector<Reference> theta() const = 0;
    virtual Stored<Reference> stored() const = 0;
    virtual Index refactored() const = 0;
    /// sqrt(V / V0) of docs/theory.md 60; NaN if it is not known.
    virtual double predicted() const = 0;
};

/// When a window is factored anew: on alarm, at the error expected to be `worse` times a fresh filter's, and every so
/// many rows (0: never).
struct Refactoring {
    double worse;
    Index every;
};

/// conventional, symmetric, potter, carlson, ud, qr, gentleman.
std::vector<std::string> const& windowed_variants();
/// Of the last `rows` rows, in "float" or "double". Fed no more than `rows` rows it is a fresh filter on them.
/// Variant "corrected": see CorrectedDowndate. Throws std::logic_error for another name.
std::unique_ptr<SlidingFilter> sliding(std::string_view variant, std::string_view arithmetic, Problem<double> const&,
                                       Index rows, Refactoring const& refactoring);

}  // namespace rlslab::studies
