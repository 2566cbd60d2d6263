// The runs: words against binary64, upward until a filter survives. The only place where the variants are compiled in
// fixed-point words.
#include "studies/accuracy/fixed_runs.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/erase.hpp>
#include <rlslab/variants/variants.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr int longest = 30, in_a_row = 3, ample = 24, looks = 200;

double norm_1(Matrix<double> const& A) {
    double out = 0;
    for (Index j = 0; j < A.cols(); ++j) {
        double sum = 0;
        for (Index i = 0; i < A.rows(); ++i) sum += std::abs(A(i, j));
        out = std::max(out, sum);
    }
    return out;
}
double relative_error(AnyFilter const& filter, Matrix<double> const& exact) {
    Matrix<Reference> const P = covariance_of(filter.stored()), difference = P - exact.cast<Reference>();
    double const error = frobenius(difference) / frobenius(exact.cast<Reference>());
    return error == error ? error : INFINITY;
}
bool has_zero_pivot(AnyFilter const& filter) {
    Stored<double> const stored = filter.stored_in_double();
    bool zero = false;
    if (stored.form == Stored<double>::Form::factor)
        for (Index i = 0; i < stored.F.rows(); ++i)
            zero = zero || stored.F(i, i) == 0 || (stored.D.size() > 0 && stored.D[i] == 0);
    return zero;
}

}  // namespace

std::vector<CatalogueEntry> const& fixed_point_filters() {
    static Arithmetic const arithmetic{"fixed", 53, -53, 0, false, [](double x) { return VariableFixed(x).value(); }};
    static std::vector<CatalogueEntry> const entries = [] {
        std::vector<CatalogueEntry> out;
        for_each(Variants<VariableFixed>{}, [&]<class F>() { out.push_back(untimed_entry_of<F>(&arithmetic)); });
        return out;
    }();
    return entries;
}

CatalogueEntry const* rounding_every_operation(std::string_view variant) {
    using T = VariableFixedRounded;
    static Arithmetic const arithmetic{"fixed", 53, -53, 0, false, [](double x) { return T(x).value(); }};
    static CatalogueEntry const entries[] = {untimed_entry_of<Symmetric<T>>(&arithmetic),
                                             untimed_entry_of<Ud<T>>(&arithmetic),
                                             untimed_entry_of<Qr<T>>(&arithmetic)};
    for (CatalogueEntry const& entry : entries)
        if (entry.variant == variant) return &entry;
    return nullptr;
}

Extremes extremes(Problem<double> const& problem, Records const& records) {
    InDouble exact(problem);
    double M = 1 / problem.prior->variance;
    Extremes out{.greatest = problem.prior->variance};
    for (Index k = 0; k < records.rows(); ++k) {
        exact.take(records, k);
        double trace_M = 0, trace_P = 0, sum = 0;
        for (Index i = 0; i < problem.size; ++i) {
            trace_M += exact.M(i, i);
            trace_P += exact.P(i, i);
            sum += std::abs(records.psi(i, k));
            out.largest = std::max(out.largest, std::abs(records.psi(i, k)));
        }
        if (trace_M > M) M = std::max(M, largest_eigenvalue(exact.M, 60));  // it is at most the trace
        if (trace_P > out.greatest) out.greatest = std::max(out.greatest, largest_eigenvalue(exact.P, 60));
        double const norm = norm_1(exact.P);
        out.P = std::max(out.P, norm);
        out.condition = std::max(out.condition, norm * norm_1(exact.M));
        out.psi = std::max(out.psi, sum);
    }
    out.least = 1 / M;
    return out;
}

double sufficient_bits(Extremes const& x, double lambda) {
    double const phi2 = x.psi * x.psi, A1 = phi2 * (x.condition + x.P * phi2) * (x.condition + x.P * phi2),
                 A2 = lambda * (1 - lambda) * phi2;
    double const p1 = lambda / phi2 * A2 / (A1 + A2 + std::sqrt(A1 * (A1 + A2)));
    double const eps = (1 - lambda) / (x.condition * x.condition * x.P) *
                       (p1 - A1 * p1 * p1 / (lambda * (1 - lambda) * (lambda - phi2 * p1)));
    return -correctly::log2(eps);
}

