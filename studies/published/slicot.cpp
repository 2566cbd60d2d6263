// The printed results of SLICOT's example programs, number by number: Kalman filters, a fast QR filter, least squares.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/fast/fast.hpp>

#include <cmath>
#include <stdexcept>

namespace rlslab::studies {
namespace {

/// Thrown where a filter's numbers are not finite.
struct Broken {};

using namespace rationals;
using Numbers = std::vector<double>;

/// Decimals of at most four digits behind the point, exactly, by rows.
M of(Index rows, Index cols, Numbers const& x) {
    M out(rows, cols);
    for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < cols; ++j) out(i, j) = Q(int(std::lround(x[size_t(i * cols + j)] * 1e4))) / 10000;
    return out;
}
M transposed(M const& A) { return A.transpose(); }
M square(M const& A) { return A.lazyProduct(A.transpose()); }
M product(M const& A, M const& B) { return A.lazyProduct(B); }
double in_double(Q const& x) { return static_cast<double>(x); }

/// Upper triangular U, A = U'U, each diagonal entry with the sign of the printed one.
Matrix<double> triangle(M const& A, std::function<double(Index)> const& printed_diagonal) {
    Index const d = A.rows();
    Matrix<Reference> X(d, d), U = Matrix<Reference>::Zero(d, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) X(i, j) = A(i, j).convert_to<Reference>();
    for (Index i = 0; i < d; ++i) {
        Reference pivot = X(i, i);
        for (Index l = 0; l < i; ++l) pivot -= U(l, i) * U(l, i);
        U(i, i) = sqrt(pivot);
        for (Index j = i + 1; j < d; ++j) {
            Reference sum = X(i, j);
            for (Index l = 0; l < i; ++l) sum -= U(l, i) * U(l, j);
            U(i, j) = sum / U(i, i);
        }
        if (printed_diagonal(i) < 0) U.row(i) = -U.row(i);
    }
    return U.unaryExpr([](Reference const& x) { return static_cast<double>(x); });
}

/// The solution after rows C with outputs Y of unit noise, from theta0 (a column for each right side) and P0: in
/// rationals, or by a variant.
struct Solution {
    M P, theta;
};
Q rational_of(Reference const& x) {
    double const y = static_cast<double>(x);
    return std::isfinite(y) ? Q(y) : throw Broken{};
}
Solution exactly(M P, M theta, M const& C, M const& Y) {
    for (Index k = 0; k < C.rows(); ++k) {
        V const psi = C.row(k).transpose(), f = P.lazyProduct(psi);
        Q const s = 1 + dot(psi, f);
        for (Index j = 0; j < theta.cols(); ++j) {
            V const column = theta.col(j);
            Q const e = Y(k, j) - dot(psi, column);
            for (Index i = 0; i < theta.rows(); ++i) theta(i, j) += f[i] * e / s;
        }
        P -= outer(f, f) / s;
    }
    return {P, theta};
}
Solution by(CatalogueEntry const& entry, M const& P0, M const& theta0, M const& C, M const& Y) {
    auto const stored = [&](Q const& x) { return entry.arithmetic->round(in_double(x)); };
    Solution out{P0, theta0};
    for (Index j = 0; j < Y.cols(); ++j) {
        Vector<double> const start = theta0.col(j).unaryExpr(stored);
        auto const filter = entry.make(
            {.size = P0.rows(), .prior = Prior<double>{.theta = start, .covariance = P0.unaryExpr(stored).eval()}},
            Seed{1});
        for (Index k = 0; k < C.rows(); ++k) {
            Vector<double> const psi = C.row(k).transpose().unaryExpr(stored);
            filter->update(psi, stored(Y(k, j)));
        }
        Vector<Reference> const theta = filter->theta();
        for (Index i = 0; i < theta.size(); ++i) out.theta(i, j) = rational_of(theta[i]);
        if (j > 0) continue;
        Matrix<Reference> const P = covariance_of(filter->stored());
        for (Index b = 0; b < P.cols(); ++b)
            for (Index a = 0; a <= b; ++a) out.P(a, b) = out.P(b, a) = rational_of(P(a, b));
    }
    return out;
}

/// One run of an example: how it solves, whether its last row is left out, and where its numbers go.
struct Run {
    std::function<Solution(M const& P0, M const& theta0, M const& C, M const& Y)> solve;
    TrialOutput& out;

