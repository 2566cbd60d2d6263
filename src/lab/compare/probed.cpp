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

/// P^-1 after all rows of the problem as stored.
Matrix<Reference> information_of(RoundedProblem const& rounded) {
    Matrix<Reference> X = inverse(prior_of(rounded.problem));
    Reference const lambda = rounded.problem.forgetting;
    Index const d = X.rows();
    for (Index k = 0; k < rounded.records.rows(); ++k)
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i <= j; ++i) {
                X(i, j) *= lambda;
                X(i, j) += Reference(rounded.records.psi(i, k)) * Reference(rounded.records.psi(j, k));
                X(j, i) = X(i, j);
            }
    return X;
}

/// Absent where there is an obstacle.
std::optional<Probed> probed(CatalogueEntry const& entry, RoundedProblem const& rounded,
                             Matrix<Reference> const& information) {
    auto const filter =
        composed({.certify = probes_of_compare}, entry.variant, entry.arithmetic->name, rounded.problem);
    if (!filter) return {};
    filter->update_block(rounded.records, 0, rounded.records.rows());
    Certificate<double> const found = filter->certificate().value();
    Probed out{found.estimate, found.bound, {}};
    if (entry.variant == "information") return out;
    Matrix<Reference> E = covariance_of(filter->stored(), inverse) * information;
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
        Matrix<Reference> const information = information_of(problem->second);
        for (Result& r : results)
            if (r.entry->arithmetic->name == arithmetic) r.probed = probed(*r.entry, problem->second, information);
    }
}

}  // namespace rlslab::compare
