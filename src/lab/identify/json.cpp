// An identified model as JSON. An unknown number is null.
#include "src/lab/identify/clock.hpp"
#include "src/lab/identify/structure.hpp"

#include <nlohmann/json.hpp>

namespace rlslab::identify {
using namespace report;
namespace {

using Json = nlohmann::ordered_json;

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

Json whiteness_json(LjungBox const& w) {
    return {{"p", number(w.p)},     {"Q", number(w.Q)},  {"lags", w.lags}, {"degrees_of_freedom", w.freedom},
            {"level", white_level}, {"white", w.white()}};
}
Json cured_json(Cured const& c, char const* order) {
    Json parameters = Json::array();
    for (CuredParameter const& p : c.parameters)
        parameters.push_back({{"name", p.name},
                              {"of", p.regressor},
                              {"value", number(p.value)},
                              {"sd", number(p.sd)},
                              {"least_squares", number(p.least_squares)},
                              {"shift", number(p.shift())}});
    Json out = {{order, c.order},
                {"rows", c.rows},
                {"parameters", parameters},
                {"sigma2", number(c.sigma2)},
                {"whiteness", whiteness_json(c.ljung_box)},
                {"health", name_of(c.health)}};
    if (c.of_noise) out["farthest_from_1"] = number(c.farthest), out["converges"] = c.farthest < 1;
    return out;
}

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

Json uncertain(Uncertain x, double factor) {
    return {{"value", number(x.value * factor)}, {"sd", number(x.sd * factor)}};
}
Json band(Band const& b) {
    return {{"value", numbers(b.value)}, {"sd", numbers(b.sd)}, {"low", numbers(b.lower)}, {"high", numbers(b.upper)}};
}
/// [rr, ri, ii] of each root; null where it is not known to first order.
Json covariances(std::vector<RootSpread> const& roots) {
    Json out = Json::array();
    for (RootSpread const& r : roots)
        out.push_back(r.first_order ? numbers({r.spread.rr, r.spread.ri, r.spread.ii}) : Json(nullptr));
    return out;
}
Json modes(std::vector<Mode> const& all, Clock const& clock) {
    Json out = Json::array();
    for (Mode const& m : all)
        out.push_back({{"pole", {number(m.pole.real()), number(m.pole.imag())}},
                       {"time_constant", uncertain(m.time_constant, clock.time(1))},
                       {"natural_frequency", uncertain(m.natural_frequency, clock.frequency(1))},
                       {"damping", uncertain(m.damping, 1)}});
    return out;
}
std::vector<double> times(size_t count, double first, Clock const& clock) {
    std::vector<double> out;
    for (size_t k = 0; k < count; ++k) out.push_back(clock.time(first + double(k)));
    return out;
}
Json responses(Identified const& m, size_t input, Clock const& clock) {
    InputResponse const& r = m.responses[input];
    std::vector<double> frequency;
    for (double const f : m.frequencies) frequency.push_back(clock.frequency(f));
    Json step = {{"time", numbers(times(r.step.value.size(), 0, clock))}};
    step.update(band(r.step));
    return {{"step", step},
            {"frequency", numbers(frequency)},
            {"magnitude_db", band(r.magnitude_db)},
            {"phase_degrees", band(r.phase_deg)}};
}
Json constancy_json(Constancy const& c, Clock const& clock) {
    if (c.samples.empty()) return nullptr;
    std::vector<Index> rows;
    std::vector<double> time;
    for (Index const k : c.samples) rows.push_back(k + 1), time.push_back(clock.time(double(k)));
    auto const path = [&](ConstancyPath const& p) {
        return Json{{"value", numbers(p.value)},
                    {"low", numbers(p.lower)},
                    {"high", numbers(p.upper)},
                    {"crosses_at_row", p.crosses ? Json(rows[size_t(*p.crosses)]) : Json(nullptr)},
                    {"crosses_at_1_percent", p.surely},
                    {"farthest_at_row", rows[size_t(p.farthest)]}};
    };
    return {{"rows", rows},      {"time", numbers(time)},  {"recursive_residuals", numbers(c.residuals)},
            {"level", 0.05},     {"cusum", path(c.cusum)}, {"cusum_of_squares", path(c.squares)},
            {"c0", number(c.c0)}};
}
/// Measured and modelled outputs of the held-out part; of all rows if there is none.
Json outputs_json(Identified const& m, Clock const& clock) {
    Index const from = m.held_out > 0 ? Index(m.measured.size()) - m.held_out : 0;
    auto const tail = [&](Signal const& x) { return x.empty() ? Json(nullptr) : numbers({x.begin() + from, x.end()}); };
    size_t const count = m.measured.size() - size_t(from);
    return {{"time", numbers(times(count, double(m.samples) - double(count), clock))},
            {"measured", tail(m.measured)},
            {"one_step", tail(m.one_step)},
            {"simulated", tail(m.simulated_held_out.empty() ? m.simulated : m.simulated_held_out)}};
}

}  // namespace

std::string as_json(Identified const& m) {
    Json parameters = Json::array(), orders = Json::array(), inputs = Json::array(), cancelling = Json::array();
    for (Parameter const& p : m.parameters)
        parameters.push_back({{"name", p.name},
                              {"of", p.regressor},
                              {"value", number(p.value)},
                              {"sd", number(p.sd)},
                              {"low", number(p.lower)},
                              {"high", number(p.upper)},
                              {"p", number(p.p)}});
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
    Clock const clock(m.options);
    for (size_t j = 0; j < m.excitation.size(); ++j)
        inputs.push_back({{"name", m.options.inputs[j]},
                          {"mean", number(m.means[j])},
                          {"delay", number(clock.time(delay_of(m.terms, int(j))))},
                          {"exciting_of_order", m.excitation[j].order},
                          {"constant_at_start", m.excitation[j].constant_at_start},
                          {"zeros", model ? complexes(m.zeros[j]) : Json(nullptr)},
                          {"zero_covariances", model ? covariances(m.zero_spreads[j]) : Json(nullptr)},
                          {"response", model ? responses(m, j, clock) : Json(nullptr)},
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
          {"time", o.time.empty() ? Json(nullptr) : Json(o.time)},
          {"validate", o.validate},
          {"confidence", o.confidence}}},
        {"units",
         {{"time", clock.unit()},
          {"frequency", clock.unit_of_frequency()},
          {"sample_time_s", m.options.sample_time ? number(*m.options.sample_time) : Json(nullptr)}}},
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
        {"suggested",
         m.choice.fits.empty()
             ? Json(nullptr)
             : Json{{"aic", m.choice.aic}, {"bic", m.choice.bic}, {"fpe", m.choice.fpe}, {"f_test", m.choice.f_test}}},
        {"orders", orders},
        {"parameters", parameters},
        {"breakdown", m.failure ? Json{{"row", m.failure->row}, {"kind", name_of(m.failure->kind)}} : Json(nullptr)},
        {"poles", model ? complexes(m.poles) : Json(nullptr)},
        {"pole_covariances", model ? covariances(m.pole_spreads) : Json(nullptr)},
        {"modes", model ? modes(m.modes, clock) : Json(nullptr)},
        {"cancelling", cancelling},
        {"inputs", inputs},
        {"output_mean", number(m.means.back())},
        {"prior", {{"c", number(m.c)}, {"scales", numbers(m.scales)}, {"moves_by_sd", number(m.prior_effect)}}},
        {"sigma2", number(m.sigma2)},
        {"degrees_of_freedom", number(m.freedom)},
        {"criteria", {{"aic", number(m.aic)}, {"bic", number(m.bic)}, {"fpe", number(m.fpe)}}},
        {"fit",
         {{"one_step", number(m.fit_one_step)},
          {"held_out_one_step", number(m.held_out_one_step)},
          {"held_out_simulated", number(m.held_out_simulated)}}},
        {"whiteness", whiteness_json(m.ljung_box)},
        {"residual_correlation", numbers(m.auto_correlation)},
        {"constancy", constancy_json(m.constancy, clock)},
        {"output", model ? outputs_json(m, clock) : Json(nullptr)},
        {"bound", number(m.bound)},
        {"digits", {{"theta", number(m.digits)}, {"worst", number(m.digits_worst)}}},
        {"condition", number(m.condition)}};
    Json all = out;
    if (m.tracked) all["tracked"] = tracked_json(*m.tracked);
    if (m.noise_model) all["noise_model"] = cured_json(*m.noise_model, "order");
    if (m.instruments) all["instruments"] = cured_json(*m.instruments, "further_lags");
    if (m.run) all["run"] = Json::parse(as_json(*m.run));
    return all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace rlslab::identify
