// Rows of different variance, and rows whose output is missing.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/state/lanes.hpp>

#include <tuple>

namespace rlslab {

namespace detail {
/// Of a row whose weight is none: nothing has changed.
template <class T>
Step<T> refused_row() {
    return {undefined<T>(), undefined<T>(), undefined<T>(), Health::nonfinite};
}
/// (3) of Weighted. `psi` is workspace of d numbers.
template <class F, class T, int N>
Step<T> missing_output(F& filter, StateVector<T, N>& psi, T& by) {
    by = T(1);
    Step<T> const step = [&] {
        if constexpr (requires { filter.pass_time(psi); }) return filter.pass_time(psi);
        else return pass_time(filter, psi);
    }();
    return {undefined<T>(), undefined<T>(), step.gamma, step.health};
}
/// (1) and (3) of Weighted, of a filter that another holds. `psi`: workspace of d numbers, which may hold the row;
/// `by`: what the filter's gain is to be multiplied by from now on.
template <class F, Real T, int N>
Step<T> weighted_row(F& filter, StateVector<T, N>& psi, T& by, Regressor<T> given, T const& y, T const& w) {
    keep_regressor(given, psi);
    Truth<T> const good = T(0) <= w && is_finite(w), taken = good && !(w == T(0));
    if (!any(good)) return refused_row<T>();
    if (!any(taken) && all(good)) return missing_output(filter, psi, by);  // (3)
    by = select(good, select(taken, square_root(w), T(1)), by);            // (1)
    scale(psi, by, psi);
    T output = by * y;
    if (!all(taken)) {
        for (Index i = 0; i < psi.size(); ++i) psi[i] = select(taken, psi[i], T(0));
        output = select(taken, output, T(0));
    }
    Regressor<T> const row(psi.data(), psi.size());
    Step<T> step = on_lanes<T>(filter, good, [&] { return filter.update(row, output); });
    step.innovation /= by;
    step.residual /= by;
    if constexpr (!std::same_as<Truth<T>, bool>)
        if (!all(taken)) {
            Step<T> const none{undefined<T>(), undefined<T>(), step.gamma, step.health};
            step = select(good, select(taken, step, none), refused_row<T>());
        }
    return step;
}
}  // namespace detail

/// F with a weight for each row: minimises sum_i lambda^(k-i) w_i (y_i - psi_i'theta)^2 in place of F's sum, the prior
/// as it is. w = 1/v where the row's noise has v times the variance that P is in units of.
///
///   (1) F takes the row (sqrt(w) psi, sqrt(w) y); innovation and residual are divided by sqrt(w), the gain multiplied:
///       all in y's unit. gamma = lambda / (lambda + w psi'P psi)
///   (2) in a field without roots: P -> w P (lambda/w) / lambda, that is F's row with lambda/w for lambda, then
///     discount(w)
///   (3) missing output: time passes and nothing is learnt, P -> P / lambda. That is F's row with psi = 0, and w = 0. A
///       theta that is stored keeps its bits; one that is solved for moves by rounding
///
/// (2) is exact, and therefore for exact fields alone: rounding makes an error of u/w in it.
/// psi         may be the gain's own numbers                      w = 1     F's own bits
/// w           < 0, infinite or NaN: nothing changes, and health is nonfinite. Of packs: a weight for each lane, each
///             with the bits of its own; allocates where a lane has such a w. Not of packs that are guarded
/// F           a variant, or what is around one: Weighted<Guarded<Windowed<Ud<float, 5>>>> keeps the scaled rows, and
///             tests the scaled innovation, whose variance is the same in all rows. A guard learns nothing of the
///             noise from (3)
/// gain()      by value. Allocates where F does and, at dynamic size, in gain(). Cost of (1): d + 3 multiplications and
/// a root. Source: folklore; derived (docs/theory.md 63).
template <OverOrderedField F>
    requires KeepsItsRows<F> && (Real<typename F::scalar> || TimeUpdates<F>) &&
             (std::same_as<Truth<typename F::scalar>, bool> || !requires(F& f) { f.pass_time(); })
class Weighted : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    StateVector<T, detail::size_of<F>> psi_;
    T lambda_, by_ = T(1);  // what the gain is multiplied by

public:
    static constexpr bool departs = true;  ///< from the problem's J

    explicit Weighted(Problem<T> const& problem) : Weighted(F(problem), problem.forgetting) {}
    /// Around a filter that was made with options of its own. `forgetting` is the problem's.
    Weighted(F const& filter, T const& forgetting)
        : detail::AroundFilter<F>(filter), psi_(filter.theta().size()), lambda_(forgetting) {}

    Step<T> update(Regressor<T> psi, T y) {
        Step<T> const step = filter_.update(psi, y);
        by_ = T(1);
        return step;
    }
    Step<T> update(Regressor<T> psi, T const& y, T const& w) {
        if constexpr (Real<T>) {  // (1), (3)
            return detail::weighted_row(filter_, psi_, by_, psi, y, w);
        } else {  // (2)
            keep_regressor(psi, psi_);
            if (!(T(0) <= w)) return detail::refused_row<T>();
            if (w == T(0)) return missing();
            Step<T> const step = measure(filter_, row(), y, T(lambda_ / w), lambda_);
            discount(filter_, w);
            by_ = ReportsInformation<F> ? w : T(1);  // these solve for P psi on request
            return step;
        }
    }
    /// (3). Its step has no innovation and no residual.
    Step<T> missing() { return detail::missing_output(filter_, psi_, by_); }

    Vector<T, detail::size_of<F>> gain() const {
        Vector<T, detail::size_of<F>> K = filter_.gain();
        for (T& x : K) x *= by_;
        return K;
    }
    /// Of an Assessed inside: theta_j, and the next output of a row of weight 1.
    auto interval(Index j, T const& q = T(1.96))
        requires requires(F& f) { f.interval(j, q); }
    {
        return filter_.interval(j, q);
    }
    auto interval(Index j, T const& q = T(1.96)) const
        requires requires(F const& f) { f.interval(j, q); }
    {
        return filter_.interval(j, q);
    }
    auto prediction(Regressor<T> psi, T const& q = T(1.96))
        requires requires(F& f) { f.prediction(psi, q); }
    {
        return filter_.prediction(psi, q);
    }
    auto prediction(Regressor<T> psi, T const& q = T(1.96)) const
        requires requires(F const& f) { f.prediction(psi, q); }
    {
        return filter_.prediction(psi, q);
    }
    /// Of the filter inside.
    friend T variance(Weighted& f, Index j) { return variance(f.filter_, j); }
    friend T variance_along(Weighted& f, Regressor<T> psi) { return variance_along(f.filter_, psi); }
    static constexpr std::string_view layer = "weighted";
    static auto state(auto& f) { return std::tie(f.filter_, f.lambda_, f.by_); }

private:
    Regressor<T> row() const { return {psi_.data(), psi_.size()}; }
};

}  // namespace rlslab
