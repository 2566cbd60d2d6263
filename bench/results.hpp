// What a run of the benchmarks has, in the JSON that Google Benchmark wrote: as a page, as a table, as times on record.
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
    std::optional<double> theta_nanoseconds;
    bool solves_for_theta() const { return theta_nanoseconds.value_or(0) > 5; }
};

struct Run {
    std::string machine;  ///< one line for people
    std::vector<BenchRow> rows;
};

/// Medians where the run was repeated, else the rows as they are. Throws std::runtime_error or
/// nlohmann::json::exception for another JSON.
Run run_of(std::string const& run_json);

/// Plots and tables in one file that loads nothing.
std::string page_of(Run const& run);

/// Markdown: nanoseconds an update of each variant and of dlib (if it is in the run) in double at 4 to 256 parameters,
/// how many parameters it takes at 48 and 16 kHz, and the machine. std::runtime_error where the run has no such row.
std::string table_of_times(Run const& run);

/// One pass that reads and writes 8192 bytes: a row's time over it is what a faster clock leaves as it is.
inline constexpr char unit_row[] = "limit/read_modify_write/8192";

/// The file of the times on record with those of this run: the unit row and update/..., which the site shows, each
/// with its least, median and largest time over the median of the unit row's, under the kind of machine: processor,
/// instruction set and compiler. In place of what was there of its kind or, `add`, the rows which that has not: the
/// others keep their numbers. before: "" where there is no file. Throws std::runtime_error without the unit row, where
/// a row has fewer than five repetitions, and where nothing can be added: of a kind that is not there, or unless the
/// rows of both stand alike: the median of their factors is within a twentieth of 1.
std::string recorded(std::string const& before, std::string const& run_json, bool add);

/// argv: the program, "ranks", and up to four numbers: ranks, parameters, rows, rows of a group. Outside of an MPI job
/// it starts mpirun with the same words. Throws std::runtime_error for other words and where mpirun does not start.
int run_ranks(char** argv);

}  // namespace rlslab::bench
