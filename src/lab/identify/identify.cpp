// The steps in order: read, test the inputs, choose a structure, estimate, validate, remark.
#include "src/lab/identify/identify.hpp"

#include "src/lab/identify/coloured.hpp"
#include "src/lab/identify/inputs.hpp"
#include "src/lab/identify/remarks.hpp"
#include "src/lab/identify/validate.hpp"

#include <algorithm>

namespace rlslab::identify {
using namespace report;
namespace {

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

std::optional<Tracked> tracked_by(IdentifyOptions const& options, Estimate const& estimate, Rows const& rows,
                                  double mean) {
    if (options.composition.empty()) return {};
    Vector<double> const scales =
        Eigen::Map<Vector<double> const>(estimate.scales.data(), Index(estimate.scales.size()));
    Matrix<double> const P0 = (estimate.c / scales.array()).square().matrix().asDiagonal();
    Problem<double> const problem{
        .size = P0.rows(), .forgetting = options.forgetting, .prior = Prior<double>{.covariance = P0}};
    return track(options.composition, options.variant, problem, rows.records, rows.samples, mean, estimate.sigma2,
                 options.confidence);
}

std::vector<Remark> joined(std::vector<Remark> a, std::vector<Remark> const& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
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
    out.tracked = tracked_by(options, estimation.estimate, rows, record.means.back());
    if (options.noise_model) out.noise_model = with_noise_model(options, structure, record, estimation.estimate);
    if (options.instruments) out.instruments = with_instruments(options, structure, record, estimation.estimate);
    if (!out.ljung_box.white()) out.cure = cure_for(out, record);
    out.remarks = joined(joined(inputs.remarks, estimation.remarks), remarks_on(out));
    std::ranges::stable_sort(out.remarks, {}, [](Remark const& remark) { return std::pair(remark.hint, remark.rank); });
    return out;
}

}  // namespace rlslab::identify
