// The recursion of theta's error with its noise term, in exact rationals: in which norm it contracts, and in which it
// does not. Longer than 150 lines: the recursion and its counterexample in rationals.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>

#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

using namespace rationals;

/// "c I": P0 = 4 I. "diagonal": P0 = diag(1, 100, 1, 100 ...). "full": P0 = I + two outer products.
M prior_of(std::string const& name, Index d) {
    M P = M::Identity(d, d);
    if (name == "c I") P *= Q(4);
    if (name == "diagonal")
        for (Index i = 1; i < d; i += 2) P(i, i) = 100;
    if (name == "full") {
        V a(d), b(d);
        for (Index i = 0; i < d; ++i) a[i] = int(i) - 1, b[i] = 2 - int(i * i);
        P += outer(a, a) + outer(b, b);
    }
    return P;
}

/// Counts, over the steps of every run.
struct Counts {
    double steps = 0, recursion = 0, metric = 0, bound = 0, longer = 0, beyond_start = 0, within_run_bound = 0,
           grew_with_noise = 0;
};

/// Eight rows of small integers. Without noise: lengths too. kappa_2(P0) = 1 for "c I", 100 for "diagonal".
template <class F>
void run(std::string const& prior, bool noisy, Q const& lambda, Seed seed, Counts& c) {
    Index const d = 2 + Index(seed.next() % 3);
    M const P0 = prior_of(prior, d), I = M::Identity(d, d);
    V const theta0 = integers(d, seed, 3);
    V truth = integers(d, seed, 5);
    if (truth == theta0) truth[0] += 1;
    F filter({.size = d, .forgetting = lambda, .prior = Prior<Q>{.theta = theta0, .covariance = P0}});
    M X = inverse(P0);
    V error = truth - theta0;
    Q const start = dot(error, error);
    Q energy = form(error, X);
    for (int k = 0; k < 8; ++k) {
        V const psi = integers(d, seed, 9);
        Q const xi = noisy ? int(seed.next() % 7) - 3 : 0;
        filter.update(psi, dot(psi, truth) + xi);
        V const K = filter.gain(), now = truth - filter.theta(),
                predicted = (I - outer(K, psi)).lazyProduct(error) - xi * K;
        X = lambda * X + outer(psi, psi);
        Q const energy_now = form(now, X), length = dot(now, now);
        ++c.steps;
        c.recursion += now == predicted;
        c.bound += energy_now <= lambda * energy + xi * xi;
        c.grew_with_noise += energy_now > lambda * energy;
        c.metric += energy_now <= lambda * energy;
        c.longer += length > dot(error, error);
        c.beyond_start += length > start;
        c.within_run_bound += length <= (prior == "diagonal" ? Q(100) : Q(1)) * start;
        error = now, energy = energy_now;
    }
}

void measure(Trial const& trial, TrialOutput& out) {
    Q const lambda = tenths(trial.number("lambda"));
    Counts c;
    Seed seed = trial.seed({"lambda", "prior", "noise"});
    for (int n = 0; n < (trial.full() ? 200 : 20); ++n)
        for_each(Variants<Q>{}, [&, draw = Seed{seed.next()}]<class F>() {
            if (F::name == trial.text("variant"))
                run<F>(trial.text("prior"), trial.text("noise") == "noise", lambda, draw, c);
        });
    out({c.steps, c.recursion / c.steps, c.metric / c.steps, c.bound / c.steps, c.grew_with_noise / c.steps,
         c.longer / c.steps, c.beyond_start / c.steps, c.within_run_bound / c.steps});
}

/// P0 = diag(1, a^2), psi = (1, 1/a)', the error (1, 0)': one step of each rational variant leaves (2/3, -a/3)',
/// exactly.
Judgement counterexample() {
    int variants = 0, exact = 0;
    std::string said;
    for_each(Variants<Q>{}, [&]<class F>() {
        ++variants;
        bool all = true;
        for (int a : {10, 100, 1000}) {
            M P0 = M::Identity(2, 2);
            P0(1, 1) = a * a;
            V const psi{{Q(1), Q(1) / a}}, truth{{Q(1), Q(0)}};
            F filter({.size = 2, .forgetting = Q(1), .prior = Prior<Q>{.theta = V::Zero(2), .covariance = P0}});
            filter.update(psi, dot(psi, truth));
            V const now = truth - filter.theta();
            Q const squared = dot(now, now), energy = form(now, inverse(P0) + outer(psi, psi));
            all = all && now[0] == Q(2) / 3 && now[1] == Q(-a) / 3 && energy == Q(2) / 3;
            if (variants == 1)
                said += fmt::format("{}{}", said.empty() ? "squared lengths from 1 to " : ", ", squared.str());
        }
        exact += all;
    });
    return {exact == variants && variants >= 9, fmt::format("{}; {} of {} variants", said, exact, variants)};
}

