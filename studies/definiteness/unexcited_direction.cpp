// A direction that no row excites: what P does there, in exact rationals.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {
namespace {

using namespace rationals;
constexpr Index d = 3;

/// Random rows orthogonal to v = (1, 2, 3), or to P0 v; row by row whether v'P_k v = lambda^-k v'P0 v.
template <class F>
void watch(Trial const& trial, TrialOutput& out) {
    Q const lambda = tenths(trial.number("lambda"));
    bool const spherical = trial.text("prior") == "c^2 I";
    M const P0 =
        spherical ? M(M::Identity(d, d) * Q(5)) : M{{Q(4), Q(1), Q(0)}, {Q(1), Q(3), Q(1)}, {Q(0), Q(1), Q(2)}};
    V const v{{1, 2, 3}}, normal = trial.text("rows") == "psi'v = 0" ? v : V(P0.lazyProduct(v));
    int const cases = trial.full() ? 100 : 10, steps = 12;
    std::vector<int> holds(steps + 1);
    Q variance = 0;  // of the first case, to draw
    std::vector<double> course;
    Seed seed = trial.seed({"lambda", "prior", "rows"});
    for (int n = 0; n < cases; ++n) {
        F filter({.size = d, .forgetting = lambda, .prior = Prior<Q>{.covariance = P0}});
        Q expected = form(v, P0);
        for (int k = 1; k <= steps; ++k) {
            V psi = integers(d, seed, 9);
            psi -= V(normal * Q(dot(psi, normal) / dot(normal, normal)));
            filter.update(psi, Q(0));
            expected /= lambda;
            variance = form(v, covariance(filter.stored()));
            holds[size_t(k)] += variance == expected;
            if (n == 0) course.push_back(static_cast<double>(variance / form(v, P0)));
        }
    }
    for (int k = 1; k <= steps; ++k) out({double(k), double(holds[size_t(k)]) / cases, course[size_t(k - 1)]});
}

void measure(Trial const& trial, TrialOutput& out) {
    for_each(Variants<Q>{}, [&]<class F>() {
        if (F::name == trial.text("variant")) watch<F>(trial, out);
    });
}

Table of(Table const& t, char const* prior, char const* rows) { return t.where("prior", prior).where("rows", rows); }

}  // namespace

extern Study const unexcited_direction;
Study const unexcited_direction{
    .name = "unexcited_direction",
    .question = "What becomes of P in a direction that no row excites?",
    .source = "derived (docs/theory.md 40; docs/literature.md 2, F15, first stated without the condition on P0)",
    .formula = R"tex(\psi_i^\top P_0 v = 0 \text{ for all } i \;\Longrightarrow\;
P_k v = \lambda^{-k} P_0 v, \quad v^\top P_k v = \lambda^{-k} v^\top P_0 v)tex",
    .interpretation =
        "The windup of forgetting without excitation, exactly: the variance grows by 1/lambda at every step and no "
        "information comes in. The condition is that rows are orthogonal to P0 v. With P0 = c^2 I that is "
        "orthogonality to v, which is how the law is usually stated; with any other P0 rows orthogonal to v still "
        "teach something about v through the prior's correlations, and the law fails at once.",
    .data = "random integer rows, d = 3",
    .factors =
        [](Budget) {
            std::vector<Cell> names;
            for_each(Variants<Q>{}, [&]<class F>() { names.emplace_back(std::string(F::name)); });
            return std::vector<Factor>{{"lambda", {1.0, 0.9}},
                                       {"prior", {"c^2 I", "full"}},
                                       {"rows", {"psi'v = 0", "psi'P0 v = 0"}},
                                       {"variant", names}};
        },
    .measures = {"steps", "share", "variance"},
    .measure = measure,
    .plots = {{.title = "v'P v over v'P0 v, full P0, λ = 0.9",
               .x = "steps",
               .y = "variance",
               .panel = "rows",
               .log = "y",
               .x_label = "rows",
               .y_label = "variance, 1 at the start",
               .where = {{"prior", {"full"}}, {"lambda", {"0.9"}}},
               .guides = {{"λ^-k", [](double k) { return correctly::pow(0.9, -k); }}}}},
    .claims =
        {
            {"psi'P0 v = 0: v'P_k v = lambda^-k v'P0 v with == after every row, for every P0 and variant",
             [](Table const& t) {
                 return within(t.where("rows", "psi'P0 v = 0"), {"prior", "lambda", "variant"}, least("share"), 1, 1);
             },
             verification("docs/theory.md 40")},
            {"psi'v = 0 is enough where P0 = c^2 I",
             [](Table const& t) {
                 return within(of(t, "c^2 I", "psi'v = 0"), {"lambda", "variant"}, least("share"), 1, 1);
             },
             verification("docs/theory.md 40")},
            {"and not enough with a full P0: after two rows the law holds in no case",
             [](Table const& t) {
                 Table const rows = of(t, "full", "psi'v = 0").where("steps", [](double k) { return k >= 2; });
                 return within(rows, {"lambda", "variant"}, greatest("share"), 0, 0);
             },
             verification("docs/theory.md 40")},
        },
};

}  // namespace rlslab::studies
