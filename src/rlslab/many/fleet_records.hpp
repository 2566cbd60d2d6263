// The memory of a fleet: of each group of filters in lockstep only what an update reads and changes.
#pragma once

#include <rlslab/linalg/forms.hpp>
#include <rlslab/state/lanes.hpp>

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
/// Shows its constants, which no update changes.
template <class Form, class To>
void constants(Form f, To& to) {
    to.number(f.lambda);
    if constexpr (requires { f.by_lambda; }) walk(to, f.by_lambda);
    else if constexpr (requires { f.by_root_lambda; }) walk(to, f.by_root_lambda);
    else if constexpr (requires { f.root_lambda; }) to.number(f.root_lambda);
}
/// Whether its form is all of F: not where F is around a filter and hands on that one's form.
template <class F, class To>
concept IsItsForm = requires(F& f, To& to) { pieces(f.form(), to); } && !requires { requires F::departs; };

/// A filter that is not its form: its whole state, in which the constants are.
template <class F, class To>
void constants_of(F& f, To& to) {
    if constexpr (IsItsForm<F, To>) constants(f.form(), to);
}
template <class F, class To>
void pieces_of(F& f, To& to) {
    if constexpr (IsItsForm<F, To>) pieces(f.form(), to);
    else walk(to, f);
}

/// Counts, writes and reads a record, which is an array of packs P. What is not a pack takes whole packs.
template <class P>
struct RecordSize : BareCounts {
    Index packs = 0;
    template <class X>
    void number(X const&) {
        packs += Index((sizeof(X) + sizeof(P) - 1) / sizeof(P));
    }
    void piece(P const*, Index n) { packs += n; }
    void one(P const&) {}
};
/// some: only the lanes of the mask.
template <class P, bool some = false>
struct RecordWriting : BareCounts {
    P* to;
    typename P::Mask mask;
    explicit RecordWriting(P* record, typename P::Mask const& lanes = true) : to(record), mask(lanes) {}
    [[gnu::always_inline]] void number(P const& x) {
        *to = some ? select(mask, x, *to) : x;
        ++to;
    }
    template <class X>
    void number(X const& now) {
        static_assert(std::is_trivially_copyable_v<X>);
        X x = now;
        if constexpr (some && requires { x[0]; }) {
            X before;
            std::memcpy(static_cast<void*>(&before), static_cast<void const*>(to), sizeof x);
            if constexpr (std::same_as<X, typename P::Mask>) x = (mask && x) || (!mask && before);
            else x = select(mask, x, before);
        }
        std::memcpy(static_cast<void*>(to), &x, sizeof x);
        to += (sizeof(X) + sizeof(P) - 1) / sizeof(P);
    }
    [[gnu::always_inline]] void piece(P const* x, Index n) {
        for (Index i = 0; i < n; ++i) to[i] = some ? select(mask, x[i], to[i]) : x[i];
        to += n;
    }
    void one(P const&) {}
};
template <class P>
struct RecordReading : BareCounts {
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

template <class T, int N>
void is_a_square(RootCovariance<T, N, false> const&);
template <class F>
concept StoresASquare = requires(F f) { f.form().P; } || requires(F f) { is_a_square(f.form()); };

/// Groups of filters F in lockstep, without their gains and, where all have the same, without their constants: records,
/// each read into an F for an update and written back. Where the size is not fixed and F stores a square, or its form
/// is not known here, the record would be most of F, and copying it took longer than it saved (docs/speed.md): those
/// are kept as they are, and those that are guarded, of whose state a row reads and changes a part.
template <class F>
class FleetRecords {
    using P = typename F::scalar;
    using Mask = typename P::Mask;

public:
    static constexpr bool in_place =
        IsGuarded<F> || (size_of<F> == Dynamic && (StoresASquare<F> || !IsItsForm<F, RecordSize<P>>));

private:
    F pattern_;
    Index packs_ = 0, count_ = 0;   // of a record; records
    bool holds_constants_ = false;  // each record; else the pattern alone
    std::vector<P, Aligned<P>> numbers_;
    std::vector<F> filters_;

public:
    FleetRecords(F const& pattern, Index count) : pattern_(pattern) {
        packs_ = packs_of_a_record();
        expects(product_fits(size_t(packs_), size_t(count)) && product_fits(sizeof(F), size_t(count)),
                "filters that memory could hold");
        if constexpr (in_place) filters_.reserve(size_t(count));
        else numbers_.reserve(size_t(packs_ * count));
        while (count_ < count) append(pattern);
    }
    void append(F fresh) {
        ++count_;
        if constexpr (in_place) {
            filters_.push_back(fresh);
        } else {
            numbers_.resize(size_t(packs_ * count_));
            write(count_ - 1, fresh);
        }
    }
    Index size() const { return numbers_.empty() && filters_.empty() ? 0 : count_; }  ///< 0 when it was moved from
    F workspace() const { return pattern_; }                                          ///< to read into
    /// Of a record, or of what is kept as it is.
    Index bytes() const { return in_place && size_of<F> != Dynamic ? Index(sizeof(F)) : packs_ * Index(sizeof(P)); }

    /// Group g: in the workspace, or where it is kept. What was changed is to be written.
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
        if (holds_constants_) constants_of(from, writing);
    }
    /// The same of some lanes; the other lanes of the record stay. Nothing, where filters are kept in place.
    void write_some(Index g, F& from, Mask const& lanes) {
        if constexpr (in_place) return;
        RecordWriting<P, true> writing(numbers_.data() + g * packs_, lanes);
        pieces_of(from, writing);
    }
    /// What may have other constants than the pattern. Then each record holds its own from now on.
    void write_with_constants(Index g, F& from) {
        if (!in_place && !holds_constants_ && differ(from, pattern_)) hold_constants();
        write(g, from);
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
        F own = workspace();
        for (Index g = 0; g < size(); ++g) look(read(g, own));
    }
    template <class Look>
    void each(Look look) {
        F own = workspace();
        for (Index g = 0; g < size(); ++g) {
            F& filter = read(g, own);
            look(filter);
            if (g == 0) pattern_ = filter;  // what is read in has a pattern of its own
            write_with_constants(g, filter);
        }
    }

private:
    F& read_into(Index g, F& workspace) const {
        RecordReading<P> reading(numbers_.data() + g * packs_);
        pieces_of(workspace, reading);
        if (holds_constants_) constants_of(workspace, reading);
        return workspace;
    }
    Index packs_of_a_record() {
        RecordSize<P> size;
        pieces_of(pattern_, size);
        if (holds_constants_) constants_of(pattern_, size);
        return size.packs;
    }
    static bool differ(F& a, F& b) {
        NumbersOfLanes<P> of_a, of_b;
        constants_of(a, of_a);
        constants_of(b, of_b);
        for (size_t i = 0; i < of_a.numbers.size(); ++i)
            if (!all(of_a.numbers[i] == of_b.numbers[i])) return true;
        return false;
    }
    void hold_constants() {
        FleetRecords wider(pattern_, 0);
        wider.holds_constants_ = true;
        wider.packs_ = wider.packs_of_a_record();
        wider.numbers_.reserve(size_t(wider.packs_ * count_));
        F own = workspace();
        for (Index g = 0; g < count_; ++g) wider.append(read(g, own));
        *this = std::move(wider);
    }
};

}  // namespace rlslab::detail