Run run_in(CatalogueEntry const& entry, Setting& setting, FixedFormat format) {
    FixedScope const scope(format);
    double const top = std::ldexp(1.0, format.bits - 1 - format.fraction) - std::ldexp(1.0, -format.fraction);
    if (setting.problem().prior->variance > top) return {"no_prior"};
    if (setting.largest() > top) return {"overflow"};
    auto const& [problem, records, exact] = setting.stored(format.fraction, *entry.arithmetic);
    if (problem.forgetting == 1) return {"no_forgetting"};
    if (!(problem.prior->variance > 0)) return {"no_prior"};
    auto const filter = entry.make(problem, Seed{1});
    Index const rows = records.rows();
    for (Index k = 0; k < rows; ++k) {
        Step<double> const step = filter->update(records.sample(k), records.y[k]);
        if (step.health == Health::nonfinite) return {"overflow"};
        if (step.health != Health::sound) return {std::string(name_of(step.health))};
        if (!(step.gamma > 0 && step.gamma <= 1)) return {"gamma"};
        if ((k + 1) % std::max<Index>(1, rows / looks) != 0) continue;
        Health const broken = breakdown(*filter, *entry.arithmetic);
        if (broken == Health::nonfinite) return {"overflow"};
        if (broken != Health::sound) return {has_zero_pivot(*filter) ? "zero_pivot" : std::string(name_of(broken))};
    }
    double const error = relative_error(*filter, exact);
    return {error < 0.5 ? "survives" : "inaccurate", error};
}

Need need_of(CatalogueEntry const& entry, Setting& setting, FixedRounding rounding) {
    Need out;
    // One vector as row and column: its antisymmetric error grows as lambda^-k, and if 30 bits do not do no fewer will.
    if ((entry.variant == "conventional" || entry.variant == "kalman") &&
        run_in(entry, setting, {48, longest, rounding}).outcome != "survives")
        return {INFINITY, INFINITY, "all"};
    std::string below = "none";
    int survived = 0;
    for (int fraction = 1; fraction <= longest && survived < in_a_row; ++fraction) {
        Run const run = run_in(entry, setting, {48, fraction, rounding});
        if (run.outcome == "survives") {
            if (survived++ == 0) out.fraction = fraction, out.below = below;
        } else {
            survived = 0;
            below = run.outcome;
        }
    }
    if (survived < in_a_row) return {INFINITY, INFINITY, below};
    int integer = 1;
    while (std::ldexp(1.0, integer) <= setting.problem().prior->variance) ++integer;
    for (; integer <= 47 - ample; ++integer) {
        if (run_in(entry, setting, {1 + integer + ample, ample, rounding}).outcome != "survives") continue;
        out.integer = integer;
        break;
    }
    return out;
}

double theta_noise(CatalogueEntry const& entry, Setting& setting, double lambda) {
    FixedFormat const format{48, 28};
    FixedScope const scope(format);
    auto const& stored = setting.stored(format.fraction, *entry.arithmetic);
    auto const filter = entry.make(stored.problem, Seed{1});
    InDouble exact(stored.problem);
    Index const rows = stored.records.rows(), d = exact.theta.size(), transient = rows / 5;
    double sum = 0;
    for (Index k = 0; k < rows; ++k) {
        filter->update(stored.records.sample(k), stored.records.y[k]);
        exact.take(stored.records, k);
        if (k < transient) continue;
        Vector<Reference> const theta = filter->theta();
        for (Index i = 0; i < d; ++i) {
            double const error = static_cast<double>(theta[i]) - exact.theta[i];
            sum += error * error;
        }
    }
    double const q = std::ldexp(1.0, -format.fraction), forgets = 1 - lambda;
    double const law = q / std::sqrt(12 * (2 * forgets - double(d + 2) * forgets * forgets));
    return std::sqrt(sum / double((rows - transient) * d)) / law;
}

double floating_bits(Setting const& setting) {
    auto const& of_any_length = variable_precision_catalogue();
    CatalogueEntry const& entry = *find_entry(of_any_length, "symmetric", of_any_length.front().arithmetic->name);
    for (int p = 3; p <= 30; ++p) {
        PrecisionScope const precision(p);
        Setting here(setting.problem(), setting.records());
        auto const& [problem, records, exact] = here.stored(0, *entry.arithmetic);
        auto const filter = entry.make(problem, Seed{1});
        bool alive = problem.forgetting < 1;
        for (Index k = 0; k < records.rows() && alive; ++k) {
            Step<double> const step = filter->update(records.sample(k), records.y[k]);
            alive = step.health == Health::sound && step.gamma > 0;
            if ((k + 1) % std::max<Index>(1, records.rows() / looks) == 0)
                alive = alive && breakdown(*filter, *entry.arithmetic) == Health::sound;
        }
        if (alive && relative_error(*filter, exact) < 0.5) return p;
    }
    return INFINITY;
}

}  // namespace rlslab::studies
