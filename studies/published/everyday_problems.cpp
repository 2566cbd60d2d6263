// On rows of the kinds that plants and tables leave: does compare name a form, and is that form near the best on
// another record of the same problem?
#include "studies/published/naming.hpp"

#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

using namespace naming;

/// Why none is named, in a word; "" where one is.
std::string reason(std::optional<Comparison> const& c) {
    if (!c) return "rank";
    compare::Recommendation const& r = c->recommendations.front();
    if (!r.variant.empty()) return "";
    if (r.why.find("prior") != r.why.npos) return "prior";
    if (r.why.find("P0") != r.why.npos || r.why.find("range") != r.why.npos) return "range";
    if (r.why.find("broke") != r.why.npos) return "broken";
    return r.why.find("half a digit of P") != r.why.npos ? "P" : "digits";
}

/// The form that one record names, judged by that record and by another, both in their own order.
void measure(Trial const& trial, TrialOutput& out) {
    Seed seed = trial.seed({"problem"});
    DrawnProblem const p = everyday_problem(Index(trial.number("problem")), Seed{seed.next()});
    Seed const rows{seed.next()}, noise{seed.next()}, other_rows{seed.next()}, other_noise{seed.next()};
    std::uint64_t const orders = seed.next(), other_orders = seed.next();
    auto const record = compared(realisation(p, rows, noise), p, orders);
    std::string const named = named_in(record), why = reason(record);
    auto const judge = [&](char const* evidence, std::optional<Comparison> const& by) {
        double const none = std::nan("");
        std::optional<Losses> losses;
        if (by) losses.emplace(*by);
        bool const judged = named != "none" && losses && !losses->sound.empty();
        auto const of = [&](std::string const& form) { return judged ? in_tenths(losses->of(form)) : none; };
        int draws = 0;
        if (by)
            for (compare::Result const& r : by->results) draws = std::max(draws, r.runs);
        out({p.word, p.kind, evidence, double(p.size), double(p.rows), p.regressors, p.noise, p.forgetting, p.prior,
             named, why.empty() ? "named" : why, double(judged), double(draws), of(named), of("ud"), of("ud_delta"),
             of("gentleman")});
    };
    judge("itself", record);
    if (named != "none") judge("other", compared(realisation(p, other_rows, other_noise), p, other_orders));
}

// --- claims ----------------------------------------------------------------------------------------------------------

Selection const itself = where("evidence", "itself"), others = where("evidence", "other").where("judged", 1.0),
                named_counts = itself.where("kind", "counts")
                                   .where("lambda", 1.0)
                                   .where("word", "double")
                                   .where("judged", 1.0)
                                   .where("prior", "proposed");
Statistic const names_information =
    Statistic([](Table const& x) { return double(x.where("named", "information").rows().size()); }, Estimate::share)
        .over("problem");
Basis const goal = own_result("issue 44's goal; set before the run");

}  // namespace

extern Study const everyday_problems{
    .name = "everyday_problems",
    .question = "On records of the kinds that people have, is the form that compare names near the best?",
    .source =
        "the rules of docs/compare.md; the distribution is that of studies/published/drawn_problem.hpp, the second",
    .formula =
        R"tex(\text{loss}_v = \max_m (\max_w \text{digits}_m(w) - \text{digits}_m(v)),\quad m = \theta, \theta_{\text{worst}}, P)tex",
    .interpretation =
        "A plant that rests when the filter is switched on, rows that repeat, whole numbers, columns in natural units, "
        "several changes of theta, a column that is constant for long. A record names a form, in its own order of "
        "rows; another record of the problem judges it, in its own order too. Both take as many draws of the "
        "roundings as compare takes.",
    .data = "1000 problems of six kinds, in float and double; 24 at the quick budget",
    .factors = {{"problem", counted(1000), counted(24)}},
    .measures = {"word", "kind", "evidence", "d", "N", "regressors", "noise", "lambda", "prior", "named", "why",
                 "judged", "draws", "loss", "ud", "ud_delta", "gentleman"},
    .measure = measure,
    .plots = {},
    .claims = {{"compare names a form in at least 80 % of these problems",
                within(itself, {}, share("judged", is_one), 0.8, 1), goal},
               {"on another record that form is within half a digit of the best in at least 93 %",
                in_band(others, share("loss", is_half_a_digit), 0.93, 1), goal},
               {"and within a digit in at least 97 %", in_band(others, share("loss", is_a_digit), 0.97, 1),
                own_result("as in study random_problems; set before the run")},
               {"and it breaks down in at most 1 %", in_band(others, share("loss", is_infinite), 0, 0.01),
                own_result("as in study random_problems; set before the run")},
               {"not less often than gentleman always, in each kind",
                in_band(others, more_often_than("gentleman"), 0, 1, {"kind"}), goal},
               {"not less often than ud_delta always, in each kind",
                in_band(others, more_often_than("ud_delta"), 0, 1, {"kind"}), goal},
               {"counts, lambda = 1, double: information is named in at least 60 %",
                in_band(named_counts, names_information, 0.6, 1),
                own_result("the sums are exact there; set before the run")}}};

}  // namespace rlslab::studies
