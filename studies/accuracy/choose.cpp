// The map: how many bits each variant needs, against the conditioning of the data.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/breakdown.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rlslab::studies {
namespace {

constexpr int shortest = 4, longest = 53;
constexpr double three_digits = 3;

/// Right decimal digits at the end, of theta and of P, whichever has fewer; 0 if P was indefinite at any of 32 looks.
double digits(CatalogueEntry const& entry, Problem<double> const& problem, Records const& records,
              CertifiedSolution const& exact) {
    auto const filter = entry.make(problem, Seed{1});
    Index const rows = records.rows(), stride = rows / 32;
    for (Index k = 0; k < rows; k += stride) {
        process_rows(*filter, records, k, std::min(k + stride, rows));
        if (breakdown(*filter, *entry.arithmetic) != Health::sound) return 0;
    }
    Errors const e = errors(*filter, exact);
    return std::max(0.0, -correctly::log10(std::max(e.theta, e.covariance)));
}

/// Rows of the deviations kappa^0 ... kappa^-1 along fixed random directions, with a prior that fits the widest of
/// them. Every variant is run on the same data with every length, from the longest down. The length needed is the least
/// one from which on all longer ones suffice.
void measure(Trial const& trial, TrialOutput& out) {
    double const lambda = trial.number("lambda"), kappa = trial.number("kappa");
    double const variance = trial.number("c2") * kappa * kappa;
    Index const size = Index(trial.number("d"));
    Index const rows = lambda == 1 ? 64 : trial.full() ? 2048 : 1024;  // few, or ten to twenty memories of 0.99
    Records given = graded(size, rows, kappa, trial.seed({"lambda", "kappa", "replicate"}));
    double const scale =
        lambda == 1 ? 8 : 32;  // about sqrt(rows): from singular values of all rows to deviations; exact
    given.psi *= scale, given.y *= scale;
    int const stride = trial.full() ? 1 : 2;
    std::vector<int> lengths;
    for (int p = longest; p >= shortest; p -= stride) lengths.push_back(p);
    std::map<std::string, std::vector<double>> kept;
    for (int const p : lengths) {
        PrecisionScope const precision(p);
        Arithmetic const& arithmetic = *variable_precision_catalogue().front().arithmetic;
        Problem<double> const problem =
            as_stored({.size = size, .forgetting = lambda, .prior = Prior<double>{.variance = variance}}, arithmetic);
        Records const records = as_stored(given, arithmetic);
        CertifiedSolution const exact = certified(problem, records, {rows}, 20).front();
        for (Cell const& form : row_forms()) {
            std::string const& name = std::get<std::string>(form);
            kept[name].push_back(
                digits(*find_entry(variable_precision_catalogue(), name, arithmetic.name), problem, records, exact));
        }
    }
    for (Cell const& name : row_forms()) {
        std::vector<double> const& of = kept[std::get<std::string>(name)];
        double needed = INFINITY, half = INFINITY;
        for (size_t i = 0; i < of.size() && of[i] >= three_digits; ++i) needed = lengths[i];
        for (size_t i = 0; i < of.size() && of[i] >= lengths[i] * correctly::log10(2) / 2; ++i) half = lengths[i];
        for (size_t i = of.size(); i-- > 0;)  // ascending, as a figure needs them
            out({std::get<std::string>(name), correctly::log2(kappa), double(lengths[i]), of[i],
                 std::min(1.0, of[i] / (lengths[i] * correctly::log10(2))), needed, half});
    }
}

/// From 2^8 on, where conditioning and not the memory decides, to the last kappa before one at which some run needs
/// more bits than there are: no run is left out for what it needs.
Selection steep(std::vector<std::string> const& variants, std::string const& column) {
    return [=](Table const& t) {
        Table const of = t.where("variant", variants).where("log2_kappa", at_least(8));
        std::vector<double> const x = of.numbers("log2_kappa"), bits = of.numbers(column);
        double end = INFINITY;
        for (size_t i = 0; i < x.size(); ++i)
            if (!(bits[i] <= longest)) end = std::min(end, x[i]);
        return of.where("log2_kappa", below(end));
    };
}
Judge bits_for_a_bit(std::vector<std::string> const& variants, std::string const& column, double from, double to,
                     std::vector<std::string> const& by = {"lambda"}) {
    return within(steep(variants, column), by, linear_slope("log2_kappa", column), from, to);
}
std::vector<std::string> const factors = words(factor_forms());
std::vector<std::string> const plain{"conventional_two_sided", "symmetric", "joseph_rank_two", "information"};

/// needed - slope log2 kappa over the same rows.
Judge offset(std::vector<std::string> const& variants, double slope_, double from, double to) {
    return within(
        steep(variants, "needed"), {"lambda", "variant"},
        [=](Table const& g) {
            std::vector<double> c = g.numbers("needed"), x = g.numbers("log2_kappa");
            for (size_t i = 0; i < c.size(); ++i) c[i] -= slope_ * x[i];
            return median(c);
        },
        from, to);
}

}  // namespace

