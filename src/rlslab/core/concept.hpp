// The concept every variant satisfies, and the abilities that only some have.
#pragma once

#include <rlslab/core/stored.hpp>

namespace rlslab {

/// Mathematics: after k updates theta() minimises J_k (see Problem), exactly in exact arithmetic; stored() is P_k, its
///              inverse, or a factor of either; gain() is K_k = P_k psi_k.
/// Members:     scalar, name                   T and the variant's name on the command line
///              F(Problem<T>)                  throws std::invalid_argument on misuse
///              update(psi, y) -> Step<T>      one row; allocates nothing (dense variants); breakdown is Step::health
///              theta(), gain(), stored()      reports; theta() and gain() are views into the filter where it holds them
/// Unchecked:   determinism; that copying copies the whole state; that reports do not change what follows.
///              The laws of tests/battery.cpp check these. The concept is the syntax, the battery the semantics.
template <class F>
concept RecursiveLeastSquares = Field<typename F::scalar> && std::copyable<F> && std::constructible_from<F, Problem<typename F::scalar>> &&
                                requires(F f, F const c, Regressor<typename F::scalar> psi, typename F::scalar y) {
                                    { F::name } -> std::convertible_to<std::string_view>;
                                    { f.update(psi, y) } -> std::same_as<Step<typename F::scalar>>;
                                    { c.theta() } -> std::convertible_to<Vector<typename F::scalar>>;
                                    { c.gain() } -> std::convertible_to<Vector<typename F::scalar>>;
                                    { c.stored() } -> std::same_as<Stored<typename F::scalar>>;
                                };

/// Propagates P, or a factor of it: covariance() multiplies the factors out in the filter's own arithmetic.
template <class F>
concept ReportsCovariance = RecursiveLeastSquares<F> && requires(F const c) {
    { c.covariance() } -> std::convertible_to<Matrix<typename F::scalar>>;
};

/// Propagates P^-1, or a factor of it.
template <class F>
concept ReportsInformation = RecursiveLeastSquares<F> && requires(F const c) {
    { c.information() } -> std::convertible_to<Matrix<typename F::scalar>>;
};

/// Can start from no information at all (Problem::prior = nullopt).
template <class F>
concept StartsWithoutPrior = RecursiveLeastSquares<F> && F::starts_without_prior;

/// What an update does with its gain unless told otherwise: nothing.
struct NoPerturbation {
    template <class K>
    void operator()(K&) const {}
};

/// Uses K in the update of P, and lets it be changed just before: update(psi, y, perturb) calls perturb(K).
template <class F>
concept GainPerturbable = ReportsCovariance<F> && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
    { f.update(psi, y, NoPerturbation{}) } -> std::same_as<Step<typename F::scalar>>;
};

/// Takes one row without reporting on it, for those whose report costs more than the row: accumulate(psi, y) leaves what
/// update(psi, y) leaves, bit for bit (where rounding is not at random). Breakdown that lasts shows at the next update and in theta().
template <class F>
concept Accumulates = RecursiveLeastSquares<F> && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
    { f.accumulate(psi, y) } -> std::same_as<void>;
};

/// Takes a block of rows at once, oldest first, columns of psi, cheaper or better than row by row; says how it stands after the last.
template <class F>
concept TakesBlocks = RecursiveLeastSquares<F> && requires(F f, Matrix<typename F::scalar> psi, Vector<typename F::scalar> y) {
    { F::block } -> std::convertible_to<Index>;
    { f.update_block(psi, y) } -> std::same_as<PerLane<typename F::scalar, Health>>;
};

/// Names its state in one line: state(f) is the tuple of references to all members that any later answer depends on, and to nothing
/// that the next row overwrites. One of them may name a state itself: so a type around a filter lists the filter first and its own
/// members after it. <rlslab/adapt/state.hpp> saves and loads what is named.
template <class F>
concept NamesItsState = requires(F& f, F const& c) {
    F::state(f);
    F::state(c);
};

/// f.merge(newer) puts after f's rows those of newer, a filter of the same problem that started without prior: f is then,
/// but for rounding, what it would be had it taken newer's rows itself. Associative; an empty newer changes no bit.
template <class F>
concept Merges = StartsWithoutPrior<F> && requires(F f, F const& newer) { f.merge(newer); };

}  // namespace rlslab
