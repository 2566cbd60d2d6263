// Rows that repeat: roundings average over distinct rows to nearest, over all rows at random.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/carlson_delta.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <set>

namespace rlslab::studies {
namespace {

using Word = VariablePrecision;
double in_word(double x) { return nearest_in(PrecisionScope::format(), x); }

Matrix<Quad> narrow(Matrix<Reference> const& wide) {
    return wide.unaryExpr([](Reference const& x) { return Quad(static_cast<double>(x)); });
}

/// ||Phat - P||_F / ||P||_F, and (tr Phat - tr P) / tr P; in Quad, as in half_power.hpp.
struct Off {
    double norm, trace;
    Off(Matrix<Quad> const& Phat, Matrix<Quad> const& P)
        : norm(double((Phat - P).norm() / P.norm())), trace(double((Phat - P).trace() / P.trace())) {}
};

// --- every cycle of a short word -------------------------------------------------------------------------------------

/// The one number that a form of one parameter stores, and P of it.
template <class F>
auto& number_of(F& f) {
    if constexpr (requires { f.form().D; }) return f.form().D[0];
    else return *f.form().S.column(0);
}
template <class F>
double covariance_of_one(double x) {
    return F::family.kind == Family::ud ? x : x * x;
}

/// d = 1, rows of period 1 or 2, every row up to powers of two, every start within a factor of 4 of P: the worst cycle.
template <class F>
void every_cycle(Trial const& trial, TrialOutput& out) {
    int const p = int(trial.number("word")), shift = 53 - p;
    double const m = trial.number("memory"), lambda = 1 - 1 / m, u = std::ldexp(1.0, -p);
    F f({.size = 1, .forgetting = Word(lambda), .prior = Prior<Word>{.variance = Word(1)}});
    std::uint64_t const ones = std::uint64_t{1} << (p - 1);
    auto const row = [&](std::uint64_t i) { return 1 + double(i) / double(ones); };
    for (bool const two : {false, true}) {
        if (two && p > (trial.full() ? 8 : 6)) continue;
        double worst = 0, longest = 0;
        for (std::uint64_t a = 0; a < ones; ++a)
            for (std::uint64_t b = 0; b < (two ? ones : 1); ++b) {
                double const x = row(a), y = row(b);
                double const M = two ? (lambda * x * x + y * y) / (1 - lambda * lambda) : x * x / (1 - lambda),
                             P = 1 / M;
                bool const whole = F::family.kind == Family::ud;
                double const low = in_word(whole ? P / 4 : std::sqrt(P) / 2);
                std::uint64_t const base = detail::bits_of(low) >> shift, states = (whole ? 4 : 2) * ones;
                std::vector<int> seen(states, 0);  // the start from which it was first met
                for (std::uint64_t start = 0; start < states; ++start) {
                    std::uint64_t at = start;
                    auto const next = [&] {
                        number_of(f) = Word(detail::from_bits((at + base) << shift));
                        f.update(std::vector{Word(x)}, Word(0));
                        if (two) f.update(std::vector{Word(y)}, Word(0));
                        at = std::clamp((detail::bits_of(double(number_of(f))) >> shift), base, base + states - 1) -
                             base;
                    };
                    for (; seen[at] == 0; next()) seen[at] = int(start) + 1;
                    if (seen[at] != int(start) + 1) continue;
                    double length = 0;
                    std::uint64_t const first = at;
                    do {
                        double const stored = covariance_of_one<F>(detail::from_bits((at + base) << shift));
                        worst = std::max(worst, detail::magnitude(stored / P - 1) / u);
                        ++length, next();
                    } while (at != first);
                    longest = std::max(longest, length);
                }
            }
        out({std::string(F::name), two ? 2.0 : 1.0, worst, m, worst / m, 0.0, longest});
    }
}

/// d = 2, period 2: rows (1, a) and (b, 1), a and b all multiples of 1/16 in [-1, 1], from P = I.
template <class F>
void cycles_of_two(Trial const& trial, TrialOutput& out) {
    double const m = trial.number("memory"), lambda = 1 - 1 / m, u = std::ldexp(1.0, -int(trial.number("word")));
    double worst = 0, longest = 0;
    for (int a = -16; a <= 16; ++a)
        for (int b = -16; b <= 16; ++b) {
            if (std::abs(a * b) == 256) continue;
            Eigen::Matrix2d rows{{1.0, a / 16.0}, {b / 16.0, 1.0}};
            Matrix<Quad> const one = rows.row(0).cast<Quad>(), two = rows.row(1).cast<Quad>();
            Matrix<Quad> const P = Quad(1 - lambda * lambda) *
                                   Matrix<Quad>(one.transpose() * one * Quad(lambda) + two.transpose() * two).inverse();
            F f({.size = 2, .forgetting = Word(lambda), .prior = Prior<Word>{.variance = Word(1)}});
            auto const period = [&] {
                for (int i = 0; i < 2; ++i) f.update(std::vector{Word(rows(i, 0)), Word(rows(i, 1))}, Word(0));
            };
            auto const numbers = [&] {
                auto const stored = f.stored();
                std::vector<double> all{double(stored.F(0, 1))};
                for (Index j = 0; j < 2; ++j) all.push_back(double(stored.D.size() ? stored.D[j] : stored.F(j, j)));
                return all;
            };
            std::set<std::vector<double>> met;
            while (met.insert(numbers()).second) period();
            std::vector<double> const first = numbers();
            double length = 0, error = 0;
            do {
                auto const stored = f.stored().template mapped<Reference>([](Word const& x) { return widen(x); });
                error = std::max(error, Off(narrow(covariance_of(stored)), P).norm / u), ++length, period();
            } while (numbers() != first);
            worst = std::max(worst, error), longest = std::max(longest, length);
        }
    out({std::string(F::name), 2.0, worst, m, worst / m, 0.0, longest});
}

// --- runs ------------------------------------------------------------------------------------------------------------

/// Rows of a kind, and how many of them are distinct.
struct Rows {
    Eigen::MatrixXd psi;
    double distinct = INFINITY;
    Rows(std::string const& kind, Index d, Index count, Seed seed) : psi(d, count) {
        Index period = count;
        bool const shuffled = kind == "shuffled 16", periodic = shuffled || kind.starts_with("period");
        if (periodic) period = std::stoi(kind.substr(kind.find(' ')));
        if (kind == "phasors") period = 20;
        if (kind == "prbs") period = 63;
        if (kind == "means") period = d;
        if (kind == "constant") period = 1;
        double const constant = 1 + seed.uniform();
        std::vector<double> bits{1, -1, 1, 1, -1, -1};  // x^6 + x^5 + 1
        while (bits.size() < 63 + size_t(d)) bits.push_back(-bits[bits.size() - 6] * bits[bits.size() - 5]);
        for (Index k = 0; k < std::min(period, count); ++k)
            for (Index i = 0; i < d; ++i) {
                double const angle = 6.283185307179586 / 20 * double((i / 2 * 2 + 1) * k);
                psi(i, k) = in_word(kind == "phasors"    ? (i % 2 ? correctly::sin(angle) : correctly::cos(angle))
                                    : kind == "prbs"     ? bits[size_t(k + d - 1 - i)]
                                    : kind == "means"    ? double(i == 0 || i == k)
                                    : kind == "constant" ? constant
                                                         : seed.bell());
            }
        std::vector<Index> order(size_t(period), 0);
        for (Index i = 0; i < period; ++i) order[size_t(i)] = i;
        Eigen::MatrixXd const first = psi.leftCols(std::min(period, count));
        for (Index k = period; k < count; ++k) {
            if (shuffled && k % period == 0)
                for (size_t i = size_t(period); i > 1; --i) std::swap(order[i - 1], order[seed.next() % i]);
            psi.col(k) = first.col(order[size_t(k % period)]);
        }
        if (!shuffled && kind != "white") distinct = kind == "phasors" ? 10 : double(period);  // row k + 10 is -row k
    }
};

/// P of `ud_delta` in words to nearest, D and U stored with a dither: uniform in a unit, or one bit a row, +-1/4 unit.
struct Dithered {
    bool bit;
    Seed seed;
    Word lambda;
    Matrix<Word> U;
    Vector<Word> D;

