// A filter that proves how many digits of P and theta it still has, while it runs.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/probes.hpp>
#include <rlslab/arithmetic/pair.hpp>
#include <rlslab/core/random.hpp>

namespace rlslab {

/// Has a P that a probe can be multiplied by, and a lambda; and is around no filter, which could keep rows from it.
template <class F>
concept Certifiable = NamesItsForm<F> && !requires(F const& f) { f.filter(); } &&
                      requires(F& f, detail::CovarianceTimes<std::span<StateVector<double>>> times) {
                          times(f.form());
                          detail::forgetting_of(f.form());
                      };

/// What a check found; of packs in each lane. In the unit of each parameter, which is 2^round(log2 sqrt(P_jj)) of P0,
/// or 1 without a prior. With E = Phat P^-1 - I, Phat what the filter stores and P that of exact arithmetic:
template <class L>
struct Certificate {
    L estimate;         ///< of ||E||_F: the root of the mean of |r_i|^2
    L bound;            ///< 10 max |r_i| and 10 u sqrt(d) of the probes' word: >= ||E||_F but with probability
                        ///< 0.08^probes, where that is above the probes' own rounding; infinite: nothing is known
    L theta;            ///< of |thetahat - theta| / |thetahat|, wherever the bound holds; infinite where bound >= 1
    Truth<L> definite;  ///< bound < 1: then Phat, where it is symmetric, is positive definite
    Truth<L> ended = false;  ///< a rule has added to P: the bound is infinite for that, whatever the numbers are
};

/// F, and s random probes that show what rounding, a flipped bit or wrong code has made of P and theta. With X = P^-1,
/// z = X theta of the problem of these rows, the numbers as F has them:
///
///   (1) x_i, i = 1 ... s: independent numbers of mean 0 and the unit's variance, from the seed
///   (2) m_i = X0 x_i, z = X0 theta0     (3) m_i = lambda m_i + psi (psi'x_i), z = lambda z + psi y at each row
///   (4) at a check r_i = Phat m_i - x_i = E x_i; estimate^2 = sum |r_i|^2 / s, bound = 10 (max |r_i| + u sqrt(d))
///   (5) t = Phat z - thetahat = theta - thetahat + E theta: |thetahat - theta| <= (|t| + |Phat e| + bound |thetahat|)
///       / (1 - bound), e the rounding of z
///   (6) where L is no longer than F's word |Phat e| <= 10 u sqrt(d S) max |Phat v_i|, v_ij = sqrt(X_jj) x_ij / its
///       unit, S as OlderZ has it; elsewhere e is below F's own rounding, and left out
///
/// What F does must not depend on x: take another seed than that of the data. Then the expectation of |r_i|^2 is
/// ||E||_F^2, and each |r_i| falls below a tenth of it with probability 0.08 at most (rank one; other ranks make it
/// less likely). Filters of one seed fail together; of n checks one fails with probability n 0.08^probes at most. A
/// symmetric Phat is positive definite where ||E||_2 < 1: in the metric of P its eigenvalues are 1 + those of E. Where
/// both triangles are stored and differ, that is not said of x'Phat x.
/// L           the word of (3) to (5), a longer one than F's: rounding of (3) itself, of about 2^-53 kappa(P) in
///             double, is part of r. Of a double F choose `Pair` where the floor of double is too high
/// P           is looked at as stored: full storage both triangles; a factor multiplied out; of a factor of P^-1 (and
///             of the normal equations, factored) Phat m is two substitutions
/// Followed    rows of whatever lambda or weight, discount, reset, removed rows, restarts of a guard and of a window:
///             the certificate is of the rows that F holds. Ends: a rule that adds to P (Kulhavy, CaoSchwartz, random
///             walk); bound and theta are infinite until the next reset. What writes into P otherwise is an error that
///             is seen
/// Compose     innermost: Guarded<Windowed<Certified<Ud<float>>>>; the other way round does not compile
/// F's bits are as without probes. Cost of a row 2 d (s + 1) multiplications, of a check 2 (s + 1) passes over what is
/// stored; memory 3 d (s + 1) numbers of L. With (6) 2 d more, twice the passes, 3 d more. Allocates when it is made,
/// and never again (F allowing).
/// Throws std::invalid_argument as F. Source: Freivalds 1977 for products; derived (docs/certificate.md).
template <Certifiable F, int probes = 3, class L = typename detail::ProbeOf<typename F::scalar>::type>
    requires(probes >= 1)
class Certified : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    static constexpr int N = detail::size_of<F>;
    static constexpr bool bounds_z = !detail::longer_word<L, T>;
    using Following = detail::Probes<L, N, probes, bounds_z>;
    using Vectors = detail::ProbeVectors<L, N, probes>;
    Following probes_;
    StateVector<L, N> unit_;
    Vectors m_;  // workspace of a check, as what follows
    detail::FourVectors<L, N> t_;
    StateVector<T, N> theta_;

public:
    static constexpr Index probe_count = probes;
    static constexpr double risk = [] {  ///< that ||E||_F is above the bound of one check
        double out = 1;
        for (int i = 0; i < probes; ++i) out *= 0.08;
        return out;
    }();

