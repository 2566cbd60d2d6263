// A filter of 9 to 32 parameters takes rows in a team of 16 or 32 lanes, in the library's order of operations.
#pragma once

#include <rlslab/many/lane.hpp>

namespace rlslab::detail {

/// The tree of the dot product of eight running lanes (linalg/dot.hpp).
template <class T>
[[gnu::always_inline]] inline T tree_of(T const* x) {
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}
/// Numbers of T that a team shares, beside a record of so many: 16 bytes begin the next team's.
template <int lanes>
constexpr Index team_room(Index words) {
    return 5 * lanes + 16 + (words + 3) / 4 * 4;
}

/// The steps that all forms share. Team: each(work) is work(lane) for each lane, alone(work) the same where no lane
/// looks at another's, all(test) whether it holds for all; Own<X> is an X that each lane has. Teams of one warp go
/// together. N: the number of parameters, or 0 where the launch says it. room: team_room numbers, 16 bytes aligned.
template <class T, int lanes, int N, class Team>
struct TeamOfRows {
    template <class X>
    using Own = typename Team::template Own<X>;
    Team const& team;
    LaneRows<T> const& in;
    Index const filter;
    T *const psi, *const products, *const x, *const part, *const sums, *const more, *const record;
    T* const there;
    Own<T> theta, next;

    TeamOfRows(Team const& of, LaneRows<T> const& rows, Index i, T* room)
        : team(of), in(rows), filter(i), psi(room + lanes), products(psi + lanes), x(products + lanes), part(x + lanes),
          sums(part + lanes), more(sums + 8), record(more + 8), there(in.records + filter * in.words), theta{}, next{} {
    }
    [[gnu::always_inline]] int size() const { return N == 0 ? int(in.size) : N; }

    /// row(y, e, s) for each row that is present, e and s its answers. keep(lane) and back(lane) leave and take what
    /// lanes own: a row that is missing beside another team's goes and is taken back.
    [[gnu::always_inline]] void take(auto const& row, auto const& keep, auto const& back) {
        int const d = size();
        int health = in.health[filter];
        unsigned missing = 0;
        T after = in.y_of(filter, 0);
        team.alone([&](int i) { next[i] = i < d ? in.psi_of(filter, 0, i) : T(0); });
        for (Index k = 0; k < in.rows; ++k) {
            T const y = after;
            bool const present = team.all([&](int i) { return next[i] - next[i] == T(0); }) && y - y == T(0);
            team.each([&](int i) {
                psi[i] = next[i];
                products[i] = next[i] * theta[i];
            });
            if (k + 1 < in.rows) {
                after = in.y_of(filter, k + 1);
                team.alone([&](int i) { next[i] = i < d ? in.psi_of(filter, k + 1, i) : T(0); });
            }
            if (!present) ++missing;
            if (!team.any_team(present)) continue;
            bool const every = team.every_team(present);
            if (!every) team.alone(keep);
            T e, s;
            row(y, e, s);
            bool const finite = team.all([&](int i) { return i >= d || theta[i] - theta[i] == T(0); });
            if (present) health = health_after(health, if_finite<T>(finite, step_of<T>(e, in.constants[0], s)).health);
            else team.alone(back);
        }
        team.alone([&](int i) {
            if (i != 0) return;
            in.health[filter] = static_cast<unsigned char>(health);
            if (missing > 0) in.missing[filter] += missing;
        });
    }
    /// Lane i's part of the dot product of d numbers: running lane i of eight.
    [[gnu::always_inline]] void run(T const* of, T* to, int i) const {
        if (i >= 8) return;
        T sum = of[i];
        for (int r = 8; r < lanes; r += 8)
            if (i + r < size()) sum = sum + of[i + r];
        to[i] = sum;
    }
    /// All loads before the first store.
    template <int most>
    [[gnu::always_inline]] void copy(T const* from, T* to) const {
        int const words = int(in.words);
        team.each([&](int i) {
            T held[most];
            T const* const source = from + i;
            T* const target = to + i;
            for (int n = 0; n < most; ++n)
                if (n * lanes + i < words) held[n] = source[n * lanes];
            for (int n = 0; n < most; ++n)
                if (n * lanes + i < words) target[n * lanes] = held[n];
        });
    }
};

/// ud and ud_delta (variants/ud.hpp, ud_delta.hpp). The record: theta, D, the strict upper triangle of U by columns.
/// Lane j has column j of U, upwards from the diagonal: the numbers of one place are a diagonal, and the sweep's v go
/// from lane to lane.
template <bool delta, class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void take_rows_of_ud(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    TeamOfRows<T, lanes, N, Team> of(team, in, filter, room);
    int const d = of.size();
    T const lambda = in.constants[0], c = in.constants[1];
    typename Team::template Own<T[lanes]> U{};
    typename Team::template Own<T> D{}, f{}, g{}, v{}, mu{};
    typename Team::template Own<bool> ends{};
    constexpr int most = (2 * lanes + lanes * (lanes - 1) / 2 + lanes - 1) / lanes;
    auto const keep = [&](int i) {
        if (i >= d) return;
        of.record[i] = of.theta[i], of.record[d + i] = D[i];
        T* const column = of.record + 2 * d + i * (i - 1) / 2 + i;
        for (int t = 1; t < lanes; ++t)
            if (t <= i) column[-t] = U[i][t];
    };
    auto const back = [&](int i) {
        if (i >= d) return;
        of.theta[i] = of.record[i], D[i] = of.record[d + i];
        T const* const column = of.record + 2 * d + i * (i - 1) / 2 + i;
        for (int t = 1; t < lanes; ++t)
            if (t <= i) U[i][t] = column[-t];
    };
    auto const row = [&](T const& y, T& e, T& s) {
        team.each([&](int i) {
            of.run(of.products, of.sums, i);
            T const* const psi = of.psi + i;
            T lane[8];  // by place, not by row: the tree is the same from each row on
            for (int l = 0; l < 8; ++l) lane[l] = -T(0);
            for (int t = lanes - 1; t >= 1; --t) {
                T const product = U[i][t] * psi[-t];
                lane[t % 8] = lane[t % 8] + (t <= i ? product : -T(0));  // -0 changes no sum
            }
            lane[0] = lane[0] + psi[0];
            f[i] = tree_of(lane);  // (1)
            g[i] = D[i] * f[i];
            of.x[i] = f[i] * g[i];
        });
        team.each([&](int i) {  // sums of blocks of eight (linalg/kernels.hpp: prefix_sums)
            e = y - tree_of(of.sums);
            int const b = i & ~7;
            T const* const block = of.x + b;
            T sum = block[0];
            for (int r = 1; r < 8; ++r) {
                T const term = block[r];
                sum = sum + (b + r <= i ? term : -T(0));
            }
            of.part[i] = sum;
        });
        team.alone([&](int i) {
            T start = lambda, mine = lambda;  // (2)
            for (int b = 0; b < lanes; b += 8) {
                if (b == (i & ~7)) mine = start;
                if (b < d) start = start + of.part[b + 7 < d ? b + 7 : d - 1];
            }
            s = start;
            T const sum = of.part[i & 7 ? i - 1 : i], before = i & 7 ? mine + sum : mine, after = mine + of.part[i];
            if constexpr (delta) {  // (3)
                T const h = (f[i] * g[i] - c * before) / after, changed = D[i] - D[i] * h;
                T const product = D[i] * (before / after);
                D[i] = T(1) / T(2) < h ? product + product * c : changed;
            } else {
                T const shrunk = D[i] * (before / after);
                D[i] = shrunk + shrunk * c;
            }
            mu[i] = f[i] / before;
            v[i] = T(0) + g[i];
            ends[i] = i == d - 1;
            if (ends[i]) of.x[i] = v[i];
        });
        T* const last = of.x + d - 1;
        for (int t = 1; t < lanes; ++t) {  // (4): row i of U is in lane i + t
            if (t >= d) break;
            team.up(v);
            team.alone([&](int i) {
                T const old = U[i][t];
                U[i][t] = old - v[i] * mu[i];
                team.settle(U[i][t]);
                v[i] = v[i] + old * g[i];
                if (ends[i]) last[-t] = v[i];
            });
        }
        team.meet();
        team.each([&](int i) { of.theta[i] = of.theta[i] + e * (of.x[i] / s); });  // (5)
    };
    of.template copy<most>(of.there, of.record);
    team.alone(back);
    of.take(row, keep, back);
    team.each(keep);
    of.template copy<most>(of.record, of.there);
}

#define RLSLAB_TEAM_OF_UD(NAME, DELTA)                                                                          \
    template <class T, int lanes, int N, class Team>                                                            \
    [[gnu::always_inline]] inline void team_##NAME(Team const& team, LaneRows<T> const& in, Index i, T* room) { \
        take_rows_of_ud<DELTA, T, lanes, N>(team, in, i, room);                                                 \
    }
