// One exact step can enlarge an error of theta however small P is, and yet no error grows in the metric of P^-1.
// Longer than 150 lines: exact data and a norm of its own.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/variants/symmetric.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>

namespace rlslab::studies {
namespace {

/// |A|_2 by its definition, with nothing of the formula to be tested: A'A's largest eigenvalue, by squaring until
/// d^(1/2^i) is 1 in 257 bits.
Reference norm_of(Matrix<Reference> const& A) {
    Matrix<Reference> B = A.transpose().lazyProduct(A);
    Reference log_norm = 0, share = 0.5;
    for (int i = 0; i < 270; ++i) {
        Reference largest = 0;
        for (Index j = 0; j < B.cols(); ++j)
            if (largest < B(j, j)) largest = B(j, j);
        log_norm += log(largest) * share;
        share /= 2;
        B /= largest;
        B = B.lazyProduct(B).eval();
    }
    return exp(log_norm);
}

/// P = diag(1, a^2) and psi = (1, 1/a), or a random P = B B' + I/16 and psi of five-bit integers, d = 2 ... 5.
std::pair<Matrix<Rational>, Vector<Rational>> data_of(Trial const& trial) {
    bool const example = trial.text("data") == "counterexample";
    Seed seed = trial.seed({"data", "a"});
    Index const d = example ? 2 : 2 + Index(seed.next() % 4);
    Matrix<Rational> P = Matrix<Rational>::Zero(d, d), B(d, d);
    Vector<Rational> psi(d);
    if (example) {
        Rational const a(trial.number("a"));
        P(0, 0) = 1, P(1, 1) = a * a;
        psi[0] = 1, psi[1] = 1 / a;
        return {P, psi};
    }
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) B(i, j) = int(seed.next() % 31) - 15;
        psi[j] = int(seed.next() % 31) - 15;
    }
    psi[0] += 16;  // so that psi is not zero
    P = B.lazyProduct(B.transpose());
    for (Index j = 0; j < d; ++j) P(j, j) += Rational(1, 16);
    return {P, psi};
}

/// One update with lambda = 1 in exact rationals.
void measure(Trial const& trial, TrialOutput& out) {
    auto const [P, psi] = data_of(trial);
    Index const d = psi.size();
    Symmetric<Rational> filter(
        Problem<Rational>{.size = d, .forgetting = 1, .prior = Prior<Rational>{.variance = 1, .covariance = P}});
    Rational const gamma = filter.update(psi, Rational(0)).gamma;
    Vector<Rational> const K = filter.gain();
    Matrix<Rational> A(d, d);
    Rational KK = 0, pp = 0, Kp = 0;
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i < d; ++i) A(i, j) = Rational(i == j ? 1 : 0) - K[i] * psi[j];
        KK += K[j] * K[j], pp += psi[j] * psi[j], Kp += K[j] * psi[j];
    }
    // P_k = A P. With delta = P x then V = x'P x before and x'P_k x after the step: it shrinks for no x orthogonal to P
    // psi and grows for none.
    bool const contracts = A.lazyProduct(P).eval() == filter.covariance();
    Reference const tau = sqrt(Reference(Rational(KK * pp))),
                    formula = (tau + sqrt(tau * tau + 4 * Reference(gamma))) / 2;
    Reference const norm = norm_of(A.unaryExpr([](Rational const& x) { return Reference(x); }).cast<Reference>());
    Reference const deviation = abs(formula / norm - 1);
    out({static_cast<double>(norm), static_cast<double>(formula), static_cast<double>(deviation),
         static_cast<double>(gamma), contracts ? "exact" : "broken",
         KK * pp == Kp * Kp ? "eigenvector" : "none"});  // K parallel to psi
}

}  // namespace

