// Several outputs with one regressor: one P and one gain for all of them.
#pragma once

#include <rlslab/adapt/around.hpp>

#include <array>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace rlslab {

namespace detail {
/// m copies of x, in place where m is fixed.
template <int m, class X>
auto copies_of(Index count, X const& x) {
    if constexpr (m == Dynamic) return std::vector<X>(size_t(count), x);
    else
        return [&x]<size_t... j>(std::index_sequence<j...>) {
            return std::array<X, size_t(m)>{((void)j, x)...};
        }(std::make_index_sequence<size_t(m)>{});
}
}  // namespace detail

/// What a row is worth in which an output is missing: NaN, or infinite.
///   drops_the_row   for all outputs: time passes, P -> P / lambda, no theta changes. P is then right for every output
///   stands          for the others nothing changes, bit for bit; the theta of the one that is missing stands, and its
///                   P is too small
enum class MissingOutput : unsigned char { drops_the_row, stands };

/// m outputs y_j = psi'theta_j + noise of one psi, each noise white with a variance of its own:
///
///   (1) e_j = y_j - psi'theta_j        (2) F's row: P, and K = P psi        (3) theta_j += K e_j,  residual gamma e_j
///
/// F holds the first theta and is fed y_1; the others need d multiplications for (1) and d for (3) each, in place of a
/// filter. Each theta_j and each step is that of an F of its own, bit for bit: for the forms that propagate P or a
/// factor of it and store theta. The information forms solve for theta, with a right-hand side an output: they do not
/// compile here.
///
/// Starts all from the problem's theta0. psi may be the gain's own numbers; a psi that is not finite spoils all
/// outputs, as it spoils F. Rows whose variance differs: sqrt(w) psi and sqrt(w) y, one w a row. Correlated noise
/// changes nothing in theta: y = psi'Theta with one psi for all. M outputs fixed: no heap where F has none; Dynamic:
/// allocates where it is made. Throws std::invalid_argument unless there is an output, and for a psi or y of another
/// size. A step's health is the worse of its own numbers' and F's. Source: folklore; docs/theory.md 64.
template <TimeUpdates F, int M = Dynamic>
    requires(ReportsCovariance<F> && std::same_as<Truth<typename F::scalar>, bool> && !requires { F::departs; } &&
             (M == Dynamic || M >= 1))
class MultiOutput : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    static constexpr int N = detail::size_of<F>;
    template <class X>
    using Row = decltype(detail::copies_of<M>(Index(1), std::declval<X const&>()));
    Row<StateVector<T, N>> theta_;  // the first one's place is workspace
    Row<Step<T>> steps_;
    StateVector<T, N> psi_;
    MissingOutput missing_;

    static Index checked(Index outputs) {
        expects(outputs >= 1 && (M == Dynamic || outputs == M), "as many outputs as the type has, at least one");
        return outputs;
    }
    Regressor<T> psi() const { return {psi_.data(), psi_.size()}; }

public:
    explicit MultiOutput(Problem<T> const& problem, Index outputs = M == Dynamic ? 1 : M,
                         MissingOutput missing = MissingOutput::drops_the_row)
        : detail::AroundFilter<F>(F(problem)),
          theta_(detail::copies_of<M>(checked(outputs), StateVector<T, N>(filter_.theta().size()))),
          steps_(detail::copies_of<M>(outputs, Step<T>{T(0), T(0), T(1)})), psi_(filter_.theta().size()),
          missing_(missing) {
        for (auto& theta : theta_)
            for (Index i = 0; i < psi_.size(); ++i) theta[i] = filter_.theta()[i];
    }

    Index outputs() const { return Index(theta_.size()); }

    /// One row: m outputs. The steps are good until the next row. An output that is missing has no innovation and no
    /// residual.
    std::span<Step<T> const> update(Regressor<T> given, Regressor<T> y) {
        expects(outputs() >= 1 && y.size() == outputs(), "as many outputs as there are thetas, at least one");
        keep_regressor(given, psi_);
        bool const whole = y_is_whole(y), used = whole || missing_ == MissingOutput::stands;
        if (!used)
            for (Index i = 0; i < psi_.size(); ++i) psi_[i] = T(0);
        for (Index j = 1; j < outputs(); ++j)
            steps_[size_t(j)].innovation = innovation(y[j], psi(), theta_[size_t(j)]);  // (1)
        // A first output that is missing is as predicted: e_1 = 0.
        T const first = !used ? T(0) : is_finite(y[0]) ? y[0] : predicted();
        Step<T> const step = filter_.update(psi(), first);  // (2)
        auto const K = filter_.gain();
        for (Index j = 0; j < outputs(); ++j) {
            bool const there = used && is_finite(y[j]);
            Step<T>& mine = steps_[size_t(j)];
            if (!there) {
                mine = {undefined<T>(), undefined<T>(), step.gamma, step.health};
            } else if (j == 0) {
                mine = step;
            } else {
                StateVector<T, N>& theta = theta_[size_t(j)];
                add_scaled(theta.data(), mine.innovation, K.data(), theta.size());  // (3)
                mine = if_finite<T>(all_finite(theta), step_of(mine.innovation, step.gamma));
                mine.health = worse(mine.health, step.health);
            }
        }
        return {steps_.data(), steps_.size()};
    }
    std::span<Step<T> const> steps() const { return {steps_.data(), steps_.size()}; }  ///< of the last row

    /// d x m, a column an output.
    Matrix<T, N, M> theta() const {
        Matrix<T, N, M> out(psi_.size(), outputs());
        for (Index j = 0; j < outputs(); ++j)
            for (Index i = 0; i < psi_.size(); ++i) out(i, j) = j == 0 ? filter_.theta()[i] : theta_[size_t(j)][i];
        return out;
    }
    /// theta of one output, good until the next row.
    Regressor<T> theta_of(Index j) const {
        return j == 0 ? Regressor<T>(filter_.theta()) : Regressor<T>(theta_[size_t(j)].data(), psi_.size());
    }
    Matrix<T, N> covariance() const { return filter_.covariance(); }
    static constexpr std::string_view layer = "outputs";
    static std::array<StateOption, 2> options(auto const& f) {
        return {{{"outputs", double(f.outputs())}, {"missing", double(f.missing_)}}};
    }
    static auto state(auto& f) { return std::tie(f.filter_, f.theta_); }

private:
    static bool y_is_whole(Regressor<T> y) {
        bool out = true;
        for (Index j = 0; j < y.size(); ++j) out = out && is_finite(y[j]);
        return out;
    }
    T predicted() const {
        auto const theta = filter_.theta();
        return dot(theta.data(), psi_.data(), psi_.size());
    }
};

}  // namespace rlslab
