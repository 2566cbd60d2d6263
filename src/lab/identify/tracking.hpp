// A composition along the record: theta and the next output, with their intervals, at every row.
#pragma once

#include <rlslab/catalogue/composition.hpp>

#include <rlslab/core/records.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rlslab::identify {

struct TrackedRow {
    Index row;                ///< of the record, from 1
    double y, predicted, sd;  ///< prediction from the rows before, and its standard deviation; NaN: not known yet
    double noise_variance;    ///< after the row
    Vector<double> theta, theta_sd;  ///< after the row
    CompositionCounts happened;
};

/// The composition around a variant in double, over all rows: the fitted ones and those held out. Formulas: Assessed.
struct Tracked {
    std::string text;  ///< "window of 60 rows; guard reset"
    std::vector<TrackedRow> rows;
    double fit;       ///< of the predictions, percent, without the guard's outliers; NaN: not known
    double covered;   ///< share of the outputs within their interval
    double quantile;  ///< of the intervals: the normal distribution's
    Index broken =
        0;  ///< first row after which the stored P was not positive definite, or a number not finite; 0: none
    Health kind = Health::sound;  ///< what broke
    std::vector<std::string> warnings = {};
};

/// Numbers of the composition that are NaN follow from the data: fortescue's VARIANCE is `noise`, reset's VARIANCE the
/// largest of P0. `mean` is added to the output again; samples: k of each row, from 0.
/// Throws InputError if the variant does not allow the composition.
Tracked track(Composition composition, std::string const& variant, Problem<double> const& problem,
              Records const& records, std::vector<Index> const& samples, double mean, double noise, double confidence);

/// Lines for the text and the page.
std::vector<std::string> tracked_lines(Tracked const& tracked, std::vector<std::string> const& names,
                                       double confidence);
/// A line for each row: row, y, predicted, sd, noise_variance, each theta and its standard deviation, and the events.
std::string tracked_csv(Tracked const& tracked, std::vector<std::string> const& names);

}  // namespace rlslab::identify
