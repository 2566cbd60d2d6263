// Recursion in model order: bordering against appending columns to a QR factorisation, in digits and in operations.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/model/fit.hpp>
#include <rlslab/model/order_recursive.hpp>
#include <rlslab/model/order_recursive_qr.hpp>

#include <fmt/format.h>

namespace rlslab::studies {
namespace {

constexpr Index size = 6, rows = 80;

void measure(Trial const& trial, TrialOutput& out) {
    Records const records = graded(size, rows, trial.number("kappa"), trial.seed({"kappa", "replicate"}));
    CertifiedSolution const exact = certified({.size = size, .prior = std::nullopt}, records, {rows}).front();
    auto const error = [&](Vector<double> const& theta) {
        double const digits = exact.theta_digits(theta.cast<Reference>());
        return digits == digits ? correctly::pow(10, -digits) : INFINITY;  // a pivot was not positive: theta is NaN
    };
    OrderRecursive<double> bordered(records.y, size);
    OrderRecursiveQr<double> qr(records.y, size);
    for (Index j = 0; j < size; ++j) {
        bordered.append(records.psi.row(j).transpose());
        qr.append(records.psi.row(j).transpose());
    }
    out({"order_recursive", error(bordered.theta())});
    out({"order_recursive_qr", error(qr.theta())});
    out({"information", error(fit(records, FitBy::normal_equations).theta)});  // the normal equations, factored afresh
}

/// Multiplications of all orders up to n by bordering, by appended columns of one QR factorisation, and by a new QR for
/// each order.
Judgement cheaper() {
    using C = Counted<double>;
    Seed seed{1};
    Index const n = 20, N = 200;
    auto const column = [&] { return Vector<C>(Vector<C>::NullaryExpr(N, [&] { return C(seed.bell()); })); };
    std::vector<Vector<C>> columns;
    for (Index j = 0; j < n; ++j) columns.push_back(column());
    Vector<C> const y = column();
    auto const all_at_once = [&]<class Recursion>(Recursion recursion) {
        return rlslab::counted([&] {
                   for (auto const& x : columns) recursion.append(x);
               })
            .multiplications;
    };
    long const bordering = all_at_once(OrderRecursive<C>(y, n)), twin = all_at_once(OrderRecursiveQr<C>(y, n));
    long anew = 0;
    for (Index d = 1; d <= n; ++d)
        anew += rlslab::counted([&] {
                    OrderRecursiveQr<C> fresh(y, d);
                    for (Index j = 0; j < d; ++j) fresh.append(columns[size_t(j)]);
                }).multiplications;
    return {3 * twin < anew && 3 * bordering < anew,
            fmt::format("{} columns, {} rows: bordering {}, appended QR {}, anew at each order {}", n, N, bordering,
                        twin, anew)};
}

}  // namespace

extern Study const order_recursion;
Study const order_recursion{
    .name = "order_recursion",
    .question = "What does recursion in model order cost, in digits and in operations?",
    .source =
        "derived (docs/theory.md 9 to 11, 46); equality with batch at every order is exact in rationals (test "
        "OrderRecursive.EqualsBatchAtEveryOrderInRationals)",
    .formula =
        R"tex(P_{d+1} = \begin{bmatrix} P + \beta g g^\top & -\beta g \\ -\beta g^\top & \beta \end{bmatrix}, \quad
              g = P\,\Phi^\top x, \quad \frac1\beta = x^\top x - x^\top\Phi\,g)tex",
    .interpretation =
        "Bordering the inverse of the Gram matrix gives every order's estimate in one pass and is exact in exact "
        "arithmetic. In double it does not lose digits as the square of the condition number, as is usually said of it "
        "and as the normal equations factored afresh (information) do, but up to the fourth power, by the spectrum: P "
        "itself carries a relative error u kappa^2, and the pivot x'x - c'P c, kappa^2 times smaller than its terms, "
        "takes that error in. No digit is left at kappa = 1e5. Appending columns to a QR factorisation loses them as "
        "the condition number. Both are far cheaper than fitting each order anew.",
    .data = "graded columns (geometric singular values), d = 6",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"kappa", powers(10, 1, 12, budget == Budget::full ? 0.25 : 0.5)},
                                       {"replicate", counted(budget == Budget::full ? 100 : 20)}};
        },
    .measures = {"variant", "error"},
    .measure = measure,
    .plots = {{.title = "Error of theta at the full order",
               .x = "kappa",
               .y = "error",
               .x_label = "condition number of the columns",
               .y_label = "relative error of theta",
               .guides = {{"u κ", [](double k) { return 0x1p-53 * k; }},
                          {"u κ²", [](double k) { return 0x1p-53 * k * k; }},
                          {"u κ⁴", [](double k) { return k < 1e5 ? 0x1p-53 * k * k * k * k : NAN; }}}}},
    .claims =
        {
            {"bordering: slope 4.0 +- 0.4 from kappa = 1e2 to 1e4.5: not 2",
             [](Table const& t) {
                 return within(
                     t.where("variant", "order_recursive").where("kappa", [](double k) { return 90 < k && k < 3.2e4; }),
                     {}, slope("kappa", "error"), 3.6, 4.4);
             },
             own_result("docs/theory.md 46")},
            {"normal equations, factored: slope 2.0 +- 0.2 between kappa = 1e2 and 1e7",
             [](Table const& t) {
                 return within(
                     t.where("variant", "information").where("kappa", [](double k) { return 90 < k && k < 1.1e7; }), {},
                     slope("kappa", "error"), 1.8, 2.2);
             },
             own_result("set before the run: as of docs/literature.md 3.6")},
            {"appended QR: slope 1.0 +- 0.15 between kappa = 1e2 and 1e11",
             [](Table const& t) {
                 return within(t.where("variant", "order_recursive_qr")
                                   .where("kappa", [](double k) { return 90 < k && k < 1.1e11; }),
                               {}, slope("kappa", "error"), 0.85, 1.15);
             },
             own_result("set before the run: as of docs/literature.md 3.6")},
            {"both cost less than a third of fitting every order anew", [](Table const&) { return cheaper(); },
             own_result("first edition, set after its run")},
        },
};

}  // namespace rlslab::studies
