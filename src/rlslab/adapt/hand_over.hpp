// A filter and the sounder variant that goes on from its P before rounding has made it worthless.
#pragma once

#include <rlslab/state/convert.hpp>
#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/window.hpp>

#include <tuple>

namespace rlslab {

// --- how near to singular --------------------------------------------------------------------------------------------

/// The least of D_j / X_jj over the pivots D_j of what the form stores, X = P or P^-1: the share of a number on the
/// diagonal that the coordinates before it (ud and the roots of P: after it) do not explain. In (0, 1]; 0 or NaN where
/// X does not factor. With C, X scaled to a unit diagonal, it is at least C's least eigenvalue, and that is at least
/// the product of all shares over 2.72 (docs/theory.md 62). The parameters' units do not matter. L and D are workspace.
/// d^3/6 multiplications where P is stored plainly, else d^2.
template <class T, int N, class Storage>
T least_share(PlainCovariance<T, N, Storage> f, StateMatrix<T, N>& L, StateVector<T, N>& D) {
    if (!factor_ldl(f.P, L, D)) return T(0);
    T least = T(1);
    for (Index j = 0; j < D.size(); ++j) least = std::min(least, T(D[j] / f.P(j, j)));
    return least;
}
template <class T, int N>
T least_share(NormalEquations<T, N> f, StateMatrix<T, N>&, StateVector<T, N>&) {
    if (!f.solved) f.solve();
    if (!f.positive) return T(0);
    T least = T(1);
    for (Index j = 0; j < f.D.size(); ++j) least = std::min(least, T(f.D[j] / f.X(j, j)));
    return least;
}
template <class T, int N>
T least_share(UdCovariance<T, N> f, StateMatrix<T, N>&, StateVector<T, N>&) {
    T least = T(1);
    for (Index j = 0; j < f.D.size(); ++j) least = std::min(least, T(f.D[j] / variance(f, j)));
    return least;
}
template <class T, int N>
T least_share(RootCovariance<T, N, true> f, StateMatrix<T, N>&, StateVector<T, N>&) {
    T least = T(1);
    for (Index j = 0; j < f.theta.size(); ++j) least = std::min(least, T(f.S(j, j) * f.S(j, j) / variance(f, j)));
    return least;
}
namespace detail {
/// X_jj = sum_{k <= j} L_jk^2 D_k; without D it is 1.
template <class T, int N>
T least_share_of_rows(StateMatrix<T, N> const& L, StateVector<T, N> const* D) {
    T least = T(1);
    for (Index j = 0; j < L.size(); ++j) {
        T sum = T(0), last = T(0);
        for (Index k = 0; k <= j; ++k) {
            T const square = L(j, k) * L(j, k);
            last = D ? T(square * (*D)[k]) : square;
            sum += last;
        }
        least = std::min(least, T(last / sum));
    }
    return least;
}
/// Whether X is stored, whose rounding is worth u / share, and not a factor of it, worth u / sqrt(share).
template <class Form>
inline constexpr bool stores_the_square = false;
template <class T, int N, class Storage>
inline constexpr bool stores_the_square<PlainCovariance<T, N, Storage>> = true;
template <class T, int N>
inline constexpr bool stores_the_square<NormalEquations<T, N>> = true;
}  // namespace detail
template <class T, int N>
T least_share(RootInformation<T, N> f, StateMatrix<T, N>&, StateVector<T, N>&) {
    return detail::least_share_of_rows<T, N>(f.L, nullptr);
}
template <class T, int N>
T least_share(UnitInformation<T, N> f, StateMatrix<T, N>&, StateVector<T, N>&) {
    return detail::least_share_of_rows<T, N>(f.L, &f.D);
}

template <class F>
concept ReportsLeastShare =
    ReportsVariances<F> && Real<typename F::scalar> && std::same_as<Truth<typename F::scalar>, bool> &&
    requires(F f, StateMatrix<typename F::scalar, detail::size_of<F>> L,
             StateVector<typename F::scalar, detail::size_of<F>> D) { least_share(f.form(), L, D); };

// --- the relay -------------------------------------------------------------------------------------------------------

/// When a relay hands over.
struct RelayOptions {
    int bits = 10;    ///< to be left in the weakest direction of P, >= 0
    Index every = 0;  ///< rows from one look to the next; 0: 10 d
};

/// F until its P comes near to where F's rounding makes it worthless; from there on Sounder, which may be of a longer
/// arithmetic:
///
///   (1) share = least_share, every so many rows; u the roundoff of F's arithmetic
///   (2) share <= 2^bits d u where F stores P or P^-1, share <= (2^bits d u)^2 where it stores a factor: hand over
///   (3) so does a step that is indefinite, and hand_over(), which a guard calls (GuardPolicy::breakdown =
///     Action::hand_over)
///   (4) convert<Sounder>(F); where P no longer factors: P = v I, v the largest variance at the start, and theta where
///     it is finite
///
/// Before (2) holds it has F's bits. There is no way back. theta, gain and the step's numbers are rounded to F's
/// arithmetic, psi and y are exact in Sounder's where that is the longer one. Both filters are held: memory F and
/// Sounder, and d^2 numbers. A look costs d^3/6 multiplications at most: d^2/60 a row. Handing over allocates and takes
/// d^3 operations, once; nothing else does (F and Sounder allowing). For filters that follow their problem: not around
/// a guard, a rule or a window; a guard goes around it. Throws std::invalid_argument on misuse, as F does. Source:
/// derived (docs/theory.md 62).
template <ReportsLeastShare F, Downdates Sounder>
    requires(Downdates<F> && ReportsVariances<Sounder> && std::same_as<Truth<typename Sounder::scalar>, bool> &&
             detail::size_of<F> == detail::size_of<Sounder>)
class Relay {
    static constexpr int N = detail::size_of<F>;
    using T = typename F::scalar;
    using U = typename Sounder::scalar;
    F first_;
    Sounder second_;
    T lambda_, least_;
    RelayOptions options_;
    bool handed_ = false;
    Index since_ = 0;        // rows since the last look
    StateVector<U, N> psi_;  // psi in Sounder's arithmetic
    StateMatrix<T, N> L_;    // workspace of (1)
    StateVector<T, N> D_;

public:
    using scalar = T;
    static constexpr std::string_view name = F::name;
    static constexpr bool departs = true;  ///< a removal would have to know who took the row

