// Which inputs excite: correlation matrices of a lecture's inputs, their dominance, their least eigenvalue, and how a
// record finds them. Longer than 150 lines: exact matrices of six inputs, and seven claims.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/reference/definiteness.hpp>

namespace rlslab::studies {
namespace {

constexpr double noise = 0.5,
                 pole = 0.8;  // of the system of the block matrix: y_k = pole y_{k-1} + u_{k-1} + noise e_k

/// White, AR(1) of variance 1, or w_k - w_{k-1}.
struct Input {
    double a = 0;
    bool differenced = false;
    double correlation(Index lag) const {
        if (differenced) return lag == 0 ? 2 : lag == 1 ? -1 : 0;
        double r = 1;
        for (Index i = 0; i < lag; ++i) r *= a;
        return r;
    }
};
Input input_named(std::string const& name) {
    if (name == "differenced") return {.differenced = true};
    return {.a = name == "white" ? 0 : std::stod(name.substr(6))};  // "AR(1) 0.9"
}

Matrix<double> toeplitz(Input const& input, Index n) {
    Matrix<double> R(n, n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) R(i, j) = input.correlation(std::abs(i - j));
    return R;
}

/// The least eigenvalue of a symmetric matrix to 1e-7, by halving; each step is decided exactly. In [-1, 4].
double least_eigenvalue(Matrix<double> const& R) {
    double below = -1, above = 4;
    while (above - below > 1e-7) {
        double const middle = (below + above) / 2;
        Matrix<Reference> shifted = R.cast<Reference>();
        for (Index i = 0; i < R.rows(); ++i) shifted(i, i) -= Reference(middle);
        bool const positive =
            definiteness({Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain, shifted, {}}) ==
            Health::sound;
        (positive ? below : above) = middle;
    }
    return below;
}

/// G of docs/theory.md 3 for n past outputs and n inputs u_{k-1} ... u_{k-n} of the first-order system, white input:
/// y_k is the sum of pole^i (u_{k-1-i} + noise e_{k-i}).
Matrix<double> block_matrix(Index n) {
    auto const power = [](Index i) {
        double out = 1;
        for (Index k = 0; k < i; ++k) out *= pole;
        return out;
    };
    Matrix<double> G = Matrix<double>::Identity(2 * n, 2 * n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            G(i, j) = power(std::abs(i - j)) * (1 + noise * noise) / (1 - pole * pole);
            // E[-y_{k-1-i} u_{k-1-j}], whose lag is j - i - 1
            if (j > i) G(i, n + j) = G(n + j, i) = -power(j - i - 1);
        }
    return G;
}

/// The rows' Gram matrix over their number; regressors of the block matrix or of the input alone.
Matrix<double> sampled(Input const& input, bool block, Index n, Index rows, Seed seed) {
    Vector<double> u = Vector<double>::Zero(n + 1), y = Vector<double>::Zero(n + 1);  // newest first
    Index const d = block ? 2 * n : n;
    Matrix<double> sum = Matrix<double>::Zero(d, d);
    double state = 0, w_before = seed.bell();
    double const fresh = std::sqrt(1 - input.a * input.a);
    Vector<double> psi(d);
    constexpr Index burn_in = 300;  // 0.9^300
    for (Index k = -burn_in; k < rows; ++k) {
        double const w = seed.bell();
        state = input.differenced ? w - w_before : input.a * state + fresh * w;
        w_before = w;
        double const next = pole * y[0] + u[0] + noise * seed.bell();
        for (Index i = n; i > 0; --i) u[i] = u[i - 1], y[i] = y[i - 1];
        u[0] = state, y[0] = next;
        if (k < 0) continue;
        for (Index i = 0; i < n; ++i) {
            if (block) psi[i] = -y[i], psi[n + i] = u[i];
            else psi[i] = u[i];
        }
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                double const product = psi[i] * psi[j];
                sum(i, j) += product;
            }
    }
    return sum / double(rows);
}

void measure(Trial const& trial, TrialOutput& out) {
    std::string const name = trial.text("input");
    bool const block = name == "block matrix";
    Input const input = block ? Input{} : input_named(name);
    Index const n = Index(trial.number("delays")), rows = Index(trial.number("rows"));
    Matrix<double> const R = block ? block_matrix(n) : toeplitz(input, n),
                         found = sampled(input, block, n, rows, trial.seed({"input", "delays", "rows", "replicate"}));
    double largest = 0;
    for (Index j = 0; j < R.cols(); ++j)
        for (Index i = 0; i < R.rows(); ++i) largest = std::max(largest, std::abs(found(i, j) - R(i, j)));
    double const least = least_eigenvalue(R), least_found = least_eigenvalue(found);
    double const tridiagonal = 2 - 2 * correctly::cos(3.141592653589793 / double(n + 1));
    out({diagonally_dominant(R) ? "dominant" : "not dominant", least, least_found / least, largest,
         input.differenced ? least - tridiagonal : 0});
}

Table coloured(Table const& t, char const* name) { return t.where("input", name); }

}  // namespace

