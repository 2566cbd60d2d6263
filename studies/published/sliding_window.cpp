// A window that slides over an outlier: what downdating keeps of a row long after it has left.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

/// P or P^-1 or R as it slides: double, sums in order, small on purpose. `weight` is lambda^window, that of the row
/// that leaves.
struct WindowFilter {
    static constexpr Index n = 4;
    std::string method;
    double lambda, weight;
    double A[n][n] = {};
    bool broken = false;

    void symmetric_rank_one(double scale, double const* f) {
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i <= j; ++i) A[i][j] = A[j][i] = A[i][j] + scale * f[i] * f[j];
    }
    /// P -/+ f f' / s, f = P x, s = weight +/- x'f: the conventional formula for a row of this weight, with either
    /// sign.
    void covariance(double const* x, double sign) {
        double f[n], s = 1;
        for (Index i = 0; i < n; ++i) {
            f[i] = 0;
            for (Index j = 0; j < n; ++j) f[i] += A[i][j] * x[j];
        }
        for (Index i = 0; i < n; ++i) s += sign * x[i] * f[i];
        symmetric_rank_one(-sign / s, f);
    }
    void scale(double factor) {
        for (auto& row : A)
            for (double& a : row) a *= factor;
    }
    void rotate_in(double const* row) {  // Givens
        double x[n];
        std::copy(row, row + n, x);
        for (Index k = 0; k < n; ++k) {
            double const r = std::sqrt(A[k][k] * A[k][k] + x[k] * x[k]);
            if (r == 0) continue;
            double const c = A[k][k] / r, s = x[k] / r;
            for (Index j = k; j < n; ++j) {
                double const a = A[k][j];
                A[k][j] = c * a + s * x[j];
                x[j] = c * x[j] - s * a;
            }
        }
    }
    /// LINPACK's dchdd: R'a = x, then rotations that take (a, alpha) to (0, 1), applied to R from below.
    void rotate_out(double const* x) {
        double a[n], c[n], s[n], alpha = 1;
        for (Index i = 0; i < n; ++i) {
            a[i] = x[i];
            for (Index k = 0; k < i; ++k) a[i] -= A[k][i] * a[k];
            a[i] /= A[i][i];
            alpha -= a[i] * a[i];
        }
        if (!(alpha > 0)) return void(broken = true);
        alpha = std::sqrt(alpha);
        for (Index i = n; i-- > 0;) {
            double const r = std::sqrt(alpha * alpha + a[i] * a[i]);
            c[i] = alpha / r, s[i] = a[i] / r, alpha = r;
        }
        for (Index j = 0; j < n; ++j) {
            double carried = 0;
            for (Index i = j + 1; i-- > 0;) {
                double const t = c[i] * carried + s[i] * A[i][j];
                A[i][j] = c[i] * A[i][j] - s[i] * carried;
                carried = t;
            }
        }
    }
    /// Hyperbolic rotations in mixed form: the row of x with the new row of R.
    void mixed_out(double const* row) {
        double x[n];
        std::copy(row, row + n, x);
        for (Index k = 0; k < n; ++k) {
            double const s = x[k] / A[k][k];
            if (!(std::abs(s) < 1)) return void(broken = true);
            double const c = std::sqrt((1 - s) * (1 + s));
            for (Index j = k; j < n; ++j) {
                A[k][j] = (A[k][j] - s * x[j]) / c;
                x[j] = c * x[j] - s * A[k][j];
            }
        }
    }
    void step(double const* in, double const* out) {
        if (broken) return;
        double leaving[n];
        for (Index i = 0; i < n; ++i) leaving[i] = out ? std::sqrt(weight) * out[i] : 0;
        if (method == "covariance") {
            scale(1 / lambda);
            covariance(in, 1);
            if (out) covariance(leaving, -1);
        } else if (method == "information") {
            scale(lambda);
            symmetric_rank_one(1, in);
            if (out) symmetric_rank_one(-1, leaving);
        } else {
            scale(std::sqrt(lambda));
            rotate_in(in);
            if (out) method == "linpack" ? rotate_out(leaving) : mixed_out(leaving);
        }
    }
    Stored<Reference> stored() const {
        using S = Stored<Reference>;
        bool const plain = method == "covariance" || method == "information";
        Matrix<Reference> F(n, n);
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) F(i, j) = plain ? A[i][j] : A[j][i];  // R'
        return {method == "covariance" ? S::Quantity::covariance : S::Quantity::information,
                plain ? S::Form::plain : S::Form::factor, F};
    }
};

