// Random probes that follow the rows of a filter, and what multiplies them by its P: of certified.hpp.
#pragma once

#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/arithmetic/pack.hpp>

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

/// Whether L has more digits than T for sure.
template <class L, class T>
inline constexpr bool longer_word = [] {
    if constexpr (requires { ArithmeticTraits<L>::digits, ArithmeticTraits<T>::digits; })
        return ArithmeticTraits<L>::digits > ArithmeticTraits<T>::digits;
    else return false;
}();

/// z of more rows than the last 32, and what rounding in L has made of z, at most: u weight sqrt(X_jj S) in z_j, by
/// Cauchy and Schwarz. X_jj and S are the sums of |w| psi_j^2 / weight and |w| y^2 n^2 / weight over the rows, n the
/// roundings of `weight` since the row, and 2 d + 40 others: of 32 sums, of the prior, of the product with P.
template <class L, int N>
struct OlderZ {
    StateVector<L, N> X, high, low;  // high + low is z over the weight, each sum of 32 rows added without an error
    std::array<L, 3> S{L(0), L(0), L(0)};  // with n^0, n^1, n^2
    L rows = L(0);
    explicit OlderZ(Index d) : X(d), high(d), low(d) {}
    /// z = X theta, X as it is.
    template <class Theta>
    void begin(Theta const& theta) {
        L sum(0);
        for (Index j = 0; j < X.size(); ++j) sum += square_root(L(X[j] * theta(j) * theta(j)));
        S = {sum * sum, L(0), L(0)};
        fill(high, L(0)), fill(low, L(0));
        rows = L(0);
    }
    void age(L const& lambda) {
        if (all(lambda == L(1))) return;
        S[2] += S[1] + S[1] + S[0], S[1] += S[0];
    }
    /// recent(j): what the last rows have made of z_j.
    template <class Recent>
    void row(L const* psi, L const& y, L const& by, Recent recent) {
        L const size = select(by < L(0), L(-by), by);
        by_four<L>([&](auto text) { text.squares(psi, X.size(), size, X.data()); });
        S[0] += size * y * y;
        rows += L(1);
        Truth<L> const full = L(31.5) < rows;
        if (!any(full)) return;
        for (Index j = 0; j < X.size(); ++j) {
            L const part = select(full, recent(j), L(0)), sum = high[j] + part, of = sum - high[j];
            low[j] += (high[j] - (sum - of)) + (part - of);
            high[j] = sum, recent(j) = select(full, L(0), recent(j));
        }
        rows = select(full, L(0), rows);
    }
    void settle(L const& by) {
        scale(X, by, X), scale(high, by, high), scale(low, by, low);
        for (L& sum : S) sum *= by;
    }
    /// sqrt(S)
    L root() const {
        L const c = L(double(2 * X.size() + 40));
        return square_root(L(S[2] + (S[1] + S[1] + S[0] * c) * c));
    }
    static auto state(auto& r) { return std::tie(r.X, r.high, r.low, r.S[0], r.S[1], r.S[2], r.rows); }
};

/// What the rows, and what stands for rows, have made of s probes x_i and of z: m_i = X x_i and z = X theta, X = P^-1
/// of exact arithmetic; kept over `weight`, which a discount multiplies, so that a row changes m once. bounds_z: what
/// rounding makes of z is followed.
template <class L, int N, int s, bool bounds_z>
struct Probes {
    struct None {
        explicit None(Index) {}
    };
    ProbeVectors<L, N, s> x, m;  // vector s of m is z; that of x is zero
    StateVector<L, N> psi;       // workspace: the row in L
    L weight = L(1);
    Truth<L> ended = false;  // P was changed in a way that m cannot follow
    [[no_unique_address]] std::conditional_t<bounds_z, OlderZ<L, N>, None> older;
    explicit Probes(Index d)
        : x(probe_vectors<ProbeVectors<L, N, s>>(d)), m(probe_vectors<ProbeVectors<L, N, s>>(d)), psi(d), older(d) {}

    /// m_i += w psi psi'x_i, z += w psi y.
    template <class T>
    void add(Regressor<T> row, T const& y, L const& w) {
        L const by = w / weight, of_y = widened<L>(y) * by;
        for (Index j = 0; j < row.size(); ++j) psi[j] = widened<L>(row[j]);
        for (std::size_t g = 0; g < x.size(); ++g)
            by_four<L>([&](auto text) {
                text.row(psi.data(), row.size(), by, of_y, g == s / 4 ? s % 4 : -1, x[g].data(), m[g].data());
            });
        if constexpr (bounds_z)
            older.row(psi.data(), widened<L>(y), by, [this](Index j) -> L& { return number_of(m, s, j); });
    }
    void discount(L const& lambda) {
        weight *= lambda;
        if constexpr (bounds_z) older.age(lambda);
        Truth<L> const small = weight < L(0x1p-500);
        if (!any(small)) return;  // else there weight 1, the same m
        L const by = select(small, weight, L(1));
        for (auto& v : m) scale(v, by, v);
        if constexpr (bounds_z) older.settle(by);
        weight = select(small, L(1), weight);
    }
    /// X = I / variance; variance 0: X = 0.
    template <class T>
    void reset(T const& variance, Regressor<T> theta) {
        L const told = widened<L>(told_by(variance, variance));
        for (std::size_t g = 0; g < x.size(); ++g) scale(x[g], told, m[g]);
        for (Index j = 0; j < theta.size(); ++j) number_of(m, s, j) = told * widened<L>(theta[j]);
        if constexpr (bounds_z) {
            fill(older.X, told);
            older.begin([&](Index j) { return widened<L>(theta[j]); });
        }
        weight = L(1), ended = false;
    }
    static auto state(auto& p) {
        if constexpr (bounds_z) return std::tie(p.x, p.m, p.weight, p.ended, p.older);
        else return std::tie(p.x, p.m, p.weight, p.ended);
    }
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

}  // namespace rlslab