    explicit Certified(Problem<T> const& problem, Seed seed = {1}) : Certified(F(problem), problem, seed) {}
    /// Around a filter that was made of this problem, with options of its own, and has taken no row.
    Certified(F const& filter, Problem<T> const& problem, Seed seed = {1})
        : detail::AroundFilter<F>(filter), probes_(filter.theta().size()), unit_(filter.theta().size()),
          m_(detail::probe_vectors<Vectors>(unit_.size())), t_(4 * unit_.size()), theta_(unit_.size()) {
        for (Index j = 0; j < unit_.size(); ++j) {
            unit_[j] = L(1);
            if (problem.prior)
                unit_[j] = detail::power_of_two_near(square_root(detail::widened<L>(variance(filter_, j))));
            for (Index i = 0; i < probes; ++i) detail::number_of(probes_.x, i, j) = unit_[j] * L(seed.bell());
        }
        if constexpr (requires { L::lanes; }) {
            for (int lane = 0; lane < L::lanes; ++lane)
                begin<Pair>(problem.template mapped<Pair>([&](T const& x) { return Pair(double(x[lane])); }), lane);
        } else {
            using Word = std::conditional_t<std::same_as<L, double>, Pair, L>;
            begin<Word>(problem.template mapped<Word>([](T const& x) { return Word(detail::widened<L>(x)); }), 0);
        }
        if constexpr (bounds_z) probes_.older.begin([&](Index j) { return t_[j]; });  // theta
    }

