// Conventional RLS: the covariance by the matrix inversion lemma, as most textbooks and programs write it.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

/// Propagates P in full storage; the vector f is used both as the column P psi and as the row psi'P.
///
///   (1) f = P psi                  (2) s = lambda + psi'f           (3) K = f / s
///   (4) P = (P - K f') / lambda    (5) theta += K e
///
/// The antisymmetric part of a rounding error grows as lambda^-k (Verhaegen 1989); the form is here as a warning.
/// Storage d^2; per update 3 d^2 + O(d) multiplications. gamma outside [0, 1] reports breakdown. P may be indefinite
/// while gamma is inside: gamma depends on P along psi only.
/// Source: Plackett 1950.
template <Scalar T, int N = Dynamic>
class Conventional {
    RealOf<T> lambda_;
    DivisorNearOne<RealOf<T>> by_lambda_;
    StateVector<T, N> theta_, f_, K_;
    StateMatrix<T, N> P_;
    [[no_unique_address]] NextRow<kernels::SubtractRankOne<T>, N> next_;

public:
    using scalar = T;
    static constexpr std::string_view name = "conventional";
    static constexpr Family family{Family::conventional};

    explicit Conventional(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)), next_(problem.size) {}

    /// `perturb(K)` changes K between (3) and (4). Its error reaches P in first order: docs/theory.md 16.
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> update(Regressor<T> psi, T y, Perturb perturb = {}) {
        return commit(look(psi, y), perturb);
    }
    [[gnu::always_inline]] Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        multiply(P_, psi.data(), f_, next_);                                                             // (1)
        return {e, lambda_ + real_part(dot(psi, f_))};                                                   // (2)
    }
    template <PerturbsGain<StateVector<T, N>> Perturb = NoPerturbation>
    [[gnu::always_inline]] Step<T> commit(Innovation<T> const& row, Perturb perturb = {}) {
        auto const [e, s] = row;
        divide(f_, s, K_);                                                                               // (3)
        perturb(K_);
        subtract_rank_one(P_, K_, f_, by_lambda_, next_);                                                // (4)
        add_scaled(theta_, e, K_);                                                                       // (5)
        return step_of(e, lambda_, s, theta_);
    }

    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() requires Field<T> { return PlainCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, P_}; }
    friend Step<T> rows_at_once(Conventional& f, RowsOf<T> psi, OutputsOf<T> y) {
        return update_rows(f, f.next_, psi, y);
    }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};
static_assert(GainPerturbable<Conventional<double>>);

}  // namespace rlslab
