// Curves of figures; the orders, the correlations of the residuals, the parameters on their way.
#include "src/lab/identify/figures.hpp"

#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;

Curve curve(std::string name, size_t place, Signal x, Signal y) {
    Look look = look_of({}, place);
    size_t known = 0;
    for (size_t k = 0; k < y.size(); ++k)
        if (!std::isnan(y[k])) x[known] = x[k], y[known++] = y[k];
    x.resize(known), y.resize(known);
    return {.name = std::move(name), .look = look, .x = std::move(x), .y = y, .lower = y, .upper = y};
}
Curve line(std::string name, size_t place, Signal x, Signal y) {
    Curve out{.name = std::move(name), .look = look_of({}, place), .x = std::move(x), .y = y, .lower = y, .upper = y};
    out.marks = false;
    return out;
}
Curve dashed(std::string name, size_t place, Signal x, Signal y) {
    Curve out = line(std::move(name), place, std::move(x), std::move(y));
    out.look.dashed = true;  // over the measured line, which shows between the dashes
    return out;
}
Signal counting(size_t n, double from) {
    Signal out(n);
    for (size_t k = 0; k < n; ++k) out[k] = from + double(k);
    return out;
}
Signal times(Clock const& clock, Index count, double from) {
    Signal out = counting(size_t(count), from);
    for (double& x : out) x = clock.time(x);
    return out;
}
Curve level(std::string name, double from, double to, double y) {
    Curve out = line(std::move(name), 6, {from, to}, {y, y});
    out.look = {"#555555", true, ""};
    return out;
}

void draw_orders(std::vector<Figure>& out, Identified const& m) {
    constexpr double least_probability = 1e-8;
    Figure orders{
        "orders", "What each order explains, and what the criteria say of it", "order", "", false, false, false, {}};
    orders.own_y = true;
    for (OrderFit const& f : m.choice.fits)
        if (f.order > 0) orders.x_ticks.push_back(f.order);
    bool const is_one = std::ranges::find(m.choice.fits, m.order, &OrderFit::order) != m.choice.fits.end() &&
                        m.structure == fmt::format("order {}", m.order);
    size_t place = 0;
    auto const criterion = [&](std::string name,
                               std::vector<std::pair<std::string, double OrderFit::*>> const& which) -> Panel& {
        Panel p{std::move(name), {}, {}};
        for (size_t i = 0; i < which.size(); ++i) {
            Signal x, y;
            for (OrderFit const& f : m.choice.fits)
                if (f.order > 0 && std::isfinite(f.*which[i].second))
                    x.push_back(f.order), y.push_back(f.*which[i].second);
            p.curves.push_back(curve(which[i].first, place++, x, y));
        }
        if (is_one) p.events.push_back({.x = double(m.order), .text = fmt::format("order {}", m.order)});
        orders.panels.push_back(std::move(p));
        return orders.panels.back();
    };
    criterion("criteria: smaller is better", {{"AIC", &OrderFit::aic}, {"BIC", &OrderFit::bic}});
    Panel& white = criterion("whiteness of the residuals: tail probability", {{"whiteness", &OrderFit::ljung_box}});
    white.log_y = true, white.y_least = least_probability, white.y_holds = {white_level, 1};
    white.guides.push_back(level(fmt::format("level {}", white_level), 1,
                                 std::max(1.0, orders.x_ticks.empty() ? 1 : orders.x_ticks.back()), white_level));
    if (std::ranges::any_of(m.choice.fits,
                            [](OrderFit const& f) { return f.order > 0 && f.ljung_box < least_probability; }))
        orders.note = fmt::format("A triangle at the lower edge stands for a probability below {}.", least_probability);
    if (m.held_out > 0) criterion("one-step fit on held-out rows, %", {{"held out", &OrderFit::held_out}});
    out.push_back(std::move(orders));
}

/// Correlations of the residuals with themselves and with each input.
void draw_correlations(std::vector<Figure>& out, Identified const& m) {
    Figure correlations{
        "residuals",
        fmt::format("Correlation of the residuals (dashed: what 99 % of a white one keep, +- {:.3f})", m.bound),
        "lag in samples",
        "correlation",
        false,
        false,
        false,
        {}};
    correlations.own_y = true;
    correlations.y_holds = {-m.bound, m.bound};
    auto const panel = [&](std::string const& name, Signal const& r, size_t skip) {
        Signal const x = counting(r.size() - skip, double(skip));
        Signal const y(r.begin() + long(skip), r.end());
        Panel p{name,
                {curve("correlation", 0, x, y)},
                {level("bound", x.front(), x.back(), m.bound), level("bound", x.front(), x.back(), -m.bound)}};
        p.curves[0].line = false, p.curves[0].stems = true;
        correlations.panels.push_back(std::move(p));
    };
    panel("with itself, lags from 1", m.auto_correlation, 1);
    for (size_t j = 0; j < m.cross_correlation.size(); ++j)
        panel("with past " + printable(m.options.inputs[j]), m.cross_correlation[j], 0);
    out.push_back(std::move(correlations));
}

void draw_trajectory(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    // Starts where the record decides, not the prior: earlier bands can be a million times as wide as at the end.
    size_t begin = 0;
    for (size_t i = 0; i < m.trajectory.size(); ++i)
        if (((m.trajectory[i].sd.array() > 20 * m.trajectory.back().sd.array()) || m.trajectory[i].sd.array().isNaN())
                .any())
            begin = i + 1;
    if (begin >= m.trajectory.size()) begin = 0;
    Figure trajectory{
        "trajectory",
        fmt::format("Parameters on their way ({}), with bands of +- 2 standard deviations", m.options.variant),
        clock.seconds() ? clock.axis() : "row",
        "value",
        false,
        false,
        false,
        {}};
    trajectory.own_y = true;
    for (size_t j = 0; j < m.parameters.size(); ++j) {
        Parameter const& p = m.parameters[j];
        int const input =
            j < m.terms.size() ? m.terms[j].input : -2;  // parameters of one signal have like sizes: a panel for each
        std::string const of =
            input == -2 ? "constant" : "of " + (input == -1 ? m.options.output : m.options.inputs[size_t(input)]);
        auto panel = std::ranges::find(trajectory.panels, of, &Panel::name);
        if (panel == trajectory.panels.end()) panel = trajectory.panels.insert(panel, {of, {}, {}});
        Curve c{.name = p.name,
                .look = look_of({}, j),
                .x = {},
                .y = {},
                .lower = {},
                .upper = {}};  // one look a parameter
        for (size_t i = begin; i < m.trajectory.size(); ++i) {
            TrajectoryPoint const& point = m.trajectory[i];
            double const value = point.theta[Index(j)], sd = point.sd[Index(j)];
            c.x.push_back(clock.seconds() ? clock.time(double(point.row)) : double(point.row)), c.y.push_back(value),
                c.lower.push_back(value - 2 * sd), c.upper.push_back(value + 2 * sd);
        }
        c.marks = j >= 16;  // colours and dashes repeat from here on
        panel->curves.push_back(std::move(c));
    }
    out.push_back(std::move(trajectory));
}

}  // namespace rlslab::identify
