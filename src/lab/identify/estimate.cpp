// Runs the variant, and compares its estimate with the certified minimiser.
#include "src/lab/identify/estimate.hpp"

#include <rlslab/catalogue/catalogue.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/reference/distributions.hpp>
#include <rlslab/reference/scatter.hpp>

#include <algorithm>

namespace rlslab::identify {

CatalogueEntry const& entry_of(std::string const& variant) {
    if (CatalogueEntry const* const entry = find_entry(variant)) return *entry;
    std::vector<std::string_view> known;
    for (CatalogueEntry const* const e : one_entry_each()) known.push_back(e->variant);  // each is in double
    expect_one_of(known, variant, "--variant", "variant");
    throw std::logic_error("a variant without double");
}

namespace {

/// The error that does not matter: a tenth of the error due to noise, or, for a record without noise, the rounding
/// error of the arithmetic: `least` of the largest term, each in units s of its regressor.
Vector<double> tolerance(Vector<double> const& sd, Vector<Reference> const& theta, Vector<double> const& s,
                         double least) {
    double largest = 0;
    for (Index i = 0; i < theta.size(); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(theta[i])) * s[i]);
    return (sd.array().isNaN().select(0, 0.1 * sd.array()) + least * largest / s.array()).matrix();
}

/// The largest |a - b| / tolerance; NaN if any is.
double largest_difference(Vector<Reference> const& a, Vector<Reference> const& b, Vector<double> const& tolerance) {
    double most = 0;
    for (Index i = 0; i < a.size(); ++i) {
        double const ratio = std::abs(static_cast<double>(Reference(a[i] - b[i]))) / tolerance[i];
        if (!(ratio <= most)) most = ratio;
        if (std::isnan(ratio)) break;
    }
    return most;
}

struct ScaledProblem {
    Problem<double> problem;
    double c;  ///< of the prior, P0_ii = (c / s_i)^2
    std::vector<double> scales;
};
/// The problem with the prior of the options, or with the default prior. The default prior is weakened until it moves
/// no parameter by more than its tolerance, 1e-12 of theta where there is no noise.
ScaledProblem with_prior(IdentifyOptions const& options, Records const& records, Scattered const& free) {
    Problem<double> problem{.size = records.parameters(), .forgetting = options.forgetting};
    if (options.p0) {
        problem.prior = Prior<double>{.variance = *options.p0};
        return {problem, std::sqrt(*options.p0), std::vector<double>(size_t(records.parameters()), 1.0)};
    }
    DefaultPrior prior = default_prior(records, problem.forgetting);
    Vector<Reference> const theta = free.exact.theta();
    Vector<double> const sd = free.scatter.sd * std::sqrt(free.scatter.J / free.scatter.freedom),
                         allowed = tolerance(sd, theta, prior.s, 1e-12);
    constexpr double largest_c = 0x1p60;
    for (;;) {
        problem.prior = prior.prior();
        double const by =
            largest_difference(certified(problem, records, {records.rows()}).front().theta(), theta, allowed);
        if (!(by > 1) || prior.c >= largest_c) break;
        // The bias falls at least as 1/c^2 along each axis of the scaled data.
        prior.c = std::min(largest_c, prior.c * correctly::exp2(std::ceil(correctly::log2(by) / 2)));
    }
    return {problem, prior.c, {prior.s.data(), prior.s.data() + prior.s.size()}};
}

std::vector<Index> checkpoints_of(Records const& records) {
    // An enclosure of P costs d^3: fewer points for very many parameters.
    Index const points = std::clamp<Index>(4000 / records.parameters(), 10, 100);
    std::vector<Index> out;
    for (Index i = 1; i <= points; ++i)
        if (Index const row = std::max<Index>(1, i * records.rows() / points); out.empty() || row > out.back())
            out.push_back(row);
    return out;
}

struct Run {
    std::vector<Vector<Reference>> theta;  ///< at the checkpoints
    std::optional<Failure> failure;
};

/// Runs the variant over the rows; its stored P is tested after every step.
Run run(CatalogueEntry const& entry, Problem<double> const& problem, Records const& records,
        std::vector<Index> const& checkpoints) {
    auto const filter = entry.make(problem, Seed{1});
    Run out;
    Index k = 0;
    for (Index const checkpoint : checkpoints) {
        while (k < checkpoint) {
            Index const last = std::min(checkpoint, k + entry.block);
            Step<double> const step = entry.block == 1 ? filter->update(records.sample(k), records.y[k])
                                                       : filter->update_block(records, k, last);
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

/// Whether the record does not determine theta.
bool remark_on_dependence(std::vector<Remark>& out, IdentifyOptions const& options, std::vector<Term> const& terms,
                          Records const& records, Scatter const& free, Vector<double> const& resolution) {
    std::vector<Index> const dependent = dependent_but_for_rounding(records, free, resolution);
    if (dependent.empty()) return false;
    std::vector<std::string> regressors;
    for (Term const& t : terms) regressors.push_back(t.regressor);
    std::string const names = names_of(dependent, regressors),
                      instead = !options.regressors.empty() || options.inputs.size() > 1
                                    ? "leave out one of " + names
                                    : "a lower order, or a richer input";
    out.push_back({Rank::dependence, sentence_on_dependence(names, instead), instead});
    return true;
}

/// Remarks about breakdown, rounding and prior. rounded, biased: rounding, or the prior, moves theta by more than its
/// tolerance. dependent: the record does not determine theta. better: the variant to use instead, or "".
void remark_on_arithmetic(std::vector<Remark>& out, IdentifyOptions const& options, Estimate const& estimate,
                          bool rounded, bool biased, bool dependent, std::string const& better) {
    std::string const& variant = options.variant;
    std::string const remedy = "a lower order, fewer samples a second, or a richer input",
                      hardly = fmt::format("{} ({})", remedy,
                                           std::isfinite(estimate.condition)
                                               ? fmt::format("kappa = {:.2g}", estimate.condition)
                                               : "kappa > 1e308"),
                      next = better.empty() ? remedy : "--variant " + better,
                      instead = better.empty()
                                    ? fmt::format("no variant in double does better on these regressors: {}", hardly)
                                    : fmt::format("--variant {} keeps enough of them on this record", better);
    bool const undetermined = rounded && biased && better.empty();
    if (estimate.failure)
        remark(out, Rank::breakdown, next, "{} broke down after row {}: {}. Do not use its numbers{}", variant,
               estimate.failure->row,
               estimate.failure->kind == Health::indefinite ? "the P it stores is not positive definite"
                                                            : "its numbers are no longer finite",
               dependent        ? ""
               : better.empty() ? ": " + instead
                                : fmt::format(": --variant {} does not break down on this record", better));
    else if (undetermined)
        remark(
            out, Rank::arithmetic, next,
            "the record hardly determines these {} parameters: the prior and the rounding both move them by more than "
            "a tenth of what noise does: {}",
            estimate.parameters.size(), hardly);
    else if (rounded)
        remark(out, Rank::arithmetic, next, "{} lost digits to rounding, more than a tenth of what noise does: {}",
               variant, instead);
    std::string const weaker = "a larger --p0, or none given";
    if (biased && !undetermined)
        remark(out, Rank::arithmetic, options.p0 ? weaker : remedy,
               "the prior moves the estimate by more than a tenth of what noise does: {}",
               options.p0 ? weaker : hardly);
}

/// The minimiser without prior. Throws InputError where there is none, or where lambda remembers too few rows.
Scattered without_prior(std::string const& file, IdentifyOptions const& options, Structure const& structure,
                        Records const& records) {
    Index const d = records.parameters();
    Problem<double> problem{.size = d, .prior = std::nullopt};
    CertifiedSolution const exact = certified(problem, records, {records.rows()}).front();
    if (exact.status() != Status::certified)
        refuse("{}: {}: the regressors are linearly dependent (exact rank {} of {})", file, structure.structure,
               exact.rank(), d);
    problem.forgetting = options.forgetting;
    Scattered out = scattered(problem, records, {records.rows()}).front();
    if (!(out.scatter.freedom >= 1))
        refuse(
            "--forgetting: lambda = {} remembers about {:.0f} rows, too few for {} parameters: expected {:.3g} or more",
            options.forgetting, 1 / (1 - options.forgetting), d, 1 - 1 / (2.0 * double(d)));
    return out;
}

}  // namespace

Estimation estimate(std::string const& file, IdentifyOptions const& options, Structure const& structure,
                    Records const& records, Vector<double> const& resolution) {
    Scattered const free = without_prior(file, options, structure, records);
    auto const [problem, c, scales] = with_prior(options, records, free);
    std::vector<Index> const checkpoints = checkpoints_of(records);
    std::vector<Scattered> const exact = scattered(problem, records, checkpoints);
    CertifiedSolution const& last = exact.back().exact;
    Scatter const& scatter = exact.back().scatter;
    Run const variant = run(entry_of(options.variant), problem, records, checkpoints);
    Vector<Reference> const &theta = variant.theta.back(), best = last.theta(), unbiased = free.exact.theta();

    Estimate out{.c = c, .scales = scales, .failure = variant.failure};
    out.condition = condition(records, options.forgetting);
    out.freedom = scatter.freedom;
    out.sigma2 = scatter.J / out.freedom;
    out.noise_free = free.scatter.J <= rounding_alone(records.rows(), records.y.cwiseAbs().maxCoeff());
    out.student = scatter.student;
    out.quantile =
        scatter.student > 0 ? correctly::student_quantile(scatter.student, 0.5 + options.confidence / 2) : NAN;
    auto const rounded_once = [](Reference const& x) { return static_cast<double>(x); };
    for (size_t i = 0; i < exact.size(); ++i)
        out.trajectory.push_back({checkpoints[i], variant.theta[i].unaryExpr(rounded_once).cast<double>(),
                                  std::sqrt(out.sigma2) * exact[i].scatter.sd});
    auto const& [row, last_theta, sd] = out.trajectory.back();
    for (size_t i = 0; i < structure.terms.size(); ++i) {
        Term const& term = structure.terms[i];
        double const value = std::isfinite(last_theta[Index(i)]) ? last_theta[Index(i)] : NAN,
                     reach = out.quantile * sd[Index(i)], t = value / sd[Index(i)];
        out.parameters.push_back({term.name, term.regressor, value, sd[Index(i)], value - reach, value + reach,
                                  correctly::fisher_tail(1, out.student, t * t)});
    }
    out.prior_effect = largest_difference(best, unbiased, sd);
    out.digits = std::min(last.theta_digits(theta), 15.95);
    out.digits_worst = std::min(last.theta_digits_worst(theta), 15.95);

    std::vector<Remark> remarks;
    bool const dependent = remark_on_dependence(remarks, options, structure.terms, records, free.scatter, resolution);
    Vector<double> const allowed = tolerance(sd, best, regressor_scales(records), 1e-9);
    bool const rounded = !dependent && !(largest_difference(theta, best, allowed) <= 1),
               biased = !dependent && !(largest_difference(best, unbiased, allowed) <= 1);
    std::string const better =
        rounded || (out.failure && !dependent) ? better_variant(problem, records, best, allowed, options.variant) : "";
    remark_on_arithmetic(remarks, options, out, rounded, biased, dependent, better);
    if (!(sd.array() >= 0).all())
        remark(remarks, Rank::arithmetic, "",
               "the standard deviations could not be worked out to 12 digits and are left out");
    return {out, {sd, scatter.correlation}, remarks};
}

}  // namespace rlslab::identify
