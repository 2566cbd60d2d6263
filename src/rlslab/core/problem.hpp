// The problem every variant solves, and what one update reports.
#pragma once

#include <rlslab/core/misuse.hpp>
#include <rlslab/core/stored.hpp>

#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

namespace rlslab {

namespace detail {
/// 2^14, or half of the exponents where the arithmetic has fewer than 28: P0 |psi|^2 then stays in its range until
/// |psi|^2 takes up the other half (binary16: 2^7).
template <Field R>
R default_variance() {
    if constexpr (requires { ArithmeticTraits<R>::max_exp; }) {
        if constexpr (ArithmeticTraits<R>::min_exp + ArithmeticTraits<R>::digits < 0)
            if (max_exponent<R>() < 28) return R(std::ldexp(1.0, max_exponent<R>() / 2));
    }
    return R(16384);
}
}  // namespace detail

/// What is known before the first row: theta0, and P0 = variance x I, a full P0, or a factor of it or of its inverse.
/// P0 is in units of the noise variance sigma^2.
template <Scalar T>
struct Prior {
    /// c^2 of P0 = c^2 I, > 0. 2^14, exact in every arithmetic; of formats with fewer than 28 exponents above 1 half of
    /// these, binary16 2^7
    RealOf<T> variance = detail::default_variance<RealOf<T>>();
    std::optional<Vector<T>> theta = {};  ///< theta0, size d; absent: 0
    /// P0, d x d, symmetric (Hermitian) positive definite; absent: variance x I. Filters take its upper triangle. An
    /// inverse, or the P of a form that stores it in full, may differ from its mirror image by
    /// |P_ij - P_ji| <= 2^(-p/2) sqrt(P_ii P_jj), half of p digits; (P + P')/2 does not differ.
    std::optional<Matrix<T>> covariance = {};
    std::optional<Stored<T>> stored =
        {};  ///< P0 as a filter stores it, in place of both: factors are handed on, P is not made
};

/// Minimise over theta, after k rows,
///   J_k = lambda^k (theta - theta0)' P0^-1 (theta - theta0) + sum_i lambda^(k-i) (y_i - psi_i' theta)^2.
/// Without a prior the first term is absent; only variants that satisfy StartsWithoutPrior accept that. With complex
/// numbers ' is the conjugate transpose, and the square is |y - psi'theta|^2 (docs/notation.md).
template <Scalar T>
struct Problem {
    Index size = 0;  ///< d >= 1, the number of parameters; may be left out for a filter of fixed size
    RealOf<T> forgetting = RealOf<T>(1);         ///< lambda, 0 < lambda <= 1
    std::optional<Prior<T>> prior = Prior<T>{};  ///< nullopt: none

