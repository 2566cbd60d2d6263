// One factorisation serves every order; the criteria are one line each.
#include "identify/order.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/model/order_recursive_qr.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {

OrderColumns order_columns(std::vector<Signal> const& inputs, Signal const& y, int most, std::vector<int> const& delay, bool intercept) {
    expects(!inputs.empty() && delay.size() == inputs.size(), "an input, and a delay for each");
    Index const first = most + *std::ranges::max_element(delay), last = Index(y.size());
    OrderColumns out{{}, {}, int(inputs.size()), intercept, {}};
    expects(last - first > out.columns(most), "more rows than parameters of the largest order");
    out.X.resize(last - first, out.columns(most));
    out.y.resize(last - first);
    for (Index at = first; at < last; ++at) {
        Index const k = Index(out.samples.size());
        Index column = 0;
        out.y[k] = y[size_t(at)];
        for (Index lag = 0; lag <= most; ++lag) {
            if (lag > 0) out.X(k, column++) = -y[size_t(at - lag)];
            for (size_t j = 0; j < inputs.size(); ++j) out.X(k, column++) = inputs[j][size_t(at - delay[j] - lag)];
            if (lag == 0 && intercept) out.X(k, column++) = 1;
        }
        if (!std::isnan(out.y[k]) && !out.X.row(k).hasNaN()) out.samples.push_back(at);
    }
    out.X.conservativeResize(Index(out.samples.size()), Eigen::NoChange);
    out.y.conservativeResize(Index(out.samples.size()));
    return out;
}

LjungBox ljung_box(Vector<double> const& residuals, Index lags, Index fitted) {
    Index const N = residuals.size();
    expects(1 <= lags && lags < N, "at least one lag, and fewer than residuals");
    struct Sum {
        double products = 0, pairs = 0;
    };
    auto const sum = [&](Index lag) {
        Sum out;
        for (Index k = lag; k < N; ++k)
            if (double const p = residuals[k] * residuals[k - lag]; !std::isnan(p)) out.products += p, ++out.pairs;
        return out;
    };
    LjungBox out{0, 1, lags, 0};
    auto const [power, there] = sum(0);
    Index seen = 0;
    if (!std::isfinite(power) || there == 0) out.Q = out.p = std::numeric_limits<double>::quiet_NaN();
    for (Index lag = 1; lag <= lags; ++lag) {
        Sum const s = sum(lag);
        seen += s.pairs > 0;
        if (!(power > 0) || s.pairs == 0) continue;  // nothing is left: nothing is correlated
        double const r = s.products / power;
        out.Q += there * (there + 2) * r * r / s.pairs;
    }
    out.freedom = std::max<Index>(1, seen - fitted);
    if (power > 0 && std::isfinite(power)) out.p = correctly::chi_squared_tail(double(out.freedom), out.Q);
    return out;
}

Index ljung_box_lags(Index rows, int order) { return std::min<Index>(rows - 1, std::max<Index>(25, 2 * order)); }

double rounding_alone(Index rows, double y) { return double(rows) * (0x1p-44 * y) * (0x1p-44 * y); }

Criteria criteria(double J, Index N, Index d) {
    double const n = double(N), parameters = double(d), mean = J / n;
    return {n * correctly::log(mean) + 2 * parameters, n * correctly::log(mean) + parameters * correctly::log(n),
            mean * (n + parameters) / (n - parameters)};
}

OrderChoice choose_order(OrderColumns const& all, int most, Index held_out) {
    Index const rows = all.y.size(), fitted = rows - held_out;
    expects(fitted > all.columns(most), "more rows to fit than parameters of the largest order");
    // Residuals of rounding alone are none: without noise every order from the true one on fits alike.
    double const nothing = rounding_alone(fitted, all.y.head(fitted).cwiseAbs().maxCoeff());
    double constant = 0, about_constant = 0;
    for (Index k = 0; k < fitted && all.intercept; ++k) constant += all.y[k] / double(fitted);
    for (Index k = 0; k < fitted; ++k) about_constant += (all.y[k] - constant) * (all.y[k] - constant);
    OrderRecursiveQr<double> recursion(Vector<double>(all.y.head(fitted)), all.columns(most));
    OrderChoice out{.rows = fitted};
    for (int order = 0; order <= most; ++order) {
        Index const d = all.columns(order);
        bool sound = true;
        while (recursion.size() < d && sound) sound = recursion.append(all.X.col(recursion.size()).head(fitted)).relative > 0x1p-90;
        if (!sound) break;
        Vector<double> const theta = recursion.theta();
        auto const predicted = [&](Index from, Index count) {
            Vector<double> p(count);
            for (Index k = 0; k < count; ++k) {
                double sum = 0;
                for (Index i = 0; i < d; ++i) sum += all.X(from + k, i) * theta[i];
                p[k] = sum;
            }
            return p;
        };
        double const J = std::max(recursion.J(), nothing);
        auto const [aic, bic, fpe] = criteria(J, fitted, d);
        OrderFit fit{order, d, J, aic, bic, fpe, 1, 0, std::numeric_limits<double>::quiet_NaN()};
        auto const improvement = [&](double from, Index parameters) {
            double const more = double(d - parameters), left = double(fitted - d), F = (from - J) / more / (J / left);
            return J > 0 && F > 0 ? correctly::fisher_tail(more, left, F) : 1;
        };
        if (!out.fits.empty()) fit.p = improvement(out.fits.back().J, out.fits.back().parameters);
        else out.static_p = improvement(about_constant, all.intercept);
        Vector<double> residuals = all.y.head(fitted);
        Vector<double> const p = predicted(0, fitted);
        for (Index k = 0; k < fitted; ++k) residuals[k] -= p[k];
        fit.ljung_box = recursion.J() <= nothing ? 1 : ljung_box(residuals, ljung_box_lags(fitted, order), order).p;
        if (fitted < rows) fit.held_out = fit_percent(all.y.tail(rows - fitted), predicted(fitted, rows - fitted));
        out.fits.push_back(fit);
    }
    auto const least = [&](double OrderFit::*criterion, auto const& keeps) {
        OrderFit const* best = nullptr;
        for (OrderFit const& fit : out.fits)
            if (keeps(fit) && (!best || fit.*criterion < best->*criterion)) best = &fit;
        return best ? best->order : -1;
    };
    auto const any = [](OrderFit const&) { return true; };
    out.aic = least(&OrderFit::aic, any);
    out.bic = least(&OrderFit::bic, any);
    out.fpe = least(&OrderFit::fpe, any);
    int const best = least(&OrderFit::bic, [](OrderFit const& fit) { return fit.order > 0; });
    for (OrderFit const& fit : out.fits)
        if (fit.order > 0 && fit.p < improvement_level) out.f_test = fit.order;
    // Below the order of the least BIC the residuals may pass only because what is missing makes them large.
    int const white =
        least(&OrderFit::bic, [&](OrderFit const& fit) { return best > 0 && fit.order >= best && fit.ljung_box >= white_level; });
    std::string const of = out.bic == 0 ? "the least BIC above order 0" : "the least BIC";
    out.order = white > 0 ? white : best;
    out.why = white == best ? of + ", and its residuals pass for white"
              : white > 0   ? fmt::format("{} among orders whose residuals pass for white (without that: {})", of, best)
                            : of + "; neither there nor above do the residuals pass for white";
    return out;
}

}  // namespace rlslab::identify
