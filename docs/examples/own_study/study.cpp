// In float, which form still finds a sensor's curve from our calibration, in whatever order its rows come?
#include <averaged.hpp>

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/erase.hpp>
#include <rlslab/input/csv.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/study_main.hpp>

using namespace rlslab;
using namespace rlslab::studies;

/// The rows of data.csv in an order drawn from the seed: degrees = theta' (1, volts, volts^2).
static Records calibration(Seed seed) {
    Columns const data = read_columns(DATA, {"volts", "degrees"});
    Records out{.psi = Matrix<double>::Zero(3, data.rows()), .y = Vector<double>::Zero(data.rows())};
    for (Index k = 0; k < data.rows(); ++k) {
        double const v = data["volts"][k];
        Index const at = Index(seed.next() % std::uint64_t(k + 1));  // the row there goes to the end
        out.psi.col(k) = out.psi.col(at), out.y[k] = out.y[at];
        out.psi.col(at) << 1, v, v * v;
        out.y[at] = data["degrees"][k];
    }
    return out;
}

Study const curve{
    .name = "curve",
    .question = "Which form finds our sensor's curve in float?",
    .source = "our calibration: data.csv, 40 rows",
    .formula = R"tex(\frac{\|\hat\theta - \theta\|}{\|\theta\|} \sim u\,\kappa \quad\text{or}\quad u\,\kappa^2)tex",
    .interpretation = "A factor keeps its digits from any prior; P itself loses them as c^2 grows.",
    .factors = {{"arithmetic", {"float", "double"}},
                {"variant", {"conventional", "averaged", "information", "ud", "qr"}},
                {"c2", powers(10, 2, 8, 2)},
                {"replicate", counted(100), counted(20)}},
    .measures = {"error"},
    .measure =
        [](Trial const& trial, TrialOutput& out) {
            Records const records = calibration(trial.seed({"replicate"}));
            Problem<double> const problem{.size = 3, .prior = Prior<double>{.variance = trial.number("c2")}};
            auto const filter = trial.entry(trial.text("variant"), trial.text("arithmetic")).make(problem, Seed{1});
            process_rows(*filter, records, 0, records.rows());
            out({errors(*filter, certified(problem, records, {records.rows()}).front()).theta});
        },
    .plots = {{.title = "Error of theta", .x = "c2", .y = "error", .panel = "arithmetic", .x_label = "prior variance"}},
    .claims = {{"in double every form has 6 digits",
                within(where("arithmetic", "double"), {}, greatest("error"), 0, 1e-6),
                verification("the digits of our table")},
               {"in float ud and qr have 4 digits",
                within(where("arithmetic", "float").where("variant", {"ud", "qr"}), {}, greatest("error"), 0, 1e-4),
                own_result("set after a first run")}},
};

/// A filter of our own stands beside the library's, by its name.
template <class F>
static void add() {
    add_to_catalogue(entry_of<F>(&arithmetic_named(ArithmeticTraits<typename F::scalar>::name, "")));
}

int main(int argc, char** argv) {
    add<Averaged<float>>(), add<Averaged<double>>();
    return study_main(argc, argv, {curve});
}
