// What a run of the benchmarks leaves for later ones on the same kind of machine: the time of each row that is shown,
// over the unit row's.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace rlslab::bench {

/// One pass that reads and writes 8192 bytes: a row's time over it is what a faster clock leaves as it is.
inline constexpr char unit_row[] = "limit/read_modify_write/8192";

/// A row's times over the median of the unit row's in the same run: interleaved at random, repetitions of two rows are
/// no pairs.
struct Ratio {
    double least, middle, greatest;
    bool operator==(Ratio const&) const = default;
};
struct Baseline {
    std::string machine;  ///< the kind: processor, instruction set and compiler
    int repetitions = 0;
    std::map<std::string, Ratio> rows;
};

/// The unit row and update/..., which the site shows, of the JSON that Google Benchmark wrote. Throws
/// std::runtime_error without the unit row, or where a row has fewer than five repetitions.
Baseline baseline_of(std::string const& run_json);

/// One for each kind of machine.
using Baselines = std::vector<Baseline>;
/// In place of the one of its kind of machine, or behind the others.
void record(Baselines& all, Baseline now);
/// The rows that the one of its kind of machine has not; the others keep their numbers. Throws std::runtime_error as
/// of_machine, and unless the rows of both stand alike: the median of their factors is within a twentieth of 1.
void add(Baselines& all, Baseline const& now);
/// "a processor, avx2, g++ 12.2.0 (871 rows); ...", or "none".
std::string names_of(Baselines const& all);
/// Throws std::runtime_error, with the kinds that were recorded, where this one was not.
Baseline const& of_machine(Baselines const& all, std::string const& machine);

std::string written(Baselines const& all);
/// Throws std::runtime_error or nlohmann::json::exception for what written() does not write.
Baselines read_baselines(std::string const& text);

}  // namespace rlslab::bench
