// A filter's run in fixed-point words: how it ends, and how many bits it needs.
#pragma once

#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/fixed_format.hpp>

#include <map>

namespace rlslab::studies {

/// Every dense variant in fixed point, in the format of the calling thread's FixedScope. The catalogue has none.
std::vector<CatalogueEntry> const& fixed_point_filters();
/// symmetric, ud or qr in the same format, with a rounding after every operation, not after every sum; null for any
/// other.
CatalogueEntry const* rounding_every_operation(std::string_view variant);

/// Extremes over a run, after every row: the eigenvalues of P; in 1-norms |P|, |P| |P^-1| and |psi|; the largest
/// |psi_i|.
struct Extremes {
    double least = 0, greatest = 0, P = 0, condition = 0, psi = 0, largest = 0;
};
Extremes extremes(Problem<double> const& problem, Records const& records);
/// -log2 of the relative precision that suffices (docs/theory.md 67).
double sufficient_bits(Extremes const& x, double lambda);

/// A problem, its data, and both as each format stores them.
class Setting {
    Problem<double> problem_;
    Records records_;
    double largest_ = 0;
    struct AsStored {
        Problem<double> problem;
        Records records;
        Matrix<double> P;
    };
    std::map<int, AsStored> by_fraction_;

public:
    Setting(Problem<double> problem, Records records) : problem_(std::move(problem)), records_(std::move(records)) {
        for (double const x : records_.psi.reshaped()) largest_ = std::max(largest_, std::abs(x));
        for (double const y : records_.y) largest_ = std::max(largest_, std::abs(y));
    }
    Problem<double> const& problem() const { return problem_; }
    Records const& records() const { return records_; }
    double largest() const { return largest_; }  ///< of all |psi_i| and |y|
    /// As words with so many bits behind the point hold them, with the exact P at the end: bits before the point change
    /// nothing while they suffice.
    AsStored const& stored(int fraction, Arithmetic const& arithmetic) {
        if (auto const found = by_fraction_.find(fraction); found != by_fraction_.end()) return found->second;
        AsStored out{as_stored(problem_, arithmetic), as_stored(records_, arithmetic), {}};
        InDouble exact(out.problem);
        for (Index k = 0; k < out.records.rows(); ++k) exact.take(out.records, k);
        out.P = exact.P;
        return by_fraction_[fraction] = std::move(out);
    }
};

/// How a run ended, in a word:
///   survives        sound and 0 < gamma <= 1 at every step, P definite at 200 looks, and at the end within half of the
///                   exact P
///   no_forgetting   lambda < 1 is the word 1       no_prior   the word for P0 is 0, or P0 does not fit
///   overflow        reported by the step (nonfinite), or seen in what is stored
///   indefinite, zero_pivot (a zero in D or on the diagonal of a triangle), gamma, undetermined, inaccurate
struct Run {
    std::string outcome;
    double error = INFINITY;
};
Run run_in(CatalogueEntry const& entry, Setting& setting, FixedFormat format);

/// The least bits behind the point from which on three lengths in a row survive, 48 bits in all: single ones survive by
/// luck. And the least before it, with 24 behind it and room for P0 and the data. Infinity: none up to 30, to 23.
struct Need {
    double fraction = INFINITY, integer = INFINITY;
    std::string below = "none";  ///< how the run with a bit less behind the point ended
};
Need need_of(CatalogueEntry const& entry, Setting& setting, FixedRounding rounding);

/// The rms error of theta from rounding alone over the law's (docs/theory.md 66), in words with 28 bits behind the
/// point.
double theta_noise(CatalogueEntry const& entry, Setting& setting, double lambda);
/// The shortest significand of floating point with which the symmetric form survives, by the same criterion; infinity:
/// none up to 30.
double floating_bits(Setting const& setting);

}  // namespace rlslab::studies
