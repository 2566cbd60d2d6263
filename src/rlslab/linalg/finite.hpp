// Tests whether theta and the gain of a filter are finite. Where the filter stores them, their numbers are tested.
// Where it solves for them on request, they are proven finite without solving if possible, and solved for otherwise.
#pragma once

#include <rlslab/linalg/triangles.hpp>

#include <algorithm>

namespace rlslab {

/// Whether every number of x is finite; true for no numbers.
template <Scalar T, int N>
Truth<T> all_finite(StateVector<T, N> const& x) {
    Truth<T> out = true;
    run_kernel<T, N>(kernels::AllFinite<T>{{x.size(), x.data(), nullptr}, &out});
    return out;
}

template <Scalar T, class X>
Truth<T> all_finite(Eigen::MatrixBase<X> const& x) {
    Truth<T> out = true;
    for (Index i = 0; i < x.size(); ++i) out = out && is_finite(T(x(i)));
    return out;
}

/// The step of a form that stores theta; gamma = lambda / s. Only theta is tested: where theta + K e is finite, so is
/// K, because even 0 times an infinity is NaN.
template <Scalar T, int N>
Step<T> step_of(T const& innovation, RealOf<T> const& lambda, RealOf<T> const& s, StateVector<T, N> const& theta) {
    return if_finite(all_finite(theta), step_of(innovation, lambda, s));
}

namespace detail {
template <Field T>
inline constexpr bool fits_double = false;
template <Field T>
    requires std::same_as<Truth<T>, bool> && (ArithmeticTraits<T>::digits <= 53 && ArithmeticTraits<T>::max_exp <= 1023)
inline constexpr bool fits_double<T> = true;
typedef double Pair __attribute__((vector_size(16)));
typedef double PairAnywhere __attribute__((vector_size(16), aligned(8), may_alias));
template <class Numbers>
[[gnu::always_inline]] inline Pair two_of(Numbers const& numbers, Index j) {
    if constexpr (requires { numbers.two(j); }) return numbers.two(j);
    else return Pair{numbers(j), numbers(j + 1)};
}
}  // namespace detail

/// The scalar in which bounds are computed: double if it holds every number of T, otherwise T; the real one where T is
/// complex.
template <Scalar T>
using BoundOf = std::conditional_t<detail::fits_double<RealOf<T>>, double, RealOf<T>>;

/// Whether a rounding error is relative to its number also where that is below 1: not in fixed point.
template <Scalar T>
inline constexpr bool errors_are_relative = ArithmeticTraits<T>::min_exp + ArithmeticTraits<T>::digits < 0;
/// The same where the format is chosen at run time: also not in one whose subnormal numbers begin so high.
template <Scalar T>
constexpr bool errors_are_relative_now() {
    return errors_are_relative<T> && min_exponent<T>() + significand_bits<T>() < 0;
}

/// For R upper triangular with columns of lengths n_j and pivots r_j: true proves that R x = b with |b|^2 <= right, and
/// R'R K = psi with psi'K <= 1, are solved by substitution without an overflow of T. False proves nothing. n2(j) =
/// n_j^2 and r2(j) = r_j^2 are called once for each j.
///
///   (1) C = R diag(1/n) has columns of length 1, so the squares of its singular values sum to d. All of them except
///       the least multiply to at most (d/(d-1))^(d-1) < e, and all of them to q = prod r_j^2 / n_j^2. Hence the least
///       is larger than q / e
///   (2) x_j^2 < e right / (q n_j^2) and K_j^2 < e / (q n_j^2). The partial sums are below these times max n_j^2; if R
///       is stored as D and a unit triangle, also divided by min r_j^2
///
/// If the bound is computed in T, the squares n_j^2 and r_j^2 are numbers of T, so 1 / min r_j and max n_j need at most
/// half of T's exponents. A factor of 2^10 covers e, sums of d terms, and rounding, which changes q by less than e^2
/// while 2 d^2 u <= 1.
///
/// bounds_lengths: true proves that 1/q and max n_j^2 / q do not overflow T, either.
template <Scalar T, bool bounds_lengths = false, class LengthSquared, class PivotSquared, class Bound = BoundOf<T>>
[[gnu::always_inline]] inline Truth<T> solved_in_range(Index d, LengthSquared n2, PivotSquared r2, Bound const& right) {
    if constexpr (!RootedScalar<T>) {  // the rationals are finite
        return true;
    } else if constexpr (!errors_are_relative<T>) {
        return false;
    } else {
        if (!errors_are_relative_now<T>()) return false;
        Bound q(1), least(1), most = right;
        Index j = 0;
        if constexpr (requires { n2.two(j); }) {  // two quotients at a time, in two products: any order gives a bound
            detail::Pair a{1, 1}, b{1, 1}, longest{0, 0};
            for (; j + 4 <= d; j += 4) {
                detail::Pair const n = n2.two(j), m = n2.two(j + 2);
                a *= detail::two_of(r2, j) / n;
                b *= detail::two_of(r2, j + 2) / m;
                if constexpr (bounds_lengths) {
                    detail::Pair const longer = n > m ? n : m;
                    longest = longest > longer ? longest : longer;
                }
            }
            a *= b;
            q = a[0] * a[1];
            if constexpr (bounds_lengths)
                for (int i : {0, 1}) most = most < longest[i] ? longest[i] : most;
        }
        for (; j < d; ++j) {
            Bound const length = n2(j), pivot = r2(j);
            q *= pivot / length;
            if constexpr (!std::same_as<Bound, RealOf<T>>) least = select(pivot < least, pivot, least);
            if constexpr (bounds_lengths || !std::same_as<Bound, RealOf<T>>) most = select(most < length, length, most);
        }
        int const exponent = std::same_as<Bound, RealOf<T>> ? max_exponent<T>() - ArithmeticTraits<T>::digits - 20
                                                            : 2 * max_exponent<T>() - 20;
        Bound const limit(std::ldexp(1.0, std::min(exponent, 1000)));
        Truth<T> in_range = (Bound(1) + most) / least < q * limit;
        if constexpr (bounds_lengths) {
            Bound const largest(std::ldexp(1.0, std::min(max_exponent<T>() - 20, 1000)));
            in_range = in_range && Bound(1) + most < q * largest;
        }
        return in_range && q <= Bound(2) &&
               d <= Index(1) << std::min((significand_bits<T>() - 1) / 2, 30);  // q: a pivot may be infinite
    }
}

/// Whether the stored theta, the pivots D, and K of X K = psi are finite, for X = L diag(D) L' (all d x d). x (d) is
/// overwritten.
template <Scalar T, int N>
Truth<T> answers_finite(StateMatrix<T, N> const& X, StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D,
                        StateVector<T, N> const& theta, StateVector<T, N> const& psi, StateVector<T, N>& x) {
    if constexpr (!RootedScalar<T>) return true;  // the rationals are finite
    using Bound = BoundOf<T>;
    Truth<T> const kept = all_finite(theta) && all_finite(D);
    if (all(solved_in_range<T>(
            x.size(), [&](Index j) { return Bound(real_part(X(j, j))); }, [&](Index j) { return Bound(D[j]); },
            Bound(1))))
        return kept;
    UncountedScope<T> const uncounted;
    x = psi;
    solve_outer(L, D, x);
    return kept && all_finite(x);
}

namespace detail {
/// Whether the solution for this right side is finite. x is overwritten; the solution is no part of the algorithm
/// (UncountedScope).
template <Scalar T, int N, class Solve>
Truth<T> finite_solution(StateVector<T, N> const& right, StateVector<T, N>& x, Solve solve) {
    UncountedScope<T> const uncounted;
    x = right;
    solve(x);
    return all_finite(x);
}
/// Whether theta, K and the pivots are finite, by solving for them: R = L', or R = diag(sqrt(D)) L'. x is overwritten.
template <Scalar T, int N>
[[gnu::noinline]] Truth<T> finite_solutions(StateMatrix<T, N> const& L, StateVector<T, N> const& z,
                                            StateVector<T, N> const& psi, StateVector<T, N>& x) {
    Truth<T> out = finite_solution<T, N>(z, x, [&](auto& b) { solve_lower_transposed(L, b); });
    out = out && finite_solution<T, N>(psi, x, [&](auto& b) { solve_outer(L, b); });
    for (Index j = 0; j < x.size(); ++j) out = out && is_finite(L(j, j));
    return out;
}
template <Scalar T, int N>
[[gnu::noinline]] Truth<T> finite_solutions(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D,
                                            StateVector<T, N> const& z, StateVector<T, N> const& psi,
                                            StateVector<T, N>& x) {
    Truth<T> out = all_finite(D) && finite_solution<T, N>(z, x, [&](auto& b) { solve_lower_transposed(L, b); });
    return out && finite_solution<T, N>(psi, x, [&](auto& b) { solve_outer(L, D, b); });
}
}  // namespace detail

/// For the forms that store R and z = R theta only: the n_j^2 of R, which are the diagonal of P^-1 = R'R, and a bound
/// of |z|^2, updated with each row. L = R', or R = diag(sqrt(D)) L' with L unit lower triangular. Cost of a row: O(d),
/// or O(d^2) where the proof fails.
template <Scalar T, int N = Dynamic>
class ColumnLengths {
    using Bound = BoundOf<T>;
    StateVector<Bound, N> squares_;
    Bound right_ = Bound(0);
    // R = L': began with a prior. R = diag(sqrt(D)) L': began without one, which states of older versions never say.
    Truth<T> mark_ = false;

