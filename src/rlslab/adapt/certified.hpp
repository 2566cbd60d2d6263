// A filter that proves how many digits of P and theta it still has, while it runs.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/random.hpp>

#include <array>
#include <span>
#include <tuple>

namespace rlslab {

namespace detail {
/// The word of the probes where none is chosen: double, of packs one in each lane. What is longer keeps its own.
template <class T>
struct ProbeOf {
    static constexpr bool longer = [] {
        if constexpr (requires { ArithmeticTraits<T>::digits; }) return ArithmeticTraits<T>::digits > 53;
        else return !std::convertible_to<T, double>;
    }();
    using type = std::conditional_t<longer, T, double>;
};
template <class T, int L>
struct ProbeOf<Pack<T, L>> {
    using type = Pack<double, L>;
};
template <class L, class T>
L widened(T const& x) {
    if constexpr (std::same_as<L, T>) {
        return x;
    } else if constexpr (requires { T::lanes; }) {
        L out;
        for (int i = 0; i < T::lanes; ++i) out.set(i, double(x[i]));
        return out;
    } else {
        return static_cast<L>(x);
    }
}

/// 2^round(log2 x); 1 where x is no positive number.
template <class L>
L power_of_two_near(L const& x) {
    if constexpr (requires { L::lanes; }) {
        L out;
        for (int i = 0; i < L::lanes; ++i) out.set(i, power_of_two_near(x[i]));
        return out;
    } else {
        double const number = static_cast<double>(x);
        if (!(number > 0) || !std::isfinite(number)) return L(1);
        return L(std::ldexp(1.0, std::ilogb(number * 1.4142135623730951)));
    }
}

/// Four vectors of d numbers side by side: number j of vector i is v[4 j + i].
template <class L, int N>
using FourVectors = StateVector<L, N == Dynamic ? Dynamic : 4 * N>;
/// s + 1 vectors, and zeros up to a multiple of four: one for each probe, and for theta.
template <class L, int N, int s>
using ProbeVectors = std::array<FourVectors<L, N>, s / 4 + 1>;
template <class Vectors>
Vectors probe_vectors(Index d) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
        return Vectors{((void)i, typename Vectors::value_type(4 * d))...};
    }(std::make_index_sequence<std::tuple_size_v<Vectors>>());
}
/// Number j of vector i.
template <class Vectors>
auto& number_of(Vectors& v, Index i, Index j) {
    return v[std::size_t(i / 4)][4 * j + i % 4];
}

namespace portable {
#include <rlslab/linalg/kernels/four.hpp>
}
#if defined(__x86_64__) && !defined(__AVX2__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace avx2 {
#include <rlslab/linalg/kernels/four.hpp>
}
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#else
namespace avx2 = portable;
#endif
/// work(text), in the registers of AVX2 where L is double and the processor has them: the same bits.
template <class L, class Work>
[[gnu::always_inline]] inline void by_four(Work const& work) {
    if constexpr (std::same_as<L, double>)
        if (kernels::isa >= Isa::avx2) return work(avx2::ByFour<L>{});
    work(portable::ByFour<L>{});
}

/// What the rows, and what stands for rows, have made of s probes x_i and of z: m_i = X x_i and z = X theta, X = P^-1
/// of exact arithmetic; kept over `weight`, which a discount multiplies, so that a row changes m once.
template <class L, int N, int s>
struct Probes {
    ProbeVectors<L, N, s> x, m;  // vector s of m is z; that of x is zero
    StateVector<L, N> psi;       // workspace: the row in L
    L weight = L(1);
    Truth<L> ended = false;  // P was changed in a way that m cannot follow
    explicit Probes(Index d)
        : x(probe_vectors<ProbeVectors<L, N, s>>(d)), m(probe_vectors<ProbeVectors<L, N, s>>(d)), psi(d) {}

