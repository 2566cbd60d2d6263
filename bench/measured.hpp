// The rows of a finished run, read back from Google Benchmark's JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rlslab::bench {

/// One row, its name taken apart: GROUP/NAME/ARITHMETIC/CASE, GROUP/NAME/CASE or GROUP/CASE.
struct BenchRow {
    std::string group, name, arithmetic, what;  ///< what: the last part, "64" or "200000x10"
    std::string family;                         ///< "covariance", "factored covariance", "information", "peer", "limit"
    double size;                                ///< parameters; a limit's are those whose d x d doubles have its bytes
    double nanoseconds, digits;
    bool finite;
    std::optional<double> theta_nanoseconds, longest_nanoseconds;                    ///< longest: of single updates
    double answered() const { return nanoseconds + theta_nanoseconds.value_or(0); }  ///< the update and theta() after it
};

struct Run {
    std::string machine;  ///< one line for people
    std::vector<BenchRow> rows;
};

/// Medians where the run was repeated, else the rows as they are. Throws std::runtime_error for what is not such a file.
Run read_run(std::string const& path);

/// "24 ns", "1.6 µs": three digits.
std::string time_for_people(double nanoseconds);

}  // namespace rlslab::bench
