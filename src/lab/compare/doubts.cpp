// The minimiser without a prior, its residuals, and what they and the columns say.
#include "src/lab/compare/compare.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/constant.hpp>
#include <rlslab/model/doubts.hpp>
#include <rlslab/model/outliers.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

std::optional<Outlier> outlier_of(Records const& records, Vector<Reference> const& theta, InFile const& in_file) {
    Signal residuals(in_file.lines.size(), NAN);  // those of rows that are left out are missing
    for (Index k = 0; k < records.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < records.parameters(); ++i) sum += records.psi(i, k) * static_cast<double>(theta[i]);
        residuals[size_t(in_file.rows[size_t(k)])] = records.y[k] - sum;
    }
    residuals.erase(residuals.begin(), residuals.begin() + records.presample);
    auto const found = outlier_in(residuals, in_file.order);
    if (!found) return {};
    Index const row = records.presample + found->at;
    return Outlier{row + 1, in_file.lines[size_t(row)], false, found->deviations, found->share};
}

std::string sentence_on_offset(Records const& records, std::vector<std::string> const& regressors) {
    double most = 0;
    bool constant = false;
    std::vector<Index> far;
    for (Index i = 0; i < records.parameters(); ++i) {
        bool const still = constant_value(records.psi.row(i)).has_value();
        double const off = still ? 0 : deviations_off_zero(records.psi.row(i));
        constant = constant || still, most = std::max(most, off);
        if (off > much_offset) far.push_back(i);
    }
    if (!constant || far.empty()) return "";
    return fmt::format(
        "{}: the mean is {}{:.3g} standard deviations off 0, beside a constant: that costs factor forms about {:.1f} "
        "digits of theta, forms that store P up to twice as many or more, and the rounding of the data to a short word "
        "as many again; --detrend gives them back",
        names_of(far, regressors), far.size() > 1 ? "up to " : "", most, correctly::log10(most));
}

}  // namespace

double deviations_off_zero(Vector<double> const& x) {
    if (auto const value = constant_value(x)) return *value == 0 ? 0 : std::numeric_limits<double>::infinity();
    int unit = 0;  // in units of a power of two, whose squares double can hold
    std::frexp(x.cwiseAbs().maxCoeff(), &unit);
    double mean = 0, squares = 0, N = double(x.size());
    for (double const v : x) mean += std::ldexp(v, -unit) / N;
    for (double const v : x) squares += (std::ldexp(v, -unit) - mean) * (std::ldexp(v, -unit) - mean) / N;
    return mean == 0 ? 0 : std::abs(mean) / std::sqrt(squares);
}

std::vector<std::string> doubts(Records const& records, CompareOptions const& options,
                                std::vector<std::string> const& regressors, InFile const& in_file) {
    Problem<double> const problem{
        .size = records.parameters(), .forgetting = options.forgetting, .prior = std::nullopt};
    Scattered const free = scattered(problem, records, {records.rows()}).front();
    if (free.exact.status() != Status::certified) return {};
    std::vector<std::string> out;
    Vector<double> const resolution =
        Eigen::Map<Vector<double> const>(in_file.resolution.data(), Index(in_file.resolution.size()));
    if (auto const dependent = dependent_but_for_rounding(records, free.scatter, resolution); !dependent.empty()) {
        std::string const names = names_of(dependent, regressors);
        out.push_back(sentence_on_dependence(names, "leave out one of " + names));
    }
    if (auto const outlier = outlier_of(records, free.exact.theta(), in_file))
        out.push_back(sentence_on(*outlier, options.composition.policy().intervenes()));
    if (std::string const offset = sentence_on_offset(records, regressors); !offset.empty()) out.push_back(offset);
    return out;
}

}  // namespace rlslab::compare
