// What a guard costs: operations of a row, counted.
#include "studies/adapt/watched.hpp"
#include <rlslab/studies/judgements.hpp>

namespace rlslab::studies {
namespace {

std::vector<std::string> const of_P{"conventional", "symmetric", "potter", "carlson", "ud", "inverse_qr"},
    looked_at_apart{"gentleman"};
Table of(Table const& t, std::vector<std::string> const& variants) {
    return t.where("variant", variants).where("policy", "report");
}

}  // namespace

extern Study const guard_cost;
Study const guard_cost{
    .name = "guard_cost",
    .question = "What does a guard cost?",
    .source = "derived (docs/theory.md 87)",
    .formula = R"tex(v d + O(1) \ \text{ where } P \text{ or a factor of it is stored}, \qquad
                     d + O(1) \ \text{ in } qr, \qquad d^2 + 5 d + O(1) \ \text{ in } gentleman)tex",
    .interpretation =
        "Operations of a row, additions and multiplications and divisions alike, on good rows with the guard armed. "
        "Where the update has a first step that changes nothing, e and s are its own, and a guard is O(1), one P_jj, "
        "or in qr theta once in d rows, beside a filter's d^2. In gentleman it substitutes psi once more at every row, "
        "for e and s. "
        "conventional breaks down by its asymmetry before it has seen the rows of d = 64. Nanoseconds stand in "
        "the bench.",
    .data = "white rows, d = 4 to 64",
    .factors =
        [](Budget) {
            std::vector<Cell> const variants(guarded_variants().begin(), guarded_variants().end());
            return std::vector<Factor>{{"variant", variants}, {"size", {4.0, 8.0, 16.0, 32.0, 64.0}}};
        },
    .measures = {"policy", "operations", "extra", "share"},
    .measure =
        [](Trial const& trial, TrialOutput& out) {
            double const bare = operations_of_a_row(trial.text("variant"), "none", Index(trial.number("size")));
            for (auto const& policy : guard_policies_by_name()) {
                double const all = operations_of_a_row(trial.text("variant"), policy, Index(trial.number("size")));
                if (all == all) out({policy, all, all - bare, (all - bare) / bare});
            }
        },
    .plots = {{.title = "Operations that a guard adds, over the filter's own",
               .x = "size",
               .y = "share",
               .x_label = "parameters d",
               .y_label = "added / own",
               .where = {{"policy", {"report"}}},
               .guides = {{"1 / d", [](double d) { return 1 / d; }}}}},
    .claims =
        {
            {"a guard adds to a row so many operations for each parameter: 0 where P is stored (conventional to d = "
             "16: then it breaks), 1 where a triangular root and in qr, 1.5 in ud, 2 in potter, to 0.1",
             [](Table const& t) {
                 auto const a_parameter = [&t](std::vector<std::string> const& variants, double v) {
                     return within(of(t, variants), {"variant"}, linear_slope("size", "extra").as(Estimate::fixed),
                                   v - 0.1, v + 0.1);
                 };
                 Table const whole = of(t, {"conventional"}).where("size", [](double d) { return d <= 16; });
                 return together({a_parameter({"symmetric"}, 0),
                                  within(whole, {}, linear_slope("size", "extra").as(Estimate::fixed), -0.1, 0.1),
                                  a_parameter({"carlson", "inverse_qr", "qr"}, 1), a_parameter({"ud"}, 1.5),
                                  a_parameter({"potter"}, 2)});
             },
             own_result("docs/theory.md 87")},
            {"at most 6 % of the filter's own from d = 16 on",
             [](Table const& t) {
                 Table const mine = of(t, of_P).where("size", [](double d) { return d >= 16; });
                 return within(mine, {"variant"}, greatest("share").as(Estimate::fixed), 0, 0.06);
             },
             own_result("set before the run: (1.5 (d + 1) + 14) / 3 d^2 in ud")},
            {"in gentleman, which is looked at apart: d^2 + 5 d, within 5 % at d = 64",
             [](Table const& t) {
                 Statistic const part([](Table const& g) { return mean("extra")(g) / (64 * 69); }, Estimate::fixed);
                 return within(of(t, looked_at_apart).where("size", 64.0), {"variant"}, part, 0.95, 1.05);
             },
             own_result("docs/theory.md 87")},
            {"which is 20 to 45 % of the filter's own",
             [](Table const& t) {
                 return within(of(t, looked_at_apart).where("size", 64.0), {"variant"},
                               mean("share").as(Estimate::fixed), 0.2, 0.45);
             },
             own_result("set before the run: 2.5 d^2 in gentleman")},
            {"on good rows policies that reset or rebuild take no operation more than one that reports, but in "
             "conventional, which breaks",
             [](Table const& t) {
                 std::vector<Judgement> parts;
                 for (auto const& [name, group] : t.groups({"variant", "size"})) {
                     if (name.starts_with("conventional")) continue;
                     double const report = group.where("policy", "report").number("operations");
                     for (std::string const policy : {"reset", "rebuild"})
                         parts.push_back(Judgement(group.where("policy", policy).number("operations") == report, name));
                 }
                 size_t held = 0;
                 for (Judgement const& part : parts) held += part.holds();
                 return Judgement(held == parts.size() && held > 0,
                                  std::to_string(held) + " of " + std::to_string(parts.size()));
             },
             verification("guard.hpp")},
        },
};

}  // namespace rlslab::studies
