// The problem every variant solves, and what one update reports.
#pragma once

#include <rlslab/core/scalar.hpp>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rlslab {

using Index = Eigen::Index;
inline constexpr int Dynamic = Eigen::Dynamic;

/// Eigen's types at the interface: estimates, covariances, data. Arithmetic inside a variant is not Eigen's.
/// DontAlign: how Eigen allocates aligned storage depends on the instruction set it is compiled for, and the compiled core
/// and an app may differ in that; these types are laid out, allocated and freed alike everywhere.
template <class T, int N = Dynamic>
using Vector = Eigen::Matrix<T, N, 1, Eigen::DontAlign>;
template <class T, int N = Dynamic>
using Matrix = Eigen::Matrix<T, N, N, Eigen::DontAlign>;

template <class T>
struct Stored;

/// What is believed before the first row: theta0, and P0 = variance x I, a full P0, or a factor of it or of its inverse.
template <Field T>
struct Prior {
    T variance = T(16384);                     ///< c^2 of P0 = c^2 I, > 0; 2^14 is exact in every arithmetic
    std::optional<Vector<T>> theta = {};       ///< theta0, size d; absent: 0
    std::optional<Matrix<T>> covariance = {};  ///< P0, d x d, symmetric positive definite; absent: variance x I
    std::optional<Stored<T>> stored = {};      ///< P0 as a filter stores it, in place of both: factors are handed on, P is not made
};

/// Minimise over theta, after k rows,
///   J_k = lambda^k (theta - theta0)' P0^-1 (theta - theta0) + sum_i lambda^(k-i) (y_i - psi_i' theta)^2.
/// Without a prior the first term is absent; only variants that can start from no information take that.
template <Field T>
struct Problem {
    Index size = 0;                              ///< d >= 1, the number of parameters
    T forgetting = T(1);                         ///< lambda, 0 < lambda <= 1
    std::optional<Prior<T>> prior = Prior<T>{};  ///< nullopt: none
};

/// Breakdown is a result.
///   sound          0 <= gamma <= 1, as for every positive definite P; 0 only by underflow. theta() and gain() are finite: looked at
///                  where they are kept; proven, or else solved for, where they are solved for on request (linalg/finite.hpp). What
///                  overflows in the store shows at once where a sum of this step has it, at the next step at the latest
///   undetermined   without a prior: fewer independent rows than parameters before this one, so that there was no theta
///                  to innovate on; the row that determines theta is the last to say so. Read off exact zeros: rounding
///                  may leave a tiny pivot where exact arithmetic has none, and such a pivot counts
///   indefinite     the computed psi'P psi is negative, or a factorisation met a pivot <= 0
///   nonfinite      an infinity (s beyond the arithmetic's range included) or a NaN
/// A sound step is necessary for a definite P, not sufficient: a variant that stores P plainly sees P only along psi.
enum class Health { sound, undetermined, indefinite, nonfinite };

constexpr std::string_view name_of(Health health) {
    constexpr std::string_view names[] = {"sound", "undetermined", "indefinite", "nonfinite"};
    return names[static_cast<int>(health)];
}

/// The worse of two.
constexpr Health worse(Health a, Health b) { return a < b ? b : a; }

/// What one update reports.
template <Field T>
struct Step {
    T innovation;  ///< e = y - psi' theta(k-1)
    T residual;    ///< y - psi' theta(k), evaluated as gamma e
    T gamma;       ///< conversion factor lambda / s, in (0, 1]; 0 when it underflows
    PerLane<T, Health> health = Health::sound;
};

/// Lane by lane.
template <Field T>
Step<T> select(Truth<T> const& truth, Step<T> const& a, Step<T> const& b)
    requires(!std::same_as<Truth<T>, bool>)
{
    return {select(truth, a.innovation, b.innovation), select(truth, a.residual, b.residual), select(truth, a.gamma, b.gamma),
            select(truth, a.health, b.health)};
}

/// A report of one update from e and gamma alone; the health they show.
template <Field T>
Step<T> report(T const& innovation, T const& gamma) {
    PerLane<T, Health> health = Health::sound;
    health = select(gamma < T(0) || T(1) < gamma, PerLane<T, Health>(Health::indefinite), health);
    health = select(is_finite(innovation) && is_finite(gamma), health, PerLane<T, Health>(Health::nonfinite));
    return {innovation, gamma * innovation, gamma, health};
}

/// The same where s is at hand: gamma = lambda / s, and an overflow of s does not pass as a small gamma.
template <Field T>
Step<T> report(T const& innovation, T const& lambda, T const& s) {
    return if_finite(is_finite(s), report(innovation, T(lambda / s)));
}

/// The step, but nonfinite where what it leaves behind is not finite.
template <Field T>
Step<T> if_finite(Truth<T> const& finite, Step<T> step) {
    step.health = select(finite, step.health, PerLane<T, Health>(Health::nonfinite));
    return step;
}

