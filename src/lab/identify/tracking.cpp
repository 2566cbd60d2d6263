// The composition processes the rows one by one, and predicts each before its update.
#include "src/lab/identify/tracking.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/catalogue/composition_text.hpp>
#include "src/lab/identify/roots.hpp"
#include "src/lab/identify/text.hpp"

#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/model/fit.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

std::string cell(double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; }

}  // namespace

Tracked track(Composition composition, std::string const& variant, Problem<double> const& problem,
              Records const& records, std::vector<Index> const& samples, double mean, double noise, double confidence) {
    if (std::string const why = obstacle(composition, variant); !why.empty())
        throw InputError(fmt::format("--variant {}: {}", variant, why));
    composition = completed(composition, problem, noise);
    Tracked out{.text = composition_text(composition), .rows = {}, .fit = std::nan(""), .covered = 0, .quantile = 0};
    out.warnings = warnings_of(composition, records.rows(), records.parameters());
    composition.window = std::min(composition.window, records.rows());  // a longer one takes memory alone
    out.quantile = normal_quantile(0.5 + confidence / 2);
    auto const filter = composed(composition, variant, "double", problem);
    Arithmetic const& arithmetic = *find_entry(variant)->arithmetic;
    Index const d = records.parameters();
    Signal measured, predicted;  // without outliers
    Index known = 0, within = 0;
    for (Index k = 0; k < records.rows(); ++k) {
        Interval<double> const expected = filter->prediction(records.sample(k), out.quantile);
        double const y = records.y[k];
        if (std::isfinite(expected.deviation)) ++known, within += expected.low <= y && y <= expected.high;
        Index const outliers = filter->counts().outliers;
        filter->update(records.sample(k), y);
        if (filter->counts().outliers == outliers) measured.push_back(y), predicted.push_back(expected.value);
        TrackedRow row{samples[size_t(k)] + 1,   y + mean,          expected.value + mean, expected.deviation,
                       filter->noise_variance(), Vector<double>(d), Vector<double>(d),     filter->counts()};
        for (Index j = 0; j < d; ++j) {
            Interval<double> const at = filter->interval(j, out.quantile);
            row.theta[j] = at.value, row.theta_sd[j] = at.deviation;
        }
        if (out.broken == 0) {
            out.kind = breakdown(*filter, arithmetic);
            if (out.kind == Health::sound && !row.theta.allFinite()) out.kind = Health::nonfinite;
            if (out.kind != Health::sound) out.broken = row.row;
        }
        out.rows.push_back(std::move(row));
    }
    auto const numbers = [](Signal const& x) { return Eigen::Map<Vector<double> const>(x.data(), Index(x.size())); };
    out.fit = fit_percent(numbers(measured), numbers(predicted));
    out.covered = known > 0 ? double(within) / double(known) : std::nan("");
    return out;
}

std::vector<std::string> tracked_lines(Tracked const& t, std::vector<std::string> const& names, double confidence) {
    TrackedRow const& last = t.rows.back();
    std::string const happened = counts_text(last.happened);
    std::vector<std::string> out{
        fmt::format("tracked over all rows by {}: one-step fit {} %{}, {} % of the outputs within their {:g} % "
                    "interval; noise variance at the end {}{}",
                    t.text, number_text(t.fit, 4), last.happened.outliers > 0 ? " without the outliers" : "",
                    number_text(100 * t.covered, 3), 100 * confidence, number_text(last.noise_variance, 4),
                    happened.empty() ? "" : "; " + happened)};
    if (t.broken > 0)
        out.push_back(fmt::format("warning: {} broke down: {} at row {}; nothing of it is to be used from there on",
                                  t.text, name_of(t.kind), t.broken));
    for (std::string const& warning : t.warnings) out.push_back("warning: " + warning);
    std::vector<std::string> parts;
    for (Index j = 0; j < last.theta.size(); ++j)
        parts.push_back(fmt::format("{} = {} +- {}", names[size_t(j)], number_text(last.theta[j], 5),
                                    number_text(t.quantile * last.theta_sd[j], 2)));
    out.push_back(fmt::format("at the end {}", fmt::join(parts, ", ")));
    return out;
}

std::string tracked_csv(Tracked const& t, std::vector<std::string> const& names) {
    std::string out = "row,y,predicted,predicted_sd,noise_variance";
    for (std::string name : names) {
        std::replace(name.begin(), name.end(), '"', '\'');
        out += fmt::format(",\"{}\",\"{}_sd\"", name, name);
    }
    out += ",refactored,unusable,outliers,changes,windups,breakdowns\n";
    for (TrackedRow const& r : t.rows) {
        out += fmt::format("{},{},{},{},{}", r.row, cell(r.y), cell(r.predicted), cell(r.sd), cell(r.noise_variance));
        for (Index j = 0; j < r.theta.size(); ++j) out += fmt::format(",{},{}", cell(r.theta[j]), cell(r.theta_sd[j]));
        CompositionCounts const& h = r.happened;
        out += fmt::format(",{},{},{},{},{},{}\n", h.refactored, h.unusable, h.outliers, h.changes, h.windups,
                           h.breakdowns);
    }
    return out;
}

}  // namespace rlslab::identify