    /// pivots_above_rounding, from the squares that are at hand where these decide it: of four times the bound, since
    /// they are rounded, too, and n_j^2 is at least the square of the largest number in column j of R.
    template <class PivotSquared, class Compare>
    Truth<T> above_rounding(PivotSquared r2, Compare compare) const {
        if constexpr (RootedScalar<T>) {
            double const share = rounding_of_a_pivot<T>();
            UncountedScope<T> const uncounted;
            Bound const by = Bound(4 * share * share),
                        least = Bound(std::ldexp(1.0, -std::min(900, max_exponent<T>())));
            Truth<T> out = share > 0;
            for (Index j = 0; j < squares_.size(); ++j) out = out && least < squares_[j] && by * squares_[j] < r2(j);
            if (all(out)) return out;
        }
        return compare();
    }
    void add(StateMatrix<T, N> const& L, StateVector<T, N> const& z) {
        for (Index i = 0; i < z.size(); ++i) {
            for (Index j = i; j < z.size(); ++j) squares_[j] += square(L(j, i));
            right_ += square(z[i]);
        }
    }
    void add(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D, StateVector<T, N> const& z) {
        for (Index i = 0; i < z.size(); ++i) {
            for (Index j = i; j < z.size(); ++j) squares_[j] += Bound(D[i]) * square(L(j, i));
            right_ += Bound(D[i]) * square(z[i]);
        }
    }
    void mark(StateMatrix<T, N> const& L, StateVector<T, N> const&) { mark_ = nonsingular(L); }
    void mark(StateMatrix<T, N> const&, StateVector<RealOf<T>, N> const& D, StateVector<T, N> const&) {
        mark_ = !nonsingular(D);
    }

