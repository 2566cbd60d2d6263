// A filter of 9 to 32 parameters takes rows in a team of 16 or 32 lanes: the library's order of operations, a lane a
// row of the matrix. Plain C++ in steps that all lanes take before the next begins.
#pragma once

#include <rlslab/many/lane.hpp>

namespace rlslab::detail {

/// The tree of the dot product of eight running lanes (linalg/dot.hpp).
template <class T>
T tree_of(T const* x) {
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}
/// Two numbers that are read together.
template <class T>
struct alignas(2 * sizeof(T)) TwoNumbers {
    T mu, g;
};
/// Numbers of T that a team needs for a record of so many: whole pairs, so that the next team's are aligned.
template <int lanes>
constexpr Index team_room(Index words) {
    return 7 * lanes + 18 + words + words % 2;
}

/// The steps that all forms share. Team: each(work) is work(lane) for each lane, all(test) whether it holds for all.
/// N: the number of parameters, or 0 where the launch says it. room: team_room numbers of the team's own.
template <class T, int lanes, int N>
struct TeamOfRows {
    LaneRows<T> const& in;
    Index const filter;
    TwoNumbers<T>* const pairs;
    T *const psi, *const products, *const f, *const x, *const part, *const sums, *const more, *const both,
                                                                                                  *const record;

    TeamOfRows(LaneRows<T> const& rows, Index i, T* room)
        : in(rows), filter(i), pairs(reinterpret_cast<TwoNumbers<T>*>(room)), psi(room + 2 * lanes),
          products(psi + lanes), f(products + lanes), x(f + lanes), part(x + lanes), sums(part + lanes), more(sums + 8),
          both(more + 8), record(both + 2) {}
    int size() const { return N == 0 ? int(in.size) : N; }

