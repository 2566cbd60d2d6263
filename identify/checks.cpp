// Roots and gains with their uncertainty; warnings with their remedies.
#include "identify/checks.hpp"
#include "identify/structure.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/model/lags.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

using Point = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;

/// A root of z^n p_0 + ... + p_n, and d root / d theta where theta_i is the coefficient p_(at[i]); at[i] < 0: not one of them.
struct Root {
    Point value;
    ComplexVector gradient;
    double apart;  ///< half the distance to the next root
};

/// z^n by products alone.
Point power(Point z, int n) {
    Point out = 1;
    for (int i = 0; i < n; ++i) out *= z;
    return out;
}

std::vector<Root> roots_of(std::vector<double> const& p, std::vector<int> const& at, std::vector<Point> const& values) {
    int const n = int(p.size()) - 1;
    std::vector<Root> out;
    for (size_t r = 0; r < values.size(); ++r) {
        Point const z = values[r];
        Point slope = 0;
        for (int i = 0; i < n; ++i) slope = slope * z + double(n - i) * p[size_t(i)];
        ComplexVector gradient = ComplexVector::Zero(Index(at.size()));
        for (size_t i = 0; i < at.size(); ++i)
            if (at[i] >= 0) gradient[Index(i)] = -power(z, n - at[i]) / slope;  // (1)
        double apart = INFINITY;
        for (size_t s = 0; s < values.size(); ++s)
            if (s != r) apart = std::min(apart, std::abs(values[s] - z) / 2);
        out.push_back({z, std::move(gradient), apart});
    }
    return out;
}

/// cov of (re, im) for a gradient: [rr ri; ri ii].
struct Spread {
    double rr = 0, ri = 0, ii = 0;
    double sd() const { return std::sqrt(rr + ii); }
};
Spread spread(ComplexVector const& g, Estimation const& e) {
    Spread out;
    Index const d = e.sd.size();
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) {
            if (g[i] == 0.0 || g[j] == 0.0) continue;
            double const c = e.sd[i] * e.correlation(i, j) * e.sd[j];
            out.rr += g[i].real() * c * g[j].real(), out.ri += g[i].real() * c * g[j].imag(), out.ii += g[i].imag() * c * g[j].imag();
        }
    return out;
}

/// (3) in the quantile's units: q, and the degrees of freedom.
std::pair<double, double> distance(Point delta, Spread const& S, bool real) {
    if (real) return {delta.real() * delta.real() / S.rr, 1};
    double const det = S.rr * S.ii - S.ri * S.ri;
    if (!(det > 1e-12 * (S.rr + S.ii) * (S.rr + S.ii))) return {std::norm(delta) / (S.rr + S.ii), 1};  // they move along a line
    return {(delta.real() * delta.real() * S.ii - 2 * delta.real() * delta.imag() * S.ri + delta.imag() * delta.imag() * S.rr) / det, 2};
}

struct Pair {
    size_t pole;
    Point zero;
    double q, sd;
};

/// For each pole at most one zero, nearest (by q) first.
std::vector<Pair> paired(std::vector<Root> const& poles, std::vector<Root> const& zeros, Estimation const& e, double confidence) {
    struct Candidate {
        size_t pole, zero;
        double q, sd;
    };
    std::vector<Candidate> all;
    for (size_t i = 0; i < poles.size(); ++i)
        for (size_t j = 0; j < zeros.size(); ++j) {
            Root const &p = poles[i], &z = zeros[j];
            bool const real = p.value.imag() == 0;
            if (real != (z.value.imag() == 0) || p.value.imag() < 0 || z.value.imag() < 0) continue;
            if (!(spread(p.gradient, e).sd() < p.apart && spread(z.gradient, e).sd() < z.apart)) continue;
            Spread const S = spread(ComplexVector(p.gradient - z.gradient), e);  // (2)
            auto const [q, freedom] = distance(p.value - z.value, S, real);
            if (correctly::chi_squared_tail(freedom, q) >= 1 - confidence) all.push_back({i, j, q, S.sd()});
        }
    std::ranges::stable_sort(all, {}, &Candidate::q);
    std::vector<Pair> out;
    std::vector<bool> taken(zeros.size(), false);
    for (Candidate const& c : all)
        if (!taken[c.zero] && std::ranges::none_of(out, [&](Pair const& p) { return p.pole == c.pole; }))
            taken[c.zero] = true, out.push_back({c.pole, zeros[c.zero].value, c.q, c.sd});
    return out;
}

