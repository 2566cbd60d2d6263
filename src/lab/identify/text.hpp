// What is said of a model, once for a terminal and a page: sentences, tables, figures, and the unit of time.
#pragma once

#include "src/lab/identify/identify.hpp"
#include "src/lab/report/figure.hpp"

#include <fmt/format.h>
#include <numeric>

namespace rlslab::identify {

/// "12.34 %"; "-" for an unknown number.
std::string percent_text(double x);
/// A number to so many significant digits; "-" for an unknown one.
std::string number_text(double x, int digits);
/// a1, b0, b0[u2], c.
std::vector<std::string> parameter_names(Identified const& model);

/// Converts samples to seconds, and cycles per sample to hertz, if the options have a sample time.
class Clock {
    std::optional<double> step_;

public:
    explicit Clock(IdentifyOptions const& options) : step_(options.sample_time) {}
    bool seconds() const { return step_.has_value(); }
    double time(double samples) const { return samples * step_.value_or(1); }
    double frequency(double cycles_per_sample) const { return cycles_per_sample / step_.value_or(1); }
    Signal times(auto const& samples) const {
        Signal out;
        for (auto const sample : samples) out.push_back(time(double(sample)));
        return out;
    }
    Signal times(Index first, size_t count) const {
        std::vector<Index> samples(count);
        std::iota(samples.begin(), samples.end(), first);
        return times(samples);
    }
    Signal frequencies(Signal x) const {
        for (double& f : x) f = frequency(f);
        return x;
    }
    char const* unit() const { return step_ ? "s" : "samples"; }
    char const* unit_of_frequency() const { return step_ ? "Hz" : "cycles per sample"; }
    /// Labels of axes.
    char const* axis() const { return step_ ? "time in seconds" : "sample"; }
    char const* axis_of_frequency() const { return step_ ? "frequency in hertz" : "frequency in cycles per sample"; }
    /// "0.35 s", "35 samples"; "0.35 s (sd 0.02)" with a standard deviation; "-" for an unknown number.
    std::string time_text(Uncertain samples) const { return text(samples, step_.value_or(1), unit()); }
    std::string frequency_text(Uncertain per_sample) const {
        return text(per_sample, 1 / step_.value_or(1), unit_of_frequency());
    }
    static std::string text(Uncertain x, double factor, char const* unit);
    /// "row 30", "row 30 (0.29 s)". Row 1 is at time 0.
    std::string row_text(Index row) const {
        return step_ ? fmt::format("row {} ({:.4g} s)", row, time(double(row - 1))) : fmt::format("row {}", row);
    }
};

/// If the variant gave no numbers, only the orders and the trajectory.
std::vector<report::Figure> figures_of(Identified const& model);

}  // namespace rlslab::identify
