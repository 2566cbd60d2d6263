// The memory of a fleet: of each group of filters in lockstep only what an update reads and changes.
#pragma once

#include <rlslab/linalg/forms.hpp>
#include <rlslab/state/state.hpp>

#include <cstring>
#include <vector>

namespace rlslab::detail {

/// Shows the columns of a triangle to `to` as pieces (first number, count). upper: rows up to the diagonal, else from
/// it on; unit: without the diagonal, which is shown to to.one: 1, or NaN after a row that was not finite.
template <class T, int N, class To>
void pieces_of_triangle(StateMatrix<T, N>& A, bool upper, bool unit, To& to) {
    Index const d = A.size();
    for (Index j = 0; j < d; ++j) {
        if (unit) to.one(A.column(j)[j]);
        if (upper) to.piece(A.column(j), unit ? j : j + 1);
        else to.piece(A.column(j) + j + unit, d - j - unit);
    }
}

/// Shows what an update reads and changes of a filter in this form, in pieces: no gain, no constants, no workspace.
template <class T, int N, class To>
void pieces(PlainCovariance<T, N> f, To& to) {
    Index const d = f.theta.size();
    to.piece(f.theta.data(), d);
    for (Index j = 0; j < d; ++j) to.piece(f.P.column(j), d);
}
template <class T, int N, class To>
void pieces(RootCovariance<T, N, false> f, To& to) {
    Index const d = f.theta.size();
    to.piece(f.theta.data(), d);
    for (Index j = 0; j < d; ++j) to.piece(f.S.column(j), d);
}
template <class T, int N, class To>
void pieces(RootCovariance<T, N, true> f, To& to) {
    to.piece(f.theta.data(), f.theta.size());
    pieces_of_triangle(f.S, true, false, to);
}
template <class T, int N, class To>
void pieces(UdCovariance<T, N> f, To& to) {
    to.piece(f.theta.data(), f.theta.size());
    to.piece(f.D.data(), f.D.size());
    pieces_of_triangle(f.U, true, true, to);
}
template <class T, int N, class To>
void pieces(RootInformation<T, N> f, To& to) {
    to.piece(f.z.data(), f.z.size());
    pieces_of_triangle(f.L, false, false, to);
    walk(to, f.lengths);
}
template <class T, int N, class To>
void pieces(UnitInformation<T, N> f, To& to) {
    to.piece(f.z.data(), f.z.size());
    to.piece(f.D.data(), f.D.size());
    pieces_of_triangle(f.L, false, true, to);
    walk(to, f.lengths);
}
/// A filter without such a form: its whole state.
template <class F, class To>
void pieces_of(F& f, To& to) {
    if constexpr (requires { pieces(f.form(), to); }) pieces(f.form(), to);
    else walk(to, f);
}

/// Counts, writes and reads a record, which is an array of packs P. What is not a pack takes whole packs.
template <class P>
struct RecordSize : Silent {
    Index packs = 0;
    template <class X>
    void number(X const&) {
        packs += Index((sizeof(X) + sizeof(P) - 1) / sizeof(P));
    }
    void piece(P const*, Index n) { packs += n; }
    void one(P const&) {}
};
template <class P>
struct RecordWriting : Silent {
    P* to;
    explicit RecordWriting(P* record) : to(record) {}
    [[gnu::always_inline]] void number(P const& x) { *to++ = x; }
    template <class X>
    void number(X const& x) {
        static_assert(std::is_trivially_copyable_v<X>);
        std::memcpy(static_cast<void*>(to), &x, sizeof x);
        to += (sizeof(X) + sizeof(P) - 1) / sizeof(P);
    }
    [[gnu::always_inline]] void piece(P const* x, Index n) {
        for (Index i = 0; i < n; ++i) to[i] = x[i];
        to += n;
    }
    void one(P const&) {}
};
template <class P>
struct RecordReading : Silent {
    P const* from;
    explicit RecordReading(P const* record) : from(record) {}
    [[gnu::always_inline]] void number(P& x) { x = *from++; }
    template <class X>
    void number(X& x) {
        std::memcpy(&x, static_cast<void const*>(from), sizeof x);
        from += (sizeof(X) + sizeof(P) - 1) / sizeof(P);
    }
    [[gnu::always_inline]] void piece(P* x, Index n) {
        for (Index i = 0; i < n; ++i) x[i] = from[i];
        from += n;
    }
    /// Not kept: what an earlier filter in this workspace left there is not this one's.
    [[gnu::always_inline]] void one(P& x) { x = P(1); }
};

template <class F>
inline constexpr bool stores_a_square = false;
template <class F>
    requires requires(F f) { f.form().P; }
inline constexpr bool stores_a_square<F> = true;
template <class T, int N>
void is_a_square(RootCovariance<T, N, false> const&);
template <class F>
    requires requires(F f) { is_a_square(f.form()); }
inline constexpr bool stores_a_square<F> = true;

/// Filters F that began alike, without their common constants and their gains: records, each read into an F
/// for an update and written back. Where the size is not fixed and F stores a square, or its form is not known here,
/// the record would be most of F, and copying it took longer than it saved (docs/speed.md): those are kept as they are.
template <class F>
class FleetRecords {
    using P = typename F::scalar;
    static constexpr bool in_place =
        size_of<F> == Dynamic && (stores_a_square<F> || !requires(F f, RecordSize<P> to) { pieces(f.form(), to); });
    F pattern_;
    Index packs_ = 0, count_;  // of a record; records
    std::vector<P, Aligned<P>> numbers_;
    std::vector<F> filters_;

public:
    FleetRecords(F const& pattern, Index count) : pattern_(pattern), count_(count) {
        RecordSize<P> size;
        pieces_of(pattern_, size);
        packs_ = size.packs;
        if constexpr (in_place) {
            filters_.assign(size_t(count), pattern);
        } else {
            numbers_.resize(size_t(packs_ * count));
            for (Index g = 0; g < count; ++g) write(g, pattern_);
        }
    }
    Index size() const { return numbers_.empty() && filters_.empty() ? 0 : count_; }  ///< 0 when it was moved from
    F const& pattern() const { return pattern_; }
    Index bytes() const { return packs_ * Index(sizeof(P)); }  ///< of a record