constexpr Index n = WindowFilter::n, window = 20, outlier = 40;
constexpr Index times[] = {65, 90, 115, 165, 250, 500, 1000, 2000};  // rows seen; the outlier leaves with row 60

Records in_window(Records const& all, Index end) {
    return {.psi = all.psi.middleCols(end - window, window), .y = all.y.segment(end - window, window), .names = {}};
}

void measure(Trial const& trial, TrialOutput& out) {
    Records records = white(n, times[std::size(times) - 1], trial.seed({"replicate"}));
    double const size = correctly::pow(10, trial.number("q")), lambda = trial.number("lambda");
    for (double& x : records.psi.col(outlier - 1)) x *= size;
    Problem<double> const problem{.size = n, .forgetting = lambda, .prior = std::nullopt};
    std::vector<CertifiedSolution> exact;
    for (Index t : times) exact.push_back(certified(problem, in_window(records, t), {window}).front());
    for (auto method : {"covariance", "information", "linpack", "mixed_hyperbolic", "refactor"}) {
        WindowFilter state{.method = method, .lambda = lambda, .weight = correctly::pow(lambda, double(window))};
        auto const row = [&](Index k) { return records.psi.col(k).data(); };
        bool const refactor = state.method == "refactor";
        Index first = 0;
        if (state.method == "covariance") {  // starts from the first window's, rounded once
            Matrix<Reference> const P = certified(problem, in_window(records, window), {window}).front().covariance();
            for (Index i = 0; i < n; ++i)
                for (Index j = 0; j < n; ++j) state.A[i][j] = static_cast<double>(P(std::min(i, j), std::max(i, j)));
            first = window;
        }
        for (size_t i = 0, k = size_t(first); i < std::size(times); ++i) {
            if (refactor) state.scale(0), k = size_t(times[i] - window);
            for (; Index(k) < times[i]; ++k)
                state.step(row(Index(k)), refactor || Index(k) < window ? nullptr : row(Index(k) - window));
            double digits = state.broken ? -INFINITY : exact[i].covariance_digits(state.stored());
            if (std::isnan(digits)) digits = -INFINITY;
            out({method, double(times[i]), std::isinf(digits) ? "breakdown" : "sound", correctly::pow(10, -digits),
                 digits});
        }
    }
}

std::vector<std::string> const squared{"information", "linpack", "mixed_hyperbolic"};
Selection at(double time, double from, double to) { return where("t", time).where("q", between(from, to)); }
/// The power of the outlier's size that the error goes with.
Statistic power = [](Table const& t) { return -linear_slope("q", "digits")(t); };
/// error(2000) / error(65), draw by draw, the median.
Statistic persistence(double from, double to) {
    auto const ratio = [=](Table const& t) {
        auto const late = at(2000, from, to)(t).numbers("digits"), early = at(65, from, to)(t).numbers("digits");
        std::vector<double> ratios;
        for (size_t i = 0; i < late.size(); ++i)
            if (std::isfinite(early[i])) ratios.push_back(correctly::pow(10, early[i] - late[i]));
        return median(ratios);
    };
    return {ratio, Estimate::middle};
}
Basis const set_with_it = reproduction("set with the earlier experiment, docs/literature.md 3.11");

}  // namespace

