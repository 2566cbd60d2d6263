// A composed filter processes the rows; its reference is solved for where the first filter asks for it.
#include "compare/composed_score.hpp"
#include <rlslab/catalogue/composed.hpp>
#include "compare/score.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/linalg/triangles.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
using namespace report;
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// -log10(|error| / |size|); infinity for no error.
double digits_of(Reference const& error, Reference const& size) {
    if (!is_finite(error) || !is_finite(size)) return nothing;
    if (error == 0) return std::numeric_limits<double>::infinity();
    return size == 0 ? -std::numeric_limits<double>::infinity() : -correctly::log10(static_cast<double>(Reference(error / size)));
}
template <class A, class B>
double digits_in_norm(A const& x, B const& from) {
    Reference error = 0, size = 0;
    for (Index j = 0; j < from.cols(); ++j)
        for (Index i = 0; i < from.rows(); ++i) {
            Reference const apart = x(i, j) - from(i, j);
            error += apart * apart;
            size += from(i, j) * from(i, j);
        }
    return digits_of(square_root(error), square_root(size));
}
double least_digits(Vector<Reference> const& x, Vector<Reference> const& from) {
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < from.size(); ++i) {
        Reference const apart = absolute(Reference(x[i] - from[i]));
        double const digits = digits_of(apart, from[i] == 0 ? Reference(1) : absolute(from[i]));
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

std::optional<double> at_most(double digits, double most) {
    if (std::isnan(digits)) return {};
    return std::min(digits, most);
}

Recursion run_in_257_bits(Composition const& composition, StoredProblem const& stored, std::string_view variant,
                          std::vector<Index> const& checkpoints) {
    Recursion out;
    auto const filter = composed(composition, variant, "reference", stored.problem);
    Index k = 0;
    for (Index const checkpoint : checkpoints) {
        for (; k < checkpoint; ++k) filter->update(stored.records.sample(k), stored.records.y[k]);
        out.theta.push_back(filter->theta());
        out.P.push_back(covariance(*filter));
    }
    return out;
}

}  // namespace

CompositionReference::CompositionReference(Composition const& composition, StoredProblem const& stored, int digits)
    : composition_(composition), stored_(stored), digits_(digits), checkpoints_(checkpoints_of(stored.records.rows())) {}

Index CompositionReference::age_of_prior(Index k, Happened const& happened) const {
    return happened.refactored > 0 ? composition_.window + happened.since : k;
}

CertifiedSolution const& CompositionReference::minimiser(size_t checkpoint, Index aged) {
    Index const k = checkpoints_[checkpoint], W = composition_.window;
    if (W == 0 || k <= W) return stored_.orders.front().exact.at(checkpoint);
    Problem<double> const& problem = stored_.problem;
    Index const nothing_yet = problem.forgetting == 1 ? 0 : aged - W;  // rows of zeros, in which the prior ages
    std::lock_guard const lock(one_at_a_time_);
    auto const known = minimisers_.find({checkpoint, nothing_yet});
    if (known != minimisers_.end()) return known->second;
    Records rows{.psi = Matrix<double>::Zero(stored_.records.parameters(), nothing_yet + W),
                 .y = Vector<double>::Zero(nothing_yet + W),
                 .names = stored_.records.names};
    rows.psi.rightCols(W) = stored_.records.psi.middleCols(k - W, W);
    rows.y.tail(W) = stored_.records.y.segment(k - W, W);
    return minimisers_.emplace(std::pair(checkpoint, nothing_yet), certified(problem, rows, {rows.rows()}, digits_).front()).first->second;
}

