// What random probes say of a running filter, beside the truth in 257 bits.
#include <rlslab/adapt/certified.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/variants/variants.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// Of the ten to use those that have a form(), and `conventional`, the last.
template <class T>
using Forms = TypeList<Symmetric<T>, JosephRankTwo<T>, Potter<T>, Carlson<T>, Ud<T>, UdDelta<T>, InverseQr<T>, Qr<T>,
                       Gentleman<T>, Conventional<T>>;

struct Rows {
    std::string kind;
    std::vector<double> psi;
    Seed seed;
    std::vector<std::vector<double>> kept = {};  // of the period
    Index k = 0;
    double y = 0;

    Rows(std::string kind_, Index d, Seed seed_) : kind(std::move(kind_)), psi(size_t(d)), seed(seed_) {}
    template <class T>
    void next(Vector<T>& row) {
        size_t const d = psi.size();
        double const common = seed.bell();
        for (size_t j = d; j-- > 0;) {
            double const own = seed.bell();
            psi[j] = kind == "common"  ? common + own / 64
                     : kind == "units" ? own * correctly::exp2(-10 * double(j) / double(d - 1))
                     : kind == "rest"  ? (k < 20 ? 0 : own)
                     : kind != "line"  ? own
                     : j > 0           ? psi[j - 1]
                                       : 0.95 * psi[0] + 0.3125 * own;
        }
        if (kind == "period" && k < 7) kept.push_back(psi);
        if (kind == "period") psi = kept[size_t(k % 7)];
        ++k;
        y = 0.01 * seed.bell();
        for (size_t j = 0; j < d; ++j) {
            row[Index(j)] = round_to<T>(psi[j]);
            y += static_cast<double>(row[Index(j)]);
        }
    }
};

template <class T>
Problem<T> problem_of(Trial const& trial) {
    return problem_as<T>({.size = Index(trial.number("size")),
                          .forgetting = trial.number("lambda"),
                          .prior = Prior<double>{.variance = 256}});
}
template <class T>
Stored<Reference> in_reference(Stored<T> const& stored) {
    return stored.template mapped<Reference>([](T const& x) { return widen(x); });
}

/// X = P^-1 and z = X theta of the same rows.
struct Exact {
    Matrix<Reference> X;
    Vector<Reference> z;
    Reference lambda;
    Exact(Index d, double forgetting)
        : X(Matrix<Reference>::Identity(d, d) / Reference(256)), z(Vector<Reference>::Zero(d)), lambda(forgetting) {}
    template <class T>
    void row(Vector<T> const& psi, T const& y) {
        for (Index j = 0; j < psi.size(); ++j) {
            for (Index i = 0; i <= j; ++i) X(i, j) = lambda * X(i, j) + widen(psi[i]) * widen(psi[j]);
            z[j] = lambda * z[j] + widen(psi[j]) * widen(y);
        }
    }
    /// ||Phat X - I||_F, infinite where Phat is not finite.
    double off(Stored<Reference> const& stored) const {
        Matrix<Reference> E = covariance_of(stored) * Matrix<Reference>(X.selfadjointView<Eigen::Upper>());
        E.diagonal().array() -= Reference(1);
        double const norm = frobenius(E);
        return std::isfinite(norm) ? norm : INFINITY;
    }
};