    /// Filter g: in `workspace`, a copy of the pattern, or where it is kept. What was changed is to be written.
    F& read(Index g, F& workspace) {
        if constexpr (in_place) return filters_[size_t(g)];
        return read_into(g, workspace);
    }
    F const& read(Index g, F& workspace) const {
        if constexpr (in_place) return filters_[size_t(g)];
        return read_into(g, workspace);
    }
    void write(Index g, F& from) {
        if constexpr (in_place) return;
        RecordWriting<P> writing(numbers_.data() + g * packs_);
        pieces_of(from, writing);
    }
    /// Asks memory for the record that follows g after some 64 cache lines.
    void prefetch_behind(Index g) const {
        constexpr Index lines = 64, line = 64;
        if constexpr (in_place) return;
        Index const next = g + std::max<Index>(1, lines * line / bytes());
        if (next >= count_) return;
        auto const* const at = reinterpret_cast<char const*>(numbers_.data() + next * packs_);
        for (Index i = 0; i < std::min(bytes(), lines * line); i += line) __builtin_prefetch(at + i, 1);
    }
    /// look(filter) for each, as its state shows it; where this is not const, look may change the filter.
    template <class Look>
    void each(Look look) const {
        F workspace = pattern_;
        for (Index g = 0; g < size(); ++g) look(read(g, workspace));
    }
    template <class Look>
    void each(Look look) {
        for (Index g = 0; g < size(); ++g) {
            F& filter = read(g, pattern_);
            look(filter);
            write(g, filter);
        }
    }

private:
    F& read_into(Index g, F& workspace) const {
        RecordReading<P> reading(numbers_.data() + g * packs_);
        pieces_of(workspace, reading);
        return workspace;
    }
};

}  // namespace rlslab::detail
