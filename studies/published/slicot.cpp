// The printed results of SLICOT's example programs, number by number: Kalman filters, a fast QR filter, least squares.
#include "studies/published/slicot_programs.hpp"
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/catalogue/catalogue.hpp>

#include <cmath>
#include <stdexcept>

namespace rlslab::studies {
namespace {

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
Table compared(Table const& t, std::string const& arithmetic, std::string const& rows = "all") {
    return t.where("arithmetic", arithmetic).where("rows", rows).where("units", [](double x) { return x >= 0; });
}
Claim printed(std::string const& program, std::string const& numbers) {
    return {program + " prints " + numbers + ": all within half a unit of the last digit, by every form that takes it",
            [program](Table const& t) {
                return within(compared(t, "double").where("program", program), {"form"}, farthest, 0, 0.5);
            },
            reproduction("SLICOT's documentation (docs/literature.md 2), half a unit of the last printed digit")};
}

}  // namespace

extern Study const slicot;
Study const slicot{
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
    .factors =
        [](Budget) {
            std::vector<Cell> const forms = joined(joined({"rationals"}, row_forms()), fast_names());
            return std::vector<Factor>{
                {"program", {"FB01QD", "FB01RD", "FB01SD", "FB01TD", "FB01VD", "FD01AD", "MB02ID", "MB02QD", "MB04OD"}},
                {"rows", {"all", "all but the last"}},
                {"arithmetic", {"double", "float"}},
                {"form", forms}};
        },
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
    .claims =
        {
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
             [](Table const& t) {
                 return everywhere(t.where("program", "FB01VD").where("form", words(row_forms())), "table", "refused");
             },
             verification("Prior: a full P0 is positive definite")},
            {"and every form starts from all other programs' priors",
             [](Table const& t) {
                 Table const others = t.where(
                     "program", {"FB01QD", "FB01RD", "FB01SD", "FB01TD", "FD01AD", "MB02ID", "MB02QD", "MB04OD"});
                 return within(others, {"program", "form"}, Statistic(least("units")).as(Estimate::fixed), 0, INFINITY);
             },
             verification("Prior: a full P0 is positive definite")},
            {"the test can fail: without the last row some number of each program is off by 10 units or more, by every "
             "variant",
             [](Table const& t) {
                 return within(compared(t, "double", "all but the last").where("form", words(row_forms())),
                               {"program", "form"}, farthest, 10, INFINITY);
             },
             verification("a saboteur")},
            {"float, triangular forms: all numbers with four digits within one unit of the last",
             [](Table const& t) {
                 return within(compared(t, "float").where("form", words(triangular_forms())), {"program", "form"},
                               farthest, 0, 1);
             },
             own_result("set before the run")},
        },
};

}  // namespace rlslab::studies
