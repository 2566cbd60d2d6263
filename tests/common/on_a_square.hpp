// `symmetric` as its formulas say, on a P in full storage, one number at a time: what it must equal bit for bit.
#pragma once

#include <rlslab/linalg/next_row.hpp>
#include <rlslab/linalg/start.hpp>

namespace rlslab {

template <Hardware T, int N = Dynamic>
class SymmetricOnASquare {
    T lambda_;
    DivisorNearOne<T> by_lambda_;
    StateVector<T, N> theta_, f_, K_;
    StateMatrix<T, N> P_;

public:
    using scalar = T;
    static constexpr std::string_view name = "symmetric";
    static constexpr bool mirrored = true;

    explicit SymmetricOnASquare(Problem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), by_lambda_(lambda_), theta_(start_theta<T, N>(problem)),
          f_(problem.size), K_(problem.size), P_(start_covariance<T, N>(problem)) {}

    Step<T> update(Regressor<T> psi, T y) { return commit(look(psi, y)); }
    Innovation<T> look(Regressor<T> psi, T y) {
        T const e = innovation(y, psi, theta_);
        for (Index i = 0; i < f_.size(); ++i) f_[i] = P_(i, 0) * psi[0];
        for (Index j = 1; j < f_.size(); ++j)
            for (Index i = 0; i < f_.size(); ++i) f_[i] += P_(i, j) * psi[j];
        return {e, lambda_ + dot(psi, f_)};
    }
    Step<T> commit(Innovation<T> const& row) {
        divide(f_, row.s, K_);
        for (Index j = 0; j < f_.size(); ++j)
            for (Index i = 0; i <= j; ++i) P_(j, i) = P_(i, j) = by_lambda_(P_(i, j) - K_[i] * f_[j]);
        add_scaled(theta_, row.e, K_);
        return step_of(row.e, lambda_, row.s, theta_);
    }
    auto theta() const { return theta_.view(); }
    auto gain() const { return K_.view(); }
    Matrix<T, N> covariance() const { return P_.view(); }
    Stored<T> stored() const { return {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, P_.view()}; }
    auto form() { return PlainCovariance<T, N>{lambda_, by_lambda_, theta_, K_, f_, P_}; }
    static auto state(auto& f) { return std::tie(f.lambda_, f.by_lambda_, f.theta_, f.K_, f.P_); }
};

}  // namespace rlslab
