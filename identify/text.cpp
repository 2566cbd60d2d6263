// An identified model in words and as JSON. A number that is not there is "-" in words, null in JSON.
#include "identify/text.hpp"

#include "identify/structure.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab::identify {
using namespace report;
namespace {

using Json = nlohmann::ordered_json;

std::string list_of(std::vector<std::complex<double>> const& values) {
    std::vector<std::string> parts;
    for (auto const& z : values)
        if (z.imag() > 0) parts.push_back(fmt::format("{:.4f} +- {:.4f}i (|z| {:.3f})", z.real(), z.imag(), std::abs(z)));
        else if (z.imag() == 0) parts.push_back(fmt::format("{:.4f}", z.real()));
    return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}
std::string percent(double x) { return std::isfinite(x) ? fmt::format("{:.2f} %", x) : "-"; }
std::string tail(double p) { return p == 0 ? "p < 1e-300" : fmt::format("p = {:.3g}", p); }

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
Json numbers(std::vector<double> const& x) {
    Json out = Json::array();
    for (double const v : x) out.push_back(number(v));
    return out;
}
Json complexes(std::vector<std::complex<double>> const& values) {
    Json out = Json::array();
    for (auto const& z : values) out.push_back({number(z.real()), number(z.imag())});
    return out;
}

std::string residual_line(Identified const& m) {
    LjungBox const& w = m.ljung_box;
    if (std::isnan(w.p))
        return fmt::format("residuals: sigma^2 = {} of the certified minimiser; those of the variant are not numbers",
                           number_text(m.sigma2, 4));
    std::string const verdict = w.Q == 0                    ? "nothing is left beyond rounding"
                                : m.options.forgetting != 1 ? "no verdict on those of the last theta over all rows"
                                                            : fmt::format("{}: {} {} {}", w.white() ? "they pass for white" : "not white",
                                                                          tail(w.p), w.white() ? ">=" : "<", white_level);
    return fmt::format("residuals: sigma^2 = {}; {} (Ljung-Box: Q = {}, {} lags, {} degrees of freedom)", number_text(m.sigma2, 4), verdict,
                       number_text(w.Q, 4), w.lags, w.freedom);
}

/// "largest correlation with past u 0.21 at lag 3".
std::string largest_of(Signal const& r, Index first, std::string const& with) {
    auto const at = std::max_element(r.begin() + first, r.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return fmt::format("{} {:.2g} at lag {}", with, *at, at - r.begin());
}

std::string arithmetic_line(Identified const& m) {
    std::string const kappa = std::isfinite(m.condition) ? fmt::format("kappa = {:.3g}", m.condition) : "kappa > 1e308";
    if (m.failure)
        return fmt::format("arithmetic: {} broke down after row {} ({}); {}", m.options.variant, m.failure->row,
                           m.failure->kind == Health::indefinite ? "P not positive definite" : "not finite", kappa);
    return fmt::format("arithmetic: {} agrees with the certified minimiser in {} of 15.9 digits ({} in its worst component); {}",
                       m.options.variant, number_text(std::round(10 * m.digits) / 10, 3),
                       number_text(std::round(10 * m.digits_worst) / 10, 3), kappa);
}

}  // namespace

std::string number_text(double x, int digits) { return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "-"; }

std::vector<std::string> data_lines(Identified const& m) {
    IdentifyOptions const& o = m.options;
    std::string prior = o.p0 ? fmt::format("P0 = {:.4g} I", *o.p0)
                             : fmt::format("P0_ii = (c / s_i)^2, c = 2^{:.0f}, s_i the size of regressor i", correctly::log2(m.c));
    if (m.prior_move <= 0.1) prior += fmt::format(": it moves no parameter by more than {:.1g} sd", m.prior_move);
    std::string means;
    for (size_t j = 0; o.detrend && j < m.means.size(); ++j)
        means += fmt::format("{}{} {:.5g}", j == 0 ? "; means taken off: " : ", ", printable(j < o.inputs.size() ? o.inputs[j] : o.output),
                             m.means[j]);
    return {fmt::format("{} samples: {} rows fitted, {} held out{}{}", m.samples, m.fitted, m.held_out,
                        m.skipped > 0 ? fmt::format("; {} skipped, which miss a value", m.skipped) : "", means),
            fmt::format("{} in double, lambda = {}, prior {}", o.variant, o.forgetting, prior)};
}

std::vector<std::string> input_lines(Identified const& m) {
    std::vector<std::string> out;
    for (size_t i = 0; i < m.excitation.size(); ++i)
        out.push_back(m.excitation[i].order == Index(m.excitation[i].orders.size())
                          ? fmt::format("input {}: excites enough for every order tried (exciting of order {} at least)",
                                        printable(m.options.inputs[i]), m.excitation[i].order)
                          : fmt::format("input {}: exciting of order {}", printable(m.options.inputs[i]), m.excitation[i].order));
    return out;
}

std::vector<std::string> order_lines(Identified const& m) {
    std::string const said = m.choice.fits.empty() || structure_given(m.options)
                                 ? ""
                                 : fmt::format("; AIC says {}, BIC {}, FPE {}, F-test {}", m.choice.aic, m.choice.bic, m.choice.fpe,
                                               m.choice.f_test > 0 ? fmt::format("{}", m.choice.f_test) : "none");
    std::string const how = structure_given(m.options) || m.options.forgetting == 1 ? "" : ", all orders fitted without forgetting";
    return {fmt::format("{} ({}{}){}", m.structure, m.why, how, said), equation_text(m.terms, m.options.output)};
}

std::vector<std::string> parameter_names(Identified const& m) {
    std::vector<std::string> out;
    for (Term const& t : m.terms) out.push_back(printable(t.name));
    return out;
}

std::vector<std::string> result_lines(Identified const& m) {
    std::vector<std::string> out;
    bool const model = !m.measured.empty();
    if (model) {
        double const size = m.poles.empty() ? 0 : std::abs(m.poles[0]);
        out.push_back("poles: " + list_of(m.poles) +
                      (0 < size && size < 1 ? fmt::format("; slowest: time constant {:.3g} samples", -1 / correctly::log(size)) : ""));
        for (size_t j = 0; j < m.zeros.size(); ++j)
            out.push_back(fmt::format("zeros of {}: {}", printable(m.options.inputs[j]), list_of(m.zeros[j])));
        for (size_t j = 0; j < m.gain.size(); ++j)
            out.push_back(std::isfinite(m.gain[j]) ? fmt::format("steady-state gain of {}: {:.5g} (sd {})", printable(m.options.inputs[j]),
                                                                 m.gain[j], number_text(m.gain_sd[j], 2))
                                                   : fmt::format("steady-state gain of {}: {}", printable(m.options.inputs[j]),
                                                                 size >= 1 ? "none, a pole lies on or outside the unit circle"
                                                                           : "not determined, a pole may lie at 1"));
        out.push_back(fmt::format("fit: {} one step ahead; held out: {} one step ahead, {} simulated (0 %: no better than the mean)",
                                  percent(m.fit_one_step), percent(m.held_out_one_step), percent(m.held_out_simulated)));
    }
    out.push_back(residual_line(m));
    if (model && m.ljung_box.Q > 0) {
        std::string line = largest_of(m.auto_correlation, 1, "their largest correlation: with themselves");
        for (size_t j = 0; j < m.cross_correlation.size(); ++j)
            line += largest_of(m.cross_correlation[j], 0, fmt::format("; with past {}", printable(m.options.inputs[j])));
        out.push_back(line + fmt::format(" (99 % bound {:.2g})", m.bound));
    }
    if (m.options.forgetting != 1) out.push_back("criteria: AIC, BIC and FPE are those of a fit without forgetting; none here");
    else if (std::isfinite(m.aic))
        out.push_back(fmt::format("criteria: AIC {:.6g}, BIC {:.6g}, FPE {:.4g}, of {} parameters over {} rows", m.aic, m.bic, m.fpe,
                                  m.terms.size(), m.fitted));
    out.push_back(arithmetic_line(m));
    if (m.tracked)
        for (std::string const& line : tracked_lines(*m.tracked, parameter_names(m), m.options.confidence)) out.push_back(line);
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
    for (Parameter const& p : m.parameters) name = std::max(name, printable(p.name).size()), of = std::max(of, p.of.size());
    if (!structure_given(m.options) && !m.choice.fits.empty()) {
        out += "\n\n  order  parameters        AIC        BIC        FPE  white: p  held out\n";
        for (OrderFit const& fit : m.choice.fits)
            out += fmt::format("{} {:>5}  {:>10} {:>10} {:>10} {:>10}  {:>8}  {:>8}\n", fit.order == m.order ? '*' : ' ', fit.order,
                               fit.parameters, number_text(fit.aic, 5), number_text(fit.bic, 5), number_text(fit.fpe, 3),
                               number_text(fit.ljung_box, 2), percent(fit.held_out));
        out.pop_back();
    }
    out += fmt::format("\n\n  {:<{}}  {:<{}} {:>12} {:>9}  {:g} % interval\n", "parameter", name, "of", of, "estimate", "sd",
                       100 * m.options.confidence);
    for (Parameter const& p : m.parameters)
        out += fmt::format("  {:<{}}  {:<{}} {:>12} {:>9}  {} ... {}\n", printable(p.name), name, p.of, of, number_text(p.value, 6),
                           number_text(p.sd, 2), number_text(p.lower, 5), number_text(p.upper, 5));
    out += '\n';
    for (std::string const& words : result_lines(m)) out += in_lines(words);
    return out;
}

namespace {

/// What was tracked, a row each.
Json tracked_json(Tracked const& t) {
    Json rows = Json::array();
    for (TrackedRow const& r : t.rows)
        rows.push_back({{"row", r.row},
                        {"y", number(r.y)},
                        {"predicted", number(r.predicted)},
                        {"predicted_sd", number(r.sd)},
                        {"noise_variance", number(r.noise_variance)},
                        {"theta", numbers({r.theta.begin(), r.theta.end()})},
                        {"sd", numbers({r.theta_sd.begin(), r.theta_sd.end()})}});
    return {{"composition", t.text},
            {"quantile", number(t.quantile)},
            {"fit_one_step", number(t.fit)},
            {"covered", number(t.covered)},
            {"breakdown", t.broken > 0 ? Json{{"row", t.broken}, {"kind", name_of(t.kind)}} : Json(nullptr)},
            {"rows", rows}};
}

}  // namespace

std::string as_json(Identified const& m) {
    Json parameters = Json::array(), orders = Json::array(), inputs = Json::array(), cancelling = Json::array();
    for (Parameter const& p : m.parameters)
        parameters.push_back({{"name", p.name},
                              {"of", p.of},
                              {"value", number(p.value)},
                              {"sd", number(p.sd)},
                              {"low", number(p.lower)},
                              {"high", number(p.upper)}});
    for (OrderFit const& f : m.choice.fits)
        orders.push_back({{"order", f.order},
                          {"parameters", f.parameters},
                          {"J", number(f.J)},
                          {"aic", number(f.aic)},
                          {"bic", number(f.bic)},
                          {"fpe", number(f.fpe)},
                          {"p", number(f.p)},
                          {"whiteness", number(f.ljung_box)},
                          {"held_out", number(f.held_out)}});
    bool const model = !m.measured.empty();
    for (size_t j = 0; j < m.excitation.size(); ++j)
        inputs.push_back({{"name", m.options.inputs[j]},
                          {"mean", number(m.means[j])},
                          {"exciting_of_order", m.excitation[j].order},
                          {"constant_at_start", m.excitation[j].constant_at_start},
                          {"zeros", model ? complexes(m.zeros[j]) : Json(nullptr)},
                          {"gain", model ? number(m.gain[j]) : Json(nullptr)},
                          {"gain_sd", model ? number(m.gain_sd[j]) : Json(nullptr)},
                          {"residual_correlation", model ? numbers(m.cross_correlation[j]) : Json(nullptr)}});
    for (Cancellation const& c : m.cancellations)
        cancelling.push_back({{"pole", {number(c.pole.real()), number(c.pole.imag())}},
                              {"zero", {number(c.zero.real()), number(c.zero.imag())}},
                              {"distance", number(c.distance)},
                              {"sd", number(c.sd)}});
    IdentifyOptions const& o = m.options;
    Json const out = {
        {"version", RLSLAB_VERSION},
        {"file", m.file},
        {"options",
         {{"output", o.output},
          {"variant", o.variant},
          {"forgetting", o.forgetting},
          {"p0", o.p0 ? number(*o.p0) : Json(nullptr)},
          {"delay", o.delay},
          {"intercept", o.intercept},
          {"detrend", o.detrend},
          {"validate", o.validate},
          {"confidence", o.confidence}}},
        {"samples", m.samples},
        {"fitted", m.fitted},
        {"skipped", m.skipped},
        {"held_out", m.held_out},
        {"warnings", m.warnings()},
        {"hints", m.hints()},
        {"next", m.next()},
        {"order", m.order},
        {"structure", m.structure},
        {"why", m.why},
        {"equation", equation_text(m.terms, o.output)},
        {"suggested", m.choice.fits.empty()
                          ? Json(nullptr)
                          : Json{{"aic", m.choice.aic}, {"bic", m.choice.bic}, {"fpe", m.choice.fpe}, {"f_test", m.choice.f_test}}},
        {"orders", orders},
        {"parameters", parameters},
        {"breakdown", m.failure ? Json{{"row", m.failure->row}, {"kind", name_of(m.failure->kind)}} : Json(nullptr)},
        {"poles", model ? complexes(m.poles) : Json(nullptr)},
        {"cancelling", cancelling},
        {"inputs", inputs},
        {"output_mean", number(m.means.back())},
        {"prior", {{"c", number(m.c)}, {"scales", numbers(m.scales)}, {"moves_by_sd", number(m.prior_move)}}},
        {"sigma2", number(m.sigma2)},
        {"degrees_of_freedom", number(m.freedom)},
        {"criteria", {{"aic", number(m.aic)}, {"bic", number(m.bic)}, {"fpe", number(m.fpe)}}},
        {"fit",
         {{"one_step", number(m.fit_one_step)},
          {"held_out_one_step", number(m.held_out_one_step)},
          {"held_out_simulated", number(m.held_out_simulated)}}},
        {"whiteness",
         {{"p", number(m.ljung_box.p)},
          {"Q", number(m.ljung_box.Q)},
          {"lags", m.ljung_box.lags},
          {"degrees_of_freedom", m.ljung_box.freedom},
          {"level", white_level},
          {"white", m.ljung_box.white()}}},
        {"residual_correlation", numbers(m.auto_correlation)},
        {"bound", number(m.bound)},
        {"digits", {{"theta", number(m.digits)}, {"worst", number(m.digits_worst)}}},
        {"condition", number(m.condition)}};
    Json all = out;
    if (m.tracked) all["tracked"] = tracked_json(*m.tracked);
    return all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace rlslab::identify
