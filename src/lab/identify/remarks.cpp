// Conditions and sentences.
#include "src/lab/identify/estimate.hpp"

#include "src/lab/identify/text.hpp"

#include <rlslab/model/lags.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {

int idle_lead(std::vector<Term> const& terms, std::vector<Parameter> const& parameters, int input) {
    int idle = 0, all = 0;
    for (size_t i = 0; i < terms.size(); ++i) {
        if (terms[i].input != input) continue;
        idle += idle == all && parameters[i].lower <= 0 && 0 <= parameters[i].upper;
        ++all;
    }
    return idle == all ? 0 : idle;
}

namespace {

using Rank = Remark::Rank;
using Point = std::complex<double>;

// --- words -----------------------------------------------------------------------------------------------------------

std::string text(Point z) {
    return z.imag() == 0 ? fmt::format("{:.4g}", z.real())
                         : fmt::format("{:.4g} +- {:.4g}i", z.real(), std::abs(z.imag()));
}

/// "--delay 0,15": the delays in use, with another one for this input.
std::string delay_option(IdentifyOptions const& o, int input, Index delay) {
    std::vector<Index> all(o.delay.begin(), o.delay.end());
    all[size_t(input)] = delay;
    return fmt::format("--delay {}", fmt::join(all, ","));
}

/// "a higher order", in the options of this structure.
std::string more_terms(Identified const& m) {
    IdentifyOptions const& o = m.options;
    bool const below = !m.choice.fits.empty() && m.order < m.choice.fits.back().order;  // higher orders were fitted
    return !o.regressors.empty() ? "more lags among the --regressors"
           : o.na    ? (o.inputs.empty() ? fmt::format("--na {}", std::min(200, 2 * *o.na)) : "a higher --na or --nb")
           : o.order ? fmt::format("--order {}", std::min(200, 2 * o.order))
           : below   ? fmt::format("--order {}", m.order + 1)
                     : fmt::format("--max-order {}", std::min(200, 2 * o.max_order));
}

// --- the first remark of each list that applies ----------------------------------------------------------------------

using Model = Identified const&;
using Remarks = std::vector<Remark>;

void remark_on_order(Remarks& out, Model m) {
    if (m.largest_order == 0 || m.order != m.largest_order) return;
    if (m.order == m.options.max_order)
        remark(out, Rank::order, more_terms(m),
               "order {} is the largest that was tried: a higher one may be better: {}", m.order, more_terms(m));
    else
        remark(out, Rank::order, "a richer input",
               "order {} is the largest that this input supports: a richer input would show whether a higher one "
               "is better",
               m.order);
}

void remark_on_dynamics(Remarks& out, Model m) {
    if (m.choice.fits.empty() || m.choice.bic != 0 || m.options.forgetting != 1) return;
    if (m.choice.static_p < improvement_level)
        remark(out, Rank::nothing, "--na 0 --nb 0",
               "BIC says 0: the past of y and of the inputs predicts nothing that the present input does not: no "
               "dynamics");
    else if (m.options.inputs.empty())
        remark(out, Rank::nothing, "--input, a column that acts on it",
               "BIC says 0: the past of {0} predicts nothing of {0}", printable(m.options.output));
    else
        remark(out, Rank::nothing, "another input, or another output",
               "BIC says 0: nothing here is predicted by the inputs or the past of y");
}

void remark_on_whiteness(Remarks& out, Model m) {
    bool const inputs = !m.options.inputs.empty(), follow = !m.past_inputs.empty();
    if (m.ljung_box.white()) return;
    if (m.options.forgetting != 1) {
        remark(
            out, Rank::whiteness, "",
            "judge by the held-out fit: with forgetting the residuals are those of the last theta over all rows, and "
            "need not be white");
        out.back().hint = true;
        return;
    }
    bool const past_outputs = std::ranges::any_of(m.terms, [](Term const& t) { return t.input == -1; });
    remark(
        out, Rank::whiteness,
        m.noise_model && m.noise_model->ljung_box.white() ? ""
        : m.cure.empty()                                  ? more_terms(m)
                                                          : m.cure,
        "the residuals are not white (p = {:.2g}): {}{}{}{}; if the system drifts: --forgetting 0.99", m.ljung_box.p,
        past_outputs ? "with past outputs in the model the estimate is biased, and its standard deviations do not hold"
                     : "the standard deviations of the estimate do not hold",
        !follow && inputs
            ? fmt::format("; they do not follow the inputs up to lag {}: the noise has dynamics of its own (a higher "
                          "order or na takes it up), an input is missing (a further column of the file?), or one acts "
                          "later (--delay)",
                          m.ljung_box.lags)
            : "",
        // What estimates without bias where the noise has dynamics of its own.
        past_outputs && !follow ? "; --noise-model estimates the noise's dynamics, too" : "",
        past_outputs && !follow && inputs ? ", and --instruments does without them" : "");
}

/// Where the CUSUM of squares is farthest off, or else where the CUSUM crosses its line.
void remark_on_constancy(Remarks& out, Model m) {
    Constancy const& c = m.constancy;
    bool const cusum = c.cusum.surely, squares = c.squares.surely;
    if (m.options.forgetting != 1 || !(cusum || squares)) return;
    remark(out, Rank::constancy, m.tracked ? "" : "--window or --forgetting 0.99",
           "the parameters{} changed around {}: {} of the recursive residuals leave{} the 1 % line: --window or "
           "--forgetting follow them",
           cusum ? "" : ", or the noise,",
           Clock(m.options).row_text(c.row(squares ? c.squares.farthest : *c.cusum.crosses)),
           cusum && squares ? "the sums and the squares"
           : cusum          ? "the sum"
                            : "the squares",
           cusum && !squares ? "s" : "");
}

/// The one-step errors of the held-out part may be this many times those of the fitted one, both by root mean square
/// and as a part of y's spread. (If y wanders, its spread differs between the parts.)
constexpr double falls_by = 1.5;

void remark_on_held_out(Remarks& out, Model m) {
    auto const fit_or = [](double fit, char const* otherwise) {
        return std::isfinite(fit) ? fmt::format("{:.3g} %", fit) : otherwise;
    };
    char const* const look =
        "look at the record where the held-out part begins; --forgetting 0.99 if the system drifts";
    double const missed = 100 - m.held_out_one_step, missed_before = 100 - m.fit_one_step;
    bool const errors_rise = m.held_out_error > falls_by * m.fit_error;
    if (m.held_out_one_step == -INFINITY && !errors_rise)  // a percentage of no spread is none
        remark(out, Rank::held_out, "another --validate",
               "held out, y does not change there: a fit in percent says nothing. The one-step error is {:.3g} there, "
               "{:.3g} in the fitted part: another --validate holds out rows in which y changes",
               m.held_out_error, m.fit_error);
    else if (m.held_out_one_step < 0)
        remark(out, Rank::held_out, look,
               "held out, the model predicts worse than the mean of y ({}): do not use it there. The last part differs "
               "from the first, or the order is too high: look at the record, try a lower --order, another --validate, "
               "--forgetting 0.99",
               fit_or(m.held_out_one_step, "y does not change there"));
    else if (m.held_out_simulated < 0)
        remark(out, Rank::held_out, "use it for prediction only",
               "held out, the model simulates worse than the mean of y ({}), though it predicts one step: use it for "
               "prediction only; for simulation try another order, or remove a drift of y",
               fit_or(m.held_out_simulated, "the simulation grows beyond all numbers"));
    else if (missed > falls_by * missed_before && errors_rise)
        remark(
            out, Rank::held_out, look,
            "one step ahead the error rises from {:.3g} % of y's spread to {:.3g} % held out: the system or its level "
            "changed, or the order is too high",
            missed_before, missed);
}

void remark_on_poles(Remarks& out, Model m) {
    if (std::ranges::any_of(m.poles, [](Point p) { return std::abs(p) >= 1; }))
        remark(out, Rank::structure, "a lower order, if the system is stable",
               "a pole lies on or outside the unit circle: simulation grows. If the system is stable, y drifts or the "
               "order is too high");
}

// --- one remark for each object --------------------------------------------------------------------------------------

Remark remark_on(Outlier const& o, Model m) {
    bool const guarded = m.options.composition.policy().intervenes();
    return {o.dominates() ? Rank::outlier : Rank::structure, sentence_on(o, guarded),
            fmt::format("look at {}{}", row_text(o), guarded ? "" : "; if it is wrong, empty that cell and run again")};
}

Remark remark_on(PastInput const& p, Model m) {
    IdentifyOptions const& o = m.options;
    std::string const name = printable(o.inputs[size_t(p.input)]);
    Index first = largest_lag, last = 0;
    for (Term const& t : m.terms)
        if (t.input == p.input) first = std::min<Index>(first, t.lag), last = std::max<Index>(last, t.lag);
    bool const late = o.regressors.empty() && (p.first_lag < first || p.first_lag > last);
    std::string const remedy = late ? delay_option(o, p.input, p.first_lag) : more_terms(m),
                      controller = p.first_lag == 0 && first > 0
                                       ? ", or it is made from the output of the same row (a controller: then no "
                                         "delay is missing, and least squares is biased)"
                                       : "",
                      cause = late ? fmt::format("{} acts from lag {} on{}", name, p.first_lag, controller)
                                   : "More of its past is needed, or the system is not linear";
    return {late ? Rank::delay : Rank::order,
            fmt::format("the residuals follow past {}: correlation {:.2g} at lag {}, where those of independent ones "
                        "stay within {:.2g}: the estimate is biased, and its standard deviations do not hold. {}: {}",
                        name, p.correlation, p.lag, p.bound, cause, remedy),
            remedy};
}

Remark remark_on_delay(int input, int idle, Model m) {
    std::string const option = delay_option(m.options, input, m.options.delay[size_t(input)] + idle);
    return {Rank::delay,
            fmt::format("0 is possible for the first {} of {}: the delay may be longer: {}",
                        idle == 1 ? "coefficient" : fmt::format("{} coefficients", idle),
                        printable(m.options.inputs[size_t(input)]), option),
            option, true};
}

/// What to do depends on the order without the pairs. A chosen order has a better criterion than a lower one with white
/// residuals: nothing is said of it.
void remark_on_cancellations(Remarks& out, Model m) {
    if (m.cancellations.empty()) return;
    std::vector<std::string> pairs;
    int lower = m.order;
    for (Cancellation const& c : m.cancellations) {
        pairs.push_back(fmt::format("pole {} and zero {} (distance {:.2g}, sd {:.2g})", text(c.pole), text(c.zero),
                                    c.distance, c.sd));
        lower -= c.pole.imag() == 0 ? 1 : 2;
    }
    std::string const finding = fmt::format("the record cannot tell apart {}", fmt::join(pairs, ", "));
    auto const fit = std::ranges::find(m.choice.fits, lower, &OrderFit::order);
    if (fit == m.choice.fits.end())
        remark(
            out, Rank::structure, "fewer terms",
            "{}: if they cancel, fewer terms do as well: lower --na and --nb, or leave regressors out, and see whether "
            "the residuals stay white",
            finding);
    else if (!(fit->ljung_box >= white_level)) {
        remark(
            out, Rank::structure, "",
            "keep order {0}: {1}, and what may cancel models the noise, for order {2} alone leaves residuals that are "
            "not white; or order {2} with the noise apart: --order {2} --noise-model {3}",
            m.order, finding, lower, m.order - lower);
        out.back().hint = true;
    } else if (structure_given(m.options) && lower > 0)
        remark(out, Rank::structure, fmt::format("--order {}", lower),
               "{0}: they may cancel, and the residuals of order {1} pass for white, too: --order {1}", finding, lower);
}

}  // namespace

std::vector<Remark> remarks_on(Identified const& m) {
    std::vector<Remark> out;
    remark_on_order(out, m);
    remark_on_dynamics(out, m);
    if (m.failure) return out;
    for (Outlier const& o : m.outliers) out.push_back(remark_on(o, m));
    if (m.options.forgetting == 1)
        for (PastInput const& p : m.past_inputs) out.push_back(remark_on(p, m));
    remark_on_whiteness(out, m);
    remark_on_constancy(out, m);
    remark_on_held_out(out, m);
    remark_on_poles(out, m);
    for (size_t j = 0; j < m.options.inputs.size() && m.options.regressors.empty(); ++j)
        if (int const idle = idle_lead(m.terms, m.parameters, int(j)); idle > 0)
            out.push_back(remark_on_delay(int(j), idle, m));
    remark_on_cancellations(out, m);
    return out;
}

}  // namespace rlslab::identify
