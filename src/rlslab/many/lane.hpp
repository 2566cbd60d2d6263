// One filter of a fleet takes rows: the body of a GPU's kernels in plain C++, for a lane of a device or of a test.
#pragma once

#include <rlslab/many/fleet_records.hpp>

namespace rlslab::detail {

/// Records lie in tiles of this many filters, number w of neighbours side by side: 32 lanes read 32 numbers in a row.
inline constexpr Index lanes_a_tile = 32;

/// What a launch takes: the filters' records, and R rows for each. psi of filter i, row k and parameter j is at
/// i psi_filter + j psi_parameter + k psi_row; y at i y_filter + k y_row. health and missing have a number a filter.
template <class T>
struct LaneRows {
    T* records;
    T const *psi, *y;
    unsigned char* health;
    unsigned* missing;
    Index filters, rows, size, words;
    Index psi_filter, psi_parameter, psi_row, y_filter, y_row;
    Index room = 0;       ///< numbers that a team shares (gpu/team.hpp)
    T constants[4] = {};  ///< lambda and what is computed from it, in the order of `constants_of`

    T psi_of(Index i, Index k, Index j) const { return psi[i * psi_filter + j * psi_parameter + k * psi_row]; }
    T y_of(Index i, Index k) const { return y[i * y_filter + k * y_row]; }
};

/// A record's numbers, `apart` numbers from one to the next; what is not a T takes whole numbers of T.
template <class T, bool writes>
struct LaneRecord : Silent {
    std::conditional_t<writes, T, T const>* at;
    Index apart;
    LaneRecord(decltype(at) first, Index to_next) : at(first), apart(to_next) {}
    template <class X>
    [[gnu::always_inline]] void number(X& x) {
        T words[(sizeof(X) + sizeof(T) - 1) / sizeof(T)] = {};
        if constexpr (writes) __builtin_memcpy(words, static_cast<void const*>(&x), sizeof(X));
        for (T& word : words) {
            if constexpr (writes) *at = word;
            else word = *at;
            at += apart;
        }
        if constexpr (!writes) __builtin_memcpy(static_cast<void*>(&x), words, sizeof(X));
    }
    [[gnu::always_inline]] void piece(auto* x, Index n) {
        for (Index i = 0; i < n; ++i) number(x[i]);
    }
    [[gnu::always_inline]] void one(auto& x) {
        if constexpr (!writes) x = T(1);
    }
};
template <class T>
using LaneReading = LaneRecord<T, false>;
template <class T>
using LaneWriting = LaneRecord<T, true>;

/// A fleet's health of a filter after one more step (Fleet::health).
inline int health_after(int before, Health step) {
    return before == int(Health::undetermined) || before < int(step) ? int(step) : before;
}

/// Filter i takes its rows by F's own update; a row with a number that is not finite is missing.
template <class F, int d, class T = typename F::scalar>
[[gnu::always_inline]] inline void take_rows(LaneRows<T> const& in, Index i) {
    static_assert(std::is_trivially_copyable_v<F>);
    alignas(F) unsigned char room[sizeof(F)];
    __builtin_memset(room, 0, sizeof room);  // as a filter begins: zeros beside a triangle
    F& own = *reinterpret_cast<F*>(room);
    LaneReading<T> constants(in.constants, 1);
    constants_of(own, constants);
    T* const record = in.records + i / lanes_a_tile * (in.words * lanes_a_tile) + i % lanes_a_tile;
    LaneReading<T> reading(record, lanes_a_tile);
    pieces_of(own, reading);
    int health = in.health[i];
    unsigned missing = 0;
    for (Index k = 0; k < in.rows; ++k) {
        T row[d];
        T const y = in.y_of(i, k);
        bool present = y - y == T(0);
        for (int j = 0; j < d; ++j) row[j] = in.psi_of(i, k, j), present = present && row[j] - row[j] == T(0);
        if (present) health = health_after(health, own.update(Regressor<T>(row, d), y).health);
        else ++missing;
    }
    in.health[i] = static_cast<unsigned char>(health);
    if (missing > 0) in.missing[i] += missing;
    LaneWriting<T> writing(record, lanes_a_tile);
    pieces_of(own, writing);
}

}  // namespace rlslab::detail
