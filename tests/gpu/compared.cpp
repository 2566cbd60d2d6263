// The comparison of compared.hpp, for the seven forms.
#include "tests/gpu/compared.hpp"

#include <rlslab/gpu/fleet.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>

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
        default: break;
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
std::uint64_t bits_of(double x) { return x != x ? 1 : std::bit_cast<std::uint64_t>(x); }
std::uint64_t bits_of(float x) { return x != x ? 1 : std::bit_cast<std::uint32_t>(x); }

template <class F>
std::vector<typename F::scalar> words_of(F& f) {
    detail::RecordSize<typename F::scalar> size;
    detail::pieces_of(f, size);
    std::vector<typename F::scalar> out(size_t(size.packs));
    detail::LaneWriting<typename F::scalar> to(out.data(), 1);
    detail::pieces_of(f, to);
    return out;
}
template <class T>
Problem<T> problem_of(int d, bool prior) {
    Problem<T> out{.size = d, .forgetting = T(0.99), .prior = std::nullopt};
    if (prior) out.prior = Prior<T>{.variance = T(1024)};
    return out;
}

template <class F>
Compared compared_of(int d, Index M, Index rows, bool prior, bool on_gpu) {
    using T = typename F::scalar;
    Problem<T> const problem = problem_of<T>(d, prior);
    std::vector<F> own(size_t(M), F{problem});
    std::vector<int> health(size_t(M), int(prior ? Health::sound : Health::undetermined));
    std::vector<Index> missing(size_t(M), 0);
    std::optional<Fleet<F>> fleet;
    if (on_gpu) fleet.emplace(M, problem);
    for (Index k0 = 0; k0 < rows;) {
        Index const R = k0 < rows / 5 ? 1 : std::min<Index>(10, rows - k0);
        Matrix<T> psi(M, d * R), y(M, R);
        Index const threads = M > 1000 ? 16 : 1;
        auto const work = [&](Index share) {
            Vector<T> row(d);
            for (Index i = share; i < M; i += threads)
                for (Index k = 0; k < R; ++k) {
                    row_of<T>(i, k0 + k, d, row.data(), y(i, k));
                    psi.row(i).segment(k * d, d) = row.transpose();
                    if (!row.allFinite() || !std::isfinite(y(i, k))) ++missing[size_t(i)];
                    else
                        health[size_t(i)] =
                            detail::health_after(health[size_t(i)], own[size_t(i)].update(row, y(i, k)).health);
                }
        };
        detail::among_threads(threads, work);
        if (fleet) fleet->update(psi, y);
        k0 += R;
    }
    Compared out;
    std::vector<Health> const theirs = fleet ? fleet->healths() : std::vector<Health>{};
    auto const digest = [&out](std::uint64_t x) { out.digest = Seed{out.digest ^ x}.next(); };
    std::vector<std::uint64_t> wanted;
    Index const numbers = Index(words_of(own[0]).size());
    for (Index i = 0; i < M; ++i) {
        for (T const x : words_of(own[size_t(i)])) wanted.push_back(bits_of(x)), digest(wanted.back());
        digest(std::uint64_t(health[size_t(i)]));
        out.not_sound += health[size_t(i)] != 0;
    }
    if (!fleet) return out;
    FleetCounts counts{0, 0};
    fleet->each([&](Index i, F& one) {
        bool same = int(theirs[size_t(i)]) == health[size_t(i)];
        std::uint64_t const* at = wanted.data() + i * numbers;
        for (T const x : words_of(one)) same = bits_of(x) == *at++ && same;
        counts.missing += missing[size_t(i)];
        if (!same && out.different++ == 0) out.first = i;
    });
    if (fleet->counts().missing != counts.missing || fleet->counts(M - 1).missing != missing[size_t(M - 1)])
        ++out.different;
    return out;
}

template <class F>
std::vector<std::string> lost_of(int d) {
    using T = typename F::scalar;
    Index const M = 70;
    Fleet<F> fleet(M, problem_of<T>(d, true)), other(M, problem_of<T>(d, true));
    Matrix<T> psi(M, d);
    Vector<T> y(M), row(d);
    std::vector<std::string> out;
    auto const same = [&](F a, F b) {
        auto const x = words_of(a), z = words_of(b);
        return std::equal(x.begin(), x.end(), z.begin(), [](T p, T q) { return bits_of(p) == bits_of(q); });
    };
    auto const rows = [&](Index k) {
        for (Index i = 0; i < M; ++i) row_of<T>(i, k, d, row.data(), y[i]), psi.row(i) = row.transpose();
    };
    for (Index k = 0; k < 20; ++k) rows(k), fleet.update(psi, y);
    F one = fleet.filter(40);
    for (Index k = 20; k < 30; ++k) {
        rows(k), fleet.update(psi, y);
        one.update(Vector<T>(psi.row(40)), y[40]);
    }
    if (!same(one, fleet.filter(40))) out.push_back("filter");
    other.put(3, one);
    if (!same(one, other.filter(3)) || other.health(3) != Health::sound) out.push_back("put");
    if (!same(other.filter(35), F(problem_of<T>(d, true)))) out.push_back("a neighbour");
    std::vector<std::byte> const bytes = state_of(fleet);
    if (load(other, bytes) != StateFault::none) out.push_back("load");
    rows(31), fleet.update(psi, y), other.update(psi, y);
    for (Index i = 0; i < M; ++i)
        if (!same(fleet.filter(i), other.filter(i)) || fleet.health(i) != other.health(i) ||
            fleet.counts(i).missing != other.counts(i).missing || other.counts(i).taken != fleet.counts(i).taken)
            out.push_back("filter " + std::to_string(i) + " of a file");
    Matrix<T> const thetas = fleet.thetas();
    if (Vector<T>(thetas.row(9)) != Vector<T>(fleet.filter(9).theta())) out.push_back("thetas");
    return out;
}