std::string text(Point z) {
    return z.imag() == 0 ? fmt::format("{:.4g}", z.real()) : fmt::format("{:.4g} +- {:.4g}i", z.real(), std::abs(z.imag()));
}

}  // namespace

/// A coefficient of more standard deviations than this divides the others to first order.
constexpr double surely = 3;

std::vector<Cancellation> cancellations(DifferenceEquation const& model, std::vector<Term> const& terms, Estimation const& estimation,
                                        double confidence) {
    std::vector<double> a{1};
    a.insert(a.end(), model.a.begin(), model.a.end());
    std::vector<int> at;
    for (Term const& t : terms) at.push_back(t.input == -1 ? t.lag : -1);
    std::vector<Root> const ps = roots_of(a, at, poles(model));
    std::vector<std::vector<Pair>> pairs;
    for (size_t j = 0; j < model.b.size(); ++j) {
        std::vector<double> b = model.b[j];
        int const lead = int(std::ranges::find_if(b, [](double x) { return x != 0; }) - b.begin());
        b.erase(b.begin(), b.begin() + lead);
        bool leads = true;  // a first coefficient that may be 0 puts a zero anywhere: none is judged by its sd
        for (size_t i = 0; i < terms.size(); ++i) {
            at[i] = terms[i].input == int(j) ? terms[i].lag - model.delay - lead : -1;
            if (at[i] == 0 && !(std::abs(b[0]) > surely * estimation.sd[Index(i)])) leads = false;
        }
        if (!leads) b.clear();
        pairs.push_back(paired(ps, b.empty() ? std::vector<Root>{} : roots_of(b, at, zeros(model, j)), estimation, confidence));
    }
    std::vector<Cancellation> out;
    for (Pair const& first : pairs.empty() ? std::vector<Pair>{} : pairs[0]) {
        auto const cancels = [&](std::vector<Pair> const& of) {
            return std::ranges::any_of(of, [&](Pair const& p) { return p.pole == first.pole; });
        };
        Point const p = ps[first.pole].value;
        if (std::ranges::all_of(pairs, cancels)) out.push_back({p, first.zero, std::abs(p - first.zero), first.sd});
    }
    return out;
}

std::pair<double, double> gain_of(DifferenceEquation const& model, std::vector<Term> const& terms, Estimation const& e, size_t input,
                                  double t) {
    double A = 1, B = 0;
    for (double const x : model.a) A += x;
    for (double const x : model.b[input]) B += x;
    ComplexVector of_A = ComplexVector::Zero(Index(terms.size())), of_gain = of_A;
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input == -1) of_A[Index(i)] = 1, of_gain[Index(i)] = -B / A / A;
        if (terms[i].input == int(input)) of_gain[Index(i)] = 1 / A;
    }
    if (!(std::abs(A) > t * spread(of_A, e).sd())) return {std::nan(""), std::nan("")};
    return {B / A, spread(of_gain, e).sd()};
}

int idle_lead(std::vector<Term> const& terms, std::vector<Parameter> const& parameters, int input) {
    int idle = 0, all = 0;
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input != input) continue;
        idle += idle == all && parameters[i].lower <= 0 && 0 <= parameters[i].upper;
        ++all;
    }
    return idle == all ? 0 : idle;
}

double normal_quantile(double p) { return correctly::student_quantile(1e9, p); }