    static Bound square(T const& x) {
        if constexpr (ComplexScalar<T>) return Bound(x.re) * Bound(x.re) + Bound(x.im) * Bound(x.im);
        else return Bound(x) * Bound(x);
    }

    /// |x|^2, a sum in eight lanes.
    static Bound squared(T const* x, Index n) {
        if constexpr (Hardware<T> && std::same_as<T, Bound>) {
            T sum;
            run_kernel<T, Dynamic>(kernels::SumOfSquares<T>{n, x, &sum});
            return sum;
        } else {
            Bound lane[8];
            for (Bound& sum : lane) sum = Bound(0);
            Index k = 0;
            for (; k + 8 <= n; k += 8)
                for (Index i = 0; i < 8; ++i) lane[i] += square(x[k + i]);
            for (Index i = 0; k + i < n; ++i) lane[i] += square(x[k + i]);
            for (Index half = 4; half >= 1; half /= 2)
                for (Index i = 0; i < half; ++i) lane[i] += lane[i + half];
            return lane[0];
        }
    }

    /// Updates n_j^2 to lambda n_j^2 + psi_j^2 and returns it: one, or two side by side.
    struct Updated {
        Bound* squares;
        T const* psi;
        Bound weight;
        [[gnu::always_inline]] Bound operator()(Index j) const {
            return squares[j] = weight * squares[j] + square(psi[j]);
        }
        [[gnu::always_inline]] detail::Pair two(Index j) const
            requires std::same_as<T, double>
        {
            detail::Pair const x = *reinterpret_cast<detail::PairAnywhere const*>(psi + j);
            auto& both = *reinterpret_cast<detail::PairAnywhere*>(squares + j);
            return both = weight * both + x * x;
        }
    };
    /// lambda D_j.
    struct Pivots {
        RealOf<T> const* D;
        Bound weight;
        [[gnu::always_inline]] Bound operator()(Index j) const { return weight * Bound(D[j]); }
        [[gnu::always_inline]] detail::Pair two(Index j) const
            requires std::same_as<T, double>
        {
            return weight * *reinterpret_cast<detail::PairAnywhere const*>(D + j);
        }
    };
    /// lambda r_j^2, R = L'.
    struct RootPivots {
        StateMatrix<T, N> const& L;
        Bound weight;
        [[gnu::always_inline]] Bound operator()(Index j) const { return weight * square(L(j, j)); }
    };
    /// Updates right_ at once.
    Updated update(RealOf<T> const& lambda, T const* psi, T const& y) {
        Bound const weight(lambda);
        right_ = weight * right_ + square(y);
        return {squares_.data(), psi, weight};
    }

public:
    explicit ColumnLengths(Index size) : squares_(size) {}

