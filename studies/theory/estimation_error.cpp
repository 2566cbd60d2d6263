// The estimation error on its way: what never grows, and what may.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

namespace rlslab::studies {
namespace {

/// Without noise theta~ = theta - theta_k obeys theta~_k = (I - K psi') theta~_{k-1}: in 257 bits, as the recursion
/// says it.
void measure(Trial const& trial, TrialOutput& out) {
    Index const d = 4, rows = trial.full() ? 200 : 60;
    Records const records = delay_line(d, rows, trial.number("pole"), trial.seed({"pole", "replicate"}), 0);
    auto const filter =
        trial.entry("information", "reference").make({.size = d, .prior = Prior<double>{.variance = 100}}, Seed{1});
    Vector<Reference> const truth = Vector<Reference>::Ones(d);
    auto const square = [](Vector<Reference> const& x, Vector<Reference> const& y) {
        Reference sum = 0;
        for (Index i = 0; i < x.size(); ++i) sum += x[i] * y[i];
        return sum;
    };
    Vector<Reference> error = truth;
    Reference V = square(error, error) / 100, length = sqrt(square(error, error));
    for (Index k = 0; k < rows; ++k) {
        filter->update(records.sample(k), records.y[k]);
        error = truth - filter->theta();
        Vector<Reference> const x = filter->stored().F.lazyProduct(error);  // P^-1 theta~
        Reference const now = square(error, x), size = sqrt(square(error, error));
        out({double(k + 1), static_cast<double>(now / V), static_cast<double>(size / length)});
        V = now, length = size;
    }
}

}  // namespace

extern Study const estimation_error;
Study const estimation_error{
    .name = "estimation_error",
    .question = "Does the estimation error ever grow when there is no noise?",
    .source = "derived (docs/theory.md 18, 19, 23, 25)",
    .formula =
        R"tex(\tilde\theta_k = (I - K\psi^\top)\tilde\theta_{k-1} = A_k\tilde\theta_{k-1}, \;
              A_k = P_kP_{k-1}^{-1}, \qquad
              \tilde\theta_k^\top P_k^{-1}\tilde\theta_k \le \tilde\theta_{k-1}^\top P_{k-1}^{-1}\tilde\theta_{k-1})tex",
    .interpretation =
        "With lambda = 1 the eigenvalues of A_k are 1, and once gamma: in the metric of P^-1 the error never grows. In "
        "the plain norm single steps do make it longer, and the more the input is coloured the longer, because I - K "
        "psi' is no contraction unless psi is an eigenvector of P.",
    .data = "delay lines of poles 0, 0.9, 0.99, d = 4, no noise",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"pole", {0.0, 0.9, 0.99}},
                                       {"replicate", counted(budget == Budget::full ? 50 : 11)}};
        },
    .measures = {"step", "ratio_in_metric", "ratio_in_norm"},
    .measure = measure,
    .plots = {{.title = "Length of the error after a step over before",
               .x = "step",
               .y = "ratio_in_norm",
               .series = "pole",
               .log = "y",
               .y_label = "ratio, plain norm"}},
    .claims =
        {
            {"in the metric of P^-1 the error never grows (by more than 2^-200 of rounding)",
             [](Table const& t) { return within(t, {"pole"}, greatest("ratio_in_metric").as(Estimate::proven), 0, 1); },
             verification("docs/theory.md 23").by("docs/theory.md 23")},
            {"in the plain norm it does: with every input some step of some run makes it longer",
             [](Table const& t) {
                 return within(t, {"pole"}, greatest("ratio_in_norm").as(Estimate::fixed), 1.0001, 1e6);
             },
             own_result("docs/theory.md 24")},
        },
};

}  // namespace rlslab::studies
