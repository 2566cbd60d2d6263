// An identified model in words and as JSON.
#include "text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

using Json = nlohmann::ordered_json;

std::string complex_text(std::complex<double> z) {
    return z.imag() == 0 ? fmt::format("{:.4f}", z.real()) : fmt::format("{:.4f}{:+.4f}i", z.real(), z.imag());
}
std::string list_of(std::vector<std::complex<double>> const& values) {
    std::vector<std::string> parts;
    for (auto const& z : values)
        if (z.imag() > 0)
            parts.push_back(fmt::format("{:.4f} +- {:.4f}i (|z| {:.3f})", z.real(), z.imag(), std::abs(z)));
        else if (z.imag() == 0)
            parts.push_back(complex_text(z));
    return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}
std::string percent(double x) { return x == x ? fmt::format("{:.2f} %", x) : "-"; }

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
Json numbers(Signal const& x) {
    Json out = Json::array();
    for (double const v : x) out.push_back(number(v));
    return out;
}
Json complexes(std::vector<std::complex<double>> const& values) {
    Json out = Json::array();
    for (auto const& z : values) out.push_back({z.real(), z.imag()});
    return out;
}

}  // namespace

std::string data_line(Identified const& m) {
    return fmt::format("{} samples, {} rows fitted, {} held out; {} in double, lambda {}", m.samples, m.fitted, m.held_out, m.options.variant, m.options.forgetting);
}
std::vector<std::string> input_lines(Identified const& m) {
    std::vector<std::string> out;
    for (size_t i = 0; i < m.excitation.size(); ++i)
        out.push_back(fmt::format("input {}: exciting of order {} at least", printable(m.options.inputs[i]), m.excitation[i].order));
    return out;
}
std::string order_line(Identified const& m) {
    return fmt::format("order {} ({}); AIC says {}, BIC {}, FPE {}, F-test {}", m.order, m.why, m.choice.aic, m.choice.bic, m.choice.fpe, m.choice.f_test);
}
std::vector<std::string> result_lines(Identified const& m) {
    std::vector<std::string> out{"poles: " + list_of(m.poles)};
    for (size_t j = 0; j < m.zeros.size(); ++j) out.push_back(fmt::format("zeros of {}: {}", printable(m.options.inputs[j]), list_of(m.zeros[j])));
    out.push_back(fmt::format("fit: {} one step ahead; held out: {} one step ahead, {} simulated", percent(m.fit_one_step), percent(m.held_out_one_step),
                              percent(m.held_out_simulated)));
    out.push_back(fmt::format("residuals: sigma^2 = {:.4g}; {} (Ljung-Box, p = {:.3g})", m.sigma2, m.whiteness < 0.01 ? "not white" : "pass for white", m.whiteness));
    out.push_back(fmt::format("arithmetic: {} kept {:.1f} of 15.9 digits of theta ({:.1f} of its worst component) against the certified minimiser; kappa = {:.3g}",
                              m.options.variant, m.digits, m.digits_worst, m.condition));
    return out;
}

std::string as_table(Identified const& m) {
    std::string out = printable(m.file, 200) + ": " + data_line(m) + '\n';
    for (std::string const& warning : m.warnings) out += "warning: " + warning + '\n';
    for (std::string const& words : input_lines(m)) out += words + '\n';
    out += '\n' + order_line(m) + '\n';
    out += fmt::format("\n  {:<10} {:>14} {:>12}   {:.0f} % interval\n", "parameter", "estimate", "sd", 100 * m.options.confidence);
    for (Parameter const& p : m.parameters) out += fmt::format("  {:<10} {:>14.6g} {:>12.2g}   {:.5g} ... {:.5g}\n", printable(p.name), p.value, p.sd, p.low, p.high);
    return out + fmt::format("\n{}\n", fmt::join(result_lines(m), "\n"));
}

std::string as_json(Identified const& m) {
    Json parameters = Json::array(), orders = Json::array(), inputs = Json::array();
    for (Parameter const& p : m.parameters)
        parameters.push_back({{"name", p.name}, {"value", number(p.value)}, {"sd", number(p.sd)}, {"low", number(p.low)}, {"high", number(p.high)}});
    for (OrderFit const& f : m.choice.fits)
        orders.push_back({{"order", f.order}, {"parameters", f.parameters}, {"J", f.J}, {"aic", number(f.aic)}, {"bic", number(f.bic)}, {"fpe", number(f.fpe)},
                          {"p", f.p}, {"whiteness", f.whiteness}, {"held_out", number(f.held_out)}});
    for (size_t j = 0; j < m.excitation.size(); ++j)
        inputs.push_back({{"name", m.options.inputs[j]}, {"mean", m.means[j]}, {"exciting_of_order", m.excitation[j].order}, {"still", m.excitation[j].still},
                          {"zeros", complexes(m.zeros[j])}, {"residual_correlation", numbers(m.cross_correlation[j])}});
    Json const out = {
        {"version", RLSLAB_VERSION},
        {"file", m.file},
        {"options", {{"output", m.options.output}, {"variant", m.options.variant}, {"forgetting", m.options.forgetting}, {"p0", m.options.p0}, {"delay", m.options.delay},
                     {"intercept", m.options.intercept}, {"detrend", m.options.detrend}, {"validate", m.options.validate}, {"confidence", m.options.confidence}}},
        {"samples", m.samples}, {"fitted", m.fitted}, {"held_out", m.held_out}, {"warnings", m.warnings},
        {"order", m.order}, {"why", m.why},
        {"suggested", {{"aic", m.choice.aic}, {"bic", m.choice.bic}, {"fpe", m.choice.fpe}, {"f_test", m.choice.f_test}}}, {"orders", orders},
        {"parameters", parameters}, {"poles", complexes(m.poles)}, {"inputs", inputs}, {"output_mean", m.means.back()},
        {"sigma2", number(m.sigma2)},
        {"fit", {{"one_step", number(m.fit_one_step)}, {"held_out_one_step", number(m.held_out_one_step)}, {"held_out_simulated", number(m.held_out_simulated)}}},
        {"whiteness", m.whiteness}, {"residual_correlation", numbers(m.auto_correlation)}, {"bound", m.bound},
        {"digits", {{"theta", number(m.digits)}, {"worst", number(m.digits_worst)}}}, {"condition", number(m.condition)}};
    return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace rlslab
