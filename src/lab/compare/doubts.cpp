// The minimiser without a prior, its residuals, and what they and the columns say.
#include "src/lab/compare/doubts.hpp"

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

/// |mean| over standard deviation of each regressor; 0 for a constant.
std::vector<double> offsets(Records const& records) {
    std::vector<double> out;
    for (Index i = 0; i < records.parameters(); ++i) {
        auto const x = records.psi.row(i);
        double mean = 0, squares = 0;
        for (double const v : x) mean += v / double(records.rows());
        for (double const v : x) squares += (v - mean) * (v - mean) / double(records.rows());
        out.push_back(constant_value(x) || !(squares > 0) ? 0 : std::abs(mean) / std::sqrt(squares));
    }
    return out;
}

std::string sentence_on_offset(Records const& records, std::vector<std::string> const& regressors) {
    std::vector<double> const all = offsets(records);
    bool constant = false;
    for (Index i = 0; i < records.parameters(); ++i) constant |= constant_value(records.psi.row(i)).has_value();
    std::vector<Index> far;
    for (size_t i = 0; i < all.size(); ++i)
        if (all[i] > much_offset) far.push_back(Index(i));
    if (!constant || far.empty()) return "";
    double const most = *std::ranges::max_element(all);
    return fmt::format(
        "{}: the mean is {}{:.3g} standard deviations off 0, beside a constant: that costs factor forms about {:.1f} "
        "digits of theta, forms that store P up to twice as many or more, and the rounding of the data to a short word "
        "as many again; --detrend gives them back",
        names_of(far, regressors), far.size() > 1 ? "up to " : "", most, correctly::log10(most));
}

}  // namespace

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
