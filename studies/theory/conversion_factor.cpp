// The numbers of a step: the conversion factor and its parts, the gain, and the information factor; their means, their
// bounds, and what a computed conversion factor proves. Longer than 150 lines: two experiments and 17 claims.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/spectra.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <cmath>

namespace rlslab::studies {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN(), kappa = 1e3, u = 0x1p-53;
std::vector<std::string> const independent{"white", "units", "geometric", "one small", "one large"};

/// Rows of each kind. Outputs play no part: gamma, K and R do not depend on them.
Matrix<double> regressors(std::string const& kind, Index d, Index rows, Seed seed) {
    if (kind == "line") return delay_line(d, rows, 0.9, seed).psi;
    if (kind == "constant") return Matrix<double>::Constant(d, rows, 0.7);
    if (kind == "geometric" || kind == "one small" || kind == "one large")
        return with_singular_values(singular_values(kind, d, kappa), rows, seed, 0).psi;
    Matrix<double> psi = white(d, rows, seed).psi;
    if (kind == "units")
        for (Index j = 0; j < d; ++j) psi.row(j) *= correctly::pow(10, double(j));
    if (kind == "binary") psi = psi.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; }).eval();
    return psi;
}

/// |K_i| over half the root of P_ii / lambda, P that of before the row (docs/theory.md 27).
double share_of_bound(double K, double P, double lambda) { return std::abs(K) / (0.5 * std::sqrt(P / lambda)); }

/// Twenty memories to forget the start, then 400 or 100 for the means. Everything from `symmetric` and `qr`.
void run(Trial const& trial, TrialOutput& out) {
    std::string const& kind = trial.text("rows");
    double const lambda = trial.number("lambda");
    Index const d = Index(trial.number("d")), start = Index(std::lround(20 / (1 - lambda))),
                rows = start + Index(std::lround((lambda < 0.98 ? 400 : 100) / (1 - lambda)));
    Matrix<double> const psi = regressors(kind, d, rows, trial.seed({"rows", "d", "lambda", "replicate"}));
    Problem<double> const problem{.size = d, .forgetting = lambda};
    Symmetric<double> filter(problem);
    Qr<double> factor(problem);
    Matrix<Reference> energy = Matrix<Reference>::Zero(d, 1);  // of the rows; e^-50 of it is left out
    Index const kept = Index(std::lround(50 / (1 - lambda)));
    double ln_gamma = 0, drop = 0, ln_first = 0, ln_last = 0, greatest_gain = 0, squares = 0, outside = 0, apart = 0;
    Vector<double> largest = Vector<double>::Zero(d);
    Matrix<double> L = factor.stored().F;  // R'
    for (Index k = 0; k < rows; ++k) {
        Vector<double> const row = psi.col(k);
        Matrix<double> const P = filter.covariance();
        double const gamma = filter.update(row, 0).gamma;
        factor.update(row, 0);
        Matrix<double> const next = factor.stored().F;
        Vector<double> solved(d);  // R'u = psi, and s_i = lambda + u_1^2 + ... + u_i^2 (docs/theory.md 22)
        double s = lambda, first = 0, last = 0;
        for (Index i = 0; i < d; ++i) {
            double sum = row[i];
            for (Index j = 0; j < i; ++j) sum -= L(i, j) * solved[j];
            solved[i] = sum / L(i, i);
            double const before = s;
            s += solved[i] * solved[i];
            last = before / s;
            if (i == 0) first = last;
            if (k >= start)
                apart = std::max(apart, std::abs(last - lambda * L(i, i) * L(i, i) / (next(i, i) * next(i, i))));
        }
        L = next;
        outside += !(gamma > 0 && gamma <= 1);
        for (Index i = 0; i < d; ++i) {
            double const share = share_of_bound(filter.gain()[i], P(i, i), lambda);
            greatest_gain = std::max(greatest_gain, share);
            if (k >= start) squares += share * share;
            largest[i] = std::max(largest[i], std::abs(row[i]));
            if (k >= rows - kept)
                energy(i, 0) = Reference(lambda) * energy(i, 0) + Reference(row[i]) * Reference(row[i]);
        }
        if (k < start) continue;
        ln_gamma += correctly::log(gamma), drop += 1 - gamma;
        ln_first += correctly::log(first), ln_last += correctly::log(last);
    }
    double const n = double(rows - start), size = double(d), ln = correctly::log(lambda), forgets = 1 - lambda;
    double entry = 0, column = 0;
    for (Index j = 0; j < d; ++j) {
        Reference sum = 0;
        for (Index i = 0; i <= j; ++i) {
            sum += Reference(L(j, i)) * Reference(L(j, i));
            entry = std::max(entry, std::abs(L(j, i)) * std::sqrt(forgets) / largest[j]);
        }
        column = std::max(column, std::abs(static_cast<double>((sum - energy(j, 0)) / energy(j, 0))));
    }
    double const c2 = problem.prior->variance;
    Symmetric<double> once(problem);
    Vector<double> along = Vector<double>::Zero(d);
    along[0] = std::sqrt(lambda / c2);
    once.update(along, 0);
    out({"all", kind == "units" ? correctly::pow(10, size - 1) : 1, size * forgets, none, outside / double(rows),
         ln_gamma / (n * size * ln), ln_first / (n * ln), ln_last / (n * ln), apart,
         drop / (n * size * -ln) - (1 - forgets * (size + 2) / 2), greatest_gain,
         share_of_bound(once.gain()[0], c2, lambda),
         std::sqrt(squares / (n * size)) / (2 * std::sqrt(lambda * forgets)) - (1 - (size + 1) * forgets / 2), entry,
         column * forgets / u, std::abs(filter.gain()[0] * 0.7 / forgets - 1) * forgets / u});
}

