// Many filters of one kind, one row each at a time: as many in lockstep as a Pack has lanes, in the order of memory.
#pragma once

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/many/fleet_records.hpp>
#include <rlslab/many/threads.hpp>

namespace rlslab {

namespace detail {
/// What a filter over packs holds for each lane, in the order of its state.
template <class P>
struct NumbersOfLanes : Silent {
    using Count = Lanes<Index, P::lanes>;
    std::vector<P> numbers = {};
    std::vector<typename P::Mask> truths = {};
    std::vector<Count> counts = {};
    void number(P const& x) { numbers.push_back(x); }
    void number(typename P::Mask const& x) { truths.push_back(x); }
    void number(Count const& x) { counts.push_back(x); }
    template <class X>
    void number(X const&) {}
    void clear() { numbers.clear(), truths.clear(), counts.clear(); }
};
/// Puts it back in the lanes of the mask.
template <class P>
struct LanesPutBack : Silent {
    typename P::Mask mask;
    P const* number_at;
    typename P::Mask const* truth_at;
    Lanes<Index, P::lanes> const* count_at;
    LanesPutBack(NumbersOfLanes<P> const& from, typename P::Mask const& lanes)
        : mask(lanes), number_at(from.numbers.data()), truth_at(from.truths.data()), count_at(from.counts.data()) {}
    void number(P& x) { x = select(mask, *number_at++, x); }
    void number(typename P::Mask& x) { x = (mask && *truth_at++) || (!mask && x); }
    void number(Lanes<Index, P::lanes>& x) { x = select(mask, *count_at++, x); }
    template <class X>
    void number(X const&) {}
};

template <class X>
constexpr bool counts_all_lanes_at_once();
template <class... Members>
constexpr bool any_counts(std::tuple<Members&...> const*) {
    return (counts_all_lanes_at_once<std::remove_const_t<Members>>() || ...);
}
template <class X>
constexpr bool counts_all_lanes_at_once() {
    if constexpr (NamesItsState<X>) return any_counts(static_cast<decltype(X::state(std::declval<X&>()))*>(nullptr));
    else return std::integral<X> && !std::same_as<X, bool>;
}
}  // namespace detail

/// A variant over a Pack whose lanes have nothing in common but options. QrBlock counts the rows of all lanes at once:
/// a fleet of it would take the rows of one filter for another's.
template <class F>
concept KeepsLanesApart = requires { F::scalar::lanes; } && NamesItsState<F> && !detail::counts_all_lanes_at_once<F>();

/// M filters F, where F is a variant over a Pack, such as Ud<Pack<double, 8>, 4>: any number of them, with one problem.
/// Each keeps the bits of the scalar variant on its own rows, while its health is not nonfinite: after that other
/// numbers may be NaN than there. A fleet that was moved from has no filters.
///
/// Rows come as a structure of arrays: psi is M x d, its column i the regressor i of all filters; y has M numbers. A
/// sample with a number that is not finite is missing: its filter stays as it was, and no other filter notices. Time
/// does not pass for it; update it with psi = 0 and y = 0 where it should. Without a prior each filter counts its own
/// rows.
///
/// Memory: bytes_per_filter() for each, what an update reads and changes, without the last gain and the zeros of a
/// triangle (all of F where that is not fixed in size and stores a square); an F for each thread. A row moves that of
/// all through the processor once. Source: layout as in arrays of structures of arrays; folklore.
template <KeepsLanesApart F>
class Fleet {
public:
    using scalar = typename F::scalar;
    using pack = scalar;
    using number = typename pack::lane_type;
    static constexpr int lanes = pack::lanes;
    static constexpr std::string_view name = F::name;

    /// Throws std::invalid_argument unless filters >= 1, and as F for the problem.
    Fleet(Index filters, Problem<number> const& problem)
        : filters_(checked_count(filters)), fresh_(in_packs(problem)), size_(Index(fresh_.theta().size())),
          packs_(fresh_, (filters + lanes - 1) / lanes), first_(problem.prior ? Health::sound : Health::undetermined),
          health_(size_t(packs_.size()), first_) {}

    Index filters() const { return packs_.size() == 0 ? 0 : filters_; }  ///< M
    Index parameters() const { return size_; }                           ///< d
    Index bytes_per_filter() const { return packs_.bytes() / lanes; }

    /// One row for each filter. Returns how many samples were missing. threads: over how many the filters are divided;
    /// no bit depends on it. Throws std::invalid_argument unless psi is M x d and y has M numbers.
    Index update(Eigen::Ref<Matrix<number> const> const& psi, Eigen::Ref<Vector<number> const> const& y,
                 unsigned threads = 1) {
        expects(packs_.size() > 0 && psi.rows() == filters_ && psi.cols() == size_ && y.size() == filters_,
                "psi: filters x parameters; y: a number for each filter");
        Index const all = packs_.size(), shares = std::clamp<Index>(Index(threads), 1, all);
        std::vector<Index> missing(size_t(shares), 0);
        while (Index(workspace_.size()) < shares) workspace_.push_back(packs_.pattern());
        auto const work = [&](Index share) {
            missing[size_t(share)] =
                update_packs(workspace_[size_t(share)], psi, y, all * share / shares, all * (share + 1) / shares);
        };
        detail::among_threads(shares, work);
        Index out = 0;
        for (Index const m : missing) out += m;
        return out;
    }

