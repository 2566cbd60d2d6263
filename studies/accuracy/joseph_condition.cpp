// Why Joseph's products lose a condition number more than the form they replace: which rounding, by how much.
// Longer than 150 lines: a copy of Joseph's update with one rounding at a time, and eight claims.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

constexpr Index size = 6, rows = 60;

/// Joseph's update in Quad on a P stored in double, with one step more in double.
enum class InDouble { storage, A, AP, first_product, second_product };

/// A B, every product and every sum in double, in order.
Matrix<Quad> multiplied_in_double(Matrix<Quad> const& A, Matrix<Quad> const& B) {
    Matrix<Quad> out(size, size);
    for (Index j = 0; j < size; ++j)
        for (Index i = 0; i < size; ++i) {
            double sum = 0;
            for (Index l = 0; l < size; ++l) sum += static_cast<double>(A(i, l)) * static_cast<double>(B(l, j));
            out(i, j) = sum;
        }
    return out;
}

Stored<Reference> joseph_with(InDouble step, Problem<double> const& problem, Records const& data) {
    auto const in_double = [](Quad const& x) { return Quad(static_cast<double>(x)); };
    Matrix<Quad> P = Matrix<Quad>::Identity(size, size) * Quad(problem.prior->variance);
    for (Index k = 0; k < rows; ++k) {
        Vector<Quad> const psi = data.psi.col(k).cast<Quad>(), f = P.lazyProduct(psi);
        Quad s = 1;
        for (Index i = 0; i < size; ++i) s += psi[i] * f[i];
        Vector<Quad> const K = f / s;
        Matrix<Quad> A = Matrix<Quad>::Identity(size, size) - K.lazyProduct(psi.transpose());
        if (step == InDouble::A) A = A.unaryExpr(in_double).eval();
        Matrix<Quad> AP = step == InDouble::first_product ? multiplied_in_double(A, P) : Matrix<Quad>(A.lazyProduct(P));
        if (step == InDouble::AP) AP = AP.unaryExpr(in_double).eval();
        Matrix<Quad> const APA = step == InDouble::second_product ? multiplied_in_double(AP, A.transpose())
                                                                  : Matrix<Quad>(AP.lazyProduct(A.transpose()));
        Matrix<Quad> const sum = APA + K.lazyProduct(K.transpose());
        P = sum.unaryExpr(in_double);
    }
    return {Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain,
            P.unaryExpr([](Quad const& x) { return widen(x); })};
}

double length(Vector<Reference> const& x) {
    Reference sum = 0;
    for (Reference const& xi : x) sum += xi * xi;
    return static_cast<double>(sqrt(sum));
}

/// What the exact recursion says of rounding: the greatest |A|_2 and two estimates of the error of P relative to |P_N|.
struct Amplification {
    double norm = 0, local = 0, products = 0, plain = 0;
};
Amplification amplification(CatalogueEntry const& exact, Problem<double> const& problem, Records const& data) {
    auto const filter = exact.make(problem, Seed{1});
    std::vector<Matrix<Reference>> P{covariance_of(filter->stored())};
    std::vector<double> norm{0}, subtracted{0};
    for (Index k = 0; k < rows; ++k) {
        double const gamma = filter->update(data.sample(k), data.y[k]).gamma;
        P.push_back(covariance_of(filter->stored()));
        double const tau = length(filter->gain()) * length(data.psi.col(k).cast<Reference>());
        subtracted.push_back(length(filter->gain()) * length(filter->gain()) / gamma);  // |K||f|, f = s K
        norm.push_back((tau + std::sqrt(tau * tau + 4 * gamma)) / 2);
    }
    double const last = frobenius(P.back()), u = 0x1p-53;
    auto const transport = [&](Index k) -> double {
        Matrix<Reference> const backwards = P[size_t(k)].householderQr().solve(P.back());  // (P_N P_k^-1)'
        return frobenius(backwards);
    };
    Amplification out;
    double before = transport(0);
    for (Index k = 1; k <= rows; ++k) {
        double const A = norm[size_t(k)], size_of_P = frobenius(P[size_t(k - 1)]) / last, now = transport(k);
        out.norm = std::max(out.norm, A);
        out.local = std::max(out.local, u * A * A * size_of_P);
        out.products = std::max(out.products, u * now * before * A * size_of_P);
        out.plain = std::max(out.plain, u * now * now * (size_of_P + subtracted[size_t(k)] / last));
        before = now;
    }
    return out;
}