extern Study const non_contraction;
Study const non_contraction{
    .name = "non_contraction",
    .question = "Can one exact step enlarge an error of theta when nothing is forgotten?",
    .source =
        "A note on the error propagation analysis of recursive least squares algorithms (abstract read: not "
        "contractive, against Ljung & Ljung 1985 and Verhaegen 1989); the example and the formula are derived "
        "(docs/theory.md 24, 25; docs/literature.md 3.8)",
    .formula =
        R"tex(\begin{aligned} \|I - K\psi^\top\|_2 &= \tfrac12\left(\tau + \sqrt{\tau^2 + 4\gamma}\right), \quad
              \tau = \|K\|\|\psi\| \\
P &= \mathrm{diag}(1, a^2), \; \psi = (1, 1/a)^\top : \quad
        I - K\psi^\top = \begin{pmatrix} 2/3 & -1/(3a) \\ -a/3 & 2/3 \end{pmatrix}, \quad
        \text{eigenvalues } 1, \tfrac13 \end{aligned})tex",
    .interpretation =
        "The step's matrix I - K psi' has no eigenvalue beyond 1, and yet its norm is: 3.46, 33.3, 333.3 for a = 10, "
        "100, 1000, about a/3, and beyond 1 unless psi is an eigenvector of P. An error of theta may grow by as much "
        "in one step. In the metric of P^-1 it cannot: (I - K psi')P = P_k, exactly, so that V = delta'P^-1 delta does "
        "not grow. The condition number of P is then the most a whole run can enlarge an error by, its square root to "
        "be precise: there is no exponential growth (study accuracy_steps).",
    .data = "random integers, d = 2 to 5; diag(1, a^2)",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"data", {"counterexample", "random"}},
                                       {"a", budget == Budget::full ? counted(2000) : joined(counted(200), {1000.0})}};
        },
    .admits =
        [](Trial const& trial) {
            double const a = trial.number("a");
            return trial.text("data") == "random" || a == 2 || a == 5 || a == 10 || a == 20 || a == 50 || a == 100 ||
                   a == 1000;
        },
    .measures = {"norm", "formula", "deviation", "gamma", "identity", "psi"},
    .measure = measure,
    .plots = {{.title = "The counterexample",
               .x = "a",
               .y = "norm",
               .series = "data",
               .x_label = "a",
               .y_label = "|I - K psi'|_2",
               .where = {{"data", {"counterexample"}}},
               .guides = {{"a/3", [](double a) { return a / 3; }}}}},
    .claims =
        {
            {"the example's norms are 3.46292442, 33.34666 and 333.33467 for a = 10, 100, 1000, to all digits given",
             [](Table const& t) {
                 bool holds = true;
                 std::string said;
                 for (auto const& [a, norm, last] :
                      {std::tuple{10.0, 3.46292442, 5e-9}, {100.0, 33.34666, 5e-6}, {1000.0, 333.33467, 5e-6}}) {
                     double const measured = t.where("data", "counterexample").where("a", a).number("norm");
                     holds = holds && std::abs(measured - norm) <= last;
                     said += fmt::format("{}{:.8f}", said.empty() ? "" : ", ", measured);
                 }
                 return Judgement(holds, said);
             },
             verification("docs/theory.md 24")},
            {"the formula is the norm to 1e-13 (to 1e-70 in 257 bits) in every case",
             [](Table const& t) { return within(t, {"data"}, greatest("deviation"), 0, 1e-70); },
             verification("docs/theory.md 24")},
            {"the norm exceeds 1 in every case but those, by chance, in which psi is an eigenvector of P: there it is "
             "1",
             [](Table const& t) {
                 Statistic const over_one = [](Table const& rows) { return least("norm")(rows) - 1; };
                 std::vector<double> const chance = t.where("psi", "eigenvector").numbers("norm");
                 Judgement const one(std::ranges::all_of(chance, [](double norm) { return norm == 1; }),
                                     fmt::format("{} eigenvectors", chance.size()));
                 return labelled("by at least", within(t.where("psi", "none"), {}, over_one, 1e-12, 1e9)) && one;
             },
             verification("docs/theory.md 24")},
            {"and still V = delta'P^-1 delta never grows: (I - K psi')P = P_k exactly, 0 < gamma < 1",
             [](Table const& t) {
                 Judgement const a = everywhere(t, "identity", "exact"),
                                 b = within(t, {"data"}, greatest("gamma"), 0, 1);
                 return a && labelled("gamma at most", b);
             },
             verification("docs/theory.md 25")},
        },
};

}  // namespace rlslab::studies