    /// The sums at the start or after a reset, from a filter's first L (and D) and z, which hold a prior or zeros.
    template <class... Factors>
    void start(Factors const&... factors) {
        restart(factors...);
        mark(factors...);
    }
    /// The sums again, from what the filter holds now.
    template <class... Factors>
    void restart(Factors const&... factors) {
        for (Index j = 0; j < squares_.size(); ++j) squares_[j] = Bound(0);
        right_ = Bound(0);
        add(factors...);
    }

    /// Whether theta is determined: by a prior, or because every pivot stands above its own rounding.
    Truth<T> determined(StateMatrix<T, N> const& L) const {
        if (all(mark_)) return mark_;
        return mark_ ||
               above_rounding([&](Index j) { return square(L(j, j)); }, [&] { return pivots_above_rounding(L); });
    }
    Truth<T> determined(StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D) const {
        if (!any(mark_)) return !mark_;
        return !mark_ ||
               above_rounding([&](Index j) { return Bound(D[j]); }, [&] { return pivots_above_rounding(L, D); });
    }

    /// Takes the row [psi' y] of weight w out of the sums, with what rounding may have put into them: they stay bounds.
    void remove_row(T const& w, Regressor<T> psi, T const& y) {
        Bound slack(0);
        if constexpr (Real<T>) slack = Bound(std::ldexp(1.0, 3 - significand_bits<Bound>()));
        auto const less = [&](Bound& sum, T const& x) {
            Bound const allowed = sum * slack, kept = sum - Bound(w) * square(x);
            sum = kept + allowed;
        };
        for (Index j = 0; j < squares_.size(); ++j) less(squares_[j], psi[j]);
        less(right_, y);
    }

