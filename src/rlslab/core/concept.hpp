// The concept every variant satisfies, and the abilities that only some have.
#pragma once

#include <rlslab/core/family.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/stored.hpp>

#include <array>
#include <span>

namespace rlslab {

/// Mathematics: after k updates theta() minimises J_k (see Problem), exactly in exact arithmetic; stored() is P_k, its
///              inverse, or a factor of either; gain() is K_k = P_k psi_k.
/// Members:     scalar, name                   T and the variant's name on the command line
///              F(Problem<T>)                  throws std::invalid_argument for a problem that is not well posed
///              update(psi, y) -> Step<T>      one row; allocates nothing (dense variants); breakdown is Step::health.
///                                             Throws std::invalid_argument unless psi has d numbers
///              theta(), gain(), stored()      reports. theta() and gain() have d numbers; where the filter stores
///                                             these, the report is a view of them, which the next update changes
/// Threads:     each may update filters of its own at any time. Several may read or copy one filter (const members) at
///              the same time, unless one of them updates it, or writes through its form. A thread keeps for itself the
///              stream of stochastic rounding, the length of variable precision, the format of fixed-point words, and
///              counts of operations: they are set in each
/// Unchecked:   determinism; that copying copies the whole state; that reports do not change later results.
///              The laws of tests/variants/battery.cpp check these. The concept is the syntax, the battery the
///              semantics.
template <class F>
concept RecursiveLeastSquares =
    Scalar<typename F::scalar> && std::copyable<F> && std::constructible_from<F, Problem<typename F::scalar>> &&
    requires(F f, F const c, Regressor<typename F::scalar> psi, typename F::scalar y) {
        { F::name } -> std::convertible_to<std::string_view>;
        { f.update(psi, y) } -> std::same_as<Step<typename F::scalar>>;
        { c.theta() } -> std::convertible_to<Vector<typename F::scalar>>;
        { c.gain() } -> std::convertible_to<Vector<typename F::scalar>>;
        { c.stored() } -> std::same_as<Stored<typename F::scalar>>;
    };

namespace detail {
/// N of a filter of fixed size, else Dynamic.
template <class F>
inline constexpr int size_of = std::remove_cvref_t<decltype(std::declval<F const&>().theta())>::SizeAtCompileTime;
}  // namespace detail

/// Over an ordered field. Compositions require it as long as their formulas are not written for complex numbers.
template <class F>
concept OverOrderedField = RecursiveLeastSquares<F> && Field<typename F::scalar>;

/// Propagates P, d x d, or a factor of it. covariance() is P; factors are multiplied out in the filter's own
/// arithmetic.
template <class F>
concept ReportsCovariance = RecursiveLeastSquares<F> && requires(F const c) {
    { c.covariance() } -> std::convertible_to<Matrix<typename F::scalar>>;
};

/// Propagates P^-1, d x d, or a factor of it. information() is P^-1; factors are multiplied out in the filter's own
/// arithmetic.
template <class F>
concept ReportsInformation = RecursiveLeastSquares<F> && requires(F const c) {
    { c.information() } -> std::convertible_to<Matrix<typename F::scalar>>;
};

/// Can start without a prior (Problem::prior = nullopt). Until the rows determine theta, health is undetermined and
/// theta() has no meaning.
template <class F>
concept StartsWithoutPrior = RecursiveLeastSquares<F> && F::starts_without_prior;

/// Changes a gain that is computed at once: perturb(K). Its type is K's.
template <class Perturb, class K>
concept PerturbsGain = std::invocable<Perturb&, K&>;
/// Changes a gain that a sweep builds column by column: perturb(v, kept), v its first j numbers after column j, and
/// kept what column j multiplied the earlier ones by before it added to them. What is changed stays so in all later
/// columns.
template <class Perturb, class T>
concept PerturbsSweep = std::invocable<Perturb&, std::span<T>, T const&>;

/// The default argument `perturb` of update: leaves the gain as it is.
struct NoPerturbation {
    template <class V, class... K>
    void operator()(V&&, K const&...) const {}
};

/// Uses a vector as the gain in its update of P (K itself, v = s K, or one that grows to it), and lets it be changed
/// first: update(psi, y, perturb) with a perturb that PerturbsGain, or PerturbsSweep; which one is said on the
/// variant's page.
template <class F>
concept GainPerturbable =
    ReportsCovariance<F> && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
        { f.update(psi, y, NoPerturbation{}) } -> std::same_as<Step<typename F::scalar>>;
    };

