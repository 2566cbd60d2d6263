// A filter in coordinates in which its first rows are white: what Joseph's products need, and no scaling gives.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/linalg/triangles.hpp>

#include <array>
#include <tuple>

namespace rlslab {

/// F in the basis of the first rows:
///
///   (1) Start, which propagates R and z = R theta, takes the first n rows:  R'R = P_n^-1
///   (2) from then on, in eta = R theta:  R'phi = psi,  F takes (phi, y).  It starts from eta = z with covariance I
///   (3) theta = R^-1 eta,  K = R^-1 K_eta,  P = R^-1 P_eta R^-T
///
/// In exact arithmetic the same theta, K, P, innovation and gamma as F. R stays: nothing that is subtracted meets P's
/// condition number again, so that an F that stores P keeps about the digits of a factor; in joseph an error of the
/// gain stays of second order. Scaling the columns would do none of it: powers of two change no bit. The price is rows
/// that R no longer whitens, where lambda < 1 and the data change: P_eta is then as ill-conditioned as the change.
///
/// psi         may be any numbers of this filter
/// n           `first`, 0: 4 d. More, while R does not determine theta (no prior, too few rows)
/// stored()    Start's in (1), then P of (3), rounded once more
/// health      Start's in (1), then F's
/// Allocates when it is made, and in theta() and gain() of dynamic size. Cost: F's row and d^2/2 multiplications; (3)
/// d^2/2 for theta, as much for K, d^3 for P. Throws std::invalid_argument for first < 0, and as Start and F do.
/// Source: derived (docs/theory.md 119).
template <class F, class Start>
    requires TimeUpdates<F> && Real<typename F::scalar> && std::same_as<Truth<typename F::scalar>, bool> &&
             std::same_as<typename F::scalar, typename Start::scalar> &&
             (detail::size_of<F> == detail::size_of<Start>) && requires(Start s) {
                 requires std::same_as<decltype(s.form()), RootInformation<typename F::scalar, detail::size_of<F>>>;
             }
class Whitened {
    static constexpr int N = detail::size_of<F>;
    using T = typename F::scalar;
    F filter_;
    Start start_;
    T lambda_;
    StateMatrix<T, N> L_;  // R'
    StateVector<T, N> phi_;
    Index first_, rows_ = 0;
    bool whitened_ = false;

public:
    using scalar = T;
    static constexpr std::string_view name = F::name;
    static constexpr bool departs = true;  ///< a time update would have to know who holds P

    explicit Whitened(Problem<T> const& problem, Index first = 0)
        : filter_(Problem<T>{.size = problem.size, .forgetting = problem.forgetting, .prior = Prior<T>{}}),
          start_(problem), lambda_(problem.forgetting), L_(problem.size), phi_(problem.size),
          first_(first == 0 ? 4 * phi_.size() : first) {  // a fixed size may be left out of the problem
        expects(first >= 0, "0 or more first rows");
    }

    Step<T> update(Regressor<T> psi, T y) {
        if (!whitened_ && rows_ >= first_) whiten();
        if (!whitened_) {
            Step<T> const step = start_.update(psi, y);  // (1)
            ++rows_;
            return step;
        }
        keep_regressor(psi, phi_);
        solve_lower(L_, phi_);  // (2)
        return filter_.update(Regressor<T>{phi_.data(), phi_.size()}, y);
    }

    Vector<T, N> theta() const { return whitened_ ? back(filter_.theta()) : Vector<T, N>(start_.theta()); }
    Vector<T, N> gain() const { return whitened_ ? back(filter_.gain()) : Vector<T, N>(start_.gain()); }
    Stored<T> stored() const {
        if (!whitened_) return start_.stored();
        Matrix<T> P = multiplied_out(filter_.stored());
        for (int side = 0; side < 2; ++side) {  // (3): R^-1 P, then R^-1 of its transpose
            for (Index j = 0; j < P.cols(); ++j) {
                auto column = P.col(j);
                solve_lower_transposed(L_, column);
            }
            P.transposeInPlace();
        }
        return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, std::move(P)};
    }
    /// Whether (2) has begun.
    bool whitened() const { return whitened_; }
    F const& filter() const { return filter_; }
    static constexpr std::string_view layer = "whitened";
    static std::array<StateOption, 2> options(auto const& w) {
        return {{{"first", double(w.first_)}, {"whitened", double(w.whitened_), true}}};
    }
    static auto state(auto& w) { return std::tie(w.filter_, w.start_, w.lambda_, w.L_, w.rows_, w.whitened_); }

private:
    /// (1) is over, unless R is singular but for rounding, or not finite.
    void whiten() {
        auto const form = start_.form();
        if (!form.lengths.determined(form.L)) return;
        for (Index i = 0; i < phi_.size(); ++i)
            if (!is_finite(form.L(i, i)) || form.L(i, i) == T(0)) return;
        L_ = form.L;
        restart(filter_, T(1), Regressor<T>{form.z.data(), form.z.size()}, lambda_);
        whitened_ = true;
    }
    Vector<T, N> back(auto const& eta) const {
        Vector<T, N> out = eta;
        solve_lower_transposed(L_, out);
        return out;
    }
};

}  // namespace rlslab
