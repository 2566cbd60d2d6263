// The steps in order: read, test the inputs, choose a structure, estimate, validate, remark.
#include "src/lab/identify/validate.hpp"

#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/catalogue/composition_text.hpp>
#include <rlslab/input/times.hpp>
#include <rlslab/model/outliers.hpp>

#include <algorithm>

namespace rlslab::identify {
using namespace report;
namespace {

struct InputCheck {
    Index supported;  ///< largest order that all inputs support, at most that of the widest structure
    std::vector<Excitation> excitation;  ///< of each input over the fitted part
    std::vector<Remark> remarks;
};
using Rank = Remark::Rank;

/// Remarks about an input of so many coefficients. u: with its mean, of which the first `fitted` samples count.
void remark_on_input(std::vector<Remark>& out, std::string const& name, Signal const& u, Index fitted,
                     Excitation const& e, Index coefficients) {
    if (e.order < coefficients)
        remark(out, Rank::excitation, "a richer input", "input {} is exciting of order {} only{}", name, e.order,
               e.order < 2 ? ""
                           : fmt::format(": it supports a model of order {}. An input that changes more often, or at "
                                         "more frequencies, supports a higher one",
                                         e.order - 1));
    else if (auto const spike = largest_spike(u, fitted); e.persistent < coefficients && spike.deviations > 10)
        remark(out, Rank::outlier, fmt::format("look at row {}", spike.row),
               "one value of input {}, in row {}, is {:.2g} standard deviations of the others off their mean, and the "
               "estimate rests on the rows that have it. If it is wrong, empty its cell, and it is skipped",
               name, spike.row, spike.deviations);
    else if (e.persistent < coefficients)
        remark(
            out, Rank::excitation, "a richer input",
            "input {} changes {}: its coefficients beyond {} rest on a few rows, and the noise there decides them. An "
            "input that changes more often says more",
            name, e.changes == 1 ? "once" : fmt::format("{} times", e.changes), e.persistent);
    constexpr Index long_enough = 20;  // a PRBS of long levels may well begin with one
    if (e.constant_at_start > long_enough && e.changes > 1 && e.order > 0)
        remark(
            out, Rank::whiteness, fmt::format("cut off the first {} samples", e.constant_at_start),
            "input {} stands still over the first {} of {} fitted samples: they say nothing of the dynamics; cut them "
            "off",
            name, e.constant_at_start, fitted);
}

void expect_supported(Record const& record, IdentifyOptions const& options, InputCheck const& check, Index needed) {
    if (structure_given(options) ? check.supported >= needed : check.supported >= 1) return;
    std::vector<std::string> reasons;
    for (Remark const& remark : check.remarks) reasons.push_back(remark.sentence);
    for (size_t j = 0; j < record.inputs.size(); ++j)
        if (auto const missing = std::ranges::count_if(record.inputs[j], [](double u) { return std::isnan(u); }))
            reasons.push_back(
                fmt::format("{} of {} samples of {} are missing, and each leaves out the rows that it is in", missing,
                            record.samples, printable(options.inputs[j])));
    refuse("{}: {} ({})", record.file,
           check.supported < 1
               ? "the input as it stands in the complete rows does not excite the system: it supports no "
                 "model of order 1 or more"
           : options.order
               ? fmt::format("order {} cannot be identified from this input; it supports order {}", options.order,
                             check.supported)
               : fmt::format("{} coefficients of an input cannot be identified from this record; it supports {}",
                             needed + 1, check.supported + 1),
           fmt::join(reasons, "; "));
}

/// An input of m coefficients must be exciting of order m. Throws InputError if the structure is given and not
/// supported, or if order 1 is not.
InputCheck check_inputs(Record const& record, IdentifyOptions const& options, Progress const& progress) {
    size_t const inputs = record.inputs.size();
    std::vector<Index> coefficients(inputs, 0);
    for (Term const& t : terms_of(options, widest_order(options)))
        if (t.input >= 0) ++coefficients[size_t(t.input)];
    Index const needed = inputs > 0 ? *std::ranges::max_element(coefficients) - 1 : widest_order(options);
    InputCheck out{.supported = needed, .excitation = {}, .remarks = {}};
    if (std::string const &said = record.of_times, mends = time_option(record.time); !said.empty())
        out.remarks.push_back({Rank::time, said, said.ends_with(mends) ? mends : ""});
    for (std::string const& sentence : record.warnings) out.remarks.push_back({Rank::excitation, sentence, ""});
    for (size_t j = 0; j < inputs; ++j) {
        Signal const& u = record.inputs_with_means[j];
        auto const part_done = [&](double part) {
            if (progress) progress((double(j) + part) / double(inputs));
        };
        Excitation const e = excitation(longest_run(u, record.fitted), coefficients[j],
                                        {.constant = options.intercept, .progress = part_done});
        if (e.order < coefficients[j]) out.supported = std::min(out.supported, e.order - 1);
        remark_on_input(out.remarks, printable(options.inputs[j]), u, record.fitted, e, coefficients[j]);
        out.excitation.push_back(e);
    }
    expect_supported(record, options, out, needed);
    return out;
}

std::vector<std::string> sentences(std::vector<Remark> const& remarks, bool hint) {
    std::vector<std::string> out;
    for (Remark const& remark : remarks)
        if (remark.hint == hint) out.push_back(remark.sentence);
    return out;
}

/// The unit to which each regressor's numbers are rounded (d).
Vector<double> resolutions_of(std::vector<Term> const& terms, Record const& record) {
    Vector<double> out(Index(terms.size()));
    for (size_t i = 0; i < terms.size(); ++i) {
        int const input = terms[i].input;
        out[Index(i)] = input == -2 ? 0 : input == -1 ? record.resolutions.back() : record.resolutions[size_t(input)];
    }
    return out;
}

Criteria criteria_of(IdentifyOptions const& options, Estimate const& estimate, Records const& fitted) {
    if (options.forgetting != 1) return {NAN, NAN, NAN};
    double const J =
        std::max(estimate.sigma2 * estimate.freedom, rounding_alone(fitted.rows(), fitted.y.cwiseAbs().maxCoeff()));
    return criteria(J, fitted.rows(), fitted.parameters());
}

/// The composition of the options along the record. Its numbers that are NaN follow from the data: fortescue's VARIANCE
/// is sigma^2, reset's VARIANCE the largest of P0. `mean` is added to the output again. Throws InputError if the
/// variant does not allow the composition.
Tracked track(IdentifyOptions const& options, Estimate const& estimate, Rows const& rows, double mean) {
    std::string const& variant = options.variant;
    Composition composition = options.composition;
    if (std::string const why = obstacle(composition, variant); !why.empty()) refuse("--variant {}: {}", variant, why);
    Records const& records = rows.records;
    Index const d = records.parameters();
    Problem<double> const problem{.size = d, .forgetting = options.forgetting, .prior = prior_of(estimate)};
    composition = completed(composition, problem, estimate.sigma2);
    Tracked out{.text = composition_text(composition), .rows = {}, .fit = NAN, .covered = NAN, .quantile = 0};
    out.warnings = warnings_of(composition, records.rows(), d);
    composition.window = std::min(composition.window, records.rows());  // a longer one takes memory alone
    out.quantile = normal_quantile(0.5 + options.confidence / 2);
    auto const filter = composed(composition, variant, "double", problem);
    Arithmetic const& arithmetic = *find_entry(variant)->arithmetic;
    Signal measured, predicted;  // measured: NaN for an outlier
    Index known = 0, within = 0;
    for (Index k = 0; k < records.rows(); ++k) {
        Interval<double> const expected = filter->prediction(records.sample(k), out.quantile);
        double const y = records.y[k];
        if (std::isfinite(expected.deviation)) ++known, within += expected.low <= y && y <= expected.high;
        Index const outliers = filter->counts().outliers;
        filter->update(records.sample(k), y);
        measured.push_back(filter->counts().outliers == outliers ? y : NAN), predicted.push_back(expected.value);
        TrackedRow row{rows.samples[size_t(k)] + 1, y + mean,          expected.value + mean, expected.deviation,
                       filter->noise_variance(),    Vector<double>(d), Vector<double>(d),     filter->counts()};
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
    out.fit = fit_of(measured, predicted, 0, records.rows());
    if (known > 0) out.covered = double(within) / double(known);
    return out;
}

}  // namespace

std::vector<std::string> Identified::warnings() const { return sentences(remarks, false); }
std::vector<std::string> Identified::hints() const { return sentences(remarks, true); }
std::string Identified::next() const {
    auto const first = std::ranges::find_if(remarks, [](Remark const& remark) { return !remark.next.empty(); });
    return first == remarks.end() ? "" : first->next;
}

Identified identify(DataFile const& file, IdentifyOptions const& given, Progress const& progress) {
    IdentifyOptions const options = completed(given);
    entry_of(options.variant);  // throws for an unknown one before the file is read
    Record const record = read_record(file, options);
    InputCheck const inputs = check_inputs(record, options, progress);
    Structure const structure = choose_structure(record, options, inputs.supported);
    expect_cures(options, structure, record);
    Rows const rows = rows_of(structure.terms, record.inputs, record.y);
    Records const fitted = rows.before(record.fitted).records;
    Estimation const estimation =
        estimate(record.file, options, structure, fitted, resolutions_of(structure.terms, record));
    Validation const validation = validate(record, options, structure, rows, fitted.rows(), estimation);
    Identified out{structure, estimation.estimate, criteria_of(options, estimation.estimate, fitted), validation};
    out.file = record.file;
    out.sha256 = record.sha256;
    out.options = options;
    out.samples = record.samples;
    out.fitted = fitted.rows();
    out.held_out = record.samples - record.fitted;
    out.skipped = rows.records.skipped;
    out.means = record.means;
    out.excitation = inputs.excitation;
    if (!options.composition.empty()) out.tracked = track(options, estimation.estimate, rows, record.means.back());
    if (options.noise_model) out.noise_model = with_noise_model(options, structure, record, estimation.estimate);
    if (options.instruments) out.instruments = with_instruments(options, structure, record, estimation.estimate);
    if (!out.ljung_box.white()) out.cure = cure_for(out, record);
    for (auto const& remarks : {inputs.remarks, estimation.remarks, remarks_on(out)})
        out.remarks.insert(out.remarks.end(), remarks.begin(), remarks.end());
    std::ranges::stable_sort(out.remarks, {}, [](Remark const& remark) { return std::pair(remark.hint, remark.rank); });
    return out;
}

}  // namespace rlslab::identify
