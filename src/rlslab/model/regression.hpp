// From columns of data to regression problems: y on given columns, or ARX models.
#pragma once

#include <rlslab/core/records.hpp>
#include <rlslab/input/csv.hpp>
#include <rlslab/model/lags.hpp>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace rlslab {

/// y[k] + a1 y[k-1] + ... + a_na y[k-na] = b0 u[k-delay] + ... + b_nb u[k-delay-nb] + c + xi[k], c only with
/// `intercept`.
///   psi = [-y[k-1] ... -y[k-na], u[k-delay] ... u[k-delay-nb], 1],   theta = [a1 ... a_na, b0 ... b_nb, c]
/// Several inputs have a polynomial b each, one after another.
struct Arx {
    int na, nb;     ///< >= 0; na = 0: a finite impulse response
    int delay = 0;  ///< >= 0
    bool intercept = false;
    int inputs = 1;                                                                  ///< >= 1
    Index size() const { return Index(na) + Index(inputs) * (nb + 1) + intercept; }  ///< d
    Index presample() const { return std::max(Index(na), Index(nb) + delay); }       ///< rows without full history
};

/// The model of that order: na = nb = order, no delay, no intercept. Throws InputError unless order >= 1.
Arx arx_of_order(int order);

/// y = psi'theta, one row for each row of the data without a missing value. With an intercept psi begins with a 1.
/// psi is d x N, d = regressors.size() + intercept. Throws InputError for no regressor, one named twice or as output,
/// fewer than d usable rows; std::invalid_argument for a column that was not read.
Records linear_records(Columns const& data, std::vector<std::string> const& regressors, std::string const& output,
                       bool intercept = false);

/// The same with present and past values u[k-lag], y[k-lag]: a past output with its own sign, not with that of Arx. The
/// first row is that at which the longest lag has a value. Names are "y[k-1]", "u[k-3]"; a plain regressor has its
/// column's name. used: unless null, the row of the data, from 0, of each row is appended to it. Throws InputError for
/// fewer than d usable rows; std::invalid_argument for no regressor, a negative lag, the output without a lag, a column
/// that was not read.
Records lagged_records(Columns const& data, std::vector<Lagged> const& regressors, std::string const& output,
                       bool intercept = false, std::vector<Index>* used = nullptr);

/// One row of the model's equation for each k at which u and y (equally long; NaN: missing) have all values that it
/// needs. psi is d x N, d = model.size(). Throws InputError for negative na, nb or delay and for fewer than d usable
/// rows; messages about rows begin with `file`.
Records arx_records(std::span<double const> u, std::span<double const> y, Arx const& model,
                    std::string const& file = "");

/// The same for several inputs, each with a name; the parameters of input "u2" are then named "b0[u2]" ... `used` as in
/// lagged_records.
Records arx_records(std::vector<std::span<double const>> const& inputs, std::vector<std::string> const& input_names,
                    std::span<double const> y, Arx const& model, std::string const& file = "",
                    std::vector<Index>* used = nullptr);

/// The same for two columns of a file. Throws InputError also if input and output are the same column.
Records arx_records(Columns const& data, std::string const& input, std::string const& output, Arx const& model);

}  // namespace rlslab
