// A composition around a variant, behind the erased interface.
#pragma once

#include <rlslab/catalogue/composition.hpp>

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/certified.hpp>
#include <rlslab/catalogue/any_filter.hpp>

#include <optional>
#include <variant>

namespace rlslab {

/// A composed filter behind the erased interface, with what it says of itself.
class ComposedFilter : public AnyFilter {
public:
    struct Account {
        CompositionCounts counts;
        std::optional<Certificate<double>> certificate;  ///< what its probes find; absent where it has none
        double noise_variance;
    };
    virtual Account account() const = 0;
    /// Of Assessed, rounded to binary64: theta_j +- q deviations, or psi's output. Deviations and the noise's variance
    /// are NaN until the noise is known, and of a variant that shows no state (`kalman` and `extended_qr` with
    /// `constant`).
    virtual Interval<double> interval(std::variant<Index, Regressor<double>> const& of, double q) = 0;
    Interval<double> prediction(Regressor<double> psi, double q) { return interval(psi, q); }
    CompositionCounts counts() const { return account().counts; }
    std::optional<Certificate<double>> certificate() const { return account().certificate; }
    double noise_variance() const { return account().noise_variance; }
};

/// The arithmetics in which compositions exist besides "reference" (257 bits).
std::vector<std::string_view> const& composed_arithmetics();
/// The composition around the variant in one of these, or in "reference"; null for another arithmetic, or where there
/// is an obstacle. Numbers are rounded to the arithmetic. Throws std::invalid_argument where they are then no options
/// (a variance that is 0 or infinite there), where the control has fewer or more numbers, for a window of fewer than 0
/// rows, and for a guard of another name.
std::unique_ptr<ComposedFilter> composed(Composition const& composition, std::string_view variant,
                                         std::string_view arithmetic, Problem<double> const& problem);

}  // namespace rlslab