/// The health after rows that were taken without a step: whether they were finite, theta is determined, and what is answered is finite.
template <Field T>
PerLane<T, Health> health_of(Truth<T> const& taken, Truth<T> const& determined, Truth<T> const& finite) {
    using H = PerLane<T, Health>;
    H const answered = select(determined, select(finite, H(Health::sound), H(Health::nonfinite)), H(Health::undetermined));
    return select(taken, answered, H(Health::nonfinite));
}

/// What is not defined: NaN in every scalar that has one.
template <Field T>
T undefined() {
    if constexpr (Real<T>)  // the rationals have none
        return T(std::numeric_limits<double>::quiet_NaN());
    else return T(0);
}

/// gamma = 0: without a prior, before theta is defined, there is no innovation to report. `seen` is any number that data
/// which are not finite have spoilt.
template <Field T>
Step<T> report_undetermined(T const& seen) {
    return {undefined<T>(), T(0), T(0),
            select(is_finite(seen), PerLane<T, Health>(Health::undetermined), PerLane<T, Health>(Health::nonfinite))};
}

/// The report of a rotated row: eta at the end of it, sqrt(gamma), the product of the cosines, and whether R had no zero
/// on its diagonal before. Where sqrt(gamma) underflows the innovation is lost and said to be: nonfinite.
template <Field T>
Step<T> report_rotated(T const& eta, T const& root_gamma, Truth<T> const& determined) {
    T const gamma = root_gamma * root_gamma;
    Step<T> step = report(T(eta / root_gamma), gamma);
    step.residual = eta * root_gamma;
    return select(determined, step, report_undetermined(eta));
}

/// Misuse throws at the door, saying what was expected.
inline void expects(bool holds, char const* what) {
    if (!holds) throw std::invalid_argument(std::string("expected ") + what);
}

/// Throws std::invalid_argument unless the problem is well posed as stated (definiteness of a full P0: start.hpp).
/// A prior that overflowed the scalar's range is let in: what follows is numerical breakdown, not misuse.
template <Field T>
Problem<T> const& checked(Problem<T> const& problem, int fixed_size = Dynamic) {
    expects(problem.size >= 1, "size >= 1");
    expects(fixed_size == Dynamic || problem.size == fixed_size, "size equal to the filter's fixed size");
    expects(all(T(0) < problem.forgetting && problem.forgetting <= T(1)), "0 < forgetting <= 1");
    if (problem.prior) {
        auto const& prior = *problem.prior;
        expects(all(T(0) < prior.variance), "prior variance > 0");
        expects(!prior.theta || prior.theta->size() == problem.size, "prior theta of the problem's size");
        expects(!prior.covariance || (prior.covariance->rows() == problem.size && prior.covariance->cols() == problem.size),
                "prior covariance of the problem's size");
        expects(!prior.stored || (prior.stored->F.rows() == problem.size && prior.stored->F.cols() == problem.size &&
                                  (prior.stored->D.size() == 0 || prior.stored->D.size() == problem.size)),
                "a stored prior of the problem's size");
        if (prior.covariance)
            for (Index j = 0; j < problem.size; ++j)
                for (Index i = 0; i < j; ++i)
                    expects(all((*prior.covariance)(i, j) == (*prior.covariance)(j, i)), "a symmetric prior covariance");
    }
    return problem;
}

namespace detail {
template <class C>
concept OfEigen = requires(C const& c) { []<class Derived>(Eigen::DenseBase<Derived> const&) {}(c); };

/// Numbers one after another in memory, for all that is known when compiling: of Eigen a vector, a map, a column; of the standard
/// library what std::span takes. The row of a matrix by columns, a reversed or a strided map, an expression are not.
template <class C, class T>
concept Contiguous = (OfEigen<C> && requires(C const& c) {
                         { c.data() } -> std::convertible_to<T const*>;
                         requires bool(C::IsVectorAtCompileTime) && C::InnerStrideAtCompileTime == 1;
                     }) || (!OfEigen<C> && std::convertible_to<C const&, std::span<T const>>);
}  // namespace detail

/// A regressor psi: a view of d numbers, one after another in memory: an Eigen vector, a std::vector, a std::array, a row of
/// data, numbers in braces. What is not contiguous does not compile: update(X.row(k).eval(), y) copies it.
template <Field T>
class Regressor {
    T const* data_;
    Index size_;

public:
    /// A pointer and a size. The literal 0 is no pointer: {0, 2} are two numbers.
    template <std::same_as<T> Number>
    Regressor(Number const* data, Index size) : data_(data), size_(size) {}
    Regressor(std::initializer_list<T> numbers) : Regressor(numbers.begin(), Index(numbers.size())) {}
    template <detail::Contiguous<T> Container>
    Regressor(Container const& c) : Regressor(std::data(c), Index(std::size(c))) {}
    T const* data() const { return data_; }
    Index size() const { return size_; }
    T const& operator[](Index i) const { return data_[i]; }
};

}  // namespace rlslab

#include <rlslab/core/stored.hpp>  // completes Prior