    /// m_i += w psi psi'x_i, z += w psi y.
    template <class T>
    void add(Regressor<T> row, T const& y, L const& w) {
        L const by = w / weight, of_y = widened<L>(y) * by;
        for (Index j = 0; j < row.size(); ++j) psi[j] = widened<L>(row[j]);
        for (std::size_t g = 0; g < x.size(); ++g)
            by_four<L>([&](auto text) {
                text.row(psi.data(), row.size(), by, of_y, g == s / 4 ? s % 4 : -1, x[g].data(), m[g].data());
            });
    }
    void discount(L const& lambda) {
        weight *= lambda;
        Truth<L> const small = weight < L(0x1p-500);
        if (!any(small)) return;  // else there weight 1, the same m
        L const by = select(small, weight, L(1));
        for (auto& v : m) scale(v, by, v);
        weight = select(small, L(1), weight);
    }
    /// X = I / variance; variance 0: X = 0.
    template <class T>
    void reset(T const& variance, Regressor<T> theta) {
        L const told = widened<L>(told_by(variance, variance));
        for (std::size_t g = 0; g < x.size(); ++g) scale(x[g], told, m[g]);
        for (Index j = 0; j < theta.size(); ++j) number_of(m, s, j) = told * widened<L>(theta[j]);
        weight = L(1), ended = false;
    }
    static auto state(auto& p) { return std::tie(p.x, p.m, p.weight, p.ended); }
};

/// A form whose changes the probes follow. What reads a form takes it for the form inside.
template <class Form, class P>
struct ProbedForm : Form {
    P& probes;
    Form const& inside() const { return *this; }
};
template <class Form, class P>
void set_forgetting(ProbedForm<Form, P> f, typename Form::scalar const& lambda) {
    set_forgetting(f.inside(), lambda);
}
template <class Form, class P>
void discount(ProbedForm<Form, P> f, typename Form::scalar const& lambda) {
    discount(f.inside(), lambda);
    f.probes.discount(widened<std::remove_cvref_t<decltype(f.probes.weight)>>(lambda));
}
template <class Form, class P>
void inflate(ProbedForm<Form, P> f, typename Form::scalar const& c, Regressor<typename Form::scalar> a)
    requires requires { inflate(f.inside(), c, a); }
{
    inflate(f.inside(), c, a);
    using L = std::remove_cvref_t<decltype(f.probes.weight)>;
    f.probes.ended = f.probes.ended || !(widened<L>(c) == L(0));
}
template <class Form, class P>
void reset(ProbedForm<Form, P> f, typename Form::scalar const& variance, Regressor<typename Form::scalar> theta) {
    f.probes.reset(variance, theta);  // theta may be the filter's own
    reset(f.inside(), variance, theta);
}
template <class Form, class P>
auto remove(ProbedForm<Form, P> f, Regressor<typename Form::scalar> psi, typename Form::scalar const& y,
            typename Form::scalar const& w)
    requires requires { remove(f.inside(), psi, y, w); }
{
    using L = std::remove_cvref_t<decltype(f.probes.weight)>;
    auto const removal = remove(f.inside(), psi, y, w);
    if (!removal.refused()) f.probes.add(psi, y, L(-widened<L>(w)));
    return removal;
}

// --- P m from what a form stores, m the vectors of the probes, in their word; `t` is workspace, as one of m ----------

template <class Vectors>
struct CovarianceTimes {
    using Numbers = typename Vectors::value_type;
    using L = std::remove_cvref_t<decltype(std::declval<Numbers>()[0])>;
    Vectors& m;
    Numbers& t;

    /// work(text, v, d) for each four vectors.
    template <class Work>
    void each(Work const& work) {
        for (Numbers& four : m) by_four<L>([&](auto text) { work(text, four.data(), t.size() / 4); });
    }
    template <class A>
    void full(A const& a) {
        each([&](auto text, L* v, Index d) { text.full(a, v, t.data(), d); });
    }
    template <class A>
    void transposed(A const& a, bool triangle) {
        each([&](auto text, L* v, Index d) { text.transposed(a, v, t.data(), d, triangle); });
    }
    template <class A>
    void upper(A const& a) {
        each([&](auto text, L* v, Index d) { text.upper(a, v, d); });
    }
    template <class A, class Over>
    void solve(A const& a, Over over) {
        each([&](auto text, L* v, Index d) { text.solve(a, over, v, d); });
    }