    /// The d parameters of filter i; its health: undetermined until its rows determine theta, then the worst of its
    /// steps. Throws std::invalid_argument unless 0 <= i < M.
    Vector<number> theta(Index i) const {
        check(i);
        F workspace = packs_.pattern();
        return packs_.read(i / lanes, workspace).theta().unaryExpr([lane = int(i % lanes)](pack const& x) {
            return x[lane];
        });
    }
    Health health(Index i) const {
        check(i);
        return health_[size_t(i / lanes)][int(i % lanes)];
    }

    /// Filter i begins anew. Throws std::invalid_argument unless 0 <= i < M.
    void reset(Index i) {
        check(i);
        detail::NumbersOfLanes<pack> fresh;
        detail::walk(fresh, fresh_);
        pack chosen;
        chosen.set(int(i % lanes), number(1));
        detail::LanesPutBack<pack> back(fresh, chosen == pack(number(1)));
        F workspace = packs_.pattern();
        F& filter = packs_.read(i / lanes, workspace);
        detail::walk(back, filter);
        packs_.write(i / lanes, filter);
        health_[size_t(i / lanes)].value[size_t(i % lanes)] = first_;
    }

    static constexpr std::string_view layer = "fleet";
    static std::array<StateOption, 1> options(auto const& f) { return {{{"filters", double(f.filters_)}}}; }
    static auto state(auto& f) {
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(f)>>)
            f.workspace_.clear();  // of the filters before; what is read in has constants of its own
        return std::tie(f.fresh_, f.packs_, f.first_, f.health_);
    }

private:
    static Index checked_count(Index filters) {
        expects(1 <= filters && filters <= std::numeric_limits<Index>::max() / (2 * lanes),
                "a number of filters, at least one");
        return filters;
    }
    void check(Index i) const { expects(0 <= i && i < filters(), "the number of a filter"); }
    static Problem<pack> in_packs(Problem<number> const& problem) {
        return problem.template mapped<pack>([](number x) { return pack(x); });
    }
    static void add(Lanes<Health, lanes>& health, Lanes<Health, lanes> const& step,
                    typename pack::Mask const& present) {
        static Lanes<Health, lanes> const sound(Health::sound);
        if (health.value == sound.value && step.value == sound.value) return;
        for (int i = 0; i < lanes; ++i)
            if (Health& mine = health.value[size_t(i)]; present[i])
                mine = mine == Health::undetermined ? step[i] : worse(mine, step[i]);
    }
    /// The numbers of `count` filters in a row, NaN behind the last.
    static pack loaded(number const* from, Index count) {
        if (count >= lanes) return pack::loaded(from);
        pack out(std::numeric_limits<number>::quiet_NaN());
        for (int i = 0; i < count; ++i) out.set(i, from[i]);
        return out;
    }

    Index update_packs(F& workspace, Eigen::Ref<Matrix<number> const> const& psi,
                       Eigen::Ref<Vector<number> const> const& y, Index first, Index last) {
        detail::NumbersOfLanes<pack> before;  // of a filter of which some lanes stay as they were
        std::vector<pack> numbers_of_row(size_t(size_), pack{});
        Eigen::Map<Vector<pack>> row(numbers_of_row.data(), size_);
        Index missing = 0;
        for (Index g = first; g < last; ++g) {
            Index const at = g * lanes, here = std::min<Index>(lanes, filters_ - at);
            pack const output = loaded(y.data() + at, here);
            typename pack::Mask present = isfinite(output);
            for (Index i = 0; i < size_; ++i) {
                row[i] = loaded(psi.col(i).data() + at, here);
                present = present && isfinite(row[i]);
            }
            for (int lane = 0; lane < here; ++lane) missing += !present[lane];
            if (!any(present)) continue;
            packs_.prefetch_behind(g);
            F& filter = packs_.read(g, workspace);
            if (all(present)) {
                add(health_[size_t(g)], filter.update(row, output).health, present);
                packs_.write(g, filter);
                continue;
            }
            before.clear();
            detail::walk(before, filter);
            for (Index i = 0; i < size_; ++i) row[i] = select(present, row[i], pack());
            auto const step = filter.update(row, select(present, output, pack()));
            detail::LanesPutBack<pack> back(before, !present);
            detail::walk(back, filter);
            packs_.write(g, filter);
            add(health_[size_t(g)], step.health, present);
        }
        return missing;
    }

    Index filters_;
    F fresh_;
    Index size_;
    detail::FleetRecords<F> packs_;
    std::vector<F> workspace_ = {};  // a filter for each thread
    Health first_;                   // of a filter that took no row
    std::vector<Lanes<Health, lanes>> health_;
};

}  // namespace rlslab