extern Study const persistent_excitation;
Study const persistent_excitation{
    .name = "persistent_excitation",
    .question = "Which inputs excite a model of any order, and does diagonal dominance tell?",
    .source = "the condition of a lecture that is not public, corrected (docs/theory.md 3, 4)",
    .formula = R"tex(R_u = (R(i-j)), \quad R(\tau) = a^{|\tau|}: \;
\text{dominant at every order only for } \frac{2|a|}{1-|a|} \le 1, \quad
u_k = w_k - w_{k-1}: \; \lambda_{\min} = 2 - 2\cos\frac{\pi}{n+2})tex",
    .interpretation =
        "White noise, coloured noise and a difference of white noise are exciting of every order: their matrices are "
        "definite at each number of delays. Diagonal dominance, the sufficient condition that the lecture names, holds "
        "for white noise, and for coloured noise at every order only up to a = 1/3. The least eigenvalue of a coloured "
        "input is what the estimate pays for. The matrix of a record, and that of past outputs and inputs together, "
        "tends to its limit as one over the root of the number of rows.",
    .data = "white, first-order coloured and differenced noise; a first-order system in white noise",
    .factors =
        [](Budget budget) {
            bool const full = budget == Budget::full;
            return std::vector<Factor>{
                {"input", {"white", "AR(1) 0.3", "AR(1) 0.5", "AR(1) 0.9", "differenced", "block matrix"}},
                {"delays", {2.0, 3.0, 5.0, 9.0}},
                {"rows", full ? std::vector<Cell>{300.0, 1000.0, 3000.0, 10000.0, 30000.0}
                              : std::vector<Cell>{300.0, 1000.0, 3000.0}},
                {"replicate", counted(full ? 100 : 30)}};
        },
    .measures = {"dominance", "least_eigenvalue", "of_limit", "deviation", "of_tridiagonal"},
    .measure = measure,
    .plots = {{.title = "Largest error of an entry of the matrix of a record",
               .x = "rows",
               .y = "deviation",
               .series = "delays",
               .panel = "input",
               .x_label = "rows N",
               .y_label = "largest error of an entry"}},
    .claims =
        {
            {"coloured noise with a = 0.3 is strictly dominant at each number of delays, with a = 0.5 and 0.9 it is "
             "not from 3 delays on",
             [](Table const& t) {
                 Table const many = t.where("delays", [](double n) { return n >= 3; });
                 return labelled("0.3",
                                 everywhere(coloured(t, "AR(1) 0.3"), "dominance", "dominant", Estimate::proven)) &&
                        labelled("0.5", everywhere(coloured(many, "AR(1) 0.5"), "dominance", "not dominant",
                                                   Estimate::proven)) &&
                        labelled("0.9", everywhere(coloured(many, "AR(1) 0.9"), "dominance", "not dominant",
                                                   Estimate::proven));
             },
             verification("docs/theory.md 4").by("docs/theory.md 4")},
            {"all the same each is definite: the least eigenvalue is above 0.01, decided exactly",
             [](Table const& t) {
                 return within(t, {"input", "delays"}, mean("least_eigenvalue").as(Estimate::fixed), 0.01, 2);
             },
             verification("docs/theory.md 4")},
            {"differenced white noise: the least eigenvalue is 2 - 2 cos(pi / (n + 2)), n + 1 delays, to 1e-6",
             [](Table const& t) {
                 return within(coloured(t, "differenced"), {"delays"}, mean("of_tridiagonal").as(Estimate::fixed),
                               -1e-6, 1e-6);
             },
             verification("docs/theory.md 4")},
            {"a = 0.9 at 5 delays: the least eigenvalue is 0.0580 +- 0.0005",
             [](Table const& t) {
                 return within(coloured(t, "AR(1) 0.9").where("delays", 5.0), {},
                               mean("least_eigenvalue").as(Estimate::fixed), 0.0575, 0.0585);
             },
             verification("docs/theory.md 4")},
            {"the difference of white noise is dominant at 2 delays, and at no larger number of them",
             [](Table const& t) {
                 Table const mine = coloured(t, "differenced");
                 return labelled("2",
                                 everywhere(mine.where("delays", 2.0), "dominance", "dominant", Estimate::proven)) &&
                        labelled("more", everywhere(mine.where("delays", [](double n) { return n >= 3; }), "dominance",
                                                    "not dominant", Estimate::proven));
             },
             verification("docs/theory.md 4").by("docs/theory.md 4")},
            {"the matrix of a record tends to its limit, exponent -0.50 +- 0.05 in the number of rows, the block "
             "matrix too",
             [](Table const& t) { return within(t, {"input"}, slope("rows", "deviation"), -0.55, -0.45); },
             own_result("docs/theory.md 3, set before the run")},
            {"the least eigenvalue of the matrix of 3000 rows and more is 0.9 to 1.05 of its limit in the median",
             [](Table const& t) {
                 return within(t.where("rows", [](double n) { return n >= 3000; }), {"input", "delays"},
                               mean("of_limit"), 0.9, 1.05);
             },
             own_result("set before the run")},
        },
};

}  // namespace rlslab::studies