/// update(psi, y) in two steps. look(psi, y) computes e and s from the state, which it leaves as it is; commit(row)
/// with what look returned, and with no other call in between, is the rest of the update. A row that was looked at and
/// is not committed leaves no trace.
template <class F>
concept LooksFirst = RecursiveLeastSquares<F> && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y,
                                                          Innovation<typename F::scalar> row) {
    { f.look(psi, y) } -> std::same_as<Innovation<typename F::scalar>>;
    { f.commit(row) } -> std::same_as<Step<typename F::scalar>>;
};

/// accumulate(psi, y) processes one row without a report, for variants whose report costs more than the row. It leaves
/// the same state as update(psi, y), bit for bit unless rounding is stochastic. `accumulate` reports no health. If it
/// breaks the filter down, the next `update` reports that, and theta() is not finite.
template <class F>
concept Accumulates =
    RecursiveLeastSquares<F> && requires(F f, Regressor<typename F::scalar> psi, typename F::scalar y) {
        { f.accumulate(psi, y) } -> std::same_as<void>;
    };

/// update_block(psi, y) processes B >= 1 rows at once, the oldest first: psi is d x B, y has B numbers. It returns the
/// health after the last row; there is no Step. F::block is the number of rows that `process` passes at once.
template <class F>
concept TakesBlocks =
    RecursiveLeastSquares<F> && requires(F f, Matrix<typename F::scalar> psi, Vector<typename F::scalar> y) {
        { F::block } -> std::convertible_to<Index>;
        { f.update_block(psi, y) } -> std::same_as<PerLane<typename F::scalar, Health>>;
    };

/// rows_at_once(f, psi, y) processes B >= 1 rows that are known in advance, the oldest first: psi is d x B, y has B
/// numbers. It leaves the bits of update row by row and returns the last row's step, and is faster where docs/speed.md
/// says: the next row is multiplied while P changes for this one, or several rows are rotated in at the same time.
template <class F>
concept TakesRowsAtOnce =
    RecursiveLeastSquares<F> && requires(F f, Matrix<typename F::scalar> psi, Vector<typename F::scalar> y) {
        { rows_at_once(f, psi, y) } -> std::same_as<Step<typename F::scalar>>;
    };

/// Names its state in one line: state(f) is the tuple of references to all members that any later answer depends on,
/// and to nothing that the next row overwrites. One of them may name a state itself: so a type around a filter lists
/// the filter first and its own members after it. <rlslab/state/state.hpp> saves and loads what is named. A filter
/// whose type only the run knows has `hides_its_state`, and shows it by itself (src/catalogue/native/adaptive.hpp).
template <class F>
concept NamesItsState = requires(F& f, F const& c) {
    F::state(f);
    F::state(c);
} || requires { requires F::hides_its_state; };

/// One option of a type around a filter, or a count of what it took, as its state says it by name:
///   static std::array<StateOption, 2> options(auto const& f) { return {{{"every", double(f.every_)}, {"rows",
///   double(f.n_), true}}}; }
/// beside a `layer`, the type's own name: `name` is that of the filter inside. A state is refused where an option is
/// another, a count is not looked at. An algorithm whose bits change counts its `edition` up; without one it is 1.
struct StateOption {
    std::string_view name;
    double value;
    bool count = false;
};

/// f.merge(newer) appends the rows of `newer` to those of f. `newer` is a filter of the same problem that started
/// without prior. Except for rounding, f is then what it would be after processing newer's rows itself. Associative; a
/// `newer` without rows changes no bit.
template <class F>
concept Merges = StartsWithoutPrior<F> && requires(F f, F const& newer) { f.merge(newer); };

}  // namespace rlslab