    Dithered(bool bit_, Index d, double lambda_, Seed seed_)
        : bit(bit_), seed(seed_), lambda(lambda_), U(Matrix<Word>::Identity(d, d)), D(Vector<Word>::Ones(d)) {}
    void take(auto const& psi) {
        Index const d = D.size();
        Word const worn = (Word(1) - lambda) / lambda;
        double const of_row = (seed.next() & 1) != 0 ? 0.25 : -0.25;
        auto const stored = [&](Word const& a, Word const& b) {
            int e = 0;
            double const x = double(a) - double(b);
            std::frexp(x, &e);
            return Word(x + (bit ? of_row : seed.uniform() - 0.5) * std::ldexp(1.0, e - PrecisionScope::bits()));
        };
        Vector<Word> v = Vector<Word>::Zero(d);
        Word before = lambda;
        for (Index j = 0; j < d; ++j) {
            Word f = Word(psi[j]);
            for (Index i = 0; i < j; ++i) f += U(i, j) * Word(psi[i]);
            Word const g = D[j] * f, x = f * g, after = before + x, h = (x - worn * before) / after, mu = f / before;
            D[j] = h > Word(0.5) ? D[j] * (before / after) / lambda : stored(D[j], D[j] * h);
            for (Index i = 0; i < j; ++i) {
                Word const old = U(i, j);
                U(i, j) = stored(old, v[i] * mu);
                v[i] += old * g;
            }
            v[j] = g, before = after;
        }
    }
    Matrix<Quad> covariance() const {
        auto const wide = [](Word const& x) { return Quad(double(x)); };
        Matrix<Quad> const T = U.unaryExpr(wide);
        return T * D.unaryExpr(wide).asDiagonal() * T.transpose();
    }
};

/// c u m / sqrt(min(T, 2 m)) to nearest, c sqrt(2) u sqrt(m / 2) at random, over u: docs/theory.md 91, 135 to 137.
double law(std::string const& form, std::string const& kind, bool nearest, double distinct, double m, double P) {
    double const c = (form.starts_with("carlson") ? 2 : 1) * 0.4247;
    int e = 0;
    if (kind == "constant" && nearest) return m / (2 * std::frexp(P, &e));
    return c * m * (nearest ? 1 / std::sqrt(std::min(distinct, 2 * m)) : 1 / std::sqrt(m));
}

void run(Trial const& trial, TrialOutput& out) {
    int const p = int(trial.number("word"));
    std::string const &kind = trial.text("rows"), &rounding = trial.text("rounding");
    bool const nearest = rounding == "nearest", dither = rounding == "dither" || rounding == "bit";
    PrecisionScope const scope(
        RunTimeFormat{{p, -126, 127}, rounding == "stochastic" ? Rounding::stochastic : Rounding::nearest});
    double const lambda = in_word(1 - 1 / trial.number("memory")), m = 1 / (1 - lambda), u = std::ldexp(1.0, -p);
    auto const d = Index(trial.number("d"));
    Index const count = Index(m * (rounding == "stochastic" && d > 1 ? 6 : 0.6931 * p + 1.5));
    Rows const rows(kind, d, count, trial.seed({"rows", "word", "memory", "d", "replicate"}));
    Matrix<Quad> const psi = rows.psi.cast<Quad>();
    Matrix<Quad> M = Matrix<Quad>::Identity(d, d);
    for (Index k = 0; k < count; ++k) M = Quad(lambda) * M + psi.col(k) * psi.col(k).transpose();
    Matrix<Quad> const P = M.inverse();
    auto const report = [&](std::string const& form, Matrix<Quad> const& Phat) {
        Off const off(Phat, P);
        double const by_law = law(form, kind, nearest, rows.distinct, m, double(P(0, 0)));
        out({form, rows.distinct, off.norm / u, by_law, off.norm / u / by_law, off.trace / u / by_law, 0.0});
    };
    Seed draws = trial.seed({"rows", "word", "memory", "d", "replicate", "rounding"});
    if (dither) {
        Dithered f(rounding == "bit", d, lambda, Seed{draws.next()});
        for (Index k = 0; k < count; ++k) f.take(rows.psi.col(k));
        return report("ud_delta", f.covariance());
    }
    Records const records{.psi = rows.psi, .y = Vector<double>::Zero(count), .names = {}};
    Problem<double> const problem{.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = 1}};
    for (std::string const form : {"ud_delta", "carlson_delta", "ud", "carlson"}) {
        auto const& any = variable_precision_catalogue();
        CatalogueEntry const& entry =
            p == 24 && nearest ? trial.entry(form, "float") : *find_entry(any, form, any.front().arithmetic->name);
        auto const filter = entry.make(problem, Seed{draws.next()});
        filter->update_block(records, 0, count);
        report(form, narrow(covariance_of(filter->stored())));
    }
    if (p != 14 || kind != "period 4" || !nearest) return;
    CertifiedSolution const exact = certified(problem, records, {count}, 12).front();
    Stored<Reference> const mine{Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain,
                                 P.unaryExpr([](Quad const& x) { return widen(x); })};
    out({"reference", rows.distinct, error_of(exact.covariance_digits(mine)), 0.0, 0.0, 0.0, 0.0});
}

void measure(Trial const& trial, TrialOutput& out) {
    if (trial.text("rows") != "every row") return run(trial, out);
    PrecisionScope const scope(int(trial.number("word")));
    auto const each = [&]<template <class, int> class... F>() {
        if (trial.number("d") == 1) (every_cycle<F<Word, 1>>(trial, out), ...);
        else (cycles_of_two<F<Word, 2>>(trial, out), ...);
    };
    each.template operator()<UdDelta, CarlsonDelta, Ud, Carlson>();
}

// --- claims ----------------------------------------------------------------------------------------------------------

using Words = std::vector<std::string>;
Selection of(char const* form, char const* rounding) { return where("form", form).where("rounding", rounding); }
Selection cycles(double period, double d) {
    return of("ud_delta", "nearest").where("rows", "every row").where("period", period).where("d", d);
}
/// The geometric mean of a column over a seed's rows.
Statistic geometric(std::string column) {
    return [=](Table const& t) {
        double sum = 0;
        std::vector<double> const all = t.numbers(column);
        for (double const x : all) sum += correctly::log(x);
        return correctly::exp(sum / double(all.size()));
    };
}
Statistic const over_law = geometric("ratio");
/// `of` the rows that `column` calls `one`, over that of those called `other`.
Statistic between_cells(std::string column, char const* one, char const* other, char const* of = "error") {
    return geometric(of).on(where(column, one)) / geometric(of).on(where(column, other));
}
Selection of_form(char const* form) { return where("form", form); }
Words const repeated{"period 4", "period 16", "period 64", "period 256"}, met{"phasors", "prbs", "means"},
    awake{"period 4", "period 16", "period 64", "period 256", "phasors", "prbs", "means", "white"};
Selection const at_random = of("ud_delta", "stochastic").where("rows", awake);
/// Up to four parameters: a period of four rows does not determine eight.
Selection determined(Selection const& rows) { return rows.where("d", below(8)); }
Words const dithered{"period 4", "phasors", "prbs"};
Basis const set_after = own_result("set after the first runs");
Basis const set_before = own_result("docs/theory.md 91, 135 to 137; set before any run of this study");
Basis const set_before_seen =
    own_result("docs/theory.md 91, 135 to 137; set before any run of this study, after measurements on white rows");

}  // namespace

