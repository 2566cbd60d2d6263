// The variant's recursion beside the certified minimiser.
#include "identify/estimate.hpp"

#include <rlslab/catalogue/catalogue.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/reference/distributions.hpp>
#include <rlslab/reference/scatter.hpp>

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;

CatalogueEntry const& entry_of(std::string const& variant) {
    if (CatalogueEntry const* const entry = find_entry(variant)) return *entry;
    std::vector<std::string_view> known;
    for (CatalogueEntry const* const e : one_entry_each()) known.push_back(e->variant);  // each is in double
    expect_one_of(known, variant, "--variant", "variant");
    throw std::logic_error("a variant without double");
}

namespace {

/// The error that does not matter: a tenth of the error due to noise, or, for a record without noise, the rounding error of the arithmetic:
/// `least` of the largest term, each in units s of its regressor.
Vector<double> tolerance(Vector<double> const& sd, Vector<Reference> const& theta, Vector<double> const& s, double least) {
    double largest = 0;
    for (Index i = 0; i < theta.size(); ++i) largest = std::max(largest, std::abs(static_cast<double>(theta[i])) * s[i]);
    return (sd.array().isNaN().select(0, 0.1 * sd.array()) + least * largest / s.array()).matrix();
}

/// The largest |a - b| / tolerance; NaN where one is.
double largest_difference(Vector<Reference> const& a, Vector<Reference> const& b, Vector<double> const& tolerance) {
    double most = 0;
    for (Index i = 0; i < a.size(); ++i) {
        double const ratio = std::abs(static_cast<double>(Reference(a[i] - b[i]))) / tolerance[i];
        if (!(ratio <= most)) most = ratio;
        if (std::isnan(ratio)) break;
    }
    return most;
}

/// The default prior, weakened further until it moves no parameter by more than its tolerance, 1e-12 of theta where there is no noise.
Problem<double> with_prior(Identified& out, Records const& records, Scattered const& free) {
    Problem<double> problem{.size = records.parameters(), .forgetting = out.options.forgetting};
    if (out.options.p0) {
        problem.prior = Prior<double>{.variance = *out.options.p0};
        out.c = std::sqrt(*out.options.p0);
        out.scales.assign(size_t(records.parameters()), 1.0);
        return problem;
    }
    DefaultPrior prior = default_prior(records, problem.forgetting);
    Vector<Reference> const theta = free.exact.theta();
    Vector<double> const sd = free.scatter.sd * std::sqrt(free.scatter.J / free.scatter.freedom),
                         allowed = tolerance(sd, theta, prior.s, 1e-12);
    constexpr double largest_c = 0x1p60;
    for (;;) {
        problem.prior = prior.prior();
        double const by = largest_difference(certified(problem, records, {records.rows()}).front().theta(), theta, allowed);
        if (!(by > 1) || prior.c >= largest_c) break;
        // The bias falls at least as 1/c^2 along each axis of the scaled data.
        prior.c = std::min(largest_c, prior.c * correctly::exp2(std::ceil(correctly::log2(by) / 2)));
    }
    out.c = prior.c;
    out.scales.assign(prior.s.data(), prior.s.data() + prior.s.size());
    return problem;
}

std::vector<Index> checkpoints_of(Records const& records) {
    // An enclosure of P costs d^3: fewer points for very many parameters.
    Index const points = std::clamp<Index>(4000 / records.parameters(), 10, 100);
    std::vector<Index> out;
    for (Index i = 1; i <= points; ++i)
        if (Index const row = std::max<Index>(1, i * records.rows() / points); out.empty() || row > out.back()) out.push_back(row);
    return out;
}

struct Run {
    std::vector<Vector<Reference>> theta;  ///< at the checkpoints
    std::optional<Failure> failure;
};

/// Runs the variant over the rows; its stored P is tested after every step.
Run run(CatalogueEntry const& entry, Problem<double> const& problem, Records const& records, std::vector<Index> const& checkpoints) {
    auto const filter = entry.make(problem, Seed{1});
    Run out;
    Index k = 0;
    for (Index const checkpoint : checkpoints) {
        while (k < checkpoint) {
            Index const last = std::min(checkpoint, k + entry.block);
            Step<double> const step =
                entry.block == 1 ? filter->update(records.sample(k), records.y[k]) : filter->update_block(records, k, last);
            k = last;
            if (out.failure) continue;
            if (Health const kind = breakdown(*filter, *entry.arithmetic, step.health); kind != Health::sound)
                out.failure = Failure{k, kind};
        }
        out.theta.push_back(filter->theta());
    }
    if (!out.failure && !is_finite(out.theta.back())) out.failure = Failure{k, Health::nonfinite};
    return out;
}

/// The variant to use instead: the first that does not break down and whose error does not matter; "" if there is none.
std::string better_variant(Problem<double> const& problem, Records const& records, Vector<Reference> const& best,
                           Vector<double> const& allowed, std::string const& than) {
    for (char const* name : {"ud", "qr", "carlson", "inverse_qr", "gentleman", "extended_qr", "potter", "qr_block"}) {
        if (name == than) continue;
        Run const tried = run(entry_of(name), problem, records, {records.rows()});
        if (!tried.failure && largest_difference(tried.theta.back(), best, allowed) <= 1) return name;
    }
    return "";
}

using Rank = Remark::Rank;

/// G = (Phi'Phi)^-1. What is left of a regressor i after the others have explained it, x_i + sum_j w_j x_j with w_j = G_ij / G_ii, has the
/// mean square 1 / (N G_ii). Numbers rounded to q_j leave sum_j w_j^2 q_j^2 / 12 by themselves: below four times that the regressors
/// depend on one another but for rounding. The one of which least is left, in its own units, is looked at.
bool warn_of_dependence(Identified& out, Records const& records, Scatter const& free, Vector<double> const& resolution) {
    Index const d = records.parameters();
    Vector<double> const s = regressor_scales(records);
    Index i = 0;
    for (Index j = 1; j < d; ++j)
        if (s[j] * free.sd[j] > s[i] * free.sd[i]) i = j;
    Vector<double> w(d);
    double rounding = 0, largest = 0;
    for (Index j = 0; j < d; ++j) {
        w[j] = free.correlation(i, j) * free.sd[j] / free.sd[i];
        rounding += w[j] * w[j] * resolution[j] * resolution[j] / 12;
        largest = std::max(largest, std::abs(w[j]) * s[j]);
    }
    double const left = 1 / (free.freedom + double(d)) / free.sd[i] / free.sd[i];
    if (!(left < 4 * rounding)) return false;
    std::vector<std::string> of;
    bool outputs = false;
    for (Index j = 0; j < d; ++j)
        if (std::abs(w[j]) * s[j] > 1e-3 * largest)
            of.push_back(out.terms[size_t(j)].of), outputs = outputs || out.terms[size_t(j)].input == -1;
    std::string const names = of.size() > 8 ? fmt::format("{} of the {} regressors", of.size(), d) : fmt::format("{}", fmt::join(of, ", ")),
                      instead = !out.options.regressors.empty() || out.options.inputs.size() > 1 ? "leave out one of " + names
                                                                                                 : "a lower order, or a richer input";
    out.remarks.push_back(
        {Rank::dependence,
         fmt::format("{} depend on one another but for the rounding of their numbers: this record does not determine their parameters, in "
                     "whatever arithmetic: {}",
                     names, instead),
         instead});
    return true;
}

void warn_of_arithmetic(Identified& out, Problem<double> const& problem, Records const& records, Vector<Reference> const& theta,
                        Vector<Reference> const& best, Vector<Reference> const& free, Vector<double> const& sd, bool dependent) {
    std::string const& variant = out.options.variant;
    Vector<double> const allowed = tolerance(sd, best, regressor_scales(records), 1e-9);
    bool const rounded = !dependent && !(largest_difference(theta, best, allowed) <= 1),
               biased = !dependent && !(largest_difference(best, free, allowed) <= 1);
    std::string const remedy = "a lower order, fewer samples a second, or a richer input",
                      hardly = fmt::format("{} ({})", remedy,
                                           std::isfinite(out.condition) ? fmt::format("kappa = {:.2g}", out.condition) : "kappa > 1e308");
    std::string const better = rounded || (out.failure && !dependent) ? better_variant(problem, records, best, allowed, variant) : "",
                      next = better.empty() ? remedy : "--variant " + better;
    std::string const instead = better.empty() ? fmt::format("no variant in double does better on these regressors: {}", hardly)
                                               : fmt::format("--variant {} keeps enough of them on this record", better);
    if (out.failure)
        out.remarks.push_back({Rank::breakdown,
                               fmt::format("{} broke down after row {}: {}. Do not use its numbers{}", variant, out.failure->row,
                                           out.failure->kind == Health::indefinite ? "the P it stores is not positive definite"
                                                                                   : "its numbers are no longer finite",
                                           dependent        ? ""
                                           : better.empty() ? ": " + instead
                                                            : fmt::format(": --variant {} does not break down on this record", better)),
                               next});
    else if (rounded && biased && better.empty())
        out.remarks.push_back({Rank::arithmetic,
                               fmt::format("the record hardly determines these {} parameters: the prior and the rounding both move them "
                                           "by more than a tenth of what noise does: {}",
                                           records.parameters(), hardly),
                               next});
    else if (rounded)
        out.remarks.push_back({Rank::arithmetic,
                               fmt::format("{} lost digits to rounding, more than a tenth of what noise does: {}", variant, instead),
                               next});
    if (biased && !(rounded && better.empty())) {
        std::string const weaker = out.options.p0 ? "a larger --p0, or none given" : remedy;
        out.remarks.push_back(
            {Rank::arithmetic,
             fmt::format("the prior moves the estimate by more than a tenth of what noise does: {}", out.options.p0 ? weaker : hardly),
             weaker});
    }
}

}  // namespace