    /// Adds the row [psi' y], after the filter has folded it into sqrt(lambda) [R z]. Returns whether theta, K and the
    /// pivots are finite. x (d) is overwritten.
    Truth<T> add_row(RealOf<T> const& lambda, StateVector<T, N> const& psi, T const& y, StateMatrix<T, N> const& L,
                     StateVector<T, N> const& z, StateVector<T, N>& x) {
        Truth<T> const proven = solved_in_range<T>(
            x.size(), update(lambda, psi.data(), y), [&](Index j) { return square(L(j, j)); }, right_);
        return all(proven) ? proven : detail::finite_solutions<T, N>(L, z, psi, x);
    }
    /// add_row in two halves for R = diag(sqrt(D)) L', the first before the row is folded in. There true proves what
    /// the second would return, and that folding the row in does not overflow; false proves nothing.
    ///
    ///   (1) 1/w = 1 + psi'P psi/lambda = det(R'R after) / det(lambda R'R) <= prod n_j^2 / (lambda D_j) = 1/q, by
    ///       Hadamard's inequality, n_j^2 with the row and D_j without
    ///   (2) with the D_j after the row the product of the quotients is q/w >= q: solved_in_range holds for them, too
    ///   (3) x_i^2 <= lambda D_i/w <= n_i^2/q
    bool begin_row(RealOf<T> const& lambda, StateVector<T, N> const& psi, T const& y,
                   StateVector<RealOf<T>, N> const& D) {
        auto const lengths = update(lambda, psi.data(), y);
        if constexpr (Hardware<T>)
            return solved_in_range<T, true>(psi.size(), lengths, Pivots{D.data(), Bound(lambda)}, right_);
        for (Index j = 0; j < psi.size(); ++j) lengths(j);
        return false;
    }
    /// The same for R = L', which then has no zero on its diagonal; `finite` is the second half.
    bool begin_row(RealOf<T> const& lambda, StateVector<T, N> const& psi, T const& y, StateMatrix<T, N> const& L) {
        auto const lengths = update(lambda, psi.data(), y);
        if constexpr (Hardware<T>)
            return solved_in_range<T, true>(psi.size(), lengths, RootPivots{L, Bound(lambda)}, right_);
        for (Index j = 0; j < psi.size(); ++j) lengths(j);
        return false;
    }
    Truth<T> end_row(StateVector<T, N> const& psi, StateMatrix<T, N> const& L, StateVector<RealOf<T>, N> const& D,
                     StateVector<T, N> const& z, StateVector<T, N>& x) const {
        Truth<T> const proven = solved_in_range<T>(
            x.size(), [&](Index j) { return squares_[j]; }, [&](Index j) { return Bound(D[j]); }, right_);
        return all(proven) ? proven : detail::finite_solutions<T, N>(L, D, z, psi, x);
    }
    /// The same for a block: add_rows before the rows [psi' y] of A (B x (d + 1)) are folded into weight [R z], finite
    /// afterwards.
    template <class Block>
    void add_rows(RealOf<T> const& weight, Block const& A, Index from, Index to) {
        Index const d = squares_.size();
        for (Index j = from; j < to; ++j) {
            Bound& sum = j < d ? squares_[j] : right_;
            sum = sum * square(T(weight)) + squared(A.col(j).data(), A.rows());
        }
    }
    /// After add_rows: whether squares and products of the columns, of R and of A, neither overflow nor underflow where
    /// that counts, for UndividedReflector and kernels::ReflectPanel: with p digits
    ///
    ///   2^(min_exp + 3p) < n_j^2 < 2^(max_exp - 8)
    ///
    /// Products of columns, of pivots, and their partial sums are below 32 max n_j^2. What a reflection leaves out
    /// below 2^(min_exp + p), and the underflow of a product, are below u^2 of n_j^2. False for a column that has
    /// always been zero; of a right-hand side zeros are as good as any. So too for the further
    /// ones, z each, whose outputs are A's columns behind the first d + 1; z before it is multiplied by weight.
    template <class Block>
    Truth<T> products_in_range(RealOf<T> const& weight, Block const& A, std::span<T* const> further) const {
        int const least = min_exponent<T>() + 3 * significand_bits<T>(), most = max_exponent<T>() - 8;
        if (least >= most) return Truth<T>(false);
        Bound const above(std::ldexp(1.0, std::max(least, -1000))), below(std::ldexp(1.0, std::min(most, 1000)));
        auto const of_a_side = [&](Bound const& x) { return Truth<T>(x == Bound(0) || (above < x && x < below)); };
        Truth<T> in_range = of_a_side(right_);
        Index const d = squares_.size();
        for (Index j = 0; j < Index(further.size()); ++j)
            in_range = in_range && of_a_side(squared(further[std::size_t(j)], d) * square(T(weight)) +
                                             squared(A.col(d + 1 + j).data(), A.rows()));
        for (Index j = 0; j < squares_.size(); ++j) in_range = in_range && above < squares_[j] && squares_[j] < below;
        return in_range;
    }
    Truth<T> finite(StateMatrix<T, N> const& L, StateVector<T, N> const& z, StateVector<T, N> const& psi,
                    StateVector<T, N>& x) {
        Truth<T> const proven = solved_in_range<T>(
            x.size(), [&](Index j) { return squares_[j]; }, [&](Index j) { return square(L(j, j)); }, right_);
        return all(proven) ? proven : detail::finite_solutions<T, N>(L, z, psi, x);
    }
    /// Whether the theta of a further right-hand side is finite, where K is. D: none for R = L'.
    template <class... Pivots>
    bool finite_too(StateVector<T, N> const& z, StateVector<T, N>& x, StateMatrix<T, N> const& L,
                    Pivots const&... D) const {
        auto const pivot = [&](Index j) {
            if constexpr (sizeof...(D) == 0) return square(L(j, j));
            else return Bound((D[j], ...));
        };
        Bound right(0);
        for (Index j = 0; j < z.size(); ++j) {
            if constexpr (sizeof...(D) == 0) right += square(z[j]);
            else right += pivot(j) * square(z[j]);
        }
        return all(solved_in_range<T>(
                   x.size(), [&](Index j) { return squares_[j]; }, pivot, right)) ||
               all(detail::finite_solution<T, N>(z, x, [&](auto& b) { solve_lower_transposed(L, b); }));
    }
    static auto state(auto& lengths) { return std::tie(lengths.squares_, lengths.right_, lengths.mark_); }
};

}  // namespace rlslab