/// One check, at a row that the seed draws: from the first to the 200th, or the 3 d-th.
template <class T>
void check_once(Trial const& trial, TrialOutput& out) {
    Problem<T> const p = problem_of<T>(trial);
    Index const d = p.size;
    Seed seed = trial.seed({"arithmetic", "lambda", "size", "rows", "replicate"});
    auto const last = Index(correctly::exp(seed.uniform() * correctly::log(double(std::max<Index>(200, 3 * d)))));
    Seed const data{seed.next()};
    Exact exact(d, static_cast<double>(p.forgetting));
    Vector<T> psi(d);
    Rows rows(trial.text("rows"), d, data);
    for (Index k = 0; k < last; ++k) rows.next(psi), exact.row(psi, round_to<T>(rows.y));
    Vector<Reference> theta;
    if (d <= 16) theta = Matrix<Reference>(exact.X.selfadjointView<Eigen::Upper>()).partialPivLu().solve(exact.z);

    auto const taken = [&]<class F>(F f) {
        Rows again(trial.text("rows"), d, data);
        for (Index k = 0; k < last; ++k) again.next(psi), f.update(psi, round_to<T>(again.y));
        return f;
    };
    for_each(Forms<T>{}, [&]<class F>() {
        Certified<F> f = taken(Certified<F>(p, Seed{seed.next()}));
        Certificate<double> const found = f.certificate();
        Stored<Reference> const stored = in_reference(f.stored());
        std::string const name(F::name);
        out({"E", name, double(last), exact.off(stored), found.estimate, found.bound});
        if (found.definite && d <= 32)
            out({"definite", name, double(last), double(definiteness(stored) == Health::sound), 1.0, found.bound});
        if (found.definite && d <= 16) {
            Reference apart = 0, length = 0;
            for (Index j = 0; j < d; ++j) {
                Reference const mine = widen(T(f.theta()[j])), off = mine - theta[j];
                apart += off * off, length += mine * mine;
            }
            out({"theta", name, double(last), static_cast<double>(Reference(sqrt(Reference(apart / length)))), 0.0,
                 found.theta});
        }
    });
    if constexpr (std::same_as<T, double>) {  // D_j of `ud` doubled: an error of rank one
        if (d > 8) return;
        auto const flipped = [&]<int s>(std::integral_constant<int, s>) {
            for (int i = 0; i < 10; ++i) {
                Certified<Ud<T>, s> f = taken(Certified<Ud<T>, s>(p, Seed{seed.next()}));
                f.form().D[Index(seed.next() % std::uint64_t(d))] *= 2;
                Certificate<double> const found = f.certificate();
                out({"rank one", std::to_string(s), double(last), exact.off(in_reference(f.stored())), found.estimate,
                     found.bound});
            }
        };
        flipped(std::integral_constant<int, 1>{});
        flipped(std::integral_constant<int, 3>{});
        flipped(std::integral_constant<int, 6>{});
    }
}

/// The first row at which the bound is not below 1, `health` speaks, P is exactly indefinite.
template <class T>
void break_down(Trial const& trial, TrialOutput& out) {
    Problem<T> const p = problem_of<T>(trial);
    Seed seed = trial.seed({"arithmetic", "lambda", "size", "rows", "replicate"});
    Seed const data{seed.next()};
    auto const last = Index(std::lround(40 / (1 - trial.number("lambda"))));
    for_each(Forms<T>{}, [&]<class F>() {
        Certified<F> f(p, Seed{seed.next()});
        Rows rows(trial.text("rows"), p.size, data);
        Vector<T> psi(p.size);
        double bound = INFINITY, health = INFINITY, indefinite = INFINITY;
        for (Index k = 1; k <= last && !(std::isfinite(health) && std::isfinite(indefinite)); ++k) {
            rows.next(psi);
            if (f.update(psi, round_to<T>(rows.y)).health != Health::sound) health = std::min(health, double(k));
            if (!std::isfinite(bound) && !f.certificate().definite) bound = double(k);
            if (std::isfinite(indefinite)) continue;
            auto const stored = f.stored();
            if (!surely_positive(stored.template mapped<double>([](T const& x) { return static_cast<double>(x); })) &&
                definiteness(in_reference(stored)) != Health::sound)
                indefinite = double(k);
        }
        if (std::isfinite(health) || std::isfinite(indefinite))
            out({"breakdown", std::string(F::name), bound, health, indefinite, bound});
    });
}

/// 3000 rows of kappa 1, a check at each tenth: the greatest bound.
template <class T>
void stay_clean(Trial const& trial, TrialOutput& out) {
    Problem<T> const p = problem_of<T>(trial);
    Seed seed = trial.seed({"arithmetic", "lambda", "size", "rows", "replicate"});
    Seed const data{seed.next()};
    for_each(Forms<T>{}, [&]<class F>() {
        if (F::name == Conventional<T>::name) return;
        Certified<F> f(p, Seed{seed.next()});
        Rows rows("white", p.size, data);
        Vector<T> psi(p.size);
        double greatest = 0;
        for (Index k = 1; k <= 3000; ++k) {
            rows.next(psi), f.update(psi, round_to<T>(rows.y));
            if (k % 10 == 0) greatest = std::max(greatest, f.certificate().bound);
        }
        out({"clean", std::string(F::name), 3000.0, 0.0, 0.0, greatest});
    });
}

template <class T>
void measure_in(Trial const& trial, TrialOutput& out) {
    if (trial.text("part") == "check") check_once<T>(trial, out);
    if (trial.text("part") == "breakdown") break_down<T>(trial, out);
    if (trial.text("part") == "clean") stay_clean<T>(trial, out);
}