    /// Of a form that only the run knows.
    template <class Form>
        requires requires(Form f, CovarianceTimes<std::span<Numbers>>& times) { times_covariance(f, times); }
    void operator()(Form f) {
        std::span<Numbers> vectors(m);
        CovarianceTimes<std::span<Numbers>> times{vectors, t};
        times_covariance(f, times);
    }
    template <class T, int N, class Storage>
    void operator()(PlainCovariance<T, N, Storage> f) {
        full(f.P);
    }
    template <class T, int N>
    void operator()(RootCovariance<T, N, false> f) {
        transposed(f.S, false), full(f.S);
    }
    template <class T, int N>
    void operator()(RootCovariance<T, N, true> f) {
        transposed(f.S, true), upper(f.S);
    }
    template <class T, int N>
    void operator()(UdCovariance<T, N> f) {
        transposed(f.U, true);
        for (Numbers& v : m)
            for (Index j = 0; j < t.size() / 4; ++j)
                for (int i = 0; i < 4; ++i) v[4 * j + i] *= widened<L>(f.D[j]);
        upper(f.U);
    }
    template <class T, int N>
    void operator()(RootInformation<T, N> f) {
        solve(f.L, [](Index) { return L(1); });
    }
    template <class T, int N>
    void operator()(UnitInformation<T, N> f) {
        solve(f.L, [&](Index j) { return widened<L>(f.D[j]); });
    }
    template <class T, int N>
    void operator()(NormalEquations<T, N> f) {
        if (!f.solved) f.solve();
        solve(f.L, [&](Index j) { return widened<L>(f.D[j]); });
    }
};
/// lambda of the next row. Where only the run knows the form, it tells.
template <class Form>
auto forgetting_of(Form f) {
    if constexpr (requires { f.lambda; }) return f.lambda;
    else return forgetting(f);
}
/// How many probes f has, or what f is around; 0: none.
template <class F>
Index probes_of(F const& f) {
    if constexpr (requires { F::probe_count; }) return F::probe_count;
    else if constexpr (requires { f.probe_count(); }) return f.probe_count();
    else if constexpr (requires { f.filter(); }) return probes_of(f.filter());
    else return 0;
}
}  // namespace detail

/// Has a P that a probe can be multiplied by, and a lambda.
template <class F>
concept Certifiable = NamesItsForm<F> && requires(F& f, detail::CovarianceTimes<std::span<StateVector<double>>> times) {
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
    L theta;            ///< of |thetahat - theta| / |thetahat| where the bound holds and the probes' word is longer
                        ///< than F's: the rounding of z is not in it. Infinite where bound >= 1
    Truth<L> definite;  ///< bound < 1: then Phat, where it is symmetric, is positive definite
    Truth<L> ended = false;  ///< a rule has added to P: the bound is infinite for that, whatever the numbers are
};

/// F, and s random probes that show what rounding, a flipped bit or wrong code has made of P and theta. With X = P^-1,
/// z = X theta of the problem of these rows, the numbers as F has them:
///
///   (1) x_i, i = 1 ... s: independent numbers of mean 0 and the unit's variance, from the seed
///   (2) m_i = X0 x_i, z = X0 theta0     (3) m_i = lambda m_i + psi (psi'x_i), z = lambda z + psi y at each row
///   (4) at a check r_i = Phat m_i - x_i = E x_i; estimate^2 = sum |r_i|^2 / s, bound = 10 (max |r_i| + u sqrt(d))
///   (5) t = Phat z - thetahat = theta - thetahat + E theta: |thetahat - theta| <= (|t| + bound |thetahat|) / (1 -
///       bound)
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
/// Compose     innermost: Guarded<Windowed<Certified<Ud<float>>>>
/// F's bits are as without probes. Cost of a row 2 d (s + 1) multiplications, of a check 2 (s + 1) passes over what is
/// stored; memory 3 d (s + 1) numbers of L. Allocates when it is made, and never again (F allowing).
/// Throws std::invalid_argument as F. Source: Freivalds 1977 for products; derived (docs/certificate.md).
template <Certifiable F, int probes = 3, class L = typename detail::ProbeOf<typename F::scalar>::type>
    requires(probes >= 1)
