// Runs the fast forms over a record and compares their prediction errors with the certified ones.
#include "src/lab/compare/score.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/fast/fast.hpp>
#include <rlslab/reference/certified.hpp>

namespace rlslab::compare {
namespace {

/// The record as T stores it, with zeros before its first sample, and the certified theta at the checkpoints.
template <class T>
struct Line {
    FastProblem<T> problem;
    Records records;
    std::vector<CertifiedSolution> exact = {};

    Line(Records const& given, double forgetting, double p0, std::vector<Index> const& checkpoints)
        : problem{.size = given.parameters(), .forgetting = T(forgetting), .energy = T(1 / p0)},
          records{.psi = Matrix<double>::Zero(given.parameters(), given.rows()),
                  .y = Vector<double>(given.rows()),
                  .names = given.names} {
        for (Index k = 0; k < given.rows(); ++k) {
            for (Index i = problem.size - 1; i > 0 && k > 0; --i) records.psi(i, k) = records.psi(i - 1, k - 1);
            records.psi(0, k) = double(T(given.psi(0, k)));
            records.y[k] = double(T(given.y[k]));
        }
        Matrix<double> P0 = Matrix<double>::Zero(problem.size, problem.size);
        double p = 1 / double(problem.energy);
        for (Index i = 0; i < problem.size; ++i, p *= double(problem.forgetting)) P0(i, i) = p;
        Problem<double> const same{
            .size = problem.size, .forgetting = double(problem.forgetting), .prior = Prior<double>{.covariance = P0}};
        exact = certified(same, records, checkpoints);
    }
};

template <class F>
long operations_of(Index d) {
    F form({.size = d});
    using T = typename F::scalar;
    for (Index k = 0; k < d; ++k) form.update(T(double(k % 3)), T(1));
    return counted([&] { form.update(T(2), T(1)); }).total();
}

/// Nothing where T cannot hold the problem.
template <class T>
void score_in(Records const& given, double forgetting, double p0, std::vector<Index> const& checkpoints,
              std::vector<FastResult>& out) {
    if (!is_forgetting_factor(T(forgetting)) || !(T(0) < T(1 / p0)) || !is_finite(T(1 / p0))) return;
    Line<T> const line(given, forgetting, p0, checkpoints);
    for_each(FastForms<T>{}, [&]<class F>() {
        FastResult result{.form = F::name, .arithmetic = ArithmeticTraits<T>::name};
        F form(line.problem);
        Reference apart = 0, size = 0;
        bool finite = true;
        size_t next = 0;
        for (Index k = 0; k < line.records.rows(); ++k) {
            Step<T> const step = form.update(T(line.records.psi(0, k)), T(line.records.y[k]));
            if (step.health != Health::sound && !result.breakdown) result.breakdown = Breakdown{k + 1, step.health};
            if (next == checkpoints.size() || checkpoints[next] != k) continue;
            CertifiedSolution const& exact = line.exact[next++];
            if (exact.status() != Status::certified) continue;
            Vector<Reference> const theta = exact.theta();
            Reference e = line.records.y[k];
            for (Index i = 0; i < theta.size(); ++i) e -= theta[i] * line.records.psi(i, k);
            finite = finite && is_finite(step.innovation);
            if (!finite) continue;
            Reference const difference = Reference(double(step.innovation)) - e;
            apart += difference * difference, size += e * e;
        }
        double const most = ArithmeticTraits<T>::digits * correctly::log10(2.0);
        if (finite && size > 0)
            result.digits = apart > 0 ? std::min(most, -0.5 * correctly::log10(double(Reference(apart / size)))) : most;
        out.push_back(result);
    });
}

}  // namespace

bool is_delay_line(Records const& records) {
    Index const d = records.parameters(), N = records.rows();
    return d >= 2 && N >= 2 && records.psi.bottomRightCorner(d - 1, N - 1) == records.psi.topLeftCorner(d - 1, N - 1);
}

std::vector<FastResult> score_fast_forms(Records const& records, double forgetting, double p0,
                                         std::vector<std::string_view> const& arithmetics,
                                         std::vector<Index> const& checkpoints) {
    std::vector<FastResult> out;
    if (!is_delay_line(records)) return out;
    for (std::string_view const arithmetic : arithmetics) {
        if (arithmetic == "float") score_in<float>(records, forgetting, p0, checkpoints, out);
        if (arithmetic == "double") score_in<double>(records, forgetting, p0, checkpoints, out);
    }
    for_each(FastForms<Counted<double>>{}, [&]<class F>() {
        long const operations = operations_of<F>(records.parameters());
        for (FastResult& result : out)
            if (result.form == F::name) result.operations = operations;
    });
    return out;
}

}  // namespace rlslab::compare