Table with(Table const& t, char const* noise) { return t.where("noise", noise); }

}  // namespace

extern Study const error_recursion;
Study const error_recursion{
    .name = "error_recursion",
    .question = "In which norm does the error of theta contract, and what does the noise add?",
    .source =
        "derived (docs/theory.md 18, 19, 23, 25), against the conclusion from the eigenvalues in a lecture that is not "
        "public",
    .formula = R"tex(\begin{aligned} \tilde\theta_k &= (I - K\psi^\top)\tilde\theta_{k-1} - K\xi_k, \qquad
V_k = \tilde\theta_k^\top P_k^{-1}\tilde\theta_k \le \lambda V_{k-1} + \xi_k^2 \\
\lVert\tilde\theta_N\rVert &\le \sqrt{\kappa_2(P_0)}\,\lVert\tilde\theta_0\rVert \ \text{ without noise} \end{aligned})tex",
    .interpretation =
        "Eight rows of small integers in exact rationals, each variant that needs no square root. The recursion of the "
        "error holds with ==, its noise term included. In the metric of P^-1 the error contracts: V falls by the "
        "factor lambda at least, and noise adds at most its square. In the 2-norm it does not: steps without noise "
        "make the error longer, from P0 = c^2 I too, and from another P0 it may end longer than it began. What holds "
        "there is the bound of a whole run, the root of the condition number of P0.",
    .data = "random integers, d = 2 to 4, three priors; diag(1, a^2)",
    .factors =
        [](Budget) {
            std::vector<Cell> names;
            for_each(Variants<Q>{}, [&]<class F>() { names.emplace_back(std::string(F::name)); });
            return std::vector<Factor>{{"lambda", {1.0, 0.9}},
                                       {"prior", {"c I", "diagonal", "full"}},
                                       {"noise", {"none", "noise"}},
                                       {"variant", names}};
        },
    .measures = {"steps", "recursion", "contracts", "bounded", "grows_with_noise", "longer", "beyond_start",
                 "within_run_bound"},
    .measure = measure,
    .plots = {{.title = "Share of steps without noise that make the error longer in the 2-norm",
               .x = "lambda",
               .y = "longer",
               .series = "prior",
               .log = "",
               .x_label = "forgetting factor",
               .y_label = "share of steps",
               .where = {{"noise", {"none"}}}}},
    .claims =
        {
            {"the recursion of the error, its noise term included, holds with == at every step, for every variant that "
             "exists in rationals",
             [](Table const& t) {
                 return within(t, {"variant", "lambda", "prior", "noise"}, least("recursion"), 1, 1);
             },
             verification("docs/theory.md 18")},
            {"without noise V = theta~'P^-1 theta~ contracts by lambda at every step, exactly",
             [](Table const& t) {
                 return within(with(t, "none"), {"variant", "lambda", "prior"}, least("contracts"), 1, 1);
             },
             verification("docs/theory.md 19, 23")},
            {"with noise V grows by its square at most, at every step; and in some steps it grows",
             [](Table const& t) {
                 Table const noisy = with(t, "noise");
                 return labelled("bounded", within(noisy, {"variant", "lambda", "prior"}, least("bounded"), 1, 1)) &&
                        labelled("grows",
                                 within(noisy, {"variant", "lambda", "prior"}, greatest("grows_with_noise"), 1e-3, 1));
             },
             verification("docs/theory.md 23")},
            {"in the 2-norm it does not contract: without noise some steps make the error longer, from each prior",
             [](Table const& t) {
                 return within(with(t, "none"), {"variant", "lambda", "prior"}, greatest("longer"), 1e-3, 1);
             },
             verification("docs/theory.md 19, 24")},
            {"P0 = diag(1, a^2), psi = (1, 1/a)', error (1, 0)': one step leaves (2/3, -a/3)' while V falls from 1 to "
             "2/3, exactly",
             [](Table const&) { return counterexample(); }, verification("docs/theory.md 19, 24")},
            {"from P0 = c^2 I the error is never longer than it began, from diag(1, 100) at most 10 times as long, "
             "without noise",
             [](Table const& t) {
                 return within(with(t, "none").where("prior", {"c I", "diagonal"}), {"variant", "lambda", "prior"},
                               least("within_run_bound"), 1, 1);
             },
             verification("docs/theory.md 25")},
            {"from diag(1, 100) some steps without noise do leave it longer than it began",
             [](Table const& t) {
                 return within(with(t, "none").where("prior", "diagonal"), {"variant", "lambda"},
                               greatest("beyond_start"), 1e-3, 1);
             },
             verification("docs/theory.md 19")},
        },
};

}  // namespace rlslab::studies