    explicit Relay(Problem<T> const& problem, RelayOptions const& options = {})
        : first_(problem), second_(problem.template mapped<U>(&number_as<U, T>)), lambda_(problem.forgetting),
          options_(options), psi_(first_.theta().size()), L_(psi_.size()), D_(psi_.size()) {
        expects(options.bits >= 0 && options.bits < 60 && options.every >= 0,
                "bits from 0 to 59, a look every >= 0 rows");
        if (options_.every == 0) options_.every = 10 * psi_.size();
        double const part = std::ldexp(double(psi_.size()), options.bits) * epsilon<T>() / 2;
        least_ = T(detail::stores_the_square<decltype(first_.form())> ? part : part * part);  // (2)
    }

    Step<T> update(Regressor<T> psi, T y) { return handed_ ? second_step(psi, y) : watch(first_.update(psi, y)); }
    /// In two steps (look.hpp).
    Innovation<T> look(Regressor<T> psi, T y) {
        if (!handed_) return detail::look_at(first_, psi, y);
        auto const [e, s] = detail::look_at(second_, widened(psi), number_as<U>(y));
        return {number_as<T>(e), number_as<T>(s)};
    }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) {
        return handed_ ? second_step(psi, y) : watch(detail::commit(first_, row, psi, y));
    }
    Vector<T, N> theta() const { return handed_ ? narrowed(second_.theta()) : Vector<T, N>(first_.theta()); }
    Vector<T, N> gain() const { return handed_ ? narrowed(second_.gain()) : Vector<T, N>(first_.gain()); }
    void theta(StateVector<T, N>& out) const { handed_ ? narrow(second_.theta(), out) : detail::theta_of(first_, out); }
    void gain(StateVector<T, N>& out) const { handed_ ? narrow(second_.gain(), out) : detail::gain_of(first_, out); }
    Stored<T> stored() const {
        return handed_ ? second_.stored().template mapped<T>(&number_as<T, U>) : first_.stored();
    }
    static constexpr std::string_view layer = "relay";
    static std::array<StateOption, 3> options(auto const& r) {
        return {{{"bits", double(r.options_.bits)},
                 {"every", double(r.options_.every)},
                 {"handed_over", double(r.handed_), true}}};
    }
    static auto state(auto& r) { return std::tie(r.first_, r.second_, r.lambda_, r.handed_, r.since_); }

