// What an error in the gain does to P, as identities in exact rational arithmetic.
#include "studies/engine/findings.hpp"
#include "studies/engine/rationals.hpp"
#include "studies/engine/scenarios.hpp"

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/conventional_two_sided.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <array>
#include <cmath>

namespace rlslab {
namespace {

using namespace rationals;

/// A fraction of small integers in every place, none of them all zero: psi = 0 would have no threshold.
V fractions(Index size, Seed& seed) {
    V out = V::Zero(size);
    while (out.isZero(Q(0)))
        for (Q& x : out) x = integers(1, seed, 9)[0] / int(1 + seed.next() % 4);
    return out;
}

/// eps over lambda / psi'P psi: below one P should stay positive definite.
constexpr std::array ratios{-2.0, 0.0, 0.5, 0.9, 0.99, 0.999, 1.0, 1.001, 1.01, 1.1, 2.0};

template <class F>
void examine(Trial const& trial, TrialOutput& out) {
    int const cases = trial.full() ? 400 : 100;
    Q const lambda = tenths(trial.number("lambda"));
    int first_order = 0, second_order = 0;
    std::array<int, ratios.size()> definite{};
    Seed seed = trial.seed({"lambda"});
    for (int n = 0; n < cases; ++n) {
        Index const d = 2 + Index(seed.next() % 3);
        M P0 = M::Identity(d, d);
        for (Index i = 0; i < d; ++i) {
            V const b = fractions(d, seed);
            P0 += outer(b, b);
        }
        F before({.size = d, .forgetting = lambda, .prior = Prior<Q>{.covariance = P0}});
        for (int k = 0; k < 3; ++k) before.update(fractions(d, seed), Q(0));  // undisturbed rows make P general
        V const psi = fractions(d, seed), deltaK = fractions(d, seed);
        F honest = before, wrong = before;
        honest.update(psi, Q(0));
        wrong.update(psi, Q(0), [&](auto& K) {
            for (Index i = 0; i < d; ++i) K[i] += deltaK[i];
        });
        M const P = before.covariance(), deltaP = wrong.covariance() - honest.covariance();
        Q const excitation = form(psi, P);
        M first = -outer(deltaK, P.lazyProduct(psi)) / lambda;
        if (F::name == "symmetric") first = M(first.selfadjointView<Eigen::Upper>());  // mirrored, as P is
        first_order += deltaP == first;
        second_order += deltaP == M((lambda + excitation) / lambda * outer(deltaK, deltaK));
        for (size_t r = 0; r < ratios.size(); ++r) {
            Q const eps = Q(std::lround(ratios[r] * 1000)) / 1000 * lambda / excitation;
            F longer = before;
            longer.update(psi, Q(0), [&](auto& K) {
                for (Index i = 0; i < d; ++i) K[i] *= 1 + eps;
            });
            M const P_longer = longer.covariance();
            definite[r] += P_longer == P_longer.transpose() && is_positive_definite(P_longer);
        }
    }
    out({"first order", 0.0, double(first_order) / cases});
    out({"second order", 0.0, double(second_order) / cases});
    for (size_t r = 0; r < ratios.size(); ++r) out({"definite", ratios[r], double(definite[r]) / cases});
}

void measure(Trial const& trial, TrialOutput& out) {
    for_each(TypeList<Conventional<Q>, ConventionalTwoSided<Q>, Symmetric<Q>, Joseph<Q>, JosephRankTwo<Q>>{}, [&]<class F>() {
        if (F::name == trial.text("variant")) examine<F>(trial, out);
    });
}

std::vector<std::string> const subtracting{"conventional", "conventional_two_sided", "symmetric"}, josephs{"joseph", "joseph_rank_two"};

Finding share(Table const& t, char const* property, std::vector<std::string> const& variants, double from, double to, double wanted) {
    Table const rows = t.where("property", property).where("ratio", [=](double r) { return from <= r && r <= to; });
    return within(rows.where("variant", variants), {"variant", "lambda", "ratio"}, least("share"), wanted, wanted);
}

}  // namespace

extern Study const gain_identities;
Study const gain_identities{
    .name = "gain_identities",
    .question = "Are the laws of an error in the gain exact?",
    .source = "Bucy & Joseph 1968 (cited, not read); derived (docs/theory.md 16, 17, 29, 30)",
    .formula = R"tex(\begin{aligned} \text{subtracting } K\psi^\top P: &\quad \delta P = -\delta K\,\psi^\top P / \lambda \\
\text{Joseph}: &\quad \delta P = s\,\delta K\,\delta K^\top / \lambda \\
\text{with gain } (1 + \varepsilon) K: &\quad
P_k > 0 \iff \varepsilon < \lambda / \psi^\top P \psi = \gamma / (1 - \gamma) \end{aligned})tex",
    .interpretation =
        "Each filter is the library's own text in exact rationals: sizes 2 to 4, random P, rows and gain errors, the same for "
        "all variants, compared with == and not with a tolerance. A gain that is too long by (1 + eps) leaves P positive "
        "definite up to the threshold lambda / psi'P psi in the forms that subtract; at the threshold itself P is singular, one "
        "thousandth beyond it is indefinite. Joseph's forms stay definite however wrong the gain is. The symmetric form obeys "
        "the first law with the triangle it computes mirrored. These are laws of the formulas; what rounding leaves of them is "
        "another question (study gain_error).",
    .factors =
        [](Budget) {
            return std::vector<Factor>{{"lambda", {1.0, 0.9}}, {"variant", covariance_forms()}};
        },
    .measures = {"property", "ratio", "share"},
    .measure = measure,
    .plots = {{.title = "Positive definite after a gain of (1 + ε) K",
               .x = "ratio",
               .y = "share",
               .panel = "lambda",
               .log = "",
               .x_label = "ε / (λ / ψ'Pψ)",
               .y_label = "share of cases",
               .where = {{"property", {"definite"}}}}},
    .claims =
        {
            {"forms that subtract K psi'P: deltaP = -deltaK psi'P / lambda to exactly 0 in every case",
             [](Table const& t) { return share(t, "first order", subtracting, 0, 0, 1); }},
            {"Joseph's forms: deltaP = s deltaK deltaK' / lambda to exactly 0 in every case",
             [](Table const& t) { return share(t, "second order", josephs, 0, 0, 1); }},
            {"the test can fail: no case of a form that subtracts obeys Joseph's law",
             [](Table const& t) { return share(t, "second order", subtracting, 0, 0, 0); }},
            {"nor any of a Joseph form the first-order law", [](Table const& t) { return share(t, "first order", josephs, 0, 0, 0); }},
            {"with gain (1 + eps) K, forms that subtract stay positive definite up to 0.999 of lambda / psi'P psi, in every case",
             [](Table const& t) { return share(t, "definite", subtracting, -2, 0.9995, 1); }},
            {"and from the threshold itself on, in no case", [](Table const& t) { return share(t, "definite", subtracting, 1, 2, 0); }},
            {"Joseph's forms stay positive definite at every eps, in every case",
             [](Table const& t) { return share(t, "definite", josephs, -2, 2, 1); }},
        },
};

}  // namespace rlslab