// --- judgements ------------------------------------------------------------------------------------------------------

std::vector<std::string> const shorter{"bfloat16", "binary16", "float"};

Selection of(char const* what) { return where("what", what); }
Selection of(char const* what, char const* arithmetic) { return of(what).where("arithmetic", arithmetic); }

using Hit = std::function<bool(double truth, double estimate, double bound)>;
size_t hits_in(Table const& t, Hit const& hit) {
    auto const truth = t.numbers("truth"), estimate = t.numbers("estimate"), bound = t.numbers("bound");
    size_t hits = 0;
    for (size_t i = 0; i < truth.size(); ++i) hits += hit(truth[i], estimate[i], bound[i]);
    return hits;
}
/// The share of rows of which `hit` is true lies in [from, to].
Judge share(Selection const& rows, Hit const& hit, double from, double to) {
    return rows.judged([=](Table const& t) { return proportion(hits_in(t, hit), t.rows().size(), from, to); });
}
/// No row is such: a count of this table.
Judge none(Selection const& rows, Hit const& hit) {
    return rows.judged([=](Table const& t) {
        size_t const hits = hits_in(t, hit);
        double greatest = 0;
        for (double const bound : t.numbers("bound")) greatest = std::max(greatest, bound);
        std::string const said = fmt::format("{} of {}; greatest {:.3g}", hits, t.rows().size(), greatest);
        return Judgement(hits == 0 && !t.empty(), said);
    });
}
bool bound_below(double truth, double, double bound) { return bound < truth; }
bool near(double truth, double estimate, double) { return truth / 2 <= estimate && estimate <= 2 * truth; }
bool lost(double, double, double bound) { return !(bound < 1); }
/// Of this many probes.
Judge near_of(double probes, double from, double to) {
    return share(of("rank one").where("variant", probes), near, from, to);
}
/// Rows from the bound to `health` of conventional in float.
Judge warns(double lambda, double from, double to) {
    return within(of("breakdown", "float").where("variant", "conventional").where("lambda", lambda), {"rows"},
                  number("truth") - number("bound"), from, to);
}
Selection broken(char const* how) {  // with a row at which it did
    return of("breakdown").where(how, [](double row) { return std::isfinite(row); });
}
Judge clean(Selection const& rows, double at) {
    return none(rows, [at](double, double, double bound) { return !(bound <= at); });
}
Basis const set_before = own_result("set before any run");
Basis const set_anew = own_result("set before any run; the bound was given its floor after the first");

}  // namespace

