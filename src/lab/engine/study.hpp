// A study: a question, its factors, the measurement for each combination of them, its plots and its claims.
#pragma once

#include <rlslab/studies/table.hpp>

#include <rlslab/catalogue/any_filter.hpp>

#include <concepts>

namespace rlslab::studies {

/// quick: seconds, for tests. full: the numbers that are quoted.
enum class Budget { quick, full };
std::string_view name_of(Budget budget);

struct Factor {
    std::string name;
    std::vector<Cell> values;
    std::vector<Cell> quick = {};  ///< at the quick budget; the same if empty
};
/// A list, or a function of the budget that makes one.
class Factors {
    std::function<std::vector<Factor>(Budget)> of_;

public:
    Factors(std::initializer_list<Factor> list);
    template <std::invocable<Budget> F>
    Factors(F of) : of_(std::move(of)) {}
    std::vector<Factor> operator()(Budget budget) const { return of_(budget); }
};

/// One combination of the factors' values: the unit of work, of parallelism and of resuming. Its results depend only on
/// the study's name, the run's seed, the budget and its own values, so that it may run on any thread and at any time.
class Trial {
    std::string_view study_;
    std::vector<Factor> const* factors_;
    std::vector<Cell> values_;
    std::uint64_t seed_;
    std::vector<CatalogueEntry> const* entries_;
    Budget budget_;

public:
    Trial(std::string_view study, std::vector<Factor> const& factors, std::vector<Cell> values, std::uint64_t seed,
          std::vector<CatalogueEntry> const& entries, Budget budget)
        : study_(study), factors_(&factors), values_(std::move(values)), seed_(seed), entries_(&entries),
          budget_(budget) {}

    std::vector<Cell> const& values() const { return values_; }
    Cell const& value(std::string_view factor) const;
    double number(std::string_view factor) const { return std::get<double>(value(factor)); }
    std::string const& text(std::string_view factor) const { return std::get<std::string>(value(factor)); }
    bool full() const { return budget_ == Budget::full; }

    /// The same seed for all trials that agree on these factors, so that several variants run on the same data.
    Seed seed(std::vector<std::string> const& factors) const;
    /// A variant by name. Throws std::logic_error if the catalogue has no such filter.
    CatalogueEntry const& entry(std::string_view variant, std::string_view arithmetic = "double") const;
};

/// The rows that a trial measures, any number of them. Each row begins with the values of the trial's factors.
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

/// A dashed curve for comparison.
struct Guide {
    std::string label;
    std::function<double(double x)> y;
};

/// How a table is drawn: y against x, one line for each value of `series`, one picture for each value of `panel`.
/// Several rows of the same x, series and panel are drawn as their median, with a band from the least to the greatest.
struct Plot {
    std::string title, x, y;
    std::string series = "variant", panel = {};
    std::string series_label = {};                                             ///< beside cells; its name if empty
    std::string log = "xy";                                                    ///< which axes are logarithmic
    std::string x_label = {}, y_label = {};                                    ///< the columns' names if empty
    std::vector<std::pair<std::string, std::vector<std::string>>> where = {};  ///< only rows with one of these values
    std::vector<Guide> guides = {};
    double floor = 0;  ///< smaller numbers are not drawn
    /// Cells instead of lines: `series` runs along y, and y's value is the shade of the cell.
    bool cells = false;
};

/// The kinds of claims. Files and printed text call an own result "finding".
enum class Kind {
    verification,  ///< the code does what the formula says; no result of ours
    reproduction,  ///< an earlier number comes out again: published, a textbook's, or the project's own
    own_result     ///< ours
};

/// The origin of a claim's band. Every claim has one.
struct Basis {
    Kind kind;
    std::string band;  ///< the source of its band: "docs/theory.md 28", "Bierman 1977, as in docs/literature.md 3.3",
                       ///< "set before the run";
    ///< an own result has the word "after" if a result had been seen, and "before" if not
    std::string data;        ///< the data of the claim; the study's if empty
    std::string proof = {};  ///< of a claim about every run: the theorem, "docs/theory.md 34", or "exact arithmetic"

    Basis(Kind kind_, std::string band_, std::string data_ = {})
        : kind(kind_), band(std::move(band_)), data(std::move(data_)) {}
    /// The same with a proof.
    Basis by(std::string proof_) const {
        Basis out = *this;
        out.proof = std::move(proof_);
        return out;
    }
};
inline Basis verification(std::string band, std::string data = {}) {
    return {Kind::verification, std::move(band), std::move(data)};
}
inline Basis reproduction(std::string band, std::string data = {}) {
    return {Kind::reproduction, std::move(band), std::move(data)};
}
inline Basis own_result(std::string band, std::string data = {}) {
    return {Kind::own_result, std::move(band), std::move(data)};
}

enum class Verdict { fails, undecided, holds };

/// The verdict on a claim, and the measurement.
struct Judgement {
    Verdict verdict;
    std::string measured;
    double risk = 0;      ///< probability that the verdict errs, by the intervals behind it; 0: nothing was random
    bool proven = false;  ///< by a proof, which the claim names

    Judgement(Verdict verdict_, std::string measured_, double risk_ = 0)
        : verdict(verdict_), measured(std::move(measured_)), risk(risk_) {}
    /// A judgement without an interval.
    Judgement(bool holds_, std::string measured_)
        : Judgement(holds_ ? Verdict::holds : Verdict::fails, std::move(measured_)) {}
    bool holds() const { return verdict == Verdict::holds; }
};
/// Both: the worse of the two verdicts, both measurements.
Judgement operator&&(Judgement const& a, Judgement const& b);
/// All of them.
Judgement together(std::vector<Judgement> const& parts);
/// Puts "label: " before the measurement.
Judgement labelled(std::string const& label, Judgement of);

/// How a claim is judged by the study's table; the same three of such.
using Judge = std::function<Judgement(Table const&)>;
Judge operator&&(Judge a, Judge b);
Judge together(std::vector<Judge> parts);
Judge labelled(std::string label, Judge of);

struct Claim {
    std::string text;
    Judge judge;
    Basis basis;
    double probability = -1;  ///< given to "holds" before the run; negative: none
};

struct Study {
    std::string name;            ///< as on the command line
    std::string question;        ///< one sentence
    std::string source;          ///< the source of the law, and how certain it is (docs/literature.md 0)
    std::string formula;         ///< LaTeX; \\ separates lines
    std::string interpretation;  ///< the result, and its differences from publications
    std::string data = {};       ///< the models of data of its claims
    Factors factors;
    std::function<bool(Trial const&)> admits = {};  ///< combinations that make sense; all if empty
    std::vector<std::string> measures;              ///< the columns behind the factors
    std::function<void(Trial const&, TrialOutput&)> measure;
    std::vector<Plot> plots;
    std::vector<Claim> claims;
};

/// THE list of studies, in the order in which people read them (studies/CMakeLists.txt).
std::vector<Study const*> const& studies();

}  // namespace rlslab::studies
