// Coloured noise whose model is estimated too: past residuals become regressors.
#pragma once

#include <rlslab/adapt/assessed.hpp>

#include <algorithm>
#include <array>
#include <tuple>

namespace rlslab {

/// Extended least squares around F: y = psi'theta + C(q) e, C = 1 + c_1 q^-1 + ... + c_n q^-n, e white. With psi = (-y,
/// u) that is the model A y = B u + C e. F has d = p + n parameters, psi has p numbers.
///
///   (1) phi_k = [psi_k; eps_{k-1} ... eps_{k-n}]        (2) F takes (phi_k, y_k)
///   (3) eps_k = y_k - phi_k'theta_k, the residual of F's step
///
/// theta()     p numbers of psi, then c_1 ... c_n
/// n = 0       F's own bits
/// (3)         eps_k = 0, its mean, where the step is not sound or where a guard inside has set the row aside:
///             unknown() counts these rows. So a NaN enters no later row; what it does to F is F's own
/// pass_time() a row that is missing: time passes in F, and its residual is 0
/// F           a variant, or what is around one. This comes outermost: psi is shorter than theta, so that it is no
///             RecursiveLeastSquares itself
/// Converges to the true parameters where 1/C - 1/2 is strictly positive real, |C(e^iw) - 1| < 1 at every w; elsewhere
/// it may not (Ljung 1977, Solo 1979; both cited, not read). No estimate of C is moved into the stable region: where it
/// stays outside, residuals grow. Bias and variance beside least squares: docs/theory.md 89.
///
/// Allocates as F does. n + p assignments besides F's row. Throws std::invalid_argument unless 0 <= n <= d, for n > 0
/// without a prior (the residuals are 0 until theta is determined, and theta is not determined while they are 0; an F
/// that was made so stays undetermined), and for a psi of another size than p. Source: Panuska 1968, Young 1968 (both
/// cited, not read).
template <OverOrderedField F>
    requires std::same_as<Truth<typename F::scalar>, bool>
class ExtendedLeastSquares : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    detail::MovedSize order_;
    Index unknown_ = 0;
    StateVector<T, detail::size_of<F>> phi_, zero_;  // phi of the last row; 0
    T residual_ = T(0);                              // eps of the last row, which enters the next one

    void shift() {
        Index const p = regressors();
        for (Index i = phi_.size() - 1; i > p; --i) phi_[i] = phi_[i - 1];
        if (order() > 0) phi_[p] = residual_;
    }

public:
    static constexpr bool departs = true;  ///< from the problem's J

    /// `order` is n.
    explicit ExtendedLeastSquares(Problem<T> const& problem, Index order) : ExtendedLeastSquares(F(problem), order) {
        expects(order == 0 || problem.prior, "a prior: without one the residuals stay 0");
    }
    /// Around a filter that was made with options of its own.
    explicit ExtendedLeastSquares(F const& filter, Index order)
        : detail::AroundFilter<F>(filter), order_(order), phi_(filter.theta().size()), zero_(phi_.size()) {
        expects(0 <= order && order <= phi_.size(), "0 <= order of the noise <= parameters");
    }

    Step<T> update(Regressor<T> psi, T y) {
        expects(psi.size() == regressors(), "a regressor without the residuals, of p numbers");
        std::copy(psi.data(), psi.data() + psi.size(), phi_.data());
        shift();                                        // (1)
        Step<T> const step = filter_.update(phi(), y);  // (2)
        bool const known = step.health == Health::sound && !detail::guard_of(filter_).set_aside();
        unknown_ += known ? 0 : 1;
        residual_ = known ? step.residual : T(0);  // (3)
        return step;
    }
    /// Its step has no innovation and no residual.
    Step<T> pass_time() {
        for (Index i = 0; i < regressors(); ++i) phi_[i] = T(0);
        shift();
        residual_ = T(0);
        Step<T> const step = detail::pass_time(filter_, zero_);
        return {undefined<T>(), undefined<T>(), step.gamma, step.health};
    }

    Index order() const { return order_.value; }                     ///< n
    Index regressors() const { return phi_.size() - order(); }       ///< p
    Regressor<T> phi() const { return {phi_.data(), phi_.size()}; }  ///< of the last row, as F took it
    Index unknown() const { return unknown_; }                       ///< rows whose residual was not taken

    static constexpr std::string_view layer = "extended_least_squares";
    static std::array<StateOption, 2> options(auto const& f) {
        return {{{"order", double(f.order())}, {"unknown", double(f.unknown_), true}}};
    }
    static auto state(auto& f) { return std::tie(f.filter_, f.phi_, f.residual_, f.unknown_); }
};

}  // namespace rlslab
