// The structural identities of recursive least squares, in exact rational arithmetic, for every variant that exists in
// it.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>

#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

using namespace rationals;
constexpr Index d = 3;

/// One run with small integers. Calls `note` for every identity at every step with whether it held.
template <class F, class Note>
void run(Q const& lambda, Seed seed, Note note) {
    M const I = M::Identity(d, d), P0 = I + outer(V{{1, 2, -1}}, V{{1, 2, -1}}) + outer(V{{0, 1, 3}}, V{{0, 1, 3}});
    V const theta0 = integers(d, seed, 3), truth = integers(d, seed, 5);
    F filter({.size = d, .forgetting = lambda, .prior = Prior<Q>{.theta = theta0, .covariance = P0}});
    M X = inverse(P0), P = P0, S = P0 / lambda;   // S: Kalman's predicted covariance
    V b = X.lazyProduct(theta0), state = theta0;  // state: Kalman's estimate
    Q J = 0, energy = form(truth - theta0, X);
    std::vector<std::pair<V, Q>> rows;
    for (int k = 0; k < 6; ++k) {
        V psi = integers(d, seed, 9);
        while (psi.isZero(Q(0))) psi = integers(d, seed, 9);  // of a row of zeros the control would hold
        Q const v = int(seed.next() % 7) - 3, y = dot(psi, truth) + v, s = lambda + form(psi, P);
        rows.emplace_back(psi, y);
        Step<Q> const step = filter.update(psi, y);
        Q const e = step.innovation, gamma = step.gamma;
        V const K = filter.gain(), theta = filter.theta(), kalman = S.lazyProduct(psi) / (form(psi, S) + 1);
        M const P_now = covariance(filter.stored()), A = I - outer(K, psi), X_before = X;
        X = lambda * X + outer(psi, psi), b = lambda * b + y * psi;
        state += kalman * (y - dot(psi, state));
        S -= M(outer(kalman, psi).lazyProduct(S));
        Q J_now = form(theta - theta0, inverse(P0)), energy_now = form(truth - theta, X);  // J by its definition
        for (auto const& [row, answer] : rows)
            J_now = lambda * J_now + (answer - dot(row, theta)) * (answer - dot(row, theta));

        note("P_k^-1 = λ P_k-1^-1 + ψψ'", P_now.lazyProduct(X) == I);
        note("θ minimises J", X.lazyProduct(theta) == b);
        note("K = P_k ψ", K == P_now.lazyProduct(psi));
        note("residual = γ e and γ = λ / s",
             step.residual == gamma * e && step.residual == y - dot(psi, theta) && gamma == lambda / s);
        note("I - Kψ' = λ P_k P_k-1^-1", A == lambda * P_now.lazyProduct(X_before));
        note("eigenvalues of I - Kψ': 1 and γ", (A - I).lazyProduct(A - gamma * I).isZero(Q(0)));
        note("trace (I - Kψ') = d - 1 + γ", A(0, 0) + A(1, 1) + A(2, 2) == d - 1 + gamma);
        note("det (I - Kψ') = γ", determinant(A) == gamma);
        note("det P_k^-1 = λ^d det P_k-1^-1 / γ",
             determinant(X) * gamma == lambda * lambda * lambda * determinant(X_before));
        note("J_k = λ J_k-1 + γ e²", J_now == lambda * J + gamma * e * e);
        note("V_k = λ V_k-1 + v² - γ e²", energy_now == lambda * energy + v * v - gamma * e * e);
        note("Joseph = conventional",
             P_now == M((A.lazyProduct(P).lazyProduct(A.transpose()) + lambda * outer(K, K)) / lambda));
        note("Kalman with S = P / λ", kalman == K && S == P_now && state == theta);
        note("(control) I - Kψ' = λ P_k-1 P_k^-1", A == lambda * P.lazyProduct(X));
        J = J_now, energy = energy_now, P = P_now, S /= lambda;
    }
}