void measure(Trial const& trial, TrialOutput& out) {
    double const kappa = trial.number("kappa");
    Problem<double> const problem{.size = size, .prior = Prior<double>{.variance = kappa * kappa}};
    Records const records = graded(size, rows, kappa, trial.seed({"kappa", "replicate"}));
    CertifiedSolution const exact = certified(problem, records, {rows}, 60).front();
    Amplification const bound = amplification(trial.entry("symmetric", "reference"), problem, records);
    auto const row = [&](std::string const& form, Stored<Reference> const& stored) {
        out({form, correctly::pow(10, -exact.covariance_digits(stored)), bound.norm, bound.local, bound.products,
             bound.plain});
    };
    for (std::string const form : {"joseph", "joseph_rank_two", "symmetric", "conventional_two_sided"}) {
        auto const filter = trial.entry(form).make(problem, Seed{1});
        process_rows(*filter, records, 0, rows);
        row(form, filter->stored());
    }
    row("P_stored", joseph_with(InDouble::storage, problem, records));
    row("A_rounded", joseph_with(InDouble::A, problem, records));
    row("AP_rounded", joseph_with(InDouble::AP, problem, records));
    row("first_product", joseph_with(InDouble::first_product, problem, records));
    row("second_product", joseph_with(InDouble::second_product, problem, records));
}

/// From where the floor is left to where half the digits of the worst form are gone.
Table in_range(Table const& t) {
    return t.where("kappa", [](double kappa) { return kappa > 999 && kappa < 1.01e6; });
}
Statistic share_of(std::string bound) {
    auto const share = [bound](Table const& t) {
        std::vector<double> ratios;
        std::vector<double> const error = t.numbers("error"), by = t.numbers(bound);
        for (size_t i = 0; i < error.size(); ++i) ratios.push_back(error[i] / by[i]);
        return median(ratios);
    };
    return {share, Estimate::middle};
}

}  // namespace

