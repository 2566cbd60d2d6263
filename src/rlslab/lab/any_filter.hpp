// The erased boundary: a filter of any variant in any arithmetic, seen through binary64 data and exact reports.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/records.hpp>
#include <rlslab/core/stored.hpp>

#include <memory>
#include <vector>

namespace rlslab {

/// Data go in as binary64 and are rounded once to the arithmetic; reports come out widened, exactly.
class AnyFilter {
public:
    virtual ~AnyFilter() = default;
    /// One row. A step's numbers are rounded to binary64.
    virtual Step<double> update(Regressor<double> psi, double y) = 0;
    /// One row, with K_i (1 + relative_i) in place of K_i. Throws std::invalid_argument unless Entry::gain_perturbable.
    virtual Step<double> update(Regressor<double> psi, double y, Vector<double> const& relative) = 0;
    /// Rows first ... last-1 as the variant likes them best: blocks where it TakesBlocks, else one by one. The step is
    /// the last row's, or for a block its health alone.
    virtual Step<double> update_block(Records const& records, Index first, Index last) = 0;
    virtual Vector<Reference> theta() const = 0;
    virtual Vector<Reference> gain() const = 0;
    virtual Stored<Reference> stored() const = 0;
    /// stored() rounded to binary64, where only what is zero becomes zero: for a first look that settles most questions of
    /// definiteness.
    virtual Stored<double> stored_in_double() const = 0;
    virtual std::unique_ptr<AnyFilter> clone() const = 0;
    /// The state bit for bit, with the stream of stochastic rounding; and back into a filter of the same size. Throws InputError for other
    /// bytes, in one line, and the filter is then as it was. See <rlslab/adapt/state.hpp>.
    virtual std::vector<std::byte> saved() const = 0;
    virtual void load(std::span<std::byte const>) = 0;
};

/// What the lab knows of an arithmetic, as data.
struct Arithmetic {
    std::string_view name;
    int digits, min_exp, max_exp;
    bool stochastic;
    double (*round)(double);  ///< a datum as this arithmetic stores it; nearest also where the operations are stochastic
    double unit_roundoff() const { return std::ldexp(1.0, -digits); }
    double decimal_digits() const { return digits * 0.30102999566398120; }  ///< log10 2
};

/// One (variant, arithmetic) pair.
struct Entry {
    std::string_view variant;
    Arithmetic const* arithmetic;
    bool starts_without_prior;
    Index block;                  ///< rows absorbed at once; 1 for most
    std::string_view propagates;  ///< "covariance" or "information"
    bool gain_perturbable;        ///< an error in K changes P
    /// The filter for a problem given in binary64; the seed is that of stochastic rounding, unused elsewhere.
    /// Throws std::invalid_argument on misuse.
    std::unique_ptr<AnyFilter> (*make)(Problem<double> const&, Seed);
    /// Nanoseconds per row with theta() after it, the least over stretches of the records; the types are not erased inside.
    double (*time)(Problem<double> const&, Records const&, Seed);
};

}  // namespace rlslab