extern Study const certificate{
    .name = "certificate",
    .question = "Does a running filter know how wrong its P and theta are?",
    .source = "derived (docs/theory.md 125 to 127); Freivalds 1977 for products",
    .formula = R"tex(r_i = \hat P m_i - x_i = E x_i \qquad E = \hat P P^{-1} - I \qquad
                     P(10 \max_i \|r_i\| < \|E\|_F) \le 0.08^s)tex",
    .interpretation =
        "Three random probes in double beside each filter; the truth is computed in 257 bits. One check in each run, "
        "at a row that is drawn. The errors of rank one are a doubled D_j of ud. Breakdowns: the first rows at which "
        "the bound is not below 1, health speaks, P is exactly indefinite. In the first run 33 of 16800 bounds lay "
        "below the truth, whose size was that of the probes' own rounding; the bound has contained that since.",
    .data =
        "P0 = 256 I; white rows, delay lines of pole 0.95, rows with a common part 64 times their own, units from "
        "1 to 1/1024, a period of 7 rows, 20 zero rows first",
    .factors = {{"part", {"check", "breakdown", "clean"}},
                {"arithmetic", {"bfloat16", "binary16", "float", "double"}},
                {"lambda", {0.9, 0.98, 1.0}},
                {"size", {2.0, 4.0, 8.0, 16.0, 32.0, 128.0}, {2.0, 4.0, 8.0}},
                {"rows", {"white", "line", "common", "units", "period", "rest"}},
                {"replicate", counted(20), counted(11)}},
    .admits =
        [](Trial const& t) {
            double const d = t.number("size"), lambda = t.number("lambda");
            if (t.text("part") == "check")
                return t.number("replicate") <= (!t.full()    ? 1
                                                 : d <= 8     ? 6
                                                 : d == 16    ? 3
                                                 : d == 32    ? 2
                                                 : lambda < 1 ? 0
                                                              : 1);
            if (d != 4 || (t.text("rows") != "white" && t.text("rows") != "line")) return false;
            if (t.text("part") == "breakdown") return lambda < 1 && t.text("arithmetic") != "double";
            return lambda == 0.98 && t.text("rows") == "white" &&
                   (t.text("arithmetic") == "float" || t.text("arithmetic") == "double");
        },
    .measures = {"what", "variant", "row", "truth", "estimate", "bound"},
    .measure =
        [](Trial const& trial, TrialOutput& out) {
            std::string const& word = trial.text("arithmetic");
            if (word == "bfloat16") measure_in<BFloat16>(trial, out);
            if (word == "binary16") measure_in<Half>(trial, out);
            if (word == "float") measure_in<float>(trial, out);
            if (word == "double") measure_in<double>(trial, out);
        },
    .plots = {},
    // The last number of each: the probability that was given to "holds" before any run.
    .claims =
        {{"the bound lies below ||E||_F in at most 12 of 10^4 runs", share(of("E"), bound_below, 0, 12e-4), set_anew,
          0.95},
         {"it does so in at most 5 of 10^4: the stated risk", share(of("E"), bound_below, 0, 5e-4), set_anew, 0.75},
         {"errors of rank one, 1 probe: 57.2 % of the estimates within [0.5, 2], to 5", near_of(1, 0.522, 0.622),
          set_before, 0.93},
         {"of 3 probes 85.4 %, to 5", near_of(3, 0.804, 0.904), set_before, 0.93},
         {"of 6 probes 94.9 %, to 4", near_of(6, 0.909, 0.989), set_before, 0.93},
         {"errors as they come, words shorter than double: 88 to 99 %",
          share(of("E").where("arithmetic", shorter), near, 0.88, 0.99), set_before, 0.85},
         {"double, whose probes round as it does: 5 to 60 % of the estimates are more than twice the truth",
          share(
              of("E", "double"), [](double truth, double estimate, double) { return estimate > 2 * truth; }, 0.05, 0.6),
          set_before, 0.7},
         {"words shorter than double: the bound is at most 20 times the truth in 85 to 99 %",
          share(
              of("E").where("arithmetic", shorter),
              [](double truth, double, double bound) { return bound <= 20 * truth; }, 0.85, 0.99),
          set_before, 0.85},
         {"the bound of theta lies below its error in at most 12 of 10^4 runs",
          share(of("theta"), bound_below, 0, 12e-4), set_before, 0.9},
         {"theta's bound is 10 to 10^4 times its error in at least 70 %",
          share(
              of("theta"),
              [](double error, double, double bound) { return bound >= 10 * error && bound <= 1e4 * error; }, 0.7, 1),
          set_before, 0.6},
         {"where the bound is below 1, P is exactly definite but for 12 of 10^4 runs",
          share(
              of("definite"), [](double definite, double, double) { return definite != 1; }, 0, 12e-4),
          set_before, 0.93},
         {"bfloat16: the bound is not below 1 in 50 to 95 % of the runs", share(of("E", "bfloat16"), lost, 0.5, 0.95),
          set_before, 0.75},
         {"binary16: in 10 to 50 %", share(of("E", "binary16"), lost, 0.1, 0.5), set_before, 0.65},
         {"float: in fewer than 2 %", share(of("E", "float"), lost, 0, 0.02), set_before, 0.7},
         {"conventional in float, lambda 0.9: the bound speaks 15 to 45 rows before health, in the median",
          warns(0.9, 15, 45), set_before, 0.75},
         {"lambda 0.98: 75 to 230 rows before", warns(0.98, 75, 230), set_before, 0.7},
         {"all forms, words up to float: in no run does health speak before the bound",
          none(broken("truth"), [](double health, double, double bound) { return health < bound; }), set_before, 0.85},
         {"nor is P exactly indefinite before it",
          none(broken("estimate"), [](double, double indefinite, double bound) { return indefinite < bound; }),
          set_before, 0.85},
         {"clean rows: no bound above 10^-2", clean(of("clean"), 1e-2), set_before, 0.85},
         {"factor forms: none above 10^-3", clean(of("clean").where("variant", words(factor_forms())), 1e-3),
          set_before, 0.8},
         {"in double none above 10^-10", clean(of("clean", "double"), 1e-10), set_before, 0.85}}};

}  // namespace rlslab::studies