    /// Compares computed(i, j) with numbers printed by rows, of `digits` behind the point.
    void compare(char const* table, Index cols, Numbers const& printed,
                 std::function<double(Index, Index)> const& computed, int digits = 4) const {
        for (size_t n = 0; n < printed.size(); ++n) {
            double const x = computed(Index(n) / cols, Index(n) % cols);
            out({std::string(table), double(n), printed[n], x,
                 std::abs(x - printed[n]) * correctly::pow(10, double(digits))});
        }
    }
    void compare(char const* table, M const& computed, Numbers const& printed) const {
        compare(table, computed.cols(), printed, [&](Index i, Index j) { return in_double(computed(i, j)); });
    }
};

// --- Kalman filters --------------------------------------------------------------------------------------------------

Numbers const dense{.2113, .8497, .7263, .8833, .7560, .6857, .1985, .6525,
                    .0002, .8782, .5442, .3076, .3303, .0683, .2320, .9329},
    output{.3616, .5664, .5015, .2693, .2922, .4826, .4368, .6325};

/// FB01QD, FB01RD: three recursions from P = 0 with Q = I; the lower root of the predicted P, and the predictor's gain.
void covariance_filter(Run const& run, M const& A, M const& C, Numbers const& root, Numbers const& gain) {
    M const B = of(4, 2, {.5618, .5042, .5896, .3493, .6853, .3873, .8906, .9222}),
            L = of(2, 2, {.9488, 0, .3760, .7340});  // R = L L'
    M whiten = M::Zero(2, 2);
    whiten(0, 0) = 1 / L(0, 0), whiten(1, 1) = 1 / L(1, 1), whiten(1, 0) = -L(1, 0) / (L(0, 0) * L(1, 1));
    M G = B, W = M::Identity(2, 2), K, P;  // P = G W G', after the first recursion: from P = 0 it learns nothing
    for (int step = 2; step <= 3; ++step) {
        Solution const after = run.solve(W, M::Zero(G.cols(), 2), product(whiten, product(C, G)), whiten);
        M const AG = product(A, G);
        K = product(AG, after.theta);
        P = product(product(AG, after.P), transposed(AG)) + square(B);
        G = M::Identity(4, 4), W = P;
    }
    Matrix<double> const U = triangle(P, [&](Index i) { return root[size_t(5 * i)]; });
    run.compare("S", 4, root, [&](Index i, Index j) { return U(j, i); });
    run.compare("K", K, gain);
}

/// FB01SD, FB01TD: three recursions from P = I, with A^-1 and A^-1 B given; the upper root of P^-1, and the state.
void information_filter(Run const& run, M const& inverse_A, M const& inverse_A_B, Numbers const& root,
                        Numbers const& state) {
    M const A = inverse(inverse_A), B = product(A, inverse_A_B), C = of(2, 4, output),
            Q_root = of(2, 2, {1.1159, .2305, 0, .6597}), Z = of(2, 1, {.0019, .5075}), Y = of(2, 1, {.2129, .5591});
    M const BQB = product(product(B, inverse(product(transposed(Q_root), Q_root))), transposed(B));
    Solution x{M::Identity(4, 4), of(4, 1, {.4076, .8408, .5017, .9128})};
    for (int step = 1; step <= 3; ++step)
        x = run.solve(product(product(A, x.P), transposed(A)) + BQB, product(A, x.theta) - product(B, Z), C, Y);
    Matrix<double> const U = triangle(inverse(x.P), [&](Index i) { return root[size_t(5 * i)]; });
    run.compare("inverse S", 4, root, [&](Index i, Index j) { return U(i, j); });
    run.compare("X", x.theta, state);
}

/// FB01VD: one recursion; its P0 and Q are not positive definite.
void conventional_filter(Run const& run) {
    M const P0 = of(4, 4,
                    {.5015, .4368, .2693, .6325, .4368, .4818, .2639, .4148, .2693, .2639, .1121, .6856, .6325, .4148,
                     .6856, .8906}),
            A = of(4, 4, dense),
            B = of(4, 3, {.0437, .7783, .5618, .4818, .2119, .5896, .2639, .1121, .6853, .4148, .6856, .8906}),
            Q_noise = of(3, 3, {.9329, .2146, .3126, .2146, .2922, .5664, .3126, .5664, .5935}),
            C = of(2, 4, {.3873, .9488, .3760, .0881, .9222, .3435, .7340, .4498}), I = M::Identity(2, 2);
    Solution const after = run.solve(P0, M::Zero(4, 2), C, I);
    run.compare("P", product(product(A, after.P), transposed(A)) + product(product(B, Q_noise), transposed(B)),
                {1.6007, 1.3283, 1.1153, 1.7177, 1.3283, 1.2763, 1.0132, 1.5137, 1.1153, 1.0132, .8222, 1.2722, 1.7177,
                 1.5137, 1.2722, 2.1562});
    run.compare("K", after.theta, {.1648, .2241, .2115, .1610, .0728, .1673, .1304, .3892});
    Matrix<double> const U = triangle(product(product(C, P0), transposed(C)) + I, [](Index) { return 1; });
    run.compare("innovations", 2, {1.5091, 1.1543, 0, 1.5072}, [&](Index i, Index j) { return U(i, j); });
}

// --- least squares ---------------------------------------------------------------------------------------------------

Q const large(1000000);  // c^2 in place of no prior: a bias of about 1e-7 (docs/theory.md 13)

/// MB02ID: a block Toeplitz matrix T, blocks 3 x 2, and right sides of ones.
void toeplitz(Run const& run) {
    M const first_column = of(12, 2, {5, 2, 1, 2, 4, 3, 4, 0, 2, 2, 3, 3, 5, 1, 3, 3, 1, 1, 2, 3, 1, 3, 2, 2}),
            first_row = of(3, 4, {1, 4, 2, 3, 2, 2, 2, 4, 3, 1, 0, 1});
    M T(12, 6);
    for (Index i = 0; i < 4; ++i)
        for (Index j = 0; j < 3; ++j)
            T.block(3 * i, 2 * j, 3, 2) =
                j > i ? M(first_row.middleCols(2 * (j - i - 1), 2)) : M(first_column.middleRows(3 * (i - j), 3));
    auto const solution = [&](M const& A) {
        Index const d = A.cols();
        return run.solve(M::Identity(d, d) * large, M::Zero(d, 1), A, M::Ones(A.rows(), 1)).theta;
    };
    run.compare("least squares", solution(T), {.0379, .1677, .0485, -.0038, .0429, .1365});
    run.compare("minimum norm", solution(transposed(T)),
                {.0509, .0547, .0218, .0008, .0436, .0404, .0031, .0451, .0421, .0243, .0556, .0472});
}

/// MB02QD: rank 2 of 3, two right sides; the solution of least norm.
void rank_deficient(Run const& run) {
    M const A = of(4, 3, {2, 2, -3, 3, 3, -1, 4, 4, -5, -1, -1, -2}), Y = of(4, 2, {1, 0, 0, 0, 0, 0, 0, 1});
    run.compare("least norm", run.solve(M::Identity(3, 3) * large, M::Zero(3, 2), A, Y).theta,
                {-.0034, -.1054, -.0034, -.1054, -.0816, -.1973});
}

/// MB04OD: two rows join a triangle R and what was rotated with it.
void updated_triangle(Run const& run) {
    M const R = of(3, 3, {3, 2, 1, 0, 2, 1, 0, 0, 1}), z = of(3, 2, {3, 2, 1, 3, 3, 2});
    M const P0 = inverse(product(transposed(R), R));
    Solution const after =
        run.solve(P0, product(P0, product(transposed(R), z)), of(2, 3, {2, 3, 1, 4, 6, 5}), of(2, 2, {1, 3, 3, 2}));
    Matrix<double> const U = triangle(inverse(after.P), [](Index) { return -1; });
    run.compare("R", 3, {-5.3852, -6.6850, -4.6424, 0, -2.8828, -2.0694, 0, 0, -1.7793},
                [&](Index i, Index j) { return U(i, j); });
    run.compare("B", 2, {-4.2710, -3.7139, -.1555, -2.1411, -1.6021, .9398}, [&](Index i, Index j) {
        double sum = 0;
        for (Index l = 0; l < 3; ++l) sum += U(i, l) * in_double(after.theta(l, j));
        return sum;
    });
}

// --- a delay line ----------------------------------------------------------------------------------------------------

constexpr double lambda_line = 0.99 * 0.99, soft_start = 1e-2;
double input(Index n) { return n > 0 ? correctly::sin(0.3 * double(n)) : 0; }
/// As the example has it: its function of n - 1 does not vanish for n = 1, but sin 0 does.
double reference(Index n) { return 0.5 * correctly::sin(0.3 * double(n)) + 2 * correctly::sin(0.3 * double(n - 1)); }

/// FD01AD: 500 samples of two taps, sqrt(lambda) = 0.99, soft start. By a variant: rotated outputs, normalised backward
/// errors, and those of the forward predictor, whose regressor is the row before.
void fast_qr(Run const& run, CatalogueEntry const& entry, Index samples) {
    double const delta = soft_start * soft_start;
    Matrix<double> P0{{1 / delta, 0}, {0, lambda_line / delta}};
    Problem<double> const problem{.size = 2, .forgetting = lambda_line, .prior = Prior<double>{.covariance = P0}};
    auto const filter = entry.make(problem, Seed{1}), predictor = entry.make(problem, Seed{1});
    double energy = delta, gamma = 1;
    for (Index n = 1; n <= samples; ++n) {
        Vector<double> const psi{{input(n), input(n - 1)}}, before{{input(n - 1), input(n - 2)}};
        gamma = filter->update(psi, reference(n)).gamma;
        Step<double> const ahead = predictor->update(before, input(n));
        energy = lambda_line * energy + ahead.innovation * ahead.residual;
    }
    struct Rotated {
        Matrix<double> U;
        Numbers z;
    };
    auto const rotated = [](AnyFilter const& f) {
        M P(2, 2);
        Matrix<Reference> const stored = covariance_of(f.stored());
        for (Index j = 0; j < 2; ++j)
            for (Index i = 0; i <= j; ++i) P(i, j) = P(j, i) = rational_of(stored(i, j));
        Matrix<double> const U = triangle(inverse(P), [](Index) { return 1; });
        double const a = static_cast<double>(f.theta()[0]), b = static_cast<double>(f.theta()[1]);
        return Rotated{U, {U(0, 0) * a + U(0, 1) * b, U(1, 1) * b}};
    };
    Rotated const own = rotated(*filter);
    Matrix<double> const& U = own.U;
    Numbers const ahead = rotated(*predictor).z;
    double const first = input(samples) / U(0, 0),
                 backward[] = {first, (input(samples - 1) - U(0, 1) * first) / U(1, 1), std::sqrt(gamma)};
    run.compare(
        "XF", 1, {4.880088, -1.456881}, [&](Index i, Index) { return ahead[size_t(i)]; }, 6);
    run.compare(
        "YQ", 1, {12.307615, 2.914057}, [&](Index i, Index) { return own.z[size_t(i)]; }, 6);
    run.compare(
        "EPSBCK", 1, {-.140367, -.140367, .980099}, [&](Index i, Index) { return backward[i]; }, 6);
    run.compare(
        "EFOR", 1, {.00197}, [&](Index, Index) { return std::sqrt(energy); }, 5);
}
/// The conversion factor of the fast forms.
void fast_forms_of(Run const& run, std::string const& form, Index samples) {
    for_each(FastForms<double>{}, [&]<class F>() {
        if (F::name != form) return;
        F filter({.size = 2, .forgetting = lambda_line, .energy = soft_start * soft_start});
        double gamma = 1;
        for (Index n = 1; n <= samples; ++n) gamma = filter.update(input(n), reference(n)).gamma;
        run.compare(
            "EPSBCK", 1, {.980099}, [&](Index, Index) { return std::sqrt(gamma); }, 6);
    });
}

std::vector<Cell> fast_names() {
    std::vector<Cell> out;
    for_each(FastForms<double>{}, [&]<class F>() { out.emplace_back(std::string(F::name)); });
    return out;
}

void run_slicot_program(Trial const& trial, TrialOutput& out) {
    std::string const &program = trial.text("program"), &form = trial.text("form");
    bool const all = trial.text("rows") == "all", rational = form == "rationals";
    CatalogueEntry const* const entry = find_entry(form, trial.text("arithmetic"));
    Run const run{[&](M const& P0, M const& theta0, M const& C, M const& Y) {
                      Index const rows = C.rows() - (all ? 0 : 1);
                      M const some = C.topRows(rows), of_some = Y.topRows(rows);
                      return rational ? exactly(P0, theta0, some, of_some) : by(*entry, P0, theta0, some, of_some);
                  },
                  out};
    if (program == "FB01QD")
        covariance_filter(
            run, of(4, 4, dense), of(2, 4, output),
            {-1.2936, 0, 0, 0, -1.1382, -.2579, 0, 0, -.9622, -.1529, .2974, 0, -1.3076, .0936, .4508, -.4897},
            {.3638, .9469, .3532, .8179, .2471, .5542, .1982, .6471});
    else if (program == "FB01RD") {
        Numbers A = dense;
        A[3] = 0;
        covariance_filter(
            run, of(4, 4, A), of(2, 4, {.3616, 0, 0, 0, .2922, .4826, 0, 0}),
            {-1.7223, 0, 0, 0, -2.1073, .5467, 0, 0, -1.7649, .1412, -.1710, 0, -1.8291, .2058, -.1497, .7760},
            {-.2135, 1.6649, -.2345, 2.1442, -.2147, 1.7069, -.1345, 1.4777});
    } else if (program == "FB01SD")
        information_filter(run, transposed(of(4, 4, dense)),
                           of(4, 2, {-.8805, 1.3257, 2.1039, .5207, -.6075, 1.0386, -.8531, 1.1688}),
                           {.6897, .7721, .7079, .6102, 0, -.3363, -.2252, -.2642, 0, 0, -.1650, .0319, 0, 0, 0, .3708},
                           {-.7125, -1.8324, 1.7500, 1.5854});
    else if (program == "FB01TD") {
        Numbers A = dense;
        A[3] = 0;
        information_filter(
            run, transposed(of(4, 4, A)), of(4, 2, {-.8805, 1.3257, 0, .5207, 0, 0, 0, 0}),
            {-.8731, -1.1461, -1.0260, -.8901, 0, -.2763, -.1929, -.3763, 0, 0, -.1110, -.1051, 0, 0, 0, .3120},
            {-2.0688, -.7814, 2.2181, .9298});
    } else if (program == "FB01VD") conventional_filter(run);
    else if (program == "MB02ID") toeplitz(run);
    else if (program == "MB02QD") rank_deficient(run);
    else if (program == "MB04OD") updated_triangle(run);
    else if (Index const samples = all ? 500 : 499; entry) fast_qr(run, *entry, samples);
    else fast_forms_of(run, form, samples);
}

void measure(Trial const& trial, TrialOutput& out) {
    try {
        run_slicot_program(trial, out);
    } catch (std::invalid_argument const&) {
        out({std::string("refused"), 0.0, 0.0, 0.0, -1.0});
    } catch (Broken const&) {
        out({std::string("broken"), 0.0, 0.0, 0.0, INFINITY});
    }
}

Statistic const farthest = Statistic(greatest("units")).as(Estimate::fixed);
/// The compared numbers; a refusal has none.
Selection compared(std::string const& arithmetic, std::string const& rows = "all") {
    return where("arithmetic", arithmetic).where("rows", rows).where("units", at_least(0));
}
Claim printed(std::string const& program, std::string const& numbers) {
    return {program + " prints " + numbers + ": all within half a unit of the last digit, by every form that takes it",
            within(compared("double").where("program", program), {"form"}, farthest, 0, 0.5),
            reproduction("SLICOT's documentation (docs/literature.md 2), half a unit of the last printed digit")};
}

}  // namespace