void measure(Trial const& trial, TrialOutput& out) {
    Q const lambda = tenths(trial.number("lambda"));
    std::vector<std::pair<std::string, std::pair<int, int>>> tally;  // identity: held, of
    auto const note = [&](std::string const& identity, bool holds) {
        auto at = std::ranges::find(tally, identity, [](auto const& entry) { return entry.first; });
        if (at == tally.end()) at = tally.insert(at, {identity, {0, 0}});
        at->second.first += holds, ++at->second.second;
    };
    Seed seed = trial.seed({"lambda"});
    for (int n = 0; n < (trial.full() ? 400 : 30); ++n)
        for_each(Variants<Q>{}, [&, draw = Seed{seed.next()}]<class F>() {
            if (F::name == trial.text("variant")) run<F>(lambda, draw, note);
        });
    for (size_t i = 0; i < tally.size(); ++i)
        out({tally[i].first, double(i + 1), double(tally[i].second.second),
             double(tally[i].second.first) / tally[i].second.second});
}

Table of(Table const& t, bool control) {
    return t.where("number", [=](double n) { return (n == 14) == control; });
}

}  // namespace

extern Study const identities;
Study const identities{
    .name = "identities",
    .question = "Do the identities of recursive least squares hold exactly, in every variant?",
    .source =
        "derived (docs/theory.md 12, 14, 15, 17, 18, 20 to 23; docs/literature.md 2, F1 to F6, F12); for Kalman's also "
        "Sayed & Kailath 1994 (cited, not read)",
    .formula = R"tex(\begin{aligned} P_k^{-1} &= \lambda P_{k-1}^{-1} + \psi\psi^\top, \quad K = P_k \psi, \quad
y - \psi^\top \theta_k = \gamma e, \quad \gamma = \lambda / s \\
I - K\psi^\top &= \lambda P_k P_{k-1}^{-1}, \quad \operatorname{tr} = d - 1 + \gamma, \quad \det = \gamma, \quad
\det P_k^{-1} = \lambda^d \det P_{k-1}^{-1} / \gamma \\
J_k &= \lambda J_{k-1} + \gamma e^2, \quad V_k = \lambda V_{k-1} + v^2 - \gamma e^2 \end{aligned})tex",
    .interpretation =
        "Six rows of small integers, a full prior and a state that is known, in exact rationals: each variant that "
        "needs no square root is the library's own text, and each identity is asked with == after every row. Thirteen "
        "are exact everywhere. The last column is a control, an identity with P_k and P_k-1 exchanged, which fails in "
        "every case: the question can be answered with no. Kalman's filter is written out here on its own and starts "
        "every step from S = P / lambda, which is how forgetting looks to it. J is computed by its definition, from "
        "all rows and the prior.",
    .data = "random integers, d = 3",
    .factors =
        [](Budget) {
            std::vector<Cell> names;
            for_each(Variants<Q>{}, [&]<class F>() { names.emplace_back(std::string(F::name)); });
            return std::vector<Factor>{{"lambda", {1.0, 0.9}}, {"variant", names}};
        },
    .measures = {"identity", "number", "cases", "share"},
    .measure = measure,
    .plots = {{.title = "Share of cases in which the identity is exact",
               .x = "number",
               .y = "share",
               .panel = "lambda",
               .log = "",
               .x_label = "identity (14: the control)",
               .y_label = "share of cases",
               .cells = true}},
    .claims =
        {
            {"thirteen identities hold with == in every case, for every variant that exists in rationals",
             [](Table const& t) {
                 return within(of(t, false), {"variant", "lambda", "identity"}, least("share"), 1, 1);
             },
             verification("docs/theory.md 12, 14, 15, 17, 18, 20 to 23")},
            {"the control fails in every case",
             [](Table const& t) {
                 return within(of(t, true), {"variant", "lambda"}, greatest("share"), 0, 0);
             },
             verification("a control: not an identity")},
            {"at least nine variants exist in exact arithmetic, and were asked",
             [](Table const& t) {
                 double const n = double(t.distinct("variant").size());
                 return Judgement{n >= 9, fmt::format("{}", n)};
             },
             verification("the list of variants")},
        },
};

}  // namespace rlslab::studies
