// The comparison of compared.hpp, for the seven forms.
#include "tests/gpu/compared.hpp"

#include <rlslab/gpu/fleet.hpp>
#include <rlslab/gpu/kernels.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/state/state.hpp>

#include <bit>
#include <chrono>
#include <cmath>

namespace rlslab::gpu {
namespace {

/// In [-1, 1), of 24 bits: the same in float and double.
double uniform(Index i, Index k, Index j) {
    std::uint64_t const at = (std::uint64_t(i) << 32) ^ (std::uint64_t(k) << 8) ^ std::uint64_t(j);
    return double(std::int64_t(Seed{at}.next() >> 40)) / 8388608.0 - 1.0;
}
/// Row k of filter i: of each 64 filters some with rows that overflow, underflow, are zero, infinite or alike.
template <class T>
void row_of(Index i, Index k, Index d, T* psi, T& y) {
    double scale = 1;
    switch (i % 64) {
        case 1: scale = std::ldexp(1.0, sizeof(T) == 8 ? 500 : 60); break;
        case 2: scale = std::ldexp(1.0, sizeof(T) == 8 ? -540 : -75); break;
        case 3: scale = 0; break;
        case 4: scale = k % 50 == 30 ? HUGE_VAL : 1; break;
        case 7: scale = std::ldexp(1.0, int(k % 40) - 20); break;
        case 8: scale = std::ldexp(1.0, k == 40 ? (sizeof(T) == 8 ? 511 : 63) : 0); break;
    }
    double sum = 0;
    for (Index j = 0; j < d; ++j) {
        double const x = uniform(i, k, i % 64 == 6 ? 0 : j);
        psi[j] = T(scale * x);
        sum += x * uniform(i, 1 << 20, j);
    }
    y = T(scale == 0 ? sum : scale * (sum + uniform(i, k, 200) / 64));
    if (i % 64 == 5 && k % 70 == 60) y = T(NAN);
}
/// The bits of x, all NaN alike: a GPU's have other signs and payloads.
std::uint64_t bits_of(auto x) {
    return x != x ? 1 : std::bit_cast<std::conditional_t<sizeof x == 8, std::uint64_t, std::uint32_t>>(x);
}

/// The bits of all that a filter's record has.
template <class F>
std::vector<std::uint64_t> words_of(F& f) {
    using T = typename F::scalar;
    detail::RecordSize<T> size;
    detail::pieces_of(f, size);
    std::vector<T> words(size_t(size.packs));
    detail::LaneWriting<T> to(words.data(), 1);
    detail::pieces_of(f, to);
    std::vector<std::uint64_t> out;
    for (T const x : words) out.push_back(bits_of(x));
    return out;
}
template <class T>
Problem<T> problem_of(int d, bool prior = true) {
    return {
        .size = d, .forgetting = T(0.99), .prior = prior ? std::optional(Prior<T>{.variance = T(1024)}) : std::nullopt};
}
template <class F>
Compared compared_of(int d, Index M, Index rows, bool prior, bool on_gpu) {
    using T = typename F::scalar;
    struct Single {
        F filter;
        int health;
        Index missing = 0;
    };
    Problem<T> const problem = problem_of<T>(d, prior);
    std::vector<Single> all(size_t(M), {F{problem}, int(prior ? Health::sound : Health::undetermined)});
    std::optional<Fleet<F>> fleet;
    if (on_gpu) fleet.emplace(M, problem);
    Index const threads = M > 1000 ? 16 : 1;
    for (Index k0 = 0, R = 1; k0 < rows; k0 += R) {
        R = k0 < rows / 5 ? 1 : std::min<Index>(10, rows - k0);
        Matrix<T> psi(M, d * R), y(M, R);
        detail::among_threads(threads, [&](Index share) {
            Vector<T> row(d);
            for (Index i = share; i < M; i += threads)
                for (Index k = 0; k < R; ++k) {
                    Single& own = all[size_t(i)];
                    row_of<T>(i, k0 + k, d, row.data(), y(i, k));
                    psi.row(i).segment(k * d, d) = row.transpose();
                    if (!row.allFinite() || !std::isfinite(y(i, k))) ++own.missing;
                    else own.health = detail::health_after(own.health, own.filter.update(row, y(i, k)).health);
                }
        });
        if (fleet) fleet->update(psi, y);
    }
    Compared out;
    auto const digest = [&out](std::uint64_t x) { out.digest = Seed{out.digest ^ x}.next(); };
    for (Single& own : all) {
        for (std::uint64_t const x : words_of(own.filter)) digest(x);
        digest(std::uint64_t(own.health));
        out.not_sound += own.health != 0;
    }
    if (!fleet) return out;
    Index missing = 0;
    std::vector<Health> const theirs = fleet->healths();
    fleet->each([&](Index i, F& one) {
        Single& own = all[size_t(i)];
        missing += own.missing;
        bool const same = words_of(one) == words_of(own.filter) && int(theirs[size_t(i)]) == own.health;
        if (!same && out.different++ == 0) out.first = i;
    });
    out.different += fleet->counts().missing != missing || fleet->counts(M - 1).missing != all.back().missing;
    return out;
}
template <class F>
std::vector<std::string> lost_of(int d) {
    using T = typename F::scalar;
    Index const M = 70;
    Fleet<F> fleet(M, problem_of<T>(d)), other(M, problem_of<T>(d));
    Matrix<T> psi(M, d);
    Vector<T> y(M), row(d);
    std::vector<std::string> out;
    auto const same = [](F a, F b) { return words_of(a) == words_of(b); };
    auto const rows = [&](Index k) {
        for (Index i = 0; i < M; ++i) row_of<T>(i, k, d, row.data(), y[i]), psi.row(i) = row.transpose();
        fleet.update(psi, y);
    };
    for (Index k = 0; k < 20; ++k) rows(k);
    F one = fleet.filter(40);
    for (Index k = 20; k < 30; ++k) rows(k), one.update(Vector<T>(psi.row(40)), y[40]);
    if (!same(one, fleet.filter(40))) out.push_back("filter");
    other.put(3, one);
    if (!same(one, other.filter(3)) || other.health(3) != Health::sound) out.push_back("put");
    if (!same(other.filter(35), F(problem_of<T>(d)))) out.push_back("a neighbour");
    std::vector<std::byte> const bytes = state_of(fleet);
    if (load(other, bytes) == StateFault::none) other.reset();
    if (!same(other.filter(0), F(problem_of<T>(d)))) out.push_back("reset");
    if (load(other, bytes) != StateFault::none) out.push_back("load");
    rows(31), other.update(psi, y);
    for (Index i = 0; i < M; ++i)
        if (!same(fleet.filter(i), other.filter(i)) || fleet.health(i) != other.health(i) ||
            fleet.counts(i).missing != other.counts(i).missing || other.counts(i).taken != fleet.counts(i).taken)
            out.push_back("filter " + std::to_string(i) + " of a file");
    if (Vector<T>(fleet.thetas().row(9)) != Vector<T>(fleet.filter(9).theta())) out.push_back("thetas");
    return out;
}
template <class F>
Timed timed_of(int d, Index M, Index rows, double seconds) {
    using T = typename F::scalar;
    Fleet<F> fleet(M, {.size = d, .forgetting = T(0.999), .prior = Prior<T>{.variance = T(16)}});
    Index const turns = rows > 1 ? 1 : 4;  // rows that were not seen a moment ago
    static std::vector<T> numbers(300'000'000 / sizeof(T));
    if (numbers[0] == T(0))
        detail::among_threads(16, [&](Index share) {
            for (size_t n = size_t(share); n < numbers.size(); n += 16) numbers[n] = T(uniform(Index(n), 1, 1));
        });
    Memory<T> psi(size_t(turns * rows * M * d)), y(size_t(turns * rows * M));
    for (Index k = 0; k < turns * rows; ++k) {
        psi.write(size_t(k * M * d), numbers.data() + k * 1009, size_t(M * d));
        y.write(size_t(k * M), numbers.data() + k * 1009 + 500'000, size_t(M));
    }
    auto const measured = [&](int n) {
        auto const start = std::chrono::steady_clock::now();
        for (Index i = 0; i < n; ++i) {
            Index const k = i % turns * rows;
            fleet.update(RowsThere<T>{psi.data() + k * M * d, y.data() + k * M, rows, 1, M, M * d, 1, M});
        }
        fleet.wait();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / n;
    };
    measured(2);
    int const n = std::max(1, int(seconds / 5 / std::max(1e-6, measured(2))));
    std::vector<double> all{measured(n), measured(n), measured(n), measured(n), measured(n)};
    std::sort(all.begin(), all.end());
    double const bytes = 2 * double(fleet.bytes_per_filter()) + 2 + double(rows * (d + 1)) * sizeof(T);
    return {all[2] / double(M) / double(rows) * 1e9, bytes / double(rows)};
}
/// f<F>() of the form F of that name.
template <class Result>
Result of(std::string_view form, bool is_double, auto const& f) {
    Result out{};
    auto const work = [&]<class F>(std::type_identity<F>) { out = f.template operator()<F>(); };
    expects(is_double ? of_form<double>(form, work) : of_form<float>(form, work), "a form of a fleet on a GPU");
    return out;
}

}  // namespace

Compared compared(std::string_view form, bool is_double, int d, long M, long rows, bool prior, bool on_gpu) {
    return of<Compared>(form, is_double, [&]<class F>() { return compared_of<F>(d, M, rows, prior, on_gpu); });
}
std::vector<std::string> lost_on_the_way(std::string_view form, bool is_double, int d) {
    return of<std::vector<std::string>>(form, is_double, [&]<class F>() { return lost_of<F>(d); });
}
Timed timed(std::string_view form, bool is_double, int d, long M, long rows, double seconds) {
    return of<Timed>(form, is_double, [&]<class F>() { return timed_of<F>(d, M, rows, seconds); });
}

}  // namespace rlslab::gpu