extern Study const choose{
    .name = "choose",
    .question = "Which variant can be trusted with how many bits?",
    .source =
        "the orders kappa, kappa^2 and beyond: Golub & Wilkinson 1966, Björck 1967, part II (cited, not read), "
        "docs/literature.md 3.6, docs/theory.md 48; the map is measured here",
    .formula =
        R"tex(\begin{aligned} p &\approx \log_2\kappa + c && \text{factor forms} \\
               p &\approx 2\log_2\kappa + c && \text{P or its inverse stored plainly} \\
               p &\approx 3\log_2\kappa + c && \text{Joseph's products} \end{aligned})tex",
    .interpretation =
        "Each line is the shortest significand from which on a variant keeps three right digits of both theta and P "
        "and is never seen indefinite; below its line it is not to be trusted. kappa is the condition of the "
        "regressors, and P0 = kappa^2: the forms that store P pay for P0 (study backward_error). The factor forms pay "
        "one bit for each bit of kappa, the forms that store P or its inverse two, Joseph's products three: float's 24 "
        "bits serve a factor form to kappa = 10^5, symmetric to 10^3, joseph to a few hundred. At small kappa the "
        "lines are flat: there the memory decides, and the square roots of lambda cost the root forms three bits. With "
        "forgetting the conventional form ends at some step in any arithmetic; after these twenty memories it needs 43 "
        "bits even for kappa = 1. The cells show the share of an arithmetic's digits that is kept, 0 where P broke "
        "down.",
    .data = "graded rows, P0 = c2 kappa^2",
    .factors = {{"d", {4.0}},
                {"c2", {1.0}},
                {"lambda", {1.0, 0.99}},
                {"kappa", powers(2, 0, 20, 2)},
                {"replicate", counted(20), counted(11)}},
    .admits =
        [](Trial const& trial) { return trial.full() || trial.number("lambda") == 1 || trial.number("kappa") == 1; },
    .measures = {"variant", "log2_kappa", "bits", "digits", "kept", "needed", "half"},
    .measure = measure,
    .plots = {{.title = "Bits needed for three right digits",
               .x = "kappa",
               .y = "needed",
               .panel = "lambda",
               .log = "x",
               .x_label = "condition number kappa",
               .y_label = "bits of significand"},
              {.title = "Share of the digits kept, lambda = 0.99",
               .x = "log2_kappa",
               .y = "kept",
               .series = "bits",
               .panel = "variant",
               .log = "",
               .x_label = "log2 kappa",
               .y_label = "share of the digits kept",
               .where = {{"lambda", {"0.99"}},
                         {"variant", {"conventional", "symmetric", "joseph", "ud"}},
                         {"bits", {"5", "9", "13", "17", "21", "25", "29", "33", "37", "41", "45", "49", "53"}}},
               .cells = true},
              {.title = "Bits needed to keep half of the digits",
               .x = "kappa",
               .y = "half",
               .panel = "lambda",
               .log = "x",
               .x_label = "condition number kappa",
               .y_label = "bits of significand"}},
    .claims = {
        {"factor forms, taken together: 1.0 +- 0.15 bits for each bit of kappa",
         bits_for_a_bit(factors, "needed", 0.85, 1.15),
         own_result("set with the earlier experiment, docs/literature.md 3.6")},
        {"P or its inverse stored plainly: 2.0 +- 0.2 bits for each bit of kappa",
         bits_for_a_bit(plain, "needed", 1.8, 2.2, {"lambda", "variant"}),
         own_result("set with the earlier experiment, docs/literature.md 3.6")},
        {"Joseph's products: 2.7 to 3.1 bits for each bit of kappa", bits_for_a_bit({"joseph"}, "needed", 2.7, 3.1),
         own_result("set with the earlier experiment, docs/literature.md 3.6")},
        {"factor forms: log2 kappa + c with c from 6 to 11", offset(factors, 1, 6, 11),
         own_result("first edition, set after its run")},
        {"symmetric, conventional_two_sided, joseph_rank_two: 2 log2 kappa + c with c from 1 to 7",
         offset({"symmetric", "conventional_two_sided", "joseph_rank_two"}, 2, 1, 7),
         own_result("first edition, set after its run")},
        {"to keep half of the digits takes twice the slopes: 2.0 +- 0.3 (factor forms together)",
         bits_for_a_bit(factors, "half", 1.7, 2.3), own_result("twice the band of docs/literature.md 3.6")},
        {"and 4.0 +- 0.4 (symmetric, conventional_two_sided, joseph_rank_two together)",
         bits_for_a_bit({"symmetric", "conventional_two_sided", "joseph_rank_two"}, "half", 3.6, 4.4),
         own_result("twice the band of docs/literature.md 3.6")},
        {"with lambda = 0.99 conventional needs at least 10 bits more than symmetric even at kappa = 1, in most runs",
         within(where("lambda", 0.99).where("kappa", 1.0), {},
                (median("needed").on(where("variant", "conventional")) -
                 median("needed").on(where("variant", "symmetric")))
                    .as(Estimate::most),
                10, INFINITY),
         own_result("first edition, set after its run")}}};

}  // namespace rlslab::studies
