// When a stored P that loses its symmetry will be indefinite.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// The antisymmetric part of P in the conventional form is only divided by lambda at each row (docs/theory.md 28, law
/// ii), while P itself keeps its size. With a_k = max |P_ij - P_ji| / sqrt(P_ii P_jj) after row k, the guard's measure,
///
///   (1) P is indefinite at about row k + ln(1 / a_k) / -ln lambda
///
/// Told where the largest |P_ij - P_ji| grew by this law from each look to the next, over the second half of them: a
/// form that computes both products damps it, and it goes up and down.
class Foretold {
public:
    /// looks: how many there will be; lambda as stored.
    Foretold(double forgetting, size_t looks) : forgetting_(forgetting), looks_(looks) {}
    void look(Index row, Stored<Reference> const& stored);
    /// (1) after the last look; none: lambda is 1, a factor is stored, or the law does not hold.
    std::optional<double> row() const;

private:
    double forgetting_;
    size_t looks_, seen_ = 0;
    Index last_ = 0;
    double largest_ = 0, share_ = 0;
    bool grows_ = true;
};

/// "11000": two digits, as many as it has.
double rounded_row(double row);

}  // namespace rlslab::compare
