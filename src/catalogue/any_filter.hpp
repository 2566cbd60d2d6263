// The type-erased interface: a filter of any variant in any arithmetic, with binary64 data and exact reports.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/family.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/records.hpp>
#include <rlslab/core/stored.hpp>

#include <functional>
#include <memory>
#include <variant>
#include <vector>

namespace rlslab {

/// Data are binary64 and are rounded once to the arithmetic. Reports are converted exactly to Reference. d is the
/// problem's size.
class AnyFilter {
public:
    virtual ~AnyFilter() = default;
    /// One row, psi of d numbers. The numbers of the step are rounded to binary64. Throws std::invalid_argument for
    /// another size.
    Step<double> update(Regressor<double> psi, double y) { return take(psi, y, nullptr); }
    /// One row, with relative errors in the vector that plays the gain in the update of P. One column: K_i (1 +
    /// errors_i) in place of K_i, wherever it is used, in a sweep's running gain too. A column for each number of the
    /// gain: column j are errors that enter a sweep's running gain after its column j, and stay; a gain computed at
    /// once takes the last. Throws std::invalid_argument unless CatalogueEntry::gain_perturbable, and for errors of
    /// another shape.
    Step<double> update(Regressor<double> psi, double y, Matrix<double> const& errors) { return take(psi, y, &errors); }
    /// Rows first ... last-1 of the records, in blocks if the variant TakesBlocks, otherwise one by one. Returns the
    /// step of the last row; after blocks its numbers are NaN and its health is that of the last block.
    virtual Step<double> update_block(Records const& records, Index first, Index last) = 0;
    Vector<Reference> theta() const { return std::get<0>(report(Number::theta)); }
    Vector<Reference> gain() const { return std::get<0>(report(Number::gain)); }
    Stored<Reference> stored() const { return std::get<1>(report(Number::stored)); }
    /// stored() rounded to binary64, except that a nonzero number never becomes zero. `surely_positive` decides most
    /// questions of definiteness from it.
    Stored<double> stored_in_double() const { return std::get<2>(report(Number::stored_in_double)); }
    virtual std::unique_ptr<AnyFilter> clone() const = 0;
    /// The state bit for bit, with the stream of stochastic rounding; and back into a filter of the same size. Throws
    /// InputError for other bytes, in one line, and the filter is then as it was. See <rlslab/state/state.hpp>.
    virtual std::vector<std::byte> saved() const = 0;
    virtual void load(std::span<std::byte const>) = 0;

protected:
    enum class Number { theta, gain, stored, stored_in_double };
    using Report = std::variant<Vector<Reference>, Stored<Reference>, Stored<double>>;
    virtual Step<double> take(Regressor<double> psi, double y, Matrix<double> const* errors) = 0;
    virtual Report report(Number what) const = 0;
};

/// ArithmeticTraits as data.
struct Arithmetic {
    std::string_view name;
    int digits, min_exp, max_exp;
    bool stochastic;
    /// A number as this arithmetic stores it: to nearest, also if the operations round otherwise.
    std::function<double(double)> round;
    double unit_roundoff() const { return std::ldexp(1.0, -digits); }
    double decimal_digits() const { return digits * 0.30102999566398120; }  ///< log10 2
};

/// The problem and the data as an arithmetic stores them, each number rounded by `round`. The reference for that
/// arithmetic must be computed from the same numbers.
inline Problem<double> as_stored(Problem<double> const& problem, std::function<double(double)> const& round) {
    return problem.mapped<double>(round);
}
inline Problem<double> as_stored(Problem<double> const& problem, Arithmetic const& arithmetic) {
    return as_stored(problem, arithmetic.round);
}
inline Records as_stored(Records records, std::function<double(double)> const& round) {
    records.psi = records.psi.unaryExpr(round).eval();
    records.y = records.y.unaryExpr(round).eval();
    return records;
}
inline Records as_stored(Records records, Arithmetic const& arithmetic) {
    return as_stored(std::move(records), arithmetic.round);
}

/// One pair of variant and arithmetic.
struct CatalogueEntry {
    std::string_view variant;
    Arithmetic const* arithmetic;
    bool starts_without_prior;
    Index block;                  ///< rows processed at once; 1 for most
    std::string_view propagates;  ///< "covariance" or "information"
    bool gain_perturbable;        ///< takes an error in what plays the gain in its update of P
    Family family;                ///< F::family: its colour and mark in figures
    /// Makes the filter for a problem given in binary64. The seed is for stochastic rounding; other arithmetics ignore
    /// it. Throws std::invalid_argument for a problem that is not well posed.
    std::function<std::unique_ptr<AnyFilter>(Problem<double> const&, Seed)> make;
    /// Nanoseconds for one row and theta() after it: the least mean over stretches of the records. Types are not erased
    /// inside.
    std::function<double(Problem<double> const&, Records const&, Seed)> time;
};

}  // namespace rlslab
