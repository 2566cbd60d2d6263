// Every variant in every arithmetic behind the erased boundary, and what a variant costs.
#pragma once

#include <rlslab/lab/any_filter.hpp>

namespace rlslab {

/// Which operations one update took, by the Counted scalar.
struct Operations {
    long additions = 0, multiplications = 0, divisions = 0, square_roots = 0;
    long total() const { return additions + multiplications + divisions + square_roots; }
};

/// What one row costs: the update, and theta() after it where a variant solves for theta on request.
struct Cost {
    Operations update, theta;
    long total() const { return update.total() + theta.total(); }
};

/// Every pair there is: arithmetics from the shortest to the longest, variants in the order of the list.
std::vector<Entry> const& catalogue();
/// Every variant in significands of any length: as many bits as the PrecisionScope has that is alive in the thread which makes,
/// feeds and asks the filter (<rlslab/arithmetic/variable_precision.hpp>). Not in the catalogue: it is a question, not an arithmetic.
std::vector<Entry> const& variable_precision_catalogue();
/// The entry of a variant in an arithmetic, of these or of the catalogue's; nullptr where there is none.
Entry const* find_entry(std::vector<Entry> const& entries, std::string_view variant, std::string_view arithmetic);
Entry const* find_entry(std::string_view variant, std::string_view arithmetic = "double");
/// An entry of each variant of the catalogue, in the order of the list.
std::vector<Entry const*> one_entry_each();
/// The arithmetics of the catalogue, in its order.
std::vector<Arithmetic> const& arithmetics();
/// The operations a variant of this size takes at steady state (lambda = 0.99), per row; theta once for each block where
/// rows come in blocks. nullopt where the arithmetic is a library's.
std::optional<Cost> cost(std::string_view variant, Index size);

}  // namespace rlslab
