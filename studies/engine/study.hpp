// What a study is: a question, its factors, what is measured of each combination, how it is drawn, and its claims.
#pragma once

#include "studies/engine/table.hpp"

#include <rlslab/lab/any_filter.hpp>

namespace rlslab {

/// quick: seconds, for tests. full: what is quoted.
enum class Budget { quick, full };

struct Factor {
    std::string name;
    std::vector<Cell> values;
};

/// One combination of the factors' values: the unit of work, of parallelism and of resuming. Its results depend only on the study's name,
/// the run's seed, the budget and its own values, so that it may run on any thread and at any time.
class Trial {
    std::string_view study_;
    std::vector<Factor> const* factors_;
    std::vector<Cell> values_;
    std::uint64_t seed_;
    std::vector<Entry> const* entries_;
    Budget budget_;

public:
    Trial(std::string_view study, std::vector<Factor> const& factors, std::vector<Cell> values, std::uint64_t seed,
          std::vector<Entry> const& entries, Budget budget)
        : study_(study), factors_(&factors), values_(std::move(values)), seed_(seed), entries_(&entries), budget_(budget) {}

    std::vector<Cell> const& values() const { return values_; }
    Cell const& value(std::string_view factor) const;
    double number(std::string_view factor) const { return std::get<double>(value(factor)); }
    std::string const& text(std::string_view factor) const { return std::get<std::string>(value(factor)); }
    bool full() const { return budget_ == Budget::full; }

    /// The same seed for all trials that agree on these factors, so that several variants are given the same data.
    Seed seed(std::vector<std::string> const& factors) const;
    /// A variant by name. Throws std::logic_error when the catalogue has no such filter.
    Entry const& entry(std::string_view variant, std::string_view arithmetic = "double") const;
};

/// The rows that a trial measured, any number of them; the values of its factors are put before each.
class TrialOutput {
    std::vector<Cell> const& values_;
    std::vector<std::string> lines_;

public:
    explicit TrialOutput(Trial const& trial) : values_(trial.values()) {}
    void operator()(std::vector<Cell> measures) {
        std::vector<Cell> row = values_;
        row.insert(row.end(), measures.begin(), measures.end());
        lines_.push_back(csv_line(row));
    }
    std::vector<std::string> const& lines() const { return lines_; }
};

/// A dashed curve to compare with.
struct Guide {
    std::string label;
    std::function<double(double x)> y;
};

/// How a table is drawn: y against x, one line for each value of `series`, one picture for each value of `panel`. Several rows of the same
/// x, series and panel are drawn as their median, with a band from the least to the greatest.
struct Plot {
    std::string title, x, y;
    std::string series = "variant", panel = {};
    std::string log = "xy";                                                    ///< which axes are logarithmic
    std::string x_label = {}, y_label = {};                                    ///< the columns' names if empty
    std::vector<std::pair<std::string, std::vector<std::string>>> where = {};  ///< only rows with one of these values
    std::vector<Guide> guides = {};
    double floor = 0;  ///< smaller numbers are not drawn
    /// Cells instead of lines: `series` runs along y, and y's value is the shade of the cell.
    bool cells = false;
};

/// Whether a claim holds, and the numbers measured.
struct Finding {
    bool holds;
    std::string measured;
};

struct Claim {
    std::string text;
    std::function<Finding(Table const&)> holds;
    std::string source = {};  ///< where the claim is from; the study's if empty
};

struct Study {
    std::string name;            ///< as on the command line
    std::string question;        ///< one sentence
    std::string source;          ///< where the law is from, and how certain that is (docs/literature.md 0)
    std::string formula;         ///< LaTeX; lines apart by \\ .
    std::string interpretation;  ///< of the result, and where it differs from published ones
    std::function<std::vector<Factor>(Budget)> factors;
    std::function<bool(Trial const&)> admits = {};  ///< combinations that make sense; all if empty
    std::vector<std::string> measures;              ///< the columns behind the factors
    std::function<void(Trial const&, TrialOutput&)> measure;
    std::vector<Plot> plots;
    std::vector<Claim> claims;
};

/// THE list of studies, in the order in which people read them (studies/CMakeLists.txt).
std::vector<Study const*> const& studies();

}  // namespace rlslab
