// The columns of a record as the model uses them.
#pragma once

#include "src/lab/identify/identify.hpp"

namespace rlslab::identify {

/// The inputs and the output less their means; NaN: a missing value.
struct Record {
    std::string file;         ///< printable
    std::string sha256 = {};  ///< of the file
    std::vector<Signal> inputs = {};
    Signal y = {};
    std::vector<Signal> inputs_with_means = {};  ///< whose numbers show their resolution
    std::vector<double> means = {};              ///< subtracted from each input, then from the output
    std::vector<double> resolutions = {};        ///< of each input, then of the output
    std::vector<long> lines = {};                ///< of the file
    std::vector<std::string> warnings = {};      ///< of inputs that count upwards
    std::string of_times = {}, time = {};        ///< what a column of times says, and its name; empty: nothing
    Index samples = 0, fitted = 0;               ///< the first `fitted` samples are fitted, the others held out
};

/// Throws InputError for a record that cannot be read, a column that does not change, too few samples for the widest
/// structure of the options, and numbers that are too small.
Record read_record(DataFile const& file, IdentifyOptions const& options);

/// Samples first ... end - 1; a missing one is 0, the mean.
Signal zero_filled(Signal const& x, Index first, Index end);
/// The longest run without a missing value among the first `count` samples.
Signal longest_run(Signal const& x, Index count);

}  // namespace rlslab::identify
