// A filter with probes takes the record; E = Phat P^-1 - I of what it stores is computed beside it.
#include "src/lab/compare/probed.hpp"

#include <rlslab/catalogue/composed.hpp>

#include <Eigen/LU>
#include <cmath>

namespace rlslab::compare {
namespace {

Matrix<Reference> inverse(Matrix<Reference> const& X) { return X.inverse(); }

Matrix<Reference> prior_of(Problem<double> const& problem) {
    Matrix<Reference> out = Matrix<Reference>::Identity(problem.size, problem.size);
    if (problem.prior->covariance) out = problem.prior->covariance->cast<Reference>();
    else out *= Reference(problem.prior->variance);
    return out;
}

/// Absent where there is an obstacle.
std::optional<Probed> probed(CatalogueEntry const& entry, RoundedProblem const& rounded,
                             std::optional<Matrix<Reference>> const& information) {
    auto const filter =
        composed({.certify = probes_of_compare}, entry.variant, entry.arithmetic->name, rounded.problem);
    if (!filter) return {};
    filter->update_block(rounded.records, 0, rounded.records.rows());
    Certificate<double> const found = filter->certificate().value();
    Probed out{found.estimate, found.bound, {}};
    if (entry.variant == "information" || !information) return out;
    Matrix<Reference> E = covariance_of(filter->stored(), inverse) * *information;
    Matrix<Reference> const P0 = prior_of(rounded.problem);
    Reference sum = 0;
    for (Index j = 0; j < E.cols(); ++j)
        for (Index i = 0; i < E.rows(); ++i) {
            auto const unit = [&](Index l) { return detail::power_of_two_near(std::sqrt(double(P0(l, l)))); };
            Reference const e = (E(i, j) - Reference(i == j ? 1 : 0)) * Reference(unit(j) / unit(i));
            sum += e * e;
        }
    out.truth = std::sqrt(static_cast<double>(sum));
    return out;
}

}  // namespace

void probe(std::vector<Result>& results, std::map<std::string_view, RoundedProblem> const& rounded) {
    for (std::string_view const arithmetic : {"float", "double"}) {
        auto const problem = rounded.find(arithmetic);
        if (problem == rounded.end() || !problem->second.in_range) continue;
        std::vector<CertifiedSolution> const& exact = problem->second.orders.front().exact;
        std::optional<Matrix<Reference>> information;
        if (!exact.empty()) information = inverse(exact.back().covariance());
        for (Result& r : results)
            if (r.entry->arithmetic->name == arithmetic) r.probed = probed(*r.entry, problem->second, information);
    }
}

}  // namespace rlslab::compare