extern Study const joseph_condition;
Study const joseph_condition{
    .name = "joseph_condition",
    .question = "Which rounding costs Joseph's products one more power of the condition number?",
    .source =
        "an earlier experiment (docs/literature.md 3.6, Joseph in detail; docs/literature.md 5, question 1); the "
        "explanation is derived (docs/theory.md 43) and measured here, and was not found in any published text",
    .formula =
        R"tex(\begin{aligned} \mathrm{fl}(A P)_{ij} &= P_{ij} - K_i f_j + \epsilon, \quad
              |\epsilon| \lesssim u\,(|A||P|)_{ij}, \quad A = I - K\psi^\top, \; f = P\psi \\
\|A\|_2 &= \tfrac12\left(\tau + \sqrt{\tau^2 + 4\gamma}\right), \quad \tau = \|K\|\|\psi\| \\
\|\delta P_N\| &\lesssim u\,\max_k \|\Phi_k\|\,\|\Phi_{k-1}\|\,\|A_k\|\,\|P_{k-1}\|, \quad
\Phi_k = P_N P_k^{-1} \end{aligned})tex",
    .interpretation =
        "When one direction is still unknown, P is kappa^2 large there, K is kappa large, and P psi is small all the "
        "same: the product A P adds terms of size |K||psi||P| that cancel to P - K f'. Their roundings do not cancel. "
        "The experiment does Joseph's update in quad on a P stored in double and puts one step back into double: "
        "storing P, rounding A, rounding A P as a whole leave the slope at 2, as for every form that stores P; adding "
        "up either of the two products in double brings the whole loss back. The expansion to a rank-two update never "
        "forms these terms and has slope 2. The local guide u |A|^2 |P|, the first explanation (docs/literature.md "
        "3.6), has itself slope 2 only: it is the transport to the end of the run by P_N P_k^-1, of norm up to kappa, "
        "that makes nearly 3 of it. The slope fitted in double is 2.8, at the lower end of the 2.8 to 3.5 of "
        "docs/literature.md 3.6. P0 is kappa^2 here: crossed with kappa (study backward_error), the slope 2 is that of "
        "P0 alone, and what Joseph's products add is a slope of 0.6 to 0.9 in kappa.",
    .data = "graded rows (geometric singular values), d = 6, P0 = kappa^2",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{{"kappa", powers(10, 1, 7, 0.25)}, {"replicate", counted(full ? 100 : 11)}};
        },
    .measures = {"form", "error", "norm", "local", "products", "plain"},
    .measure = measure,
    .plots = {{.title = "Error of P: the variants",
               .x = "kappa",
               .y = "error",
               .series = "form",
               .x_label = "condition number of the regressors",
               .y_label = "relative error of P",
               .where = {{"form", {"joseph", "joseph_rank_two", "symmetric", "conventional_two_sided"}}}},
              {.title = "Joseph's update in quad but for one step",
               .x = "kappa",
               .y = "error",
               .series = "form",
               .x_label = "condition number of the regressors",
               .y_label = "relative error of P",
               .where = {{"form",
                          {"joseph", "P_stored", "A_rounded", "AP_rounded", "first_product", "second_product"}}}},
              {.title = "The greatest |I - K psi'| of the run",
               .x = "kappa",
               .y = "norm",
               .series = "form",
               .x_label = "condition number of the regressors",
               .y_label = "max |I - K psi'|_2",
               .where = {{"form", {"joseph"}}},
               .guides = {{"kappa / 25", [](double kappa) { return kappa / 25; }}}}},
    .claims =
        {
            {"joseph: slope 2.7 ... 3.1 over 1e3 <= kappa <= 1e6",
             [](Table const& t) {
                 return within(in_range(t).where("form", "joseph"), {}, slope("kappa", "error"), 2.7, 3.1);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.6")},
            {"symmetric, conventional_two_sided, joseph_rank_two: slope 2 +- 0.2 over the same range",
             [](Table const& t) {
                 return within(in_range(t).where("form", {"symmetric", "conventional_two_sided", "joseph_rank_two"}),
                               {"form"}, slope("kappa", "error"), 1.8, 2.2);
             },
             reproduction("set with the earlier experiment, docs/literature.md 3.6")},
            {"in quad on a stored P, A or A P rounded as a whole: slope 2 +- 0.2 all the same",
             [](Table const& t) {
                 return within(in_range(t).where("form", {"P_stored", "A_rounded", "AP_rounded"}), {"form"},
                               slope("kappa", "error"), 1.8, 2.2);
             },
             own_result("as that of the variants, docs/literature.md 3.6")},
            {"either product added up in double: slope 2.7 ... 3.1, with nothing else of Joseph's form in double",
             [](Table const& t) {
                 return within(in_range(t).where("form", {"first_product", "second_product"}), {"form"},
                               slope("kappa", "error"), 2.7, 3.1);
             },
             own_result("as that of the variants, docs/literature.md 3.6")},
            {"max |I - K psi'|_2 grows like kappa: slope 1 +- 0.1 over 1e2 <= kappa <= 1e7",
             [](Table const& t) {
                 Table const rows = t.where("form", "joseph").where("kappa", [](double kappa) { return kappa > 99; });
                 return within(rows, {}, slope("kappa", "norm"), 0.9, 1.1);
             },
             own_result("docs/theory.md 24, 27")},
            {"the transported guide: slope 2.6 ... 3.1, and joseph's median error is 1/300 ... 1/3 of it at every "
             "kappa of the range",
             [](Table const& t) {
                 Table const rows = in_range(t).where("form", "joseph");
                 Judgement const a = within(rows, {}, slope("kappa", "products"), 2.6, 3.1),
                                 b = within(rows, {"kappa"}, share_of("products"), 1.0 / 300, 1.0 / 3);
                 return a && b;
             },
             own_result("first edition, set after its run")},
            {"the local guide u |A|^2 |P| has slope 2.0 +- 0.1",
             [](Table const& t) {
                 return within(in_range(t).where("form", "joseph"), {}, slope("kappa", "local"), 1.9, 2.1);
             },
             own_result("docs/theory.md 43, in place of a band set after its run")},
            {"and is too small: at kappa = 1e6 joseph's median error is 100 times as large and more",
             [](Table const& t) {
                 Table const rows =
                     in_range(t).where("form", "joseph").where("kappa", [](double kappa) { return kappa > 9e5; });
                 return within(rows, {}, share_of("local"), 100, 1e5);
             },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
