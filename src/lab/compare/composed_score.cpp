// A composed filter processes the rows; its reference is computed when the first filter needs it.
#include "src/lab/compare/composed_score.hpp"
#include <rlslab/catalogue/composed.hpp>

#include <rlslab/linalg/product.hpp>
#include <rlslab/linalg/triangles.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
using detail::product;
namespace {

double digits_in_norm(Matrix<Reference> const& x, Matrix<Reference> const& exact) {
    return digits_of(square_root(Matrix<Reference>(x - exact).squaredNorm()), square_root(exact.squaredNorm()));
}
/// Of the worst component; of one that is exactly 0 the error counts as it is.
double least_digits(Vector<Reference> const& x, Vector<Reference> const& exact) {
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < exact.size(); ++i) {
        double const digits = digits_of(Reference(x[i] - exact[i]), exact[i] == 0 ? Reference(1) : exact[i]);
        if (!(digits >= least)) least = digits;
        if (std::isnan(digits)) break;
    }
    return least;
}

/// P in 257 bits; NaN where the information stored does not factor.
Matrix<Reference> inverse_of(Matrix<Reference> const& X) {
    Index const d = X.rows();
    StateMatrix<Reference, Dynamic> L(d);
    StateVector<Reference, Dynamic> D(d), e(d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) L(i, j) = X(i, j);
    bool const positive = factor_ldl(L, L, D);
    Matrix<Reference> out(d, d);
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) e[i] = Reference(i == j ? 1 : 0);
        solve_ldl(L, D, positive, e);
        out.col(j) = e.view();
    }
    return out;
}
Matrix<Reference> covariance(AnyFilter const& filter) { return covariance_of(filter.stored(), &inverse_of); }

Recursion run_in_257_bits(Composition const& composition, RoundedProblem const& rounded, std::string_view variant,
                          std::vector<Index> const& checkpoints) {
    Recursion out;
    auto const filter = composed(composition, variant, "reference", rounded.problem);
    Index k = 0;
    for (Index const checkpoint : checkpoints) {
        for (; k < checkpoint; ++k) filter->update(rounded.records.sample(k), rounded.records.y[k]);
        out.theta.push_back(filter->theta());
        out.P.push_back(covariance(*filter));
    }
    return out;
}

}  // namespace

CompositionReference::CompositionReference(Composition const& composition, RoundedProblem const& rounded, int digits)
    : composition_(composition), rounded_(rounded), digits_(digits),
      checkpoints_(checkpoints_of(rounded.records.rows())) {}

Index CompositionReference::age_of_prior(Index k, CompositionCounts const& happened) const {
    return happened.refactored > 0 ? composition_.window + happened.since : k;
}

CertifiedSolution const& CompositionReference::minimiser(size_t checkpoint, Index aged) {
    Index const k = checkpoints_[checkpoint], W = composition_.window;
    if (W == 0 || k <= W) return rounded_.orders.front().exact.at(checkpoint);
    Problem<double> const& problem = rounded_.problem;
    Index const nothing_yet = problem.forgetting == 1 ? 0 : aged - W;  // rows of zeros, in which the prior ages
    std::lock_guard const lock(one_at_a_time_);
    auto const known = minimisers_.find({checkpoint, nothing_yet});
    if (known != minimisers_.end()) return known->second;
    Records rows{.psi = Matrix<double>::Zero(rounded_.records.parameters(), nothing_yet + W),
                 .y = Vector<double>::Zero(nothing_yet + W),
                 .names = rounded_.records.names};
    rows.psi.rightCols(W) = rounded_.records.psi.middleCols(k - W, W);
    rows.y.tail(W) = rounded_.records.y.segment(k - W, W);
    return minimisers_
        .emplace(std::pair(checkpoint, nothing_yet), certified(problem, rows, {rows.rows()}, digits_).front())
        .first->second;
}

