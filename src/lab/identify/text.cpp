// The sentences about an identified model, and its table for a terminal or a file. An unknown number is "-".
#include "src/lab/identify/text.hpp"
#include "src/lab/identify/clock.hpp"
#include "src/lab/identify/structure.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

std::string list_of(std::vector<std::complex<double>> const& values) {
    std::vector<std::string> parts;
    for (auto const& z : values)
        if (z.imag() > 0)
            parts.push_back(fmt::format("{:.4f} +- {:.4f}i (|z| {:.3f})", z.real(), z.imag(), std::abs(z)));
        else if (z.imag() == 0) parts.push_back(fmt::format("{:.4f}", z.real()));
    return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}
/// "time constant 4.5 samples (sd 0.2), natural frequency 0.1 cycles per sample, damping 0.3".
std::string modes_text(std::vector<Mode> const& modes, Clock const& clock) {
    std::vector<std::string> parts;
    for (Mode const& m : modes) {
        if (m.pole == 0.0) parts.push_back("a pole at 0, without a time constant");
        else if (m.pole.imag() > 0)
            parts.push_back(fmt::format("natural frequency {}, damping {}", clock.frequency_text(m.natural_frequency),
                                        Clock::text(m.damping, 1, "")));
        else if (std::isfinite(m.time_constant.value))
            parts.push_back(fmt::format("time constant {}{}", clock.time_text(m.time_constant),
                                        m.pole.real() < 0 ? " with changing sign" : ""));
        else parts.push_back(fmt::format("{:.4g} does not decay", m.pole.real()));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

/// "stays within its 5 % lines", "crosses its 5 % line at row 120 (1.19 s)".
std::string crossing_text(ConstancyPath const& path, Constancy const& c, Clock const& clock) {
    if (!path.crosses) return "stays within its 5 % lines";
    return fmt::format("crosses its 5 % line{} at {}", path.surely ? ", and the one at 1 %," : "",
                       clock.row_text(c.samples[size_t(*path.crosses)] + 1));
}

std::string tail(double p) { return p == 0 ? "p < 1e-300" : fmt::format("p = {:.3g}", p); }

std::string whiteness_text(double sigma2, LjungBox const& w, bool judged) {
    std::string const verdict = w.zeros   ? "nothing is left beyond rounding"
                                : !judged ? "no verdict on those of the last theta over all rows"
                                          : fmt::format("{}: {} {} {}", w.white() ? "they pass for white" : "not white",
                                                        tail(w.p), w.white() ? ">=" : "<", white_level);
    return fmt::format("sigma^2 = {}; {} (Ljung-Box: Q = {}, {} lags, {} degrees of freedom)", number_text(sigma2, 4),
                       verdict, number_text(w.Q, 4), w.lags, w.freedom);
}

std::string residual_line(Identified const& m) {
    LjungBox const& w = m.ljung_box;
    if (std::isnan(w.p))
        return fmt::format("residuals: sigma^2 = {} of the certified minimiser; those of the variant are not numbers",
                           number_text(m.sigma2, 4));
    return "residuals: " + whiteness_text(m.sigma2, w, m.options.forgetting == 1);
}

/// "largest correlation with past u 0.21 at lag 3".
std::string largest_of(Signal const& r, Index first, std::string const& with) {
    auto const at =
        std::max_element(r.begin() + first, r.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return fmt::format("{} {:.2g} at lag {}", with, *at, at - r.begin());
}

std::string arithmetic_line(Identified const& m) {
    std::string const kappa = std::isfinite(m.condition) ? fmt::format("kappa = {:.3g}", m.condition) : "kappa > 1e308";
    if (m.failure)
        return fmt::format("arithmetic: {} broke down after row {} ({}); {}", m.options.variant, m.failure->row,
                           m.failure->kind == Health::indefinite ? "P not positive definite" : "not finite", kappa);
    return fmt::format(
        "arithmetic: {} agrees with the certified minimiser in {} of 15.9 digits ({} in its worst component); {}",
        m.options.variant, number_text(std::round(10 * m.digits) / 10, 3),
        number_text(std::round(10 * m.digits_worst) / 10, 3), kappa);
}

}  // namespace

std::string Clock::text(Uncertain x, double factor, char const* unit) {
    std::string const space = *unit ? " " : "", sd = number_text(x.sd * factor, 2);
    return number_text(x.value * factor, 4) + space + unit + (sd == "-" ? "" : fmt::format(" (sd {})", sd));
}

std::string percent_text(double x) { return std::isfinite(x) ? fmt::format("{:.2f} %", x) : "-"; }
std::string number_text(double x, int digits) { return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "-"; }

std::vector<std::string> data_lines(Identified const& m) {
    IdentifyOptions const& o = m.options;
    std::string prior =
        o.p0 ? fmt::format("P0 = {:.4g} I", *o.p0)
             : fmt::format("P0_ii = (c / s_i)^2, c = 2^{:.0f}, s_i the size of regressor i", correctly::log2(m.c));
    if (m.prior_effect <= 0.1) prior += fmt::format(": it moves no parameter by more than {:.1g} sd", m.prior_effect);
    std::string means;
    for (size_t j = 0; o.detrend && j < m.means.size(); ++j)
        means += fmt::format("{}{} {:.5g}", j == 0 ? "; means taken off: " : ", ",
                             printable(j < o.inputs.size() ? o.inputs[j] : o.output), m.means[j]);
    std::string const step = o.sample_time ? fmt::format(", one each {:g} s", *o.sample_time) : "";
    return {fmt::format("{} samples{}: {} rows fitted, {}{}{}", m.samples, step, m.fitted,
                        m.held_out > 0 ? fmt::format("the last {} samples held out", m.held_out) : "none held out",
                        m.skipped > 0 ? fmt::format("; {} rows skipped, which miss a value", m.skipped) : "", means),
            fmt::format("{} in double, lambda = {}, prior {}", o.variant, o.forgetting, prior)};
}

std::vector<std::string> input_lines(Identified const& m) {
    std::vector<std::string> out;
    if (m.options.inputs.empty())
        out.push_back(fmt::format("no input: {} is predicted from its own past alone", printable(m.options.output)));
    for (size_t i = 0; i < m.excitation.size(); ++i)
        out.push_back(
            m.excitation[i].order == Index(m.excitation[i].orders.size())
                ? fmt::format("input {}: excites enough for every order tried (exciting of order {} at least)",
                              printable(m.options.inputs[i]), m.excitation[i].order)
                : fmt::format("input {}: exciting of order {}", printable(m.options.inputs[i]), m.excitation[i].order));
    return out;
}

std::vector<std::string> order_lines(Identified const& m) {
    std::string const suggested =
        m.choice.fits.empty() || structure_given(m.options)
            ? ""
            : fmt::format("; AIC says {}, BIC {}, FPE {}, F-test {}", m.choice.aic, m.choice.bic, m.choice.fpe,
                          m.choice.f_test > 0 ? fmt::format("{}", m.choice.f_test) : "none");
    std::string const how =
        structure_given(m.options) || m.options.forgetting == 1 ? "" : ", all orders fitted without forgetting";
    return {fmt::format("{} ({}{}){}", m.structure, m.why, how, suggested), equation_text(m.terms, m.options.output)};
}

std::vector<std::string> parameter_names(Identified const& m) {
    std::vector<std::string> out;
    for (Term const& t : m.terms) out.push_back(printable(t.name));
    return out;
}

std::vector<std::string> cured_header() { return {"parameter", "of", "estimate", "sd", "least squares", "off by sd"}; }
std::vector<std::vector<std::string>> cured_rows(Cured const& c) {
    std::vector<std::vector<std::string>> out;
    for (CuredParameter const& p : c.parameters)
        out.push_back({printable(p.name), p.regressor, number_text(p.value, 6), number_text(p.sd, 2),
                       number_text(p.least_squares, 6), number_text(p.shift(), 2)});
    return out;
}
std::string cured_title(Cured const& c) {
    return c.of_noise
               ? fmt::format(
                     "noise model: C e with C of order {}, by extended least squares over {} rows; sd is of first "
                     "order (docs/theory.md 89)",
                     c.order, c.rows)
               : fmt::format(
                     "instruments: the equation's inputs and constant, and further past of each input ({} "
                     "lag{}), over {} rows; sd is of first order, for noise of any colour (docs/theory.md 90)",
                     c.order, c.order == 1 ? "" : "s", c.rows);
}
std::vector<std::string> cured_lines(Cured const& c) {
    LjungBox const& w = c.ljung_box;
    std::vector<std::string> out{
        "their residuals: " + whiteness_text(c.sigma2, w, true) +
        (c.of_noise || w.white() ? "" : "; they need not be white, the instruments allow for that")};
    if (c.health != Health::sound)
        out.push_back(fmt::format("warning: ud broke down ({}): do not use these numbers", name_of(c.health)));
    if (c.of_noise)
        out.push_back(c.farthest < 1
                          ? fmt::format("|C(e^iw) - 1| < 1 at every w (at most {:.3g}): the recursion converges there",
                                        c.farthest)
                          : fmt::format("|C(e^iw) - 1| reaches {}, not below 1: the recursion may converge slowly or "
                                        "not at all: no sd is given",
                                        number_text(c.farthest, 3)));
    return out;
}

std::vector<std::string> result_lines(Identified const& m) {
    std::vector<std::string> out;
    Clock const clock(m.options);
    bool const model = !m.measured.empty();
    if (model) {
        double const size = m.poles.empty() ? 0 : std::abs(m.poles[0]);
        out.push_back("poles: " + list_of(m.poles) +
                      (0 < size && size < 1 ? fmt::format("; slowest: time constant {:.3g} {}",
                                                          clock.time(-1 / correctly::log(size)), clock.unit())
                                            : ""));
        if (!m.modes.empty()) out.push_back("modes: " + modes_text(m.modes, clock));
        for (size_t j = 0; j < m.zeros.size(); ++j)
            out.push_back(fmt::format("zeros of {}: {}", printable(m.options.inputs[j]), list_of(m.zeros[j])));
        for (size_t j = 0; j < m.gain.size() && clock.seconds(); ++j)
            out.push_back(fmt::format("delay of {}: {} ({} samples)", printable(m.options.inputs[j]),
                                      clock.time_text({double(delay_of(m.terms, int(j)))}), delay_of(m.terms, int(j))));
        for (size_t j = 0; j < m.gain.size(); ++j)
            out.push_back(std::isfinite(m.gain[j])
                              ? fmt::format("steady-state gain of {}: {:.5g} (sd {})", printable(m.options.inputs[j]),
                                            m.gain[j], number_text(m.gain_sd[j], 2))
                              : fmt::format("steady-state gain of {}: {}", printable(m.options.inputs[j]),
                                            size >= 1 ? "none, a pole lies on or outside the unit circle"
                                                      : "not determined, a pole may lie at 1"));
        std::string const simulated =
            m.options.inputs.empty() ? "" : fmt::format(", {} simulated", percent_text(m.held_out_simulated));
        out.push_back(
            fmt::format("fit: {} one step ahead; held out: {} one step ahead{} (0 %: no better than the mean)",
                        percent_text(m.fit_one_step), percent_text(m.held_out_one_step), simulated));
    }
    out.push_back(residual_line(m));
    if (model && m.ljung_box.Q > 0) {
        std::string line = largest_of(m.auto_correlation, 1, "their largest correlation: with themselves");
        for (size_t j = 0; j < m.cross_correlation.size(); ++j)
            line +=
                largest_of(m.cross_correlation[j], 0, fmt::format("; with past {}", printable(m.options.inputs[j])));
        out.push_back(line + fmt::format(" (99 % bound {:.2g})", m.bound));
    }
    if (!m.constancy.samples.empty())
        out.push_back(fmt::format("constancy: the CUSUM of the recursive residuals {}; that of their squares {}",
                                  crossing_text(m.constancy.cusum, m.constancy, clock),
                                  crossing_text(m.constancy.squares, m.constancy, clock)));
    if (m.options.forgetting != 1)
        out.push_back("criteria: AIC, BIC and FPE are those of a fit without forgetting; none here");
    else if (std::isfinite(m.aic))
        out.push_back(fmt::format("criteria: AIC {:.6g}, BIC {:.6g}, FPE {:.4g}, of {} parameters over {} rows", m.aic,
                                  m.bic, m.fpe, m.terms.size(), m.fitted));
    out.push_back(arithmetic_line(m));
    if (m.tracked)
        for (std::string const& line : tracked_lines(*m.tracked, parameter_names(m), m.options.confidence))
            out.push_back(line);
    for (std::string const& hint : m.hints()) out.push_back("hint: " + hint);
    if (!m.next().empty()) out.push_back("next: " + m.next());
    return out;
}

std::string as_table(Identified const& m, size_t columns) {
    size_t const width = line_width(columns, 120);
    auto const in_lines = [width](std::string const& text) { return wrapped(text, 0, 4, width) + '\n'; };
    auto const on_a_terminal = [&](std::string const& text) { return columns > 0 ? in_lines(text) : text + '\n'; };
    std::string out, file = printable(m.file, 200) + ": ";
    for (std::string const& words : data_lines(m)) out += on_a_terminal(file + words), file.clear();
    for (std::string const& words : input_lines(m)) out += on_a_terminal(words);
    for (std::string const& warning : m.warnings()) out += in_lines("warning: " + warning);
    for (std::string const& words : order_lines(m)) out += '\n' + on_a_terminal(words), out.pop_back();
    size_t name = 9, of = 4;
    for (Parameter const& p : m.parameters)
        name = std::max(name, printable(p.name).size()), of = std::max(of, p.regressor.size());
    if (!structure_given(m.options) && !m.choice.fits.empty()) {
        out += "\n\n  order  parameters        AIC        BIC        FPE  white: p  held out\n";
        for (OrderFit const& fit : m.choice.fits)
            out +=
                fmt::format("{} {:>5}  {:>10} {:>10} {:>10} {:>10}  {:>8}  {:>8}\n", fit.order == m.order ? '*' : ' ',
                            fit.order, fit.parameters, number_text(fit.aic, 5), number_text(fit.bic, 5),
                            number_text(fit.fpe, 3), number_text(fit.ljung_box, 2), percent_text(fit.held_out));
        out.pop_back();
    }
    out += fmt::format("\n\n  {:<{}}  {:<{}} {:>12} {:>9}  {:g} % interval\n", "parameter", name, "of", of, "estimate",
                       "sd", 100 * m.options.confidence);
    for (Parameter const& p : m.parameters)
        out += fmt::format("  {:<{}}  {:<{}} {:>12} {:>9}  {} ... {}\n", printable(p.name), name, p.regressor, of,
                           number_text(p.value, 6), number_text(p.sd, 2), number_text(p.lower, 5),
                           number_text(p.upper, 5));
    out += '\n';
    for (auto const& cured : {m.noise_model, m.instruments}) {
        if (!cured) continue;
        out += in_lines(cured_title(*cured)) + '\n';
        for (CuredParameter const& p : cured->parameters) of = std::max(of, p.regressor.size());
        auto rows = cured_rows(*cured);
        rows.insert(rows.begin(), cured_header());
        for (auto const& r : rows)
            out += fmt::format("  {:<{}}  {:<{}} {:>12} {:>9} {:>14} {:>10}\n", r[0], name, r[1], of, r[2], r[3], r[4],
                               r[5]);
        out += '\n';
        for (std::string const& words : cured_lines(*cured)) out += in_lines(words);
        out += '\n';
    }
    for (std::string const& words : result_lines(m)) out += in_lines(words);
    return out;
}

}  // namespace rlslab::identify