extern Study const sliding_window{
    .name = "sliding_window",
    .question = "What does an outlier that has left the window leave behind?",
    .source =
        "Stewart 1979; Alexander, Pan & Plemmons 1988; Björck, Park & Eldén 1994 (cited, not read); the slopes are "
        "derived (docs/theory.md 47); the table: an earlier experiment (docs/literature.md 3.11)",
    .formula = R"tex(\text{covariance: } \frac{\|\delta P\|}{\|P\|} \sim u\,10^{4q} \qquad
                \text{information, } R: \ \frac{\|\delta P\|}{\|P\|} \sim u\,10^{2q} \qquad
                     \text{refactored: } \sim u)tex",
    .interpretation =
        "The row at t = 40 is 10^q times too large and leaves the window of 20 rows with row 60. P^-1 holds 10^2q "
        "while it is inside, and the rounding of that, u 10^2q, stays when it is subtracted; R and its downdates do no "
        "better. In P the downdate divides by 1 - psi'P psi = O(10^-2q), which is computed with an error u 10^2q: a "
        "relative error u 10^4q. Only a factor of the rows in the window forgets. With lambda = 1 the damage stays: "
        "over many draws the ratio of late to early error has a median near 1, where the single draws of "
        "docs/literature.md 3.11 had 0.1 to 1. With lambda below 1 it decays as lambda^k.",
    .data = "white rows, d = 4, one outlier",
    .factors = {{"lambda", {1.0, 0.95}},
                {"q", {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0}},
                {"replicate", counted(100), counted(25)}},
    .measures = {"method", "t", "outcome", "error", "digits"},
    .measure = measure,
    .plots = {{.title = "Error of P five steps after the outlier has left",
               .x = "q",
               .y = "error",
               .series = "method",
               .panel = "lambda",
               .log = "y",
               .x_label = "outlier of size 10^q: q",
               .y_label = "relative error of P",
               .where = {{"t", {"65"}}},
               .guides = {{"u 10^{4q}", [](double q) { return 0x1p-53 * correctly::pow(10, 4 * q); }},
                          {"u 10^{2q}", [](double q) { return 0x1p-53 * correctly::pow(10, 2 * q); }}}},
              {.title = "Error of P long after the outlier has left, 10^4",
               .x = "t",
               .y = "error",
               .series = "method",
               .panel = "lambda",
               .x_label = "rows seen",
               .y_label = "relative error of P",
               .where = {{"q", {"4"}}}}},
    .claims = {
        {"covariance form: error ~ size^4, slope 4.0 +- 0.6 over q = 2 ... 4",
         within(at(65, 2, 4).where("method", "covariance"), {"lambda"}, power, 3.4, 4.6), set_with_it},
        {"information form and both downdates of R: error ~ size^2, slope 2.0 +- 0.3 over q = 2 ... 6",
         within(at(65, 2, 6).where("method", squared), {"method", "lambda"}, power, 1.7, 2.3), set_with_it},
        {"a factor from the window's own rows: slope 0.00 +- 0.01",
         within(at(65, 0, 8).where("method", "refactor"), {"lambda"}, power, -0.01, 0.01),
         reproduction("earlier experiment, docs/literature.md 3.11")},
        {"the covariance form has no digit left from q = 4.5 on, where u 10^(4q) = 100: median error at least 0.1",
         within(at(65, 4.5, 8).where("method", "covariance"), {"q", "lambda"}, median("error"), 0.1, 1e3),
         own_result("docs/theory.md 47, in place of a band set after its run")},
        {"lambda = 1: the damage stays: the ratio of the errors at t = 2000 and 65 has a median of 0.1 to 1 over q "
         "= 2 ... 6",
         within(where("lambda", 1.0).where("method", squared), {"method"}, persistence(2, 6), 0.1, 1), set_with_it},
        {"and for the covariance form over q = 2 ... 4",
         within(where("lambda", 1.0).where("method", "covariance"), {"method"}, persistence(2, 4), 0.1, 1),
         set_with_it},
        {"lambda = 0.95: the damage decays as lambda^k: decades per step -log10 lambda = 0.0223 +- 20 % over t = "
         "65 ... 165 at q = 4",
         within(where("lambda", 0.95).where("q", 4.0).where("t", at_most(165)).where("method", squared), {"method"},
                linear_slope("t", "digits"), 0.8 * 0.0223, 1.2 * 0.0223),
         own_result("docs/theory.md 47")},
        {"so that at t = 1000 whatever did not break down stands below 1e-13 again, from q = 0 to 6",
         within(at(1000, 0, 6).where("lambda", 0.95).where("outcome", "sound"), {"method"}, median("error"), 0, 1e-13),
         own_result("first edition, set after its run")}}};

}  // namespace rlslab::studies