Recursion const& CompositionReference::recursion(std::string_view variant) {
    bool const of_its_own = is_its_own_rule(composition_, variant);
    std::string const name(of_its_own ? variant : "ud");
    std::lock_guard const lock(one_at_a_time_);
    if (auto const known = recursions_.find(name); known != recursions_.end()) return known->second;
    Recursion& out = recursions_[name] = run_in_257_bits(composition_, rounded_, name, checkpoints_);
    if (of_its_own) {
        out.agreement.assign(checkpoints_.size(), std::numeric_limits<double>::infinity());
        return out;
    }
    Recursion const second = run_in_257_bits(composition_, rounded_, "qr", checkpoints_);
    for (size_t c = 0; c < checkpoints_.size(); ++c) {
        double const theta = digits_in_norm(second.theta[c], out.theta[c]), P = digits_in_norm(second.P[c], out.P[c]);
        out.agreement.push_back(std::isnan(theta) || std::isnan(P) ? -std::numeric_limits<double>::infinity()
                                                                   : std::min(theta, P));
    }
    return out;
}

bool intervened(Composition const& c, CompositionCounts const& h) {
    if (c.guard.empty()) return false;
    return h.unusable > 0 || (c.policy().intervenes() && h.outliers + h.changes + h.windups + h.breakdowns > 0);
}

Result score_composed(CatalogueEntry const& entry, RoundedProblem const& rounded, CompositionReference& reference) {
    Composition const& composition = reference.composition();
    if (std::string const why = obstacle(composition, entry.variant); !why.empty())
        return {.entry = &entry, .obstacle = why};
    if (!rounded.in_range || rounded.orders.front().exact.empty())
        return {.entry = &entry, .breakdown = Breakdown{0, Health::indefinite}};
    Arithmetic const& arithmetic = *entry.arithmetic;
    std::unique_ptr<ComposedFilter> filter;
    try {
        filter = composed(composition, entry.variant, arithmetic.name, rounded.problem);
    } catch (std::invalid_argument const& refused) {
        return {.entry = &entry, .obstacle = refused.what()};
    }
    std::vector<Index> const checkpoints = checkpoints_of(rounded.records.rows());
    std::vector<CompositionCounts> happened;
    Index certified_to = 0;
    auto const against_reference = [&](size_t c) -> Digits {
        happened.push_back(filter->counts());
        Vector<Reference> const theta = filter->theta();
        double const own = arithmetic.decimal_digits();
        if (!composition.keeps_the_problem() || intervened(composition, happened.back())) {
            Recursion const& r = reference.recursion(entry.variant);
            double const most = std::min(own, r.agreement[c]);
            return {at_most(digits_in_norm(theta, r.theta[c]), most), at_most(least_digits(theta, r.theta[c]), most),
                    at_most(digits_in_norm(covariance(*filter), r.P[c]), most)};
        }
        certified_to = checkpoints[c];
        CertifiedSolution const& exact = reference.minimiser(c, reference.age_of_prior(certified_to, happened.back()));
        return {at_most(exact.theta_digits(theta), own), at_most(exact.theta_digits_worst(theta), own),
                at_most(exact.covariance_digits(filter->stored()), own)};
    };
    Runs runs;
    runs.own.push_back(run(*filter, arithmetic, 1, rounded, {}, against_reference));
    Result out = result_of(entry, rounded, runs);
    out.foretold.reset();  // what is around the form looks at its P, and changes it
    out.happened = std::move(happened);
    out.certified_to = certified_to;
    return out;
}

// --- probes: a filter with them takes the record; E = Phat P^-1 - I of what it stores is computed beside it ----------

namespace {

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
    Matrix<Reference> E = product(covariance(*filter), *information);
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
        if (!exact.empty()) information = inverse_of(exact.back().covariance());
        for (Result& r : results)
            if (r.entry->arithmetic->name == arithmetic) r.probed = probed(*r.entry, problem->second, information);
    }
}

}  // namespace rlslab::compare
