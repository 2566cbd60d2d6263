// compare --digits N: the shortest arithmetic that keeps N digits of every parameter, with its scaling and its prior.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// The digits of the worst parameter that a variant keeps in an arithmetic:
///   (1) along   at nine tenths of the checkpoints along each run, of the exact solution there for the prior and the
///               data as stored, as `compare` counts them
///   (2) at_end  after the last row, of the least-squares solution for the data as given: the least of all runs. Prior
///               and rounding of the data are in it
/// A run is a draw of the roundings in the record's order, or another order of the rows. (1) is of the
/// record's order. A parameter whose least-squares value is zero has no digits and is left out of (2).
struct KeptDigits {
    Result const* result;
    double along, at_end;
    double both() const { return std::min(along, at_end); }
};

/// One arithmetic, tried. Moves, for results are pointed at.
struct ArithmeticTrial {
    ArithmeticTrial() = default;
    ArithmeticTrial(ArithmeticTrial&&) = default;
    ArithmeticTrial& operator=(ArithmeticTrial&&) = default;

    std::string arithmetic;
    std::vector<int> exponents;     ///< regressor i was taken times 2^exponents[i]; empty: the columns as they are
    int output_exponent = 0;        ///< likewise y
    std::vector<bool> is_zero;      ///< least-squares value 0: below 1e-38 of the largest, in units of the regressors
    Comparison comparison{};        ///< of the columns as they were taken
    bool in_range = true;           ///< whether the stored prior and lambda are positive and finite there
    std::vector<KeptDigits> sound;  ///< variants that never broke down, as they are recommended (answer.hpp)
    double wanted = 0;              ///< digits

    std::vector<std::string> zeros() const;  ///< the names of parameters that are zero
    KeptDigits const* first_enough() const;  ///< the first that keeps as many as are wanted, or null
    KeptDigits const* most() const;          ///< the one that keeps the most, or null
};

/// A guarded filter, with the policy that resets, once through the record.
struct GuardTrial {
    CompositionCounts counts;
    bool same_bits;  ///< after every row theta equals that of the filter alone, number for number
};

struct DigitsAnswer {
    double wanted = 0;
    std::vector<ArithmeticTrial> trials;  ///< the last one is the one that keeps the digits, if any does
    std::optional<GuardTrial> guard;      ///< around the chosen variant; absent where it cannot have one
    ArithmeticTrial const* chosen() const {
        return !trials.empty() && trials.back().first_enough() ? &trials.back() : nullptr;
    }
    KeptDigits const* choice() const { return chosen() ? trials.back().first_enough() : nullptr; }
    bool guarded() const { return guard.has_value(); }  ///< in the code
};

/// options.digits (absent: `compare`'s own three) of every parameter. For each of the options' arithmetics in turn
/// (none: all, the shortest first), until one has a variant that keeps them:
///   (3) the columns as they are; or, if the largest number of a column or of y has an exponent beyond -e/4 ... e/4, e
///       the arithmetic's largest, each column and y times the power of two that makes its largest number at least 1
///       and less than 2
///   (4) P0 is the default prior (default_prior.hpp) with c doubled until at the last row it leaves 0.3 digits more
///       than are wanted, or than the arithmetic has, or P0 would leave its range
///   (5) of the variants that keep the digits and never broke down the first in the order of `compare`'s recommendation
///     for so many digits
/// The composition and p0 of the options are left out. Throws InputError as `compare` does.
DigitsAnswer digits_answer(Records const& records, CompareOptions const& options, ModelText const& model = {},
                           report::Progress const& progress = {});

/// The answer as text, with the C++ that makes the filter.
std::string answer_text(DigitsAnswer const& answer, bool colour, size_t columns = 0);
/// Digits to a tenth, rounded down: none is promised that is not there.
inline double tenth_below(double digits) { return std::floor(10 * digits) / 10 + 0.0; }
/// The file of code alone (answer.hpp); "" where nothing keeps the digits, or the hardware has no such arithmetic.
std::string code(DigitsAnswer const& answer, std::string_view word = "cpp");

}  // namespace rlslab::compare
