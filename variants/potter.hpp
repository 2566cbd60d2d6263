// Potter's square-root form.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates a full square root S of the covariance, P = S S', semidefinite by construction.
///
///   (1) f = S'psi                  (2) s = lambda + f'f             (3) v = S f, K = v / s
///   (4) S = (S - v f' / (s + sqrt(lambda s))) / sqrt(lambda)        (5) theta += K e
///
/// Storage d^2; per update 4 d^2 + O(d) multiplications. Source: Potter 1963, in Bierman 1977.
template <RootedScalar T, int N = Dynamic>
class Potter {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_root_lambda_;
    StateVector<T, N> theta_, f_, v_, K_;
    StateMatrix<T, N> S_;

public:
    using scalar = T;
    static constexpr std::string_view name = "potter";
    static constexpr Family family{Family::root};

    explicit Potter(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_root_lambda_(square_root(lambda_)),
          theta_(start_theta<T, N>(problem)),
          f_(problem.size), v_(problem.size), K_(problem.size), S_(start_root<T, N>(problem)) {}

    /// `perturb(v)` changes v before K = v / s and (4). Its error reaches P in first order, P stays semidefinite:
    /// docs/theory.md 32.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        return commit(look(psi, y), perturb);
    }
    [[gnu::always_inline]] Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply_transposed(S_, psi.data(), f_);                                                         // (1)
        return {e, lambda_ + real_part(dot(f_, f_))};                                                    // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        multiply(S_, f_.data(), v_);                                                                     // (3)
        perturb(v_);
        divide(v_, s, K_);
        divide(f_, s + square_root(lambda_ * s), f_);                                                    // (4)
        subtract_rank_one(S_, v_, f_, by_root_lambda_);
        add_scaled(theta_, e, K_);                                                                       // (5)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return outer(S_); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::factor, S_.view()}; }
    auto form() requires Field<T> {
        return RootCovariance<T, N, false>{lambda_, by_root_lambda_, theta_, K_, f_, v_, S_};
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_root_lambda_, f.theta_, f.K_, f.S_); }
};
static_assert(GainPerturbable<Potter<double>>);

}  // namespace rlslab