    /// The problem with convert(x) in place of each number x.
    template <Field To, class Convert>
        requires Field<T>
    Problem<To> mapped(Convert convert) const {
        Problem<To> out{.size = size, .forgetting = convert(forgetting), .prior = std::nullopt};
        if (!prior) return out;
        out.prior = Prior<To>{.variance = convert(prior->variance)};
        if (prior->theta) out.prior->theta = prior->theta->unaryExpr(convert);
        if (prior->covariance) out.prior->covariance = prior->covariance->unaryExpr(convert);
        if (prior->stored) out.prior->stored = prior->stored->template mapped<To>(convert);
        return out;
    }
};

/// Whether lambda is a forgetting factor.
template <Field T>
Truth<T> is_forgetting_factor(T const& lambda) {
    return T(0) < lambda && lambda <= T(1);
}

/// Breakdown is a result.
///   sound          0 <= gamma <= 1, as for every positive definite P; 0 only by underflow. theta() and gain() are
///                  finite: tested where the filter stores them, otherwise proven finite or solved for
///                  (linalg/finite.hpp). An overflow in the stored numbers is reported by this step if one of its sums
///                  contains it, and by the next step at the latest
///   undetermined   without a prior: before this row there were fewer independent rows than parameters, so that no
///                  theta could predict y. The row that determines theta is the last to report this. Independent means
///                  that each pivot stands above its own rounding, |R_jj| > 2^min(p/4, 10) u max |R_ij|
///                  (linalg/triangles.hpp): a pivot that rounding left where exact arithmetic has a zero is none.
///                  theta() then is what rounding made of it, and may be 1e15. A passage of forgetting that wears a
///                  pivot down brings it back. In rationals and in fixed point exact zeros decide
///   indefinite     the computed psi'P psi is negative, or a factorisation met a pivot <= 0
///   nonfinite      an infinity (s beyond the arithmetic's range included) or a NaN
/// A sound step is necessary for a definite P, not sufficient: a variant that stores P plainly sees P only along psi.
enum class Health { sound, undetermined, indefinite, nonfinite };

constexpr std::string_view name_of(Health health) {
    constexpr std::string_view names[] = {"sound", "undetermined", "indefinite", "nonfinite"};
    return names[static_cast<int>(health)];
}

/// The worse of two, in the order of the enumeration.
constexpr Health worse(Health a, Health b) { return a < b ? b : a; }

template <>
struct Encoding<Health> {
    static constexpr std::size_t size = 1;
    static void write(Health const& x, std::byte* to) { *to = std::byte(x); }
    static bool read(std::byte const* from, Health& x) {
        x = Health(std::to_integer<int>(*from));
        return x <= Health::nonfinite;
    }
};

/// What a row shows before it changes anything.
template <Scalar T>
struct Innovation {
    T e;          ///< y - psi' theta(k-1), in the unit of y
    RealOf<T> s;  ///< innovation variance lambda + psi' P psi, in units of the noise's
};

/// What one update reports. While theta is undetermined innovation and residual are NaN and gamma is 0.
template <Scalar T>
struct Step {
    T innovation;     ///< e = y - psi' theta(k-1), in the unit of y
    T residual;       ///< y - psi' theta(k), evaluated as gamma e
    RealOf<T> gamma;  ///< conversion factor lambda / s, in (0, 1], without unit; 0 when it underflows
    PerLane<T, Health> health = Health::sound;
};

/// a in the lanes where `truth` holds, b in the others.
template <Scalar T>
Step<T> select(Truth<T> const& truth, Step<T> const& a, Step<T> const& b)
    requires(!std::same_as<Truth<T>, bool>)
{
    return {select(truth, a.innovation, b.innovation), select(truth, a.residual, b.residual),
            select(truth, a.gamma, b.gamma), select(truth, a.health, b.health)};
}

/// The step of an update with innovation e and conversion factor gamma; its residual is gamma e. Health is nonfinite if
/// e or gamma is not finite, else indefinite if gamma lies outside [0, 1], else sound.
template <Scalar T>
Step<T> step_of(T const& innovation, std::type_identity_t<RealOf<T>> const& gamma) {
    using R = RealOf<T>;
    PerLane<T, Health> health = Health::sound;
    health = select(gamma < R(0) || R(1) < gamma, PerLane<T, Health>(Health::indefinite), health);
    health = select(is_finite(innovation) && is_finite(gamma), health, PerLane<T, Health>(Health::nonfinite));
    return {innovation, gamma * innovation, gamma, health};
}

/// The same for gamma = lambda / s. If s overflowed, health is nonfinite: gamma alone would be 0 and look sound.
template <Scalar T>
Step<T> step_of(T const& innovation, std::type_identity_t<RealOf<T>> const& lambda,
                std::type_identity_t<RealOf<T>> const& s) {
    return if_finite(is_finite(s), step_of(innovation, RealOf<T>(lambda / s)));
}

/// The step, with health nonfinite in the lanes where `finite` is false.
template <Scalar T>
Step<T> if_finite(Truth<T> const& finite, Step<T> step) {
    step.health = select(finite, step.health, PerLane<T, Health>(Health::nonfinite));
    return step;
}

/// The health after rows that were processed without a step. rows_finite: the rows were finite; determined: they
/// determine theta; finite: theta and the gain are finite. The first condition that fails decides: nonfinite,
/// undetermined, nonfinite.
template <Scalar T>
PerLane<T, Health> health_of(Truth<T> const& rows_finite, Truth<T> const& determined, Truth<T> const& finite) {
    using H = PerLane<T, Health>;
    H const answered =
        select(determined, select(finite, H(Health::sound), H(Health::nonfinite)), H(Health::undetermined));
    return select(rows_finite, answered, H(Health::nonfinite));
}

/// The value of a result that is not defined: NaN, or 0 in a scalar that has no NaN (the rationals).
template <Scalar T>
T undefined() {
    if constexpr (ComplexScalar<T>) return {undefined<RealOf<T>>(), undefined<RealOf<T>>()};
    else if constexpr (Real<T>)  // the rationals have none
        return T(std::numeric_limits<double>::quiet_NaN());
    else return T(0);
}

/// The step before theta is determined: innovation and residual are undefined(), gamma is 0. `seen` is a number
/// computed from the row that is not finite if the row was not: health is then nonfinite instead of undetermined.
template <Scalar T>
Step<T> report_undetermined(T const& seen) {
    return {undefined<T>(), T(0), RealOf<T>(0),
            select(is_finite(seen), PerLane<T, Health>(Health::undetermined), PerLane<T, Health>(Health::nonfinite))};
}

/// The step in the lanes where theta was determined before it, elsewhere report_undetermined(seen), or of its
/// innovation.
template <Scalar T>
Step<T> if_determined(Truth<T> const& determined, Step<T> const& step, T const& seen) {
    return all(determined) ? step : select(determined, step, report_undetermined(seen));
}
template <Scalar T>
Step<T> if_determined(Truth<T> const& determined, Step<T> const& step) {
    return if_determined(determined, step, step.innovation);
}

/// The step of a row that was rotated into R:
///   gamma = root_gamma^2,   innovation = eta / root_gamma,   residual = eta root_gamma
/// eta is the rotated output, root_gamma the product of the cosines. determined: R had no zero on its diagonal before
/// this row. If root_gamma underflows to 0, the innovation is not known and health is nonfinite.
template <Scalar T>
Step<T> report_rotated(T const& eta, RealOf<T> const& root_gamma, Truth<T> const& determined) {
    RealOf<T> const gamma = root_gamma * root_gamma;
    Step<T> step = step_of(T(eta / root_gamma), gamma);
    step.residual = eta * root_gamma;
    return if_determined(determined, step, eta);
}

namespace detail {
/// |P_ij - P_ji'| <= 2^(-p/2) sqrt(P_ii P_jj): the two agree in half of their digits, in the parameters' own units.
template <Scalar T>
Truth<T> mirrored_but_for_rounding(T const& above, T const& below, RealOf<T> const& P_ii, RealOf<T> const& P_jj) {
    using R = RealOf<T>;
    Truth<T> mirrored = above == conjugate(below);
    if constexpr (RootedScalar<T>) {
        if (all(mirrored)) return mirrored;
        R const share = R(std::ldexp(1.0, -significand_bits<R>() / 2)) * square_root(P_ii) * square_root(P_jj);
        T const apart = above - conjugate(below);
        if constexpr (ComplexScalar<T>)
            mirrored = mirrored || (absolute(apart.re) <= share && absolute(apart.im) <= share);
        else mirrored = mirrored || absolute(apart) <= share;
    }
    return mirrored;
}
}  // namespace detail

/// Returns the problem. Throws std::invalid_argument unless size >= 1 (or, if fixed_size is not Dynamic, size is that
/// or 0), 0 < forgetting <= 1, and the prior has a variance > 0 and numbers of the right shape, P0 symmetric. Whether a
/// full P0 is positive definite is tested where a filter starts (linalg/start.hpp). A prior that overflowed the range
/// of T is accepted: the consequence is numerical breakdown, not misuse.
template <Scalar T>
Problem<T> const& checked(Problem<T> const& problem, int fixed_size = Dynamic) {
    bool const implied = fixed_size != Dynamic && problem.size == 0;
    Index const size = implied ? fixed_size : problem.size;
    expects(size >= 1, "size >= 1");
    expects(fixed_size == Dynamic || size == fixed_size, "size equal to the filter's fixed size");
    expects(product_fits(std::size_t(size), std::size_t(size) + 64), "a size whose square memory could hold");
    expects(all(is_forgetting_factor(problem.forgetting)), "0 < forgetting <= 1");
    if (problem.prior) {
        auto const& prior = *problem.prior;
        expects(all(RealOf<T>(0) < prior.variance), "prior variance > 0");
        expects(!prior.theta || prior.theta->size() == size, "prior theta of the problem's size");
        expects(!prior.covariance || (prior.covariance->rows() == size && prior.covariance->cols() == size),
                "prior covariance of the problem's size");
        expects(!prior.stored || (prior.stored->F.rows() == size && prior.stored->F.cols() == size &&
                                  (prior.stored->D.size() == 0 || prior.stored->D.size() == size)),
                "a stored prior of the problem's size");
        if (prior.covariance)
            for (Index j = 0; j < size; ++j)
                for (Index i = 0; i < j; ++i)
                    expects(all(detail::mirrored_but_for_rounding<T>(
                                (*prior.covariance)(i, j), (*prior.covariance)(j, i),
                                real_part((*prior.covariance)(i, i)), real_part((*prior.covariance)(j, j)))),
                            "a symmetric prior covariance, as (P + P')/2 is");
        if constexpr (ComplexScalar<T>) {
            if (prior.covariance)
                for (Index j = 0; j < size; ++j)
                    expects(all((*prior.covariance)(j, j).im == RealOf<T>(0)),
                            "a Hermitian prior covariance: a real diagonal");
        }
    }
    return problem;
}

namespace detail {
template <class C>
concept OfEigen = requires(C const& c) { []<class Derived>(Eigen::DenseBase<Derived> const&) {}(c); };

/// Numbers one after another in memory, as far as the compiler knows: Eigen's vectors, maps and columns; what std::span
/// accepts. The row of a matrix stored by columns, a reversed or strided map, and an expression do not satisfy it.
template <class C, class T>
concept Contiguous = (OfEigen<C> && requires(C const& c) {
                         { c.data() } -> std::convertible_to<T const*>;
                         requires bool(C::IsVectorAtCompileTime) && C::InnerStrideAtCompileTime == 1;
                     }) || (!OfEigen<C> && std::convertible_to<C const&, std::span<T const>>);
}  // namespace detail

/// A regressor psi: a view of d numbers, one after another in memory: an Eigen vector, a std::vector, a std::array, a
/// row of data, numbers in braces. It copies nothing and must not outlive them. An update accepts a view of the
/// filter's own theta or gain. Numbers that are not contiguous do not compile: update(X.row(k).eval(), y) copies them
/// first. Complex<F> views numbers of std::complex<F> as they are.
template <Scalar T>
class Regressor {
    T const* data_;
    Index size_;

public:
    /// A pointer to `size` numbers. The literal 0 is not a pointer here: {0, 2} are two numbers.
    template <std::same_as<T> Number>
    Regressor(Number const* data, Index size) : data_(data), size_(size) {}
    Regressor(std::initializer_list<T> numbers) : Regressor(numbers.begin(), Index(numbers.size())) {}
    template <detail::Contiguous<T> Container>
    Regressor(Container const& c) : Regressor(std::data(c), Index(std::size(c))) {}
    template <detail::Contiguous<std::complex<RealOf<T>>> Container>
        requires ComplexScalar<T> && std::floating_point<RealOf<T>>
    Regressor(Container const& c) : data_(detail::viewed(std::data(c))), size_(Index(std::size(c))) {}
    T const* data() const { return data_; }
    Index size() const { return size_; }
    T const& operator[](Index i) const { return data_[i]; }
};

}  // namespace rlslab
