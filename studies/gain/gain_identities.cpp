// What an error in the gain does to P, as identities in exact rational arithmetic.
// Longer than 150 lines: 14 identities, each written out in rationals.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/conventional_two_sided.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/kalman.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <array>
#include <cmath>
#include <functional>

namespace rlslab::studies {
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

/// A filter of d = 2 ... 4 with a general P: a random prior, and three rows without an error.
template <class F>
F started(Q const& lambda, Seed& seed) {
    Index const d = 2 + Index(seed.next() % 3);
    M P0 = M::Identity(d, d);
    for (Index i = 0; i < d; ++i) {
        V const b = fractions(d, seed);
        P0 += outer(b, b);
    }
    F out({.size = d, .forgetting = lambda, .prior = Prior<Q>{.covariance = P0}});
    for (int k = 0; k < 3; ++k) out.update(fractions(d, seed), Q(0));
    return out;
}

/// The order of a change of P that is `change(t)` for an error t: from two small ones.
double order(std::function<M(Q const&)> const& change) {
    auto const size = [&change](double t) {
        M const D = change(Q(t));
        double largest = 0;
        for (Index j = 0; j < D.cols(); ++j)
            for (Index i = 0; i < D.rows(); ++i) largest = std::max(largest, std::abs(static_cast<double>(D(i, j))));
        return largest;
    };
    return correctly::log2(size(0x1p-20) / size(0x1p-30)) / 10;
}

/// P of F's formula from an f and an s that are wrong, and the K they make. Joseph's form has neither but in K: its own
/// text, with that K. joseph_rank_two has them in (4) too, before its page lets K be changed: (4) and (5) of that page.
template <class F>
M from_wrong(F const& before, V const& psi, Q const& lambda, V const& f, Q const& s) {
    V const K = f / s;
    if (F::name == "joseph") {
        F out = before;
        out.update(psi, Q(0), [&K](auto& gain) {
            for (Index i = 0; i < K.size(); ++i) gain[i] = K[i];
        });
        return out.covariance();
    }
    V const g = f - s / 2 * K;
    return (before.covariance() - (outer(K, g) + outer(g, K))) / lambda;
}

template <class F>
void examine(Trial const& trial, TrialOutput& out) {
    int const cases = trial.full() ? 400 : 100;
    Q const lambda = tenths(trial.number("lambda"));
    int first_order = 0, second_order = 0, same_formula = 0;
    std::array<double, 2> least{9, 9}, greatest{0, 0};  // of the orders in s and in f
    std::array<int, ratios.size()> definite{};
    Seed seed = trial.seed({"lambda"});
    for (int n = 0; n < cases; ++n) {
        F const before = started<F>(lambda, seed);
        Index const d = before.theta().size();
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
        if (F::name == "joseph" || F::name == "joseph_rank_two") {
            V const f = P.lazyProduct(psi);
            Q const s = lambda + excitation;
            M const exact = honest.covariance();
            same_formula += from_wrong(before, psi, lambda, f, s) == exact;
            std::array const orders{
                order([&](Q const& t) { return M(from_wrong(before, psi, lambda, f, s * (1 + t)) - exact); }),
                order([&](Q const& t) {
                    return M(from_wrong(before, psi, lambda, f + t * deltaK, s + t * dot(psi, deltaK)) - exact);
                })};
            for (size_t i = 0; i < 2; ++i)
                least[i] = std::min(least[i], orders[i]), greatest[i] = std::max(greatest[i], orders[i]);
        }
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
    if (greatest[0] == 0) return;
    out({"formula", 0.0, double(same_formula) / cases});
    for (size_t i = 0; i < 2; ++i) {
        out({i == 0 ? "order in s" : "order in f", 0.0, least[i]});
        out({i == 0 ? "order in s" : "order in f", 1.0, greatest[i]});
    }
}

/// ud: an error of the running gain that enters after column j, for every j.
void examine_sweep(Trial const& trial, TrialOutput& out) {
    int const cases = trial.full() ? 400 : 100;
    Q const lambda = tenths(trial.number("lambda"));
    int columns = 0, law = 0, as_at_the_start = 0, last = 0, definite = 0;
    Seed seed = trial.seed({"lambda"});
    for (int n = 0; n < cases; ++n) {
        Ud<Q> const before = started<Ud<Q>>(lambda, seed);
        Index const d = before.theta().size();
        V const psi = fractions(d, seed);
        V const delta = fractions(d, seed) * Q(10);  // of the gain and far beyond: the law knows no smallness
        Ud<Q> honest = before;
        honest.update(psi, Q(0));
        Stored<Q> const stored = before.stored();
        V const K = honest.gain(), f = stored.F.transpose().lazyProduct(psi);
        V v = V::Zero(d);
        Q s = lambda, s_d = lambda;
        for (Index j = 0; j < d; ++j) s_d += f[j] * stored.D[j] * f[j];
        for (Index j = 0; j < d; ++j) {
            v += stored.F.col(j) * Q(stored.D[j] * f[j]);
            s += f[j] * stored.D[j] * f[j];
            Ud<Q> wrong = before;
            wrong.update(psi, Q(0), [&](std::span<Q> running, Q const&) {
                if (Index(running.size()) == j + 1)
                    for (Index i = 0; i <= j; ++i) running[size_t(i)] += delta[i];
            });
            V delta_v = delta;
            for (Index i = j + 1; i < d; ++i) delta_v[i] = 0;
            V const w = K - v / s;
            M const linear = -(outer(delta_v, w) + outer(w, delta_v)) / lambda,
                    square = outer(delta_v, delta_v) / lambda;
            M const deltaP = wrong.covariance() - honest.covariance();
            law += deltaP == M(linear + (1 / s - 1 / s_d) * square);
            as_at_the_start +=
                deltaP == M(-(outer(delta_v, K) + outer(K, delta_v)) / lambda + (1 / lambda - 1 / s_d) * square);
            if (j + 1 == d) last += deltaP == M::Zero(d, d) && !(wrong.gain() == honest.gain());
            definite += is_positive_definite(wrong.covariance());
            ++columns;
        }
    }
    out({"sweep", 0.0, double(law) / columns});
    out({"at the start", 0.0, double(as_at_the_start) / columns});
    out({"last column", 0.0, double(last) / cases});
    out({"definite", 0.0, double(definite) / columns});
}

void measure(Trial const& trial, TrialOutput& out) {
    for_each(TypeList<Conventional<Q>, ConventionalTwoSided<Q>, Symmetric<Q>, Kalman<Q>, Joseph<Q>, JosephRankTwo<Q>>{},
             [&]<class F>() {
                 if (F::name == trial.text("variant")) examine<F>(trial, out);
             });
    if (trial.text("variant") == "ud") examine_sweep(trial, out);
}

std::vector<std::string> const subtracting{"conventional", "conventional_two_sided", "symmetric", "kalman"};
std::vector<std::string> const josephs{"joseph", "joseph_rank_two"};

Judgement share(Table const& t, char const* property, std::vector<std::string> const& variants, double from, double to,
                double wanted) {
    Table const rows = t.where("property", property).where("ratio", [=](double r) { return from <= r && r <= to; });
    return within(rows.where("variant", variants), {"variant", "lambda", "ratio"}, least("share"), wanted, wanted);
}
Judgement order_within(Table const& t, char const* variant, double from, double to) {
    Table const rows = t.where("variant", variant);
    return labelled("s", within(rows.where("property", "order in s"), {"lambda", "ratio"}, least("share"), from, to)) &&
           labelled("f", within(rows.where("property", "order in f"), {"lambda", "ratio"}, least("share"), from, to));
}

}  // namespace

extern Study const gain_identities;
Study const gain_identities{
    .name = "gain_identities",
    .question = "Are the laws of an error in the gain exact?",
    .source = "Bucy & Joseph 1968 (cited, not read); derived (docs/theory.md 16, 17, 29 to 31, 33, 34)",
    .formula =
        R"tex(\begin{aligned} \text{subtracting } K\psi^\top P: &\quad \delta P = -\delta K\,\psi^\top P / \lambda \\
\text{Joseph}: &\quad \delta P = s\,\delta K\,\delta K^\top / \lambda \\
\text{UD, after column } j: &\quad
\delta P = \bigl[-(\delta v\, w^\top + w\, \delta v^\top) + (1/s_j - 1/s) \delta v\, \delta v^\top\bigr] / \lambda, \quad
w = K - K_{(j)} \\
\text{with gain } (1 + \varepsilon) K: &\quad
P_k > 0 \iff \varepsilon < \lambda / \psi^\top P \psi = \gamma / (1 - \gamma) \end{aligned})tex",
    .interpretation =
        "Each filter is the library's own text in exact rationals: sizes 2 to 4, random P, rows and gain errors, the "
        "same for all variants, compared with == and not with a tolerance. A gain that is too long by (1 + eps) leaves "
        "P positive definite up to the threshold lambda / psi'P psi in the forms that subtract; at the threshold "
        "itself P is singular, one thousandth beyond it is indefinite. Joseph's forms stay definite however wrong the "
        "gain is. The symmetric form obeys the first law with the triangle it computes mirrored. UD has no K in its "
        "update of U and D, but a vector that grows to the gain: an error of it reaches P in first order, unless it "
        "enters after the last column, and never touches definiteness. An error of s or of f is one of K alone in "
        "Joseph's form by products, and stays of second order; in joseph_rank_two it is of first order (formulas (4) "
        "and (5) of its page, evaluated here: the page lets K be changed only after them). The root forms obey their "
        "laws to 1e-60 (tests/variants/gain_laws.cpp). What runs and rounding make of all this: studies gain_error, "
        "gain_error_size, gain_error_definiteness.",
    .data = "random rational P, rows and errors, d = 2, 3, 4",
    .factors =
        [](Budget) {
            return std::vector<Factor>{{"lambda", {1.0, 0.9}},
                                       {"variant", joined(covariance_forms(), {"kalman", "ud"})}};
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
               .where = {{"property", {"definite"}},
                         {"variant",
                          {"conventional", "conventional_two_sided", "symmetric", "kalman", "joseph",
                           "joseph_rank_two"}}}}},
    .claims =
        {
            {"forms that subtract K psi'P: deltaP = -deltaK psi'P / lambda to exactly 0 in every case",
             [](Table const& t) { return share(t, "first order", subtracting, 0, 0, 1); },
             verification("docs/theory.md 16")},
            {"Joseph's forms: deltaP = s deltaK deltaK' / lambda to exactly 0 in every case",
             [](Table const& t) { return share(t, "second order", josephs, 0, 0, 1); },
             verification("docs/theory.md 17")},
            {"the test can fail: no case of a form that subtracts obeys Joseph's law",
             [](Table const& t) { return share(t, "second order", subtracting, 0, 0, 0); },
             verification("docs/theory.md 16")},
            {"nor any of a Joseph form the first-order law",
             [](Table const& t) { return share(t, "first order", josephs, 0, 0, 0); },
             verification("docs/theory.md 17")},
            {"UD: an error of the running gain after column j obeys the law of the sweeps, to exactly 0, for every j",
             [](Table const& t) { return share(t, "sweep", {"ud"}, 0, 0, 1); }, verification("docs/theory.md 33 (G8)")},
            {"after the last column it changes the gain and nothing of P",
             [](Table const& t) { return share(t, "last column", {"ud"}, 0, 0, 1); },
             verification("docs/theory.md 33 (G8)")},
            {"the test can fail: the law of an error at the start, before any column, holds in fewer than one case in "
             "ten: with zeros in f",
             [](Table const& t) {
                 return within(t.where("property", "at the start"), {"lambda"}, greatest("share"), 0, 0.1);
             },
             verification("docs/theory.md 33 (G8)")},
            {"and UD's P stays positive definite in every case, with errors far larger than the gain",
             [](Table const& t) { return share(t, "definite", {"ud"}, 0, 0, 1); },
             verification("docs/theory.md 34 (G6)")},
            {"with gain (1 + eps) K, forms that subtract stay positive definite up to 0.999 of lambda / psi'P psi, in "
             "every case",
             [](Table const& t) { return share(t, "definite", subtracting, -2, 0.9995, 1); },
             verification("docs/theory.md 29")},
            {"and from the threshold itself on, in no case",
             [](Table const& t) { return share(t, "definite", subtracting, 1, 2, 0); },
             verification("docs/theory.md 29")},
            {"Joseph's forms stay positive definite at every eps, in every case",
             [](Table const& t) { return share(t, "definite", josephs, -2, 2, 1); }, verification("docs/theory.md 30")},
            {"the formulas of Joseph's forms as evaluated here are those of the variants, in every case",
             [](Table const& t) { return share(t, "formula", josephs, 0, 0, 1); }, verification("docs/theory.md 17")},
            {"joseph_rank_two: errors of s and of f reach P with slope 1.00 +- 0.01",
             [](Table const& t) { return order_within(t, "joseph_rank_two", 0.99, 1.01); },
             verification("docs/theory.md 31 (G7)")},
            {"joseph: with slope 2.00 +- 0.01", [](Table const& t) { return order_within(t, "joseph", 1.99, 2.01); },
             verification("docs/theory.md 31 (G7)")},
        },
};

}  // namespace rlslab::studies