namespace {

using Rank = Remark::Rank;

/// "--delay 0,15": those in use but for one input.
std::string delay_option(IdentifyOptions const& o, int input, Index delay) {
    std::vector<Index> all(o.delay.begin(), o.delay.end());
    all[size_t(input)] = delay;
    return fmt::format("--delay {}", fmt::join(all, ","));
}

/// "a higher order", in the options of this structure.
std::string more_terms(Identified const& m) {
    IdentifyOptions const& o = m.options;
    bool const below = !m.choice.fits.empty() && m.order < m.choice.fits.back().order;  // orders above it were tried
    return !o.regressors.empty() ? "more lags among the --regressors"
           : o.na                ? "a higher --na or --nb"
           : o.order             ? fmt::format("--order {}", std::min(200, 2 * o.order))
           : below               ? fmt::format("--order {}", m.order + 1)
                                 : fmt::format("--max-order {}", std::min(200, 2 * o.max_order));
}

/// What to do depends on the order that is left: chosen by its criterion, the larger one is better than a smaller one whose residuals are
/// white.
void advise_of_cancellations(Identified& m, bool chosen) {
    if (m.cancellations.empty()) return;
    std::vector<std::string> pairs;
    int lower = m.order;
    for (Cancellation const& c : m.cancellations) {
        pairs.push_back(fmt::format("pole {} and zero {} (distance {:.2g}, sd {:.2g})", text(c.pole), text(c.zero), c.distance, c.sd));
        lower -= c.pole.imag() == 0 ? 1 : 2;
    }
    std::string const apart = fmt::format("the record cannot tell apart {}", fmt::join(pairs, ", "));
    auto const fit = std::ranges::find(m.choice.fits, lower, &OrderFit::order);
    if (fit == m.choice.fits.end())
        m.remarks.push_back({Rank::structure,
                             apart + ": if they cancel, fewer terms do as well: lower --na and --nb, or leave regressors out, and see "
                                     "whether the residuals stay white",
                             "fewer terms"});
    else if (!(fit->ljung_box >= white_level))
        m.remarks.push_back(
            {Rank::structure,
             fmt::format("keep order {}: {}, and what may cancel models the noise, for order {} alone leaves residuals that are not white",
                         m.order, apart, lower),
             "", true});
    else if (!chosen && lower > 0)
        m.remarks.push_back(
            {Rank::structure,
             fmt::format("{0}: they may cancel, and the residuals of order {1} pass for white, too: --order {1}", apart, lower),
             fmt::format("--order {}", lower)});
}

void advise_of_outliers(Identified& m) {
    for (Outlier const& o : m.outliers) {
        std::string const row = o.line == o.row ? fmt::format("row {}", o.row) : fmt::format("row {} (line {})", o.row, o.line);
        bool const rules = o.share > 0.1;  // what the others say hardly counts
        m.remarks.push_back(
            {rules ? Rank::outlier : Rank::structure,
             fmt::format(
                 "{} is {:.2g} standard deviations off what the model predicts{}: it alone has {:.3g} % of the sum of squares{}. {}"
                 "If it is wrong, or a row just before it, empty that cell, and it is skipped; --guard reset leaves such rows out as they "
                 "come",
                 row, o.deviations, o.held_out ? ", in the part held out" : "", 100 * o.share, o.held_out ? " there" : "",
                 !rules       ? ""
                 : o.held_out ? "The held-out fit says little. "
                              : "Do not believe the estimate, nor that residuals pass for white. "),
             fmt::format("look at {}{}", row, m.tracked ? "" : "; --guard reset leaves it out")});
    }
}

void advise_of_residuals(Identified& m) {
    IdentifyOptions const& o = m.options;
    if (o.forgetting != 1) {
        if (!m.ljung_box.white())
            m.remarks.push_back(
                {Rank::whiteness,
                 "judge by the held-out fit: with forgetting the residuals are those of the last theta over all rows, and need not be "
                 "white",
                 "", true});
        return;
    }
    for (Followed const& f : m.followed) {
        std::string const name = printable(o.inputs[size_t(f.input)]);
        Index first = largest_lag, last = 0;
        for (Term const& t : m.terms)
            if (t.input == f.input) first = std::min<Index>(first, t.lag), last = std::max<Index>(last, t.lag);
        bool const late = o.regressors.empty() && (f.begins < first || f.begins > last);
        std::string const remedy = late ? delay_option(o, f.input, f.begins) : more_terms(m);
        m.remarks.push_back(
            {late ? Rank::delay : Rank::order,
             fmt::format(
                 "the residuals follow past {}: correlation {:.2g} at lag {}, where those of independent ones stay within {:.2g}: the "
                 "estimate is biased, and its standard deviations do not hold. {}: {}",
                 name, f.correlation, f.lag, f.bound,
                 late ? fmt::format("{} acts from lag {} on{}", name, f.begins,
                                    f.begins == 0 && first > 0
                                        ? ", or it is made from the output of the same row (a controller: then no delay "
                                          "is missing, and least squares is biased)"
                                        : "")
                      : "More of its past is needed, or the system is not linear",
                 remedy),
             remedy});
    }
    if (m.ljung_box.white()) return;
    bool const past_outputs = std::ranges::any_of(m.terms, [](Term const& t) { return t.input == -1; });
    m.remarks.push_back(
        {Rank::whiteness,
         fmt::format(
             "the residuals are not white (p = {:.2g}): {}{}; if the system drifts: --forgetting 0.99", m.ljung_box.p,
             past_outputs ? "with past outputs in the model the estimate is biased, and its standard deviations do not hold"
                          : "the standard deviations of the estimate do not hold",
             m.followed.empty() && !o.inputs.empty()
                 ? fmt::format("; they do not follow the inputs up to lag {}: the noise has dynamics of its own (a higher order or na "
                               "takes it up), an input is missing (a further column of the file?), or one acts later (--delay)",
                               m.ljung_box.lags)
                 : ""),
         more_terms(m)});
}

/// A warning is given if the one-step errors of the held-out part are more than this times those of the fitted one, both by root mean
/// square and as a part of y's spread. (Where y wanders its spread is another in each part.)
constexpr double falls_by = 1.5;

void advise_of_held_out(Identified& m) {
    std::string const change = "look at the record where the held-out part begins; --forgetting 0.99 if the system drifts";
    if (m.held_out_one_step < 0)
        m.remarks.push_back(
            {Rank::held_out,
             fmt::format("held out, the model predicts worse than the mean of y ({}): do not use it there. The last part differs from the "
                         "first, or the order is too high: look at the record, try a lower --order, another --validate, --forgetting 0.99",
                         std::isfinite(m.held_out_one_step) ? fmt::format("{:.3g} %", m.held_out_one_step) : "y does not change there"),
             change});
    else if (m.held_out_simulated < 0)
        m.remarks.push_back(
            {Rank::held_out,
             fmt::format("held out, the model simulates worse than the mean of y ({}), though it predicts one step: use it for prediction "
                         "only; for simulation try another order, or remove a drift of y",
                         std::isfinite(m.held_out_simulated) ? fmt::format("{:.3g} %", m.held_out_simulated)
                                                             : "the simulation grows beyond all numbers"),
             "use it for prediction only"});
    else if (100 - m.held_out_one_step > falls_by * (100 - m.fit_one_step) && m.held_out_error > falls_by * m.fit_error)
        m.remarks.push_back({Rank::held_out,
                             fmt::format("one step ahead the error rises from {:.3g} % of y's spread to {:.3g} % held out: the system or "
                                         "its level changed, or the order is too high",
                                         100 - m.fit_one_step, 100 - m.held_out_one_step),
                             change});
}

}  // namespace