RLSLAB_TEAM_OF_UD(ud, false)
RLSLAB_TEAM_OF_UD(ud_delta, true)
#undef RLSLAB_TEAM_OF_UD

/// conventional (variants/conventional.hpp). The record: theta, P by columns. Lane i has row i of P.
template <class T, int lanes, int N, class Team>
[[gnu::always_inline]] inline void team_conventional(Team const& team, LaneRows<T> const& in, Index filter, T* room) {
    TeamOfRows<T, lanes, N, Team> of(team, in, filter, room);
    int const d = of.size();
    T const lambda = in.constants[0], c = in.constants[1];
    typename Team::template Own<T[lanes]> P{};
    typename Team::template Own<T> f{};
    auto const keep = [&](int i) {
        if (i >= d) return;
        T* const mine = of.there + i;
        mine[0] = of.theta[i];
        for (int j = 0; j < lanes; ++j)
            if (j < d) mine[d + j * d] = P[i][j];
    };
    auto const back = [&](int i) {
        if (i >= d) return;
        T const* const mine = of.there + i;
        of.theta[i] = mine[0];
        for (int j = 0; j < lanes; ++j)
            if (j < d) P[i][j] = mine[d + j * d];
    };
    auto const row = [&](T const& y, T& e, T& s) {
        team.each([&](int i) {
            of.run(of.products, of.sums, i);
            T const* const psi = static_cast<T const*>(__builtin_assume_aligned(of.psi, 16));
            T sum = P[i][0] * psi[0];
            for (int j = 1; j < lanes; ++j)
                if (j < d) sum = sum + P[i][j] * psi[j];
            f[i] = of.part[i] = sum;  // (1)
            of.x[i] = psi[i] * sum;
        });
        team.each([&](int i) {
            of.run(of.x, of.more, i);
            e = y - tree_of(of.sums);
        });
        team.each([&](int i) {
            T const* const all = static_cast<T const*>(__builtin_assume_aligned(of.part, 16));
            s = lambda + tree_of(of.more);  // (2)
            T const K = f[i] / s;           // (3)
            for (int j = 0; j < lanes; ++j) {
                if (j >= d) break;
                T const t = P[i][j] - K * all[j];  // (4)
                P[i][j] = t + t * c;
            }
            of.theta[i] = of.theta[i] + e * K;  // (5)
        });
    };
    team.alone(back);
    of.take(row, keep, back);
    team.alone(keep);
}

}  // namespace rlslab::detail
