// Random stable systems, identified from simulated records: are the parameters found, and do the intervals have their
// coverage?
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/model/difference.hpp>
#include <rlslab/model/fit.hpp>

namespace rlslab::studies {
namespace {

void measure(Trial const& trial, TrialOutput& out) {
    int const number = int(trial.number("system")), order = 1 + number % 6;
    Seed seed = trial.seed({"system"});
    DifferenceEquation const model = random_stable(order, seed);
    Index const N = 2000;
    Signal const u = prbs(11, N);
    Signal xi = white_noise(N, trial.seed({"system", "noise"}));
    for (double& x : xi) x *= trial.number("noise");
    Signal const y = simulate(model, {u}, xi);
    Records const records = arx_records(u, y, arx_of_order(order));
    Vector<double> truth(records.parameters());
    for (int i = 0; i < order; ++i) truth[i] = model.a[size_t(i)];
    for (int i = 0; i <= order; ++i) truth[order + i] = model.b[0][size_t(i)];
    Fit const batch = fit(records);
    double inside = 0;
    for (Index i = 0; i < truth.size(); ++i) inside += batch.lower[i] <= truth[i] && truth[i] <= batch.upper[i];
    for (Cell const& variant : joined(factor_forms(), {"symmetric", "information"})) {
        auto const filter =
            trial.entry(std::get<std::string>(variant))
                .make({.size = records.parameters(), .prior = Prior<double>{.variance = 0x1p60}}, Seed{1});
        filter->update_block(records, 0, records.rows());
        Vector<Reference> const theta = filter->theta();
        Reference off = 0, size = 0;
        for (Index i = 0; i < truth.size(); ++i) {
            off += (theta[i] - truth[i]) * (theta[i] - truth[i]);
            size += Reference(truth[i]) * truth[i];
        }
        out({double(order), variant, static_cast<double>(sqrt(off / size)), inside / double(truth.size())});
    }
}

}  // namespace

extern Study const known_systems;
Study const known_systems{
    .name = "known_systems",
    .question = "Do known systems come back from their records?",
    .source = "docs/theory.md 1, 4, 6, 8",
    .formula = R"tex(y_k + a_1 y_{k-1} + \dots + a_n y_{k-n} = b_0 u_k + \dots + b_n u_{k-n} + \xi_k)tex",
    .interpretation =
        "Two hundred random stable systems of order 1 to 6 driven by a PRBS, each identified at its order. Without "
        "noise the parameters come back to the arithmetic and the conditioning of the record; with it the estimate's "
        "own 95 % intervals hold the true values 95 % of the time.",
    .data = "random stable systems of order 1 to 6, PRBS input",
    .factors =
        [](Budget budget) {
            return std::vector<Factor>{{"system", counted(budget == Budget::full ? 200 : 120)}, {"noise", {0.0, 0.1}}};
        },
    .measures = {"order", "variant", "error", "inside"},
    .measure = measure,
    .plots = {{.title = "Error of theta",
               .x = "order",
               .y = "error",
               .panel = "noise",
               .log = "y",
               .x_label = "order",
               .y_label = "relative error of theta"}},
    .claims =
        {
            {"without noise, ten digits by every factor form, of most systems",
             [](Table const& t) {
                 std::vector<std::string> names;
                 for (Cell const& v : factor_forms()) names.push_back(std::get<std::string>(v));
                 return within(t.where("noise", 0.0).where("variant", names), {"variant"},
                               greatest("error").over("system"), 0, 1e-10);
             },
             own_result("first edition, set after its run")},
            {"with noise, the 95 % intervals hold the truth 95 +- 2 % of the time",
             [](Table const& t) {
                 return within(t.where("noise", 0.1).where("variant", "ud"), {},
                               mean("inside").as(Estimate::share).over("system"), 0.93, 0.97);
             },
             reproduction("docs/theory.md 8")},
        },
};

}  // namespace rlslab::studies