    Step<T> update(Regressor<T> psi, T y) {
        take(psi, y);
        return filter_.update(psi, y);
    }
    /// In two steps (look.hpp): the probes take what is committed.
    Innovation<T> look(Regressor<T> psi, T y)
        requires requires(F& f, Innovation<T> row) { f.look(psi, y), detail::commit(f, row, psi, y); }
    {
        return filter_.look(psi, y);
    }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) {
        take(psi, y);
        return detail::commit(filter_, row, psi, y);
    }
    /// Others may discount, reset or take rows back through it; the probes follow.
    auto form() {
        using Form = decltype(filter_.form());
        return detail::ProbedForm<Form, Following>{filter_.form(), probes_};
    }
    static constexpr std::string_view layer = "certified";
    static std::array<StateOption, 1> options(auto const&) { return {{{"probes", double(probes)}}}; }
    static auto state(auto& f) { return std::tie(f.filter_, f.probes_, f.unit_); }

    /// (4) to (6). Of a const filter a copy answers, which allocates as F does.
    Certificate<L> certificate() {
        for (std::size_t i = 0; i < m_.size(); ++i) scale(probes_.m[i], probes_.weight, m_[i]);
        if constexpr (bounds_z)
            for (Index j = 0; j < unit_.size(); ++j)
                detail::number_of(m_, probes, j) += probes_.weight * (probes_.older.low[j] + probes_.older.high[j]);
        detail::CovarianceTimes<Vectors>{m_, t_}(filter_.form());
        detail::theta_of(filter_, theta_);
        auto const square = [&](Index i, auto const& from) {
            L sum(0);
            for (Index j = 0; j < unit_.size(); ++j) {
                L const r = (detail::number_of(m_, i, j) - from(j)) / unit_[j];
                sum += r * r;
            }
            return sum;
        };
        L const root_d(std::sqrt(double(unit_.size()))), u(std::ldexp(1.0, -ArithmeticTraits<L>::digits));
        L sum(0), largest(0), length(0);
        for (Index i = 0; i < probes; ++i) {
            L const r = square(i, [&](Index j) { return detail::number_of(probes_.x, i, j); });
            sum += r, largest = worst_of(r, largest);
        }
        L apart = square_root(square(probes, [&](Index j) { return detail::widened<L>(theta_[j]); }));
        for (Index j = 0; j < unit_.size(); ++j) {
            L const x = detail::widened<L>(theta_[j]) / unit_[j];
            length += x * x;
        }
        if constexpr (bounds_z) {  // (6)
            for (Index j = 0; j < unit_.size(); ++j) {
                L const root = square_root(probes_.older.X[j]);
                for (Index i = 0; i <= probes; ++i)
                    detail::number_of(m_, i, j) = root * detail::number_of(probes_.x, i, j) / unit_[j];
            }
            detail::CovarianceTimes<Vectors>{m_, t_}(filter_.form());
            L along(0);
            for (Index i = 0; i < probes; ++i) along = worst_of(square(i, [](Index) { return L(0); }), along);
            apart += L(10) * u * root_d * probes_.weight * probes_.older.root() * square_root(along);
        }
        L const infinite(std::numeric_limits<double>::infinity());
        Certificate<L> out{square_root(L(sum / L(probes))), L(10) * (square_root(largest) + u * root_d), infinite,
                           false, probes_.ended};
        out.bound = select(out.bound < infinite && !out.ended, out.bound, infinite);
        out.definite = out.bound < L(1);
        L const worst = (apart / square_root(length) + out.bound) / (L(1) - out.bound);
        out.theta = select(out.definite && worst < infinite, worst, infinite);
        return out;
    }
    Certificate<L> certificate() const { return Certified(*this).certificate(); }

private:
    /// (2): X0 = A D A', of double's probes in pairs: the start of F, whose rounding P0 multiplies, is part of E.
    template <class Word>
    void begin(Problem<Word> exact, int lane) {
        auto const get = [&](auto const& x) {
            if constexpr (requires { L::lanes; }) return Word(double(x[lane]));
            else return Word(x);
        };
        auto const add = [&](L& sum, Word const& x) {
            if constexpr (requires { L::lanes; }) sum.set(lane, sum[lane] + double(x));
            else sum += static_cast<L>(x);
        };
        Index const d = exact.size = unit_.size();
        StateMatrix<Word, N> A(d);
        StateVector<Word, N> D(d), m(d);
        start_information(checked(exact), A, D);
        auto const theta = start_theta<Word, N>(exact);
        for (Index i = 0; i <= probes; ++i) {
            auto const from = [&](Index j) { return i < probes ? get(detail::number_of(probes_.x, i, j)) : theta[j]; };
            for (Index j = 0; j < d; ++j) m[j] = Word(0);
            for (Index j = 0; j < d; ++j) {
                Word along = from(j);
                for (Index k = j + 1; k < d; ++k) along += A(k, j) * from(k);
                along *= D[j];
                m[j] += along;
                for (Index k = j + 1; k < d; ++k) m[k] += A(k, j) * along;
            }
            for (Index j = 0; j < d; ++j) add(detail::number_of(probes_.m, i, j), m[j]);
        }
        for (Index j = 0; j < d; ++j) add(t_[j], theta[j]);
        if constexpr (bounds_z)
            for (Index j = 0; j < d; ++j)
                for (Index k = j; k < d; ++k) add(probes_.older.X[k], k == j ? D[j] : Word(A(k, j) * A(k, j) * D[j]));
    }
    /// The larger one; NaN if one is.
    static L worst_of(L const& a, L const& b) { return select(a <= b || b != b, b, a); }
    void take(Regressor<T> psi, T const& y) {
        expects(psi.size() == unit_.size(), "a regressor of the problem's size");
        probes_.discount(detail::widened<L>(detail::forgetting_of(filter_.form())));  // (3)
        probes_.add(psi, y, L(1));
    }
};

}  // namespace rlslab