void advise(Identified& m, int most) {
    IdentifyOptions const& o = m.options;
    bool const chosen = !structure_given(o), at_limit = chosen && m.order == most;
    if (at_limit && most == o.max_order)
        m.remarks.push_back({Rank::order,
                             fmt::format("order {} is the largest that was tried: a higher one may be better: {}", m.order, more_terms(m)),
                             more_terms(m)});
    else if (at_limit)
        m.remarks.push_back(
            {Rank::order,
             fmt::format("order {} is the largest that this input supports: a richer input would show whether a higher one is better",
                         m.order),
             "a richer input"});
    if (!m.choice.fits.empty() && m.choice.bic == 0 && o.forgetting == 1)
        m.remarks.push_back(
            {Rank::nothing,
             fmt::format("BIC says 0: {}",
                         m.choice.static_p < improvement_level
                             ? "the past of y and of the inputs predicts nothing that the present input does not: no dynamics"
                             : "nothing here is predicted by the inputs or the past of y"),
             m.choice.static_p < improvement_level ? "--na 0 --nb 0" : "another input, or another output"});
    if (m.failure) return;
    advise_of_outliers(m);
    advise_of_residuals(m);
    advise_of_held_out(m);
    if (std::ranges::any_of(m.poles, [](Point p) { return std::abs(p) >= 1; }))
        m.remarks.push_back(
            {Rank::structure,
             "a pole lies on or outside the unit circle: simulation grows. If the system is stable, y drifts or the order is too high",
             "a lower order, if the system is stable"});
    for (size_t j = 0; j < o.inputs.size() && o.regressors.empty(); ++j)
        if (int const idle = idle_lead(m.terms, m.parameters, int(j)); idle > 0) {
            std::string const option = delay_option(o, int(j), o.delay[j] + idle);
            m.remarks.push_back(
                {Rank::delay,
                 fmt::format("the first {} of {} cannot be told from 0: the delay may be longer: {}",
                             idle == 1 ? "coefficient" : fmt::format("{} coefficients", idle), printable(o.inputs[j]), option),
                 option, true});
        }
    advise_of_cancellations(m, chosen);
}

}  // namespace rlslab::identify