extern Study const distinct_rows{
    .name = "distinct_rows",
    .question = "How much of P is lost where rows repeat, and does rounding at random cure it?",
    .source = "derived (docs/theory.md 91, 135 to 137)",
    .formula = R"tex(\frac{\|\delta P\|}{\|P\|} = \frac{c\,u\,m}{\sqrt{\min(T, 2m)}} \text{ (nearest)}, \qquad
c\sqrt2\,u\sqrt{m/2} \text{ (at random)}, \qquad m = \frac{1}{1-\lambda})tex",
    .interpretation =
        "What failed: one random bit a row leaves a third to two thirds of the error to nearest and is no cure; rows "
        "in a new order each period are one at a memory of 1000, and not at 10000; two rows in two parameters err by "
        "up to 4.1 u m; a PRBS errs as a constant does, by u m over a significand, because every square in it is 1. A "
        "deviation: period 4 was run with 8 parameters too, which it does not determine. Bands are missed by that "
        "alone, and three of them are judged again without it. Seen: rounding to nearest loses the law's u m / sqrt(T) "
        "on white rows, phasors and means of groups. Stochastic rounding, or a uniform dither of one unit where D and "
        "U are stored, leaves c u sqrt(m) on each of these. So it is better where fewer than m rows are distinct, and "
        "costs sqrt(2) on others by the guide (seen: medians 1.0 to 1.8 times). carlson drifts under it: its root of "
        "lambda is rounded once. Phasors, PRBS and means are fixed rows: to nearest each is one run, and an interval "
        "has no width.",
    .data =
        "white rows that repeat, 50 Hz phasors at 20 samples a period, PRBS of period 63, means of groups, a constant, "
        "white rows; P0 = I; after ln(1/u) + 1.5 memories, stochastically 6; every row: cycles in 6 to 11 bits",
    .factors = {{"rows",
                 {"every row", "period 4", "period 16", "period 64", "period 256", "shuffled 16", "phasors", "prbs",
                  "means", "constant", "white"}},
                {"word", {6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 14.0, 24.0}},
                {"memory", {8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 100.0, 1000.0, 10000.0}},
                {"d", {1.0, 2.0, 4.0, 8.0}},
                {"rounding", {"nearest", "stochastic", "dither", "bit"}},
                {"replicate", counted(20), counted(11)}},
    .admits =
        [](Trial const& t) {
            double const p = t.number("word"), m = t.number("memory"), d = t.number("d");
            std::string const &kind = t.text("rows"), &rounding = t.text("rounding");
            if (kind == "every row")  // u m = 1/8
                return m == std::ldexp(1.0, int(p) - 3) && p <= (t.full() ? 11 : 8) && d <= 2 && (d == 1 || p <= 8) &&
                       rounding == "nearest" && t.number("replicate") == 1;
            if (p < 11 || m * std::ldexp(1.0, -int(p)) > 0.07 || (m != 100 && m != 1000 && m != 10000)) return false;
            if (!t.full() && (m == 10000 || d == 8)) return false;
            if ((kind == "constant") != (d == 1)) return false;
            if (rounding == "dither" || rounding == "bit")
                return p == 24 && (d == 1 || (d == 4 && (kind == "period 4" || kind == "phasors" || kind == "prbs")));
            return d == 1 || d == 4 || (m == 1000 ? p == 24 : m == 100 && p == 11);
        },
    .measures = {"form", "period", "error", "law", "ratio", "trace", "cycle"},
    .measure = measure,
    .plots = {{.title = "Error of P over u, white rows that repeat",
               .x = "period",
               .y = "error",
               .series = "form",
               .panel = "rounding",
               .x_label = "distinct rows",
               .y_label = "relative error of P / u",
               .where = {{"rows", repeated}, {"memory", {"1000"}}, {"word", {"24"}}, {"d", {"4"}}}}},
    // The last number of each: the probability that was given to "holds" before any run.
    .claims = {
        {"P in Quad lies within 1e-10 of the certified one",
         within(of_form("reference"), {}, greatest("error"), 0, 1e-10), verification("u of double, times m"), 0.97},
        {"one parameter, one row, 8 bits and more: the worst cycle of ud_delta errs by 0.85 to 1.35 u m",
         within(cycles(1, 1).where("word", at_least(8)), {"word"}, greatest("ratio").as(Estimate::fixed), 0.85, 1.35),
         set_before, 0.65},
        {"two rows, one parameter or two: by 0.5 to 1.5 u m",
         within(cycles(2, 1), {"word"}, greatest("ratio").as(Estimate::fixed), 0.5, 1.5) &&
             within(cycles(2, 2), {"word"}, greatest("ratio").as(Estimate::fixed), 0.5, 1.5),
         set_before, 0.6},
        {"a constant row: ud_delta errs by 0.9 to 1.1 times u m over the significand of P",
         within(of("ud_delta", "nearest").where("rows", "constant"), {"word", "memory"}, over_law, 0.9, 1.1),
         set_before, 0.75},
        {"white rows of period 4, 16, 64, 256, to nearest: ud_delta has 0.5 to 1.5 times its law, the mean over "
         "settings",
         within(of("ud_delta", "nearest").where("rows", repeated), {"rows"}, over_law, 0.5, 1.5), set_before_seen,
         0.65},
        {"phasors, PRBS, means of groups, to nearest: 0.4 to 1.6 times",
         within(of("ud_delta", "nearest").where("rows", met), {"rows"}, over_law, 0.4, 1.6), set_before, 0.4},
        {"stochastic rounding: ud_delta has 0.5 to 1.6 times its law, whatever rows but a constant",
         within(at_random, {"rows"}, root_mean_square("ratio"), 0.5, 1.6), set_before, 0.55},
        {"there the trace of P errs by -0.1 to 0.1 times the law, the mean over rows and settings",
         within(at_random, {}, Statistic(mean("trace")).as(Estimate::mean), -0.1, 0.1), set_before, 0.75},
        {"stochastic rounding: ud errs by 1.3 to 2.3 times what ud_delta does",
         within(where("rounding", "stochastic").where("rows", awake), {"memory"},
                between_cells("form", "ud", "ud_delta"), 1.3, 2.3),
         set_before, 0.6},
        {"24 bits, the longest memory: carlson, whose root of lambda is rounded once, at least 5 times what "
         "carlson_delta does",
         within(
             where("rounding", "stochastic").where("rows", awake).where("word", 24.0).where("memory", at_least(1000)),
             {}, between_cells("form", "carlson", "carlson_delta"), 5, INFINITY),
         set_before, 0.7},
        {"24 bits, memories of 1000 and more, to nearest: 16 rows in an order that is drawn anew each period err "
         "by 0.6 to 1.6 times what rows without repetition do",
         within(of("ud_delta", "nearest").where("word", 24.0).where("memory", at_least(1000)), {"memory"},
                between_cells("rows", "shuffled 16", "white"), 0.6, 1.6),
         set_before, 0.55},
        {"period 4, phasors, PRBS: with one random bit a row, +-1/4 unit, ud_delta has 0.4 to 1.8 times the law of "
         "stochastic rounding",
         within(of("ud_delta", "bit").where("rows", dithered), {"rows"}, root_mean_square("ratio"), 0.4, 1.8),
         set_before, 0.55},
        {"a constant row: that bit leaves 0.4 to 0.6 of the error to nearest",
         within(of_form("ud_delta").where("rows", "constant").where("word", 24.0), {"memory"},
                between_cells("rounding", "bit", "nearest"), 0.4, 0.6),
         set_before, 0.7},
        {"to nearest over stochastically, period 4 to 256: 0.6 to 1.5 times sqrt(m / min(T, 2 m))",
         within(of_form("ud_delta").where("rows", repeated), {"memory"},
                between_cells("rounding", "nearest", "stochastic", "ratio"), 0.6, 1.5),
         set_before_seen, 0.6},
        {"rows that determine each parameter, to nearest: ud_delta has 0.5 to 1.5 times its law at each period of "
         "white rows",
         within(determined(of("ud_delta", "nearest").where("rows", repeated)), {"rows"}, over_law, 0.5, 1.5),
         set_after},
        {"such rows, stochastically: 0.5 to 1.6 times its law, and a mean error of the trace of -0.1 to 0.1",
         within(determined(at_random), {"rows"}, root_mean_square("ratio"), 0.5, 1.6) &&
             within(determined(at_random), {}, Statistic(mean("trace")).as(Estimate::mean), -0.1, 0.1),
         set_after},
        {"period 4, phasors, PRBS: a uniform dither of one unit leaves 0.4 to 1.6 times the law of stochastic "
         "rounding",
         within(of("ud_delta", "dither").where("rows", dithered), {"rows"}, root_mean_square("ratio"), 0.4, 1.6),
         set_after},
        {"there one random bit a row leaves 0.3 to 0.8 of the error to nearest",
         within(of_form("ud_delta").where("rows", dithered).where("word", 24.0).where("d", 4.0), {"rows"},
                between_cells("rounding", "bit", "nearest"), 0.3, 0.8),
         set_after}}};

}  // namespace rlslab::studies