    bool handed_over() const { return handed_; }
    F const& first() const { return first_; }
    Sounder const& second() const { return second_; }

    /// (4). False where P did not factor, or where it was handed over before.
    bool hand_over() {
        if (handed_) return false;
        auto const made = convert<Sounder>(first_, number_as<U>(lambda_));  // may throw std::bad_alloc: before a change
        handed_ = true;
        if (made) {
            second_ = *made;
            return true;
        }
        U start = U(0);
        for (Index j = 0; j < psi_.size(); ++j) start = std::max(start, variance(second_, j));
        Vector<T, N> const theta = first_.theta();
        if (all_finite<T>(theta) && U(0) < start && is_finite(start))
            rlslab::restart(second_, start, widened(theta), number_as<U>(lambda_));
        return false;
    }

    /// What a guard asks for.
    friend T variance(Relay& r, Index j) {
        return r.handed_ ? number_as<T>(variance(r.second_, j)) : variance(r.first_, j);
    }
    friend T variance_along(Relay& r, Regressor<T> psi) {
        return r.handed_ ? number_as<T>(variance_along(r.second_, r.widened(psi))) : variance_along(r.first_, psi);
    }
    friend T watched_variance(Relay& r, Index j) {
        return r.handed_ ? number_as<T>(watched_variance(r.second_, j)) : watched_variance(r.first_, j);
    }
    friend bool symmetric_within(Relay& r, T const& share, Index i, Index j)
        requires MayLoseSymmetry<F>
    {
        return r.handed_ || symmetric_within(r.first_, share, i, j);
    }
    friend void restart(Relay& r, T const& variance, Regressor<T> theta, T const& lambda) {
        if (r.handed_) rlslab::restart(r.second_, number_as<U>(variance), r.widened(theta), number_as<U>(lambda));
        else rlslab::restart(r.first_, variance, theta, lambda);
    }
    friend Step<T> cap_row(Relay& r, Regressor<T> psi, T const& y, T const& lambda) {
        if (!r.handed_) return rlslab::cap_row(r.first_, psi, y, lambda);
        return narrowed(rlslab::cap_row(r.second_, r.widened(psi), number_as<U>(y), number_as<U>(lambda)));
    }

private:
    /// (1) to (3), after F's step.
    Step<T> watch(Step<T> const& step) {
        bool const look = ++since_ >= options_.every;
        if (look) since_ = 0;
        if (step.health == Health::indefinite || (look && step.health == Health::sound && !(least_ < share())))
            hand_over();
        return step;
    }
    T share() { return least_share(first_.form(), L_, D_); }  // (1)
    Regressor<U> widened(Regressor<T> x) {
        expects(x.size() == psi_.size(), "as many numbers as parameters");
        for (Index i = 0; i < x.size(); ++i) psi_[i] = number_as<U>(x[i]);
        return {psi_.data(), psi_.size()};
    }
    template <class V, class Out>
    static void narrow(V const& x, Out& out) {
        for (Index i = 0; i < x.size(); ++i) out[i] = number_as<T>(x[i]);
    }
    template <class V>
    static Vector<T, N> narrowed(V const& x) {
        Vector<T, N> out(x.size());
        narrow(x, out);
        return out;
    }
    static Step<T> narrowed(Step<U> const& step) {
        return {number_as<T>(step.innovation), number_as<T>(step.residual), number_as<T>(step.gamma), step.health};
    }
    Step<T> second_step(Regressor<T> psi, T const& y) {
        return narrowed(second_.update(widened(psi), number_as<U>(y)));
    }
};

}  // namespace rlslab