template <class F>
Timed timed_of(int d, Index M, Index rows, double seconds) {
    using T = typename F::scalar;
    Problem<T> problem{.size = d, .forgetting = T(0.999), .prior = Prior<T>{.variance = T(16)}};
    Fleet<F> fleet(M, problem);
    Index const of_row = M * (d + 1),
                turns = rows > 1 ? 1 : std::max<Index>(1, std::min<Index>(8, Index(1) << 30) / (of_row * 8));
    static std::vector<T> numbers;
    if (Index(numbers.size()) < of_row + 100000) {
        numbers.resize(size_t(of_row + 100000));
        auto const work = [&](Index share) {
            for (size_t n = size_t(share); n < numbers.size(); n += 16) numbers[n] = T(uniform(Index(n), 1, 1));
        };
        detail::among_threads(16, work);
    }
    Memory<T> psi(size_t(turns * rows * M * d)), y(size_t(turns * rows * M));
    for (Index k = 0; k < turns * rows; ++k) {
        psi.write(size_t(k * M * d), numbers.data() + k * 1009, size_t(M * d));
        y.write(size_t(k * M), numbers.data() + k * 1009 + M * d, size_t(M));
    }
    Index turn = 0;
    auto const launch = [&] {
        Index const k = turn++ % turns * rows;
        fleet.update(RowsThere<T>{psi.data() + k * M * d, y.data() + k * M, rows, 1, M, M * d, 1, M});
    };
    using clock = std::chrono::steady_clock;
    auto const measured = [&](int n) {
        auto const start = clock::now();
        for (int i = 0; i < n; ++i) launch();
        fleet.wait();
        return std::chrono::duration<double>(clock::now() - start).count() / n;
    };
    measured(2);
    int const n = std::max(1, int(seconds / 5 / std::max(1e-6, measured(2))));
    std::vector<double> all;
    for (int i = 0; i < 5; ++i) all.push_back(measured(n));
    std::sort(all.begin(), all.end());
    double const bytes = 2 * double(fleet.bytes_per_filter()) + 2 + double(rows * (d + 1)) * sizeof(T);
    return {all[2] / double(M) / double(rows) * 1e9, bytes / double(rows)};
}

/// f of a filter of the form, as a type.
template <class T, class Function>
auto of_form(std::string const& form, Function const& f) {
    if (form == "ud") return f(std::type_identity<Ud<T>>{});
    if (form == "ud_delta") return f(std::type_identity<UdDelta<T>>{});
    if (form == "conventional") return f(std::type_identity<Conventional<T>>{});
    if (form == "carlson") return f(std::type_identity<Carlson<T>>{});
    if (form == "gentleman") return f(std::type_identity<Gentleman<T>>{});
    if (form == "qr") return f(std::type_identity<Qr<T>>{});
    expects(form == "inverse_qr", "a form of forms()");
    return f(std::type_identity<InverseQr<T>>{});
}
template <class Function>
auto of(std::string const& form, bool is_double, Function const& f) {
    return is_double ? of_form<double>(form, f) : of_form<float>(form, f);
}

}  // namespace

std::vector<std::string> const& forms() {
    static std::vector<std::string> const all{"ud",        "ud_delta", "conventional", "carlson",
                                              "gentleman", "qr",       "inverse_qr"};
    return all;
}
Compared compared(std::string const& form, bool is_double, int d, long M, long rows, bool prior, bool on_gpu) {
    return of(form, is_double,
              [&](auto type) { return compared_of<typename decltype(type)::type>(d, M, rows, prior, on_gpu); });
}
std::vector<std::string> lost_on_the_way(std::string const& form, bool is_double, int d) {
    return of(form, is_double, [&](auto type) { return lost_of<typename decltype(type)::type>(d); });
}
Timed timed(std::string const& form, bool is_double, int d, long M, long rows, double seconds) {
    return of(form, is_double, [&](auto type) { return timed_of<typename decltype(type)::type>(d, M, rows, seconds); });
}

}  // namespace rlslab::gpu