Recursion const& CompositionReference::recursion(std::string_view variant) {
    bool const of_its_own = variant == "kalman" && composition_.control == "random_walk";
    std::string const name = of_its_own ? "kalman" : "ud";
    std::lock_guard const lock(one_at_a_time_);
    if (auto const known = recursions_.find(name); known != recursions_.end()) return known->second;
    Recursion& out = recursions_[name] = run_in_257_bits(composition_, stored_, name, checkpoints_);
    if (of_its_own) {
        out.agreement.assign(checkpoints_.size(), std::numeric_limits<double>::infinity());
        return out;
    }
    Recursion const second = run_in_257_bits(composition_, stored_, "qr", checkpoints_);
    for (size_t c = 0; c < checkpoints_.size(); ++c) {
        double const theta = digits_in_norm(second.theta[c], out.theta[c]), P = digits_in_norm(second.P[c], out.P[c]);
        out.agreement.push_back(std::isnan(theta) || std::isnan(P) ? -std::numeric_limits<double>::infinity() : std::min(theta, P));
    }
    return out;
}

bool intervened(Composition const& c, Happened const& h) {
    if (c.guard.empty()) return false;
    return h.unusable > 0 || (c.guard != "report" && h.outliers + h.changes + h.windups + h.breakdowns > 0);
}

Result score_composed(CatalogueEntry const& entry, StoredProblem const& stored, CompositionReference& reference) {
    Result result{.entry = &entry};
    Composition const& composition = reference.composition();
    result.obstacle = obstacle(composition, entry.variant);
    if (!result.obstacle.empty()) return result;
    if (!stored.in_range || stored.orders.front().exact.empty()) {
        result.breakdown = Breakdown{0, "indefinite"};
        return result;
    }
    Arithmetic const& arithmetic = *entry.arithmetic;
    std::unique_ptr<ComposedFilter> filter;
    try {
        filter = composed(composition, entry.variant, arithmetic.name, stored.problem);
    } catch (std::invalid_argument const& refused) {
        result.obstacle = refused.what();
        return result;
    }
    result.runs = 1;
    if (std::string const kind = breakdown(*filter, arithmetic); !kind.empty()) result.breakdown = Breakdown{0, kind};
    std::vector<Index> const checkpoints = checkpoints_of(stored.records.rows());
    Index const settled = std::min(stored.records.rows(), 2 * stored.records.parameters());
    PerMeasure<std::vector<std::optional<double>>> all;
    Index k = 0;
    for (size_t c = 0; c < checkpoints.size(); ++c) {
        for (; k < checkpoints[c]; ++k) {
            Health const health = filter->update(stored.records.sample(k), stored.records.y[k]).health;
            if (result.breakdown) continue;
            std::string kind = breakdown(*filter, arithmetic);
            if (kind.empty() && health == Health::nonfinite && !is_finite(filter->theta())) kind = "nonfinite";
            if (!kind.empty()) result.breakdown = Breakdown{k + 1, kind};
        }
        Happened const happened = filter->happened();
        Vector<Reference> const theta = filter->theta();
        bool const by_recursion = !composition.keeps_the_problem() || intervened(composition, happened);
        double most = arithmetic.decimal_digits();
        Digits digits;
        if (by_recursion) {
            Recursion const& r = reference.recursion(entry.variant);
            most = std::min(most, r.agreement[c]);
            digits = {at_most(digits_in_norm(theta, r.theta[c]), most), at_most(least_digits(theta, r.theta[c]), most),
                      at_most(digits_in_norm(covariance(*filter), r.P[c]), most)};
        } else {
            CertifiedSolution const& exact = reference.minimiser(c, reference.age_of_prior(k, happened));
            digits = {at_most(exact.theta_digits(theta), most), at_most(exact.theta_digits_worst(theta), most),
                      at_most(exact.covariance_digits(filter->stored()), most)};
            result.certified_to = k;
        }
        result.path.push_back(digits);
        result.happened.push_back(happened);
        if (k >= settled)
            for (size_t m = 0; m < 3; ++m) (all.*all.all()[m]).push_back(digits.*Digits::all()[m]);
    }
    if (!result.breakdown && !is_finite(filter->theta())) result.breakdown = Breakdown{k, "nonfinite"};
    result.broken = result.breakdown.has_value();
    Stored<Reference> const last = filter->stored();
    result.factor = last.form == Stored<Reference>::Form::factor;
    result.asymmetry = asymmetry_of(last);
    result.ends = {filter->theta()};
    set_spread(result, all);
    return result;
}

}  // namespace rlslab::compare
