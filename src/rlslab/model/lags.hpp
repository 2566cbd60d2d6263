// Lists of regressors in text: "y[k-1],y[k-2],u[k-3]".
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <rlslab/core/input_error.hpp>

#include <string>
#include <vector>

namespace rlslab {

/// column[k - lag].
struct Lagged {
    std::string column;
    int lag = 0;
    bool plain = false;  ///< written without brackets
    friend bool operator==(Lagged const&, Lagged const&) = default;
};

/// "u[k-3]", "u[k]".
std::string text_of(Lagged const& regressor);

inline constexpr int largest_lag = 1'000'000;
inline constexpr int most_regressors = 2000;

/// The regressors that these words name, in their order. A word is the name of a column and a number of samples back:
///
///   u[k-3]       u, three samples ago          u[k]    u now
///   y[k-1..k-4]  y[k-1],y[k-2],y[k-3],y[k-4]   u       as u[k]
///
/// A column whose name ends in brackets is followed by a second pair. Throws InputError whose message begins with
/// `option`, for a word that is none of these, a value from the future, the output at the same sample or without a lag,
/// a regressor named twice, more than most_regressors, or a lag above largest_lag.
std::vector<Lagged> lagged_of(std::string const& option, std::vector<std::string> const& words,
                              std::string const& output);

}  // namespace rlslab