/// P of Fibonacci numbers, with the determinant 1: definite, in whole numbers, of any condition; and rows along its
/// least direction, of random length. How often gamma leaves (0, 1]: from f = P psi, and from a root of P.
template <class T>
void fibonacci(Trial const& trial, TrialOutput& out, std::string const& word) {
    Seed seed = trial.seed({"rows", "replicate"});
    int const p = std::numeric_limits<T>::digits, cases = 64;
    double before = 2, now = 3, after = 5;  // F_3, F_4, F_5; n even, so that F_(n-1) F_(n+1) = F_n^2 + 1
    while (after < std::ldexp(1.0, p)) {
        int plain = 0, rooted = 0;
        for (int i = 0; i < cases; ++i) {
            double const length = 1 + seed.uniform();
            T const psi[] = {T(before * length), T(-now * length)}, lambda = T(trial.number("lambda"));
            T const P[] = {T(after), T(now), T(before)},
                    f[] = {P[0] * psi[0] + P[1] * psi[1], P[1] * psi[0] + P[2] * psi[1]};
            T const s = lambda + (psi[0] * f[0] + psi[1] * f[1]), gamma = lambda / s;
            T const root = std::sqrt(P[2]), a = psi[0] / root, b = P[1] / root * psi[0] + root * psi[1];
            T const gamma_rooted = lambda / (lambda + (a * a + b * b));
            plain += !(gamma > 0 && gamma <= 1), rooted += !(gamma_rooted > 0 && gamma_rooted <= 1);
        }
        double const condition = (after + before) * (after + before) * std::ldexp(1.0, -p);
        auto const note = [&](std::string const& how, int count) {
            out({how + " " + word, none, none, condition, double(count) / cases, none, none, none, none, none, none,
                 none, none, none, none, none});
        };
        note("P psi", plain), note("root", rooted);
        double const next = after + now, beyond = next + after;  // the next even index
        before = after, now = next, after = beyond;
    }
}

void measure(Trial const& trial, TrialOutput& out) {
    if (trial.text("rows") != "Fibonacci") return run(trial, out);
    fibonacci<double>(trial, out, "double");
    fibonacci<float>(trial, out, "float");
}

// --- claims ----------------------------------------------------------------------------------------------------------

Table runs(Table const& t) { return t.where("of", "all"); }
/// Independent rows, and a memory of at least 10 d.
Table first_order(Table const& t) {
    return runs(t).where("rows", independent).where("d_over_memory", [](double x) { return x <= 0.1 + 1e-9; });
}
Table well_scaled(Table const& t) {
    return runs(t).where("units_to", [](double x) { return x < 1e7; });
}
Statistic const outside = Statistic(greatest("outside")).as(Estimate::most);
Table of_fibonacci(Table const& t, std::string const& how, std::function<bool(double)> const& condition) {
    return t.where("of", {how + " double", how + " float"}).where("condition_u", condition);
}
std::vector<std::string> const by{"rows", "d", "lambda"};

}  // namespace