class Certified : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    static constexpr int N = detail::size_of<F>;
    using Following = detail::Probes<L, N, probes>;
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
        Index const d = unit_.size();
        Problem<L> exact = problem.template mapped<L>([](T const& x) { return detail::widened<L>(x); });
        exact.size = d;
        StateMatrix<L, N> A(d);
        StateVector<L, N> D(d);
        start_information(checked(exact), A, D);
        for (Index j = 0; j < d; ++j) {
            unit_[j] = L(1);
            if (problem.prior)
                unit_[j] = detail::power_of_two_near(square_root(detail::widened<L>(variance(filter_, j))));
            for (Index i = 0; i < probes; ++i) detail::number_of(probes_.x, i, j) = unit_[j] * L(seed.bell());
        }
        auto const theta = start_theta<L, N>(exact);
        for (Index i = 0; i <= probes; ++i) {  // (2): X0 = A D A'
            auto const from = [&](Index j) { return i < probes ? detail::number_of(probes_.x, i, j) : theta[j]; };
            for (Index j = 0; j < d; ++j) {
                L along = from(j);
                for (Index k = j + 1; k < d; ++k) along += A(k, j) * from(k);
                along *= D[j];
                for (Index k = j; k < d; ++k) detail::number_of(probes_.m, i, k) += (k == j ? L(1) : A(k, j)) * along;
            }
        }
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

    /// (4) and (5). Of a const filter a copy answers, which allocates as F does.
    Certificate<L> certificate() {
        for (std::size_t i = 0; i < m_.size(); ++i) scale(probes_.m[i], probes_.weight, m_[i]);
        detail::CovarianceTimes<Vectors>{m_, t_}(filter_.form());
        detail::theta_of(filter_, theta_);
        L sum(0), largest(0), apart(0), length(0);
        for (Index i = 0; i <= probes; ++i) {
            L square(0);
            for (Index j = 0; j < unit_.size(); ++j) {
                L const from = i < probes ? detail::number_of(probes_.x, i, j) : detail::widened<L>(theta_[j]),
                        r = (detail::number_of(m_, i, j) - from) / unit_[j], in_unit = from / unit_[j];
                square += r * r;
                if (i == probes) length += in_unit * in_unit;
            }
            if (i == probes) apart = square_root(square), length = square_root(length);
            else sum += square, largest = select(square <= largest || largest != largest, largest, square);  // or NaN
        }
        L const infinite(std::numeric_limits<double>::infinity());
        L const floor(std::ldexp(std::sqrt(double(unit_.size())), -ArithmeticTraits<L>::digits));
        Certificate<L> out{square_root(L(sum / L(probes))), L(10) * (square_root(largest) + floor), infinite, false,
                           probes_.ended};
        out.bound = select(out.bound < infinite && !out.ended, out.bound, infinite);
        out.definite = out.bound < L(1);
        L const worst = (apart / length + out.bound) / (L(1) - out.bound);
        out.theta = select(out.definite && worst < infinite, worst, infinite);
        return out;
    }
    Certificate<L> certificate() const { return Certified(*this).certificate(); }

private:
    void take(Regressor<T> psi, T const& y) {
        expects(psi.size() == unit_.size(), "a regressor of the problem's size");
        probes_.discount(detail::widened<L>(detail::forgetting_of(filter_.form())));  // (3)
        probes_.add(psi, y, L(1));
    }
};

}  // namespace rlslab