    template <class Team, class Row>
    [[gnu::always_inline]] void take(Team const& team, Row const& row) {
        int const d = size();
        T* const there = in.records + filter * in.words;
        team.each([&](int i) { copy(there, record, i); });
        int health = in.health[filter];
        unsigned missing = 0;
        for (Index k = 0; k < in.rows; ++k) {
            T const y = in.y_of(filter, k);
            team.each([&](int i) {
                if (i >= d) return;
                psi[i] = in.psi_of(filter, k, i);
                products[i] = psi[i] * record[i];
            });
            bool const present = team.all([&](int i) { return i >= d || psi[i] - psi[i] == T(0); });
            if (present && y - y == T(0)) {
                row(y);
                bool const finite = team.all([&](int i) { return i >= d || record[i] - record[i] == T(0); });
                Step<T> const step = step_of<T>(both[0], in.constants[0], both[1]);
                health = health_after(health, if_finite<T>(finite, step).health);
            } else {
                ++missing;
            }
        }
        team.each([&](int i) {
            copy(record, there, i);
            if (i == 0) in.health[filter] = static_cast<unsigned char>(health);
            if (i == 0 && missing > 0) in.missing[filter] += missing;
        });
    }
    /// Lane i's part of the dot product of d numbers: running lane i of eight.
    [[gnu::always_inline]] void run(T const* of, T* to, int i) const {
        if (i >= 8) return;
        T sum = of[i];
        for (int r = i + 8; r < size(); r += 8) sum = sum + of[r];
        to[i] = sum;
    }
    /// theta of lane i is complete.
    [[gnu::always_inline]] void finish(T const& K, int i) const { record[i] = record[i] + both[0] * K; }

private:
    /// All loads before the first store.
    [[gnu::always_inline]] void copy(T const* from, T* to, int i) const {
        if constexpr (N == 0) {
            for (Index w = i; w < in.words; w += lanes) to[w] = from[w];
        } else {
            constexpr int most = (N + N * N + lanes - 1) / lanes;
            int const words = int(in.words);
            T held[most];
            for (int n = 0; n < most; ++n)
                if (n * lanes + i < words) held[n] = from[n * lanes + i];
            for (int n = 0; n < most; ++n)
                if (n * lanes + i < words) to[n * lanes + i] = held[n];
        }
    }
};

/// ud and ud_delta (variants/ud.hpp, ud_delta.hpp). The record: theta, D, the strict upper triangle of U by columns.
template <bool delta, class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void take_rows_of_ud(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    TeamOfRows<T, lanes, N> of(in, filter, room);
    int const d = of.size();
    T const lambda = in.constants[0], c = in.constants[1];
    T *const D = of.record + d, *const U = D + d;
    of.take(team, [&](T const& y) {
        team.each([&](int i) {
            of.run(of.products, of.sums, i);
            if (i >= d) return;
            T const* const column = U + i * (i - 1) / 2;
            T lane[8];
            for (int l = 0; l < 8; ++l)
                for (int r = l; r < lanes; r += 8)
                    if (r <= i) {
                        T const product = (r < i ? column[r] : T(1)) * of.psi[r];
                        lane[l] = r == l ? product : lane[l] + product;
                    }
            for (int half = 4; half >= 1; half /= 2)
                for (int l = 0; l < half; ++l)
                    if (l + half <= i) lane[l] = lane[l] + lane[l + half];
            of.f[i] = lane[0];  // (1)
            of.pairs[i].g = D[i] * of.f[i];
            of.x[i] = of.f[i] * of.pairs[i].g;
        });
        team.each([&](int i) {  // sums of blocks of eight (linalg/kernels.hpp: prefix_sums)
            if (i == 0) of.both[0] = y - tree_of(of.sums);
            if (i >= d) return;
            int const b = i & ~7;
            T sum = of.x[b];
            for (int r = 1; r < 8; ++r)
                if (b + r <= i) sum = sum + of.x[b + r];
            of.part[i] = sum;
        });
        team.each([&](int i) {
            if (i >= d) return;
            T start = lambda, mine = lambda;  // (2)
            for (int b = 0; b < lanes; b += 8) {
                if (b == (i & ~7)) mine = start;
                if (b < d) start = start + of.part[b + 7 < d ? b + 7 : d - 1];
            }
            if (i == 0) of.both[1] = start;
            T const before = i == (i & ~7) ? mine : mine + of.part[i - 1], after = mine + of.part[i];
            if constexpr (delta) {  // (3)
                T const h = (of.x[i] - c * before) / after, changed = D[i] - D[i] * h;
                T const product = D[i] * (before / after);
                D[i] = T(1) / T(2) < h ? product + product * c : changed;
            } else {
                T const shrunk = D[i] * (before / after);
                D[i] = shrunk + shrunk * c;
            }
            of.pairs[i].mu = of.f[i] / before;
        });
        team.each([&](int i) {
            if (i >= d) return;
            T v = T(0) + of.pairs[i].g;
            for (int j = 1; j < d; ++j)  // (4)
                if (j > i) {
                    T& u = U[j * (j - 1) / 2 + i];
                    TwoNumbers<T> const by = of.pairs[j];
                    T const t = u;
                    u = t - v * by.mu;
                    v = v + t * by.g;
                }
            of.finish(v / of.both[1], i);  // (5)
        });
    });
}

template <class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void team_ud(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    take_rows_of_ud<false, T, lanes, N>(team, in, filter, room);
}
template <class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void team_ud_delta(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    take_rows_of_ud<true, T, lanes, N>(team, in, filter, room);
}

/// conventional (variants/conventional.hpp). The record: theta, P by columns.
template <class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void team_conventional(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    TeamOfRows<T, lanes, N> of(in, filter, room);
    int const d = of.size();
    T const lambda = in.constants[0], c = in.constants[1];
    T* const P = of.record + d;
    of.take(team, [&](T const& y) {
        team.each([&](int i) {
            of.run(of.products, of.sums, i);
            if (i >= d) return;
            T sum = P[i] * of.psi[0];
            for (int j = 1; j < d; ++j) sum = sum + P[j * d + i] * of.psi[j];
            of.f[i] = sum;  // (1)
            of.x[i] = of.psi[i] * sum;
        });
        team.each([&](int i) {
            of.run(of.x, of.more, i);
            if (i == 0) of.both[0] = y - tree_of(of.sums);
        });
        team.each([&](int i) {
            T const s = lambda + tree_of(of.more);  // (2)
            if (i == 0) of.both[1] = s;
            if (i >= d) return;
            T const K = of.f[i] / s;       // (3)
            for (int j = 0; j < d; ++j) {  // (4)
                T const t = P[j * d + i] - K * of.f[j];
                P[j * d + i] = t + t * c;
            }
            of.finish(K, i);  // (5)
        });
    });
}

}  // namespace rlslab::detail
