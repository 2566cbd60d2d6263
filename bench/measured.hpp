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
    std::optional<double> theta_nanoseconds, longest_nanoseconds;  ///< longest: of single updates
    bool solves_for_theta() const { return theta_nanoseconds.value_or(0) > 5; }
    double answered() const {
        return nanoseconds + theta_nanoseconds.value_or(0);
    }  ///< the update and theta() after it
};

struct Run {
    std::string machine;  ///< one line for people
    std::vector<BenchRow> rows;
};

/// Medians where the run was repeated, else the rows as they are. Throws std::runtime_error or
/// nlohmann::json::exception for another JSON.
Run run_of(std::string const& run_json);

/// "24 ns", "1.6 µs": three digits.
std::string time_for_people(double nanoseconds);

/// Markdown: nanoseconds an update of each variant and of dlib (where it is in the run) in double at 4 to 256
/// parameters, how many parameters it takes at 48 and 16 kHz, and the machine. Throws std::runtime_error where the run
/// has no such row.
std::string table_of_times(Run const& run);

}  // namespace rlslab::bench
