// An identified model as JSON. A number that is not finite is written as null.
#include "src/lab/identify/structure.hpp"
#include "src/lab/identify/text.hpp"
#include "src/lab/report/json.hpp"

namespace rlslab::identify {
using namespace report;
namespace {

Json numbers(auto const& x) { return std::vector<double>(x.begin(), x.end()); }
Json parts(std::complex<double> z) { return std::vector{z.real(), z.imag()}; }

Json whiteness_json(LjungBox const& w) {
    return object("p Q lags degrees_of_freedom level white", {w.p, w.Q, w.lags, w.freedom, white_level, w.white()});
}
Json cured_json(Cured const& c) {
    Json const parameters = each(c.parameters, [](CuredParameter const& p) {
        return object("name of value sd least_squares shift",
                      {p.name, p.regressor, p.value, p.sd, p.least_squares, p.shift()});
    });
    Json out = object((c.of_noise ? "order" : "further_lags") + std::string(" rows parameters sigma2 whiteness health"),
                      {c.order, c.rows, parameters, c.sigma2, whiteness_json(c.ljung_box), name_of(c.health)});
    if (c.of_noise) out.update(object("farthest_from_1 converges", {c.farthest, c.farthest < 1}));
    return out;
}
Json breakdown(Index row, Health kind) { return object("row kind", {row, name_of(kind)}); }
Json tracked_json(Tracked const& t) {
    Json const rows = each(t.rows, [](TrackedRow const& r) {
        return object("row y predicted predicted_sd noise_variance theta sd",
                      {r.row, r.y, r.predicted, r.sd, r.noise_variance, numbers(r.theta), numbers(r.theta_sd)});
    });
    return object("composition quantile fit_one_step covered breakdown rows",
                  {t.text, t.quantile, t.fit, t.covered, t.broken > 0 ? breakdown(t.broken, t.kind) : Json(), rows});
}

Json uncertain(Uncertain x, double factor) { return object("value sd", {x.value * factor, x.sd * factor}); }
Json band(Band const& b) { return object("value sd low high", {b.value, b.sd, b.lower, b.upper}); }
/// [rr, ri, ii] of each root; null where it is not known to first order.
Json covariances(std::vector<RootSpread> const& roots) {
    return each(roots, [](RootSpread const& r) -> Json {
        if (!r.first_order) return nullptr;
        return std::vector{r.spread.rr, r.spread.ri, r.spread.ii};
    });
}
Json response(Identified const& m, InputResponse const& r, Clock const& clock) {
    Json step = object("time", {clock.times(0, r.step.value.size())});
    step.update(band(r.step));
    return object("step frequency magnitude_db phase_degrees",
                  {step, clock.frequencies(m.frequencies), band(r.magnitude_db), band(r.phase_deg)});
}
Json input_json(Identified const& m, size_t j, Clock const& clock) {
    Json out = object("name mean delay exciting_of_order constant_at_start",
                      {m.options.inputs[j], m.means[j], clock.time(delay_of(m.terms, int(j))), m.excitation[j].order,
                       m.excitation[j].constant_at_start});
    std::vector<Json> of_model;
    if (!m.measured.empty())
        of_model = {each(m.zeros[j], parts),
                    covariances(m.zero_spreads[j]),
                    response(m, m.responses[j], clock),
                    m.gain[j],
                    m.gain_sd[j],
                    m.cross_correlation[j]};
    out.update(object("zeros zero_covariances response gain gain_sd residual_correlation", of_model));
    return out;
}
Json constancy_json(Constancy const& c, Clock const& clock) {
    if (c.samples.empty()) return nullptr;
    auto const path = [&](ConstancyPath const& p) {
        return object(
            "value low high crosses_at_row crosses_at_1_percent farthest_at_row",
            {p.value, p.lower, p.upper, p.crosses ? Json(c.row(*p.crosses)) : Json(), p.surely, c.row(p.farthest)});
    };
    return object("rows time recursive_residuals level cusum cusum_of_squares c0",
                  {each(c.samples, [](Index k) { return k + 1; }), clock.times(c.samples), c.residuals, 0.05,
                   path(c.cusum), path(c.squares), c.c0});
}
/// Measured and modelled outputs of the held-out part; of all rows if there is none.
Json outputs_json(Identified const& m, Clock const& clock) {
    Index const from = m.held_out > 0 ? Index(m.measured.size()) - m.held_out : 0;
    auto const tail = [&](Signal const& x) { return x.empty() ? Json() : Json(Signal(x.begin() + from, x.end())); };
    size_t const count = m.measured.size() - size_t(from);
    return object("time measured one_step simulated",
                  {clock.times(m.samples - Index(count), count), tail(m.measured), tail(m.one_step),
                   tail(m.simulated_held_out.empty() ? m.simulated : m.simulated_held_out)});
}

}  // namespace

std::string as_json(Identified const& m) {
    bool const model = !m.measured.empty();
    Clock const clock(m.options);
    IdentifyOptions const& o = m.options;
    OrderChoice const& choice = m.choice;
    Json const parameters = each(m.parameters, [](Parameter const& p) {
        return object("name of value sd low high p", {p.name, p.regressor, p.value, p.sd, p.lower, p.upper, p.p});
    });
    Json const orders = each(choice.fits, [](OrderFit const& f) {
        return object("order parameters J aic bic fpe p whiteness held_out",
                      {f.order, f.parameters, f.J, f.aic, f.bic, f.fpe, f.p, f.ljung_box, f.held_out});
    });
    Json const modes = each(m.modes, [&](Mode const& mode) {
        return object("pole time_constant natural_frequency damping",
                      {parts(mode.pole), uncertain(mode.time_constant, clock.time(1)),
                       uncertain(mode.natural_frequency, clock.frequency(1)), uncertain(mode.damping, 1)});
    });
    Json const cancelling = each(m.cancellations, [](Cancellation const& c) {
        return object("pole zero distance sd", {parts(c.pole), parts(c.zero), c.distance, c.sd});
    });
    Json inputs = Json::array();
    for (size_t j = 0; j < m.excitation.size(); ++j) inputs.push_back(input_json(m, j, clock));
    Json const options = object("output variant forgetting p0 delay intercept detrend time validate confidence",
                                {o.output, o.variant, o.forgetting, o.p0.value_or(NAN), o.delay, o.intercept, o.detrend,
                                 o.time.empty() ? Json() : Json(o.time), o.validate, o.confidence}),
               units = object("time frequency sample_time_s",
                              {clock.unit(), clock.unit_of_frequency(), o.sample_time.value_or(NAN)}),
               suggested = object("aic bic fpe f_test", {choice.aic, choice.bic, choice.fpe, choice.f_test}),
               fit = object("one_step held_out_one_step held_out_simulated",
                            {m.fit_one_step, m.held_out_one_step, m.held_out_simulated});
    Json out = object("version file options units", {RLSLAB_VERSION, m.file, options, units});
    out.update(object("samples fitted skipped held_out warnings hints next",
                      {m.samples, m.fitted, m.skipped, m.held_out, m.warnings(), m.hints(), m.next()}));
    out.update(object("order structure why equation suggested orders parameters",
                      {m.order, m.structure, m.why, equation_text(m.terms, o.output),
                       choice.fits.empty() ? Json() : suggested, orders, parameters}));
    out.update(object(
        "breakdown poles pole_covariances modes cancelling inputs output_mean",
        {m.failure ? breakdown(m.failure->row, m.failure->kind) : Json(), model ? each(m.poles, parts) : Json(),
         model ? covariances(m.pole_spreads) : Json(), model ? modes : Json(), cancelling, inputs, m.means.back()}));
    out.update(object("prior sigma2 degrees_of_freedom criteria fit",
                      {object("c scales moves_by_sd", {m.c, m.scales, m.prior_effect}), m.sigma2, m.freedom,
                       object("aic bic fpe", {m.aic, m.bic, m.fpe}), fit}));
    out.update(object("whiteness residual_correlation constancy output bound digits condition",
                      {whiteness_json(m.ljung_box), m.auto_correlation, constancy_json(m.constancy, clock),
                       model ? outputs_json(m, clock) : Json(), m.bound,
                       object("theta worst", {m.digits, m.digits_worst}), m.condition}));
    if (m.tracked) out["tracked"] = tracked_json(*m.tracked);
    if (m.noise_model) out["noise_model"] = cured_json(*m.noise_model);
    if (m.instruments) out["instruments"] = cured_json(*m.instruments);
    if (m.run) out["run"] = Json::parse(as_json(*m.run));
    return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace rlslab::identify
