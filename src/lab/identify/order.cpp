// Fits all orders with one factorisation, then chooses one.
#include "src/lab/identify/structure.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/input/constant.hpp>
#include <rlslab/model/order_recursive_qr.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {

OrderColumns order_columns(std::vector<Signal> const& inputs, Signal const& y, int most, std::vector<int> const& delay,
                           bool intercept) {
    expects(delay.size() == inputs.size(), "a delay for each input");
    std::vector<Term> terms;
    for (int lag = 0; lag <= most; ++lag) {
        if (lag > 0) terms.push_back({"", "", -1, lag});
        for (size_t j = 0; j < inputs.size(); ++j) terms.push_back({"", "", int(j), delay[j] + lag});
        if (lag == 0 && intercept) terms.push_back({"", "", -2, 0});
    }
    expects(Index(y.size()) - presample(terms) > Index(terms.size()), "more rows than parameters of the largest order");
    Rows rows = rows_of(terms, inputs, y);
    return {rows.records.psi.transpose(), rows.records.y, int(inputs.size()), intercept, std::move(rows.samples)};
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
    auto const [power, present] = sum(0);
    Index seen = 0;
    if (!std::isfinite(power) || present == 0) out.Q = out.p = std::numeric_limits<double>::quiet_NaN();
    for (Index lag = 1; lag <= lags; ++lag) {
        Sum const s = sum(lag);
        seen += s.pairs > 0;
        if (!(power > 0) || s.pairs == 0) continue;  // residuals of zeros are not correlated
        double const r = s.products / power;
        out.Q += present * (present + 2) * r * r / s.pairs;
    }
    out.freedom = std::max<Index>(1, seen - fitted);
    out.zeros = present > 0 && power == 0;
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

namespace {

/// F-test of d parameters over N rows with J against fewer parameters with a larger J: the tail probability of the
/// improvement; 1 if there are no more parameters.
double improvement(double larger_J, Index fewer, double J, Index d, Index N) {
    double const more = double(d - fewer), left = double(N - d), F = (larger_J - J) / more / (J / left);
    return J > 0 && F > 0 && more > 0 ? correctly::fisher_tail(more, left, F) : 1;
}

/// X theta for rows from ... from + count - 1.
Vector<double> predicted(Matrix<double> const& X, Vector<double> const& theta, Index from, Index count) {
    Vector<double> p(count);
    for (Index k = 0; k < count; ++k) {
        double sum = 0;
        for (Index i = 0; i < theta.size(); ++i) sum += X(from + k, i) * theta[i];
        p[k] = sum;
    }
    return p;
}

/// The sum of squares of y about its mean, or about 0 without an intercept.
double squares_about_mean(Vector<double> const& y, Index rows, bool intercept) {
    double mean = 0, out = 0;
    for (Index k = 0; k < rows && intercept; ++k) mean += y[k] / double(rows);
    if (intercept) mean = constant_value(y.head(rows)).value_or(mean);
    for (Index k = 0; k < rows; ++k) out += (y[k] - mean) * (y[k] - mean);
    return out;
}

/// The fits, and the F-test of order 0.
OrderChoice fit_orders(OrderColumns const& all, int most, Index held_out) {
    Index const rows = all.y.size(), fitted = rows - held_out;
    expects(fitted > all.columns(most), "more rows to fit than parameters of the largest order");
    // Residuals of rounding alone are none: without noise every order from the true one on fits alike.
    double const nothing = rounding_alone(fitted, all.y.head(fitted).cwiseAbs().maxCoeff());
    OrderRecursiveQr<double> recursion(Vector<double>(all.y.head(fitted)), all.columns(most));
    OrderChoice out{.rows = fitted};
    for (int order = 0; order <= most; ++order) {
        Index const d = all.columns(order);
        bool sound = true;
        while (recursion.size() < d && sound)
            sound = recursion.append(all.X.col(recursion.size()).head(fitted)).relative > 0x1p-90;
        if (!sound) break;
        Vector<double> const theta = recursion.theta();
        double const J = std::max(recursion.J(), nothing);
        auto const [aic, bic, fpe] = criteria(J, fitted, d);
        OrderFit fit{order, d, J, aic, bic, fpe, 1, 0, std::numeric_limits<double>::quiet_NaN()};
        if (!out.fits.empty()) fit.p = improvement(out.fits.back().J, out.fits.back().parameters, J, d, fitted);
        else out.static_p = improvement(squares_about_mean(all.y, fitted, all.intercept), all.intercept, J, d, fitted);
        Vector<double> const residuals = all.y.head(fitted) - predicted(all.X, theta, 0, fitted);
        fit.ljung_box = recursion.J() <= nothing ? 1 : ljung_box(residuals, ljung_box_lags(fitted, order), order).p;
        if (held_out > 0) fit.held_out = fit_percent(all.y.tail(held_out), predicted(all.X, theta, fitted, held_out));
        out.fits.push_back(fit);
    }
    return out;
}

/// The order with the least criterion among the fits that satisfy `allowed`; -1 if none does.
template <class Allowed>
int least(std::vector<OrderFit> const& fits, double OrderFit::*criterion, Allowed allowed) {
    OrderFit const* best = nullptr;
    for (OrderFit const& fit : fits)
        if (allowed(fit) && (!best || fit.*criterion < best->*criterion)) best = &fit;
    return best ? best->order : -1;
}

}  // namespace

OrderChoice choose_order(OrderColumns const& columns, int most, Index held_out) {
    OrderChoice out = fit_orders(columns, most, held_out);
    auto const any = [](OrderFit const&) { return true; };
    out.aic = least(out.fits, &OrderFit::aic, any);
    out.bic = least(out.fits, &OrderFit::bic, any);
    out.fpe = least(out.fits, &OrderFit::fpe, any);
    for (OrderFit const& fit : out.fits)
        if (fit.order > 0 && fit.p < improvement_level) out.f_test = fit.order;
    int const best = least(out.fits, &OrderFit::bic, [](OrderFit const& fit) { return fit.order > 0; });
    // Below the order of the least BIC the residuals may pass only because missing terms make them large.
    int const white = least(out.fits, &OrderFit::bic, [&](OrderFit const& fit) {
        return best > 0 && fit.order >= best && fit.ljung_box >= white_level;
    });
    std::string const of = out.bic == 0 ? "the least BIC above order 0" : "the least BIC";
    out.order = white > 0 ? white : best;
    out.why = white == best ? of + ", and its residuals pass for white"
              : white > 0   ? fmt::format("{} among orders whose residuals pass for white (without that: {})", of, best)
                            : of + "; neither there nor above do the residuals pass for white";
    return out;
}

}  // namespace rlslab::identify