extern Study const conversion_factor;
Study const conversion_factor{
    .name = "conversion_factor",
    .question = "How large are the conversion factor, the gain and the information factor, and what bounds them?",
    .source = "derived (docs/theory.md 14, 22, 26, 27, 120, 121)",
    .formula = R"tex(\begin{aligned} &E \ln\gamma = d \ln\lambda, \quad E \ln\cos^2_i = \ln\lambda, \quad
\frac{E(1 - \gamma)}{d\,|\ln\lambda|} \approx 1 - \frac{(1-\lambda)(d+2)}{2} \\
&|K_i| \le \tfrac12\sqrt{P_{ii}/\lambda}, \quad
\text{rms} \approx 2\sqrt{\lambda(1-\lambda)}\,\bigl(1 - \tfrac{(d+1)(1-\lambda)}{2}\bigr) \text{ of it} \\
&|R_{ij}| \le \max|\psi_{kj}| / \sqrt{1-\lambda} \end{aligned})tex",
    .interpretation =
        "Means are over 100 or 400 memories after 20 that forget the start. theta and y play no part. The mean "
        "logarithm of the conversion factor follows from stationarity alone, whatever the rows; its mean and the "
        "gain's size are first-order laws of independent rows. P of Fibonacci numbers is definite in whole numbers at "
        "any condition: a gamma outside (0, 1] that comes from it proves rounding, not an indefinite P. Eight columns "
        "in units from 1 to 10^7 with P0 = 16384 I leave symmetric a P that is not definite in the first rows: a "
        "gamma outside of (0, 1] and a gain above its bound show it. Rows of signs and a constant row are rounded in "
        "the same direction at each step: the squared lengths of qr's columns are off by 3 to 4 u / (1 - lambda).",
    .data =
        "white rows, a delay line with pole 0.9, columns in units 1 to 10^(d-1), three spectra of condition 1e3 in "
        "rotated directions, signs, a constant; P of Fibonacci numbers",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{
                {"rows",
                 {"white", "line", "units", "geometric", "one small", "one large", "binary", "constant", "Fibonacci"}},
                {"d", full ? std::vector<Cell>{1.0, 2.0, 4.0, 8.0} : std::vector<Cell>{1.0, 2.0}},
                {"lambda", full ? std::vector<Cell>{0.9, 0.97, 0.99} : std::vector<Cell>{0.9, 0.97}},
                {"replicate", counted(full ? 20 : 11)}};
        },
    .admits =
        [](Trial const& trial) {
            double const d = trial.number("d");
            std::string const& kind = trial.text("rows");
            if (kind == "Fibonacci") return d == 2 && trial.number("lambda") == 0.9;
            return kind == "constant" ? d == 1 : d > 1 || kind == "white" || kind == "line" || kind == "binary";
        },
    .measures = {"of", "units_to", "d_over_memory", "condition_u", "outside", "ln_gamma", "ln_first", "ln_last",
                 "substitution", "drop_less_law", "gain", "gain_attained", "gain_less_law", "entry", "column",
                 "constant_gain"},
    .measure = measure,
    .plots = {{.title = "gamma outside of (0, 1] from a definite P",
               .x = "condition_u",
               .y = "outside",
               .series = "of",
               .log = "x",
               .x_label = "condition number of P times u",
               .y_label = "share of rows",
               .where = {{"rows", {"Fibonacci"}}}}},
    .claims =
        {
            {"gamma lies in (0, 1] in every row of most runs",
             [](Table const& t) { return within(runs(t), by, outside, 0, 0); },
             own_result("docs/theory.md 14, set before the run")},
            {"and without eight columns in units up to 10^7 under P0 = 16384 I",
             [](Table const& t) { return within(well_scaled(t), by, outside, 0, 0); },
             verification("docs/theory.md 14")},
            {"from f = P psi of a definite P gamma leaves (0, 1] in no run while kappa_P u < 2^-5/2, of d = 2",
             [](Table const& t) {
                 return within(of_fibonacci(t, "P psi", [](double c) { return c < 0.17; }), {"of"},
                               Statistic(greatest("outside")).as(Estimate::proven), 0, 0);
             },
             verification("docs/theory.md 120").by("docs/theory.md 120")},
            {"with kappa_P u >= 2^10 it does in 0.3 to 0.6 of the rows",
             [](Table const& t) {
                 return within(of_fibonacci(t, "P psi", [](double c) { return c >= 1024; }), {"of"},
                               Statistic(mean("outside")).as(Estimate::share), 0.3, 0.6);
             },
             own_result("docs/theory.md 120, set before the run")},
            {"in 0.2 to 0.3: the four roundings of f = P psi cancel in half of the cases, and else have either sign",
             [](Table const& t) {
                 return within(of_fibonacci(t, "P psi", [](double c) { return c >= 1024; }), {"of"},
                               Statistic(mean("outside")).as(Estimate::mean), 0.2, 0.3);
             },
             own_result("docs/theory.md 120, set after the first run")},
            {"from a root of the same P it does in no run",
             [](Table const& t) {
                 return within(of_fibonacci(t, "root", [](double) { return true; }), {"of"},
                               Statistic(greatest("outside")).as(Estimate::proven), 0, 0);
             },
             verification("docs/theory.md 120").by("docs/theory.md 120")},
            {"mean of ln gamma: d ln lambda, to 1 %",
             [](Table const& t) { return within(runs(t), by, mean("ln_gamma"), 0.99, 1.01); },
             own_result("docs/theory.md 22, set before the run")},
            {"mean of ln cos^2, first rotation and last: ln lambda, to 1 %",
             [](Table const& t) {
                 return labelled("first", within(runs(t), by, mean("ln_first"), 0.99, 1.01)) &&
                        labelled("last", within(runs(t), by, mean("ln_last"), 0.99, 1.01));
             },
             own_result("docs/theory.md 22, set before the run")},
            {"cos^2 of a rotation from one substitution is that of R before and after, to 1e-12",
             [](Table const& t) { return within(runs(t), by, greatest("substitution"), 0, 1e-12); },
             verification("docs/theory.md 22")},
            {"independent rows, d (1 - lambda) <= 0.1: the mean of 1 - gamma, over d |ln lambda|, is 1 - (1 - lambda) "
             "(d + 2) / 2, to 0.02",
             [](Table const& t) {
                 return within(first_order(t), by, Statistic(mean("drop_less_law")).as(Estimate::mean), -0.02, 0.02);
             },
             own_result("docs/theory.md 121, set before the run")},
            {"no K_i exceeds half the root of P_ii / lambda",
             [](Table const& t) { return within(runs(t), by, Statistic(greatest("gain")).as(Estimate::every), 0, 1); },
             own_result("docs/theory.md 27, set before the run")},
            {"and none does without eight columns in units up to 10^7",
             [](Table const& t) {
                 return within(well_scaled(t), by, Statistic(greatest("gain")).as(Estimate::proven), 0, 1 + 8 * u);
             },
             verification("docs/theory.md 27").by("docs/theory.md 27")},
            {"a row along one axis with psi'P psi = lambda attains it, to 8 u",
             [](Table const& t) { return within(runs(t), by, greatest("gain_attained"), 1 - 8 * u, 1 + 8 * u); },
             verification("docs/theory.md 27")},
            {"independent rows, d (1 - lambda) <= 0.1: the rms gain is 2 sqrt(lambda (1 - lambda)) (1 - (d + 1) (1 - "
             "lambda) / 2) of the bound, to 0.03 of the root",
             [](Table const& t) {
                 return within(first_order(t), by, Statistic(mean("gain_less_law")).as(Estimate::mean), -0.03, 0.03);
             },
             own_result("docs/theory.md 121, set before the run")},
            {"no entry of R exceeds max|psi| / sqrt(1 - lambda), and rows of signs attain it to 1e-6",
             [](Table const& t) {
                 return within(runs(t), by, Statistic(greatest("entry")).as(Estimate::proven), 0, 1 + 1e-12) &&
                        labelled("signs",
                                 within(t.where("rows", "binary"), by, greatest("entry"), 1 - 1e-6, 1 + 1e-12));
             },
             verification("docs/theory.md 26").by("docs/theory.md 26")},
            {"squared lengths of qr's columns are those of the rows to 2.5 u / (1 - lambda)",
             [](Table const& t) { return within(runs(t), by, greatest("column"), 0, 2.5); },
             own_result("docs/theory.md 26 and 39, set before the run")},
            {"a constant row: the gain is (1 - lambda) / psi, to 4 u / (1 - lambda)",
             [](Table const& t) {
                 return within(t.where("rows", "constant"), {"lambda"}, greatest("constant_gain"), 0, 4);
             },
             verification("docs/theory.md 26")},
        },
};

}  // namespace rlslab::studies