Estimation estimate(Identified& out, Records const& records, Vector<double> const& resolution) {
    IdentifyOptions const& options = out.options;
    Index const d = records.parameters(), rows = records.rows();
    Problem<double> without{.size = d, .forgetting = options.forgetting, .prior = std::nullopt};
    Scattered const free = scattered(without, records, {rows}).front();
    if (!(free.scatter.freedom >= 1))
        throw InputError(
            fmt::format("--forgetting: lambda = {} remembers about {:.0f} rows, too few for {} parameters: expected {:.3g} or more",
                        options.forgetting, 1 / (1 - options.forgetting), d, 1 - 1 / (2.0 * double(d))));
    Problem<double> const problem = with_prior(out, records, free);
    std::vector<Index> const checkpoints = checkpoints_of(records);
    std::vector<Scattered> const exact = scattered(problem, records, checkpoints);
    CertifiedSolution const& last = exact.back().exact;
    Run const variant = run(entry_of(options.variant), problem, records, checkpoints);
    Vector<Reference> const& theta = variant.theta.back();
    out.failure = variant.failure;
    Scatter const& scatter = exact.back().scatter;
    out.condition = condition(records, options.forgetting);
    out.freedom = scatter.freedom;
    out.sigma2 = scatter.J / out.freedom;
    out.noise_free = free.scatter.J <= rounding_alone(rows, records.y.cwiseAbs().maxCoeff());
    out.quantile = scatter.student > 0 ? correctly::student_quantile(scatter.student, 0.5 + options.confidence / 2) : std::nan("");
    for (size_t i = 0; i < exact.size(); ++i)
        out.trajectory.push_back({checkpoints[i],
                                  variant.theta[i].unaryExpr([](Reference const& x) { return static_cast<double>(x); }).cast<double>(),
                                  std::sqrt(out.sigma2) * exact[i].scatter.sd});
    Estimation const result{out.trajectory.back().sd, scatter.correlation};
    out.prior_move = largest_difference(last.theta(), free.exact.theta(), result.sd);
    bool const dependent = warn_of_dependence(out, records, free.scatter, resolution);
    warn_of_arithmetic(out, problem, records, theta, last.theta(), free.exact.theta(), result.sd, dependent);
    if (!(result.sd.array() >= 0).all())
        out.remarks.push_back({Rank::arithmetic, "the standard deviations could not be worked out to 12 digits and are left out", ""});
    out.digits = std::min(last.theta_digits(theta), 15.95);
    out.digits_worst = std::min(last.theta_digits_worst(theta), 15.95);
    return result;
}

}  // namespace rlslab::identify