extern Study const slicot{
    .name = "slicot",
    .question = "Do the variants give the numbers that SLICOT's example programs print?",
    .source =
        "SLICOT 5.0, documentation of FB01QD, FB01RD, FB01SD, FB01TD, FB01VD, FD01AD, MB02ID, MB02QD, MB04OD (read; "
        "docs/literature.md 2)",
    .formula = R"tex(\begin{aligned} &\text{filter}: \quad P_{i+1|i} = A P_{i|i} A^\top + B Q B^\top, \quad
P_{i|i}, K \text{ from rows } R^{-1/2} C, \lambda = 1 \\
&\text{least squares}: \quad P_0 = 10^6 I, \ \theta_0 = 0 \end{aligned})tex",
    .interpretation =
        "A measurement with noise R is recursive least squares with lambda = 1 and the rows R^-1/2 C; the time update "
        "between is made in rationals. A column of the gain is the estimate from theta0 = 0 and a unit output. P = B "
        "B' of the first recursion is singular: its measurement is made in the coordinates of B. FD01AD's numbers are "
        "those of a triangle and of a second filter, whose regressor is the row before; of the fast forms only the "
        "conversion factor is compared. Each number is compared with the printed one, in units of its last digit. In "
        "double every form gives every number; FB01VD's P0 and Q are not positive definite, so that its numbers are "
        "those of its formulas in rationals alone. In float P0 = 10^6 I at rank 2 of 3 leaves an error of theta of "
        "about u times 10^6.",
    .data = "the examples' own",
    .factors = {{"program", {"FB01QD", "FB01RD", "FB01SD", "FB01TD", "FB01VD", "FD01AD", "MB02ID", "MB02QD", "MB04OD"}},
                {"rows", {"all", "all but the last"}},
                {"arithmetic", {"double", "float"}},
                {"form", joined(joined({"rationals"}, row_forms()), fast_names())}},
    .admits =
        [](Trial const& trial) {
            bool const line = trial.text("program") == "FD01AD", in_float = trial.text("arithmetic") == "float",
                       rational_numbers = trial.text("form") == "rationals",
                       fast = !rational_numbers && !find_entry(trial.text("form"));
            if (rational_numbers || fast) return !in_float && line == fast;
            return !in_float || !line;
        },
    .measures = {"table", "entry", "printed", "computed", "units"},
    .measure = measure,
    .plots = {{.title = "Distance from the printed number, double",
               .x = "entry",
               .y = "units",
               .series = "form",
               .panel = "program",
               .log = "",
               .x_label = "number",
               .y_label = "units of the last digit",
               .where = {{"rows", {"all"}}, {"arithmetic", {"double"}}}}},
    .claims = {
        printed("FB01QD", "S with the rows (-1.2936), (-1.1382 -0.2579) ... and K = (0.3638 0.9469) ..."),
        printed("FB01RD", "S with the rows (-1.7223), (-2.1073 0.5467) ... and K = (-0.2135 1.6649) ..."),
        printed("FB01SD", "the inverse of S, 0.6897 0.7721 ..., and X = -0.7125, -1.8324, 1.7500, 1.5854"),
        printed("FB01TD", "the inverse of S, -0.8731 -1.1461 ..., and X = -2.0688, -0.7814, 2.2181, 0.9298"),
        printed("FB01VD", "P = 1.6007 1.3283 ..., K = 0.1648 0.2241 ..., and 1.5091 1.1543 1.5072"),
        printed("FD01AD", "XF = 4.880088, -1.456881, YQ = 12.307615, 2.914057, EPSBCK and EFOR"),
        printed("MB02ID", "0.0379 0.1677 ... (least squares) and 0.0509 0.0547 ... (least norm)"),
        printed("MB02QD", "the solution of least norm, -0.0034 -0.0034 -0.0816 and -0.1054 -0.1054 -0.1973"),
        printed("MB04OD", "R = -5.3852 -6.6850 ... and B = -4.2710 -3.7139 ..."),
        {"no form starts from FB01VD's P0, which is not positive definite: .5015 x .1121 < .2693^2",
         everywhere(where("program", "FB01VD").where("form", words(row_forms())), "table", "refused"),
         verification("Prior: a full P0 is positive definite")},
        {"and every form starts from all other programs' priors",
         within(where("program", {"FB01QD", "FB01RD", "FB01SD", "FB01TD", "FD01AD", "MB02ID", "MB02QD", "MB04OD"}),
                {"program", "form"}, Statistic(least("units")).as(Estimate::fixed), 0, INFINITY),
         verification("Prior: a full P0 is positive definite")},
        {"the test can fail: without the last row some number of each program is off by 10 units or more, by every "
         "variant",
         within(compared("double", "all but the last").where("form", words(row_forms())), {"program", "form"}, farthest,
                10, INFINITY),
         verification("a saboteur")},
        {"float, triangular forms: all numbers with four digits within one unit of the last",
         within(compared("float").where("form", words(triangular_forms())), {"program", "form"}, farthest, 0, 1),
         own_result("set before the run")}}};

}  // namespace rlslab::studies
