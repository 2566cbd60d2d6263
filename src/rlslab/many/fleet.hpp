// Many filters of one kind, one row each at a time: as many in lockstep as a Pack has lanes, in the order of memory.
// Longer than 400 lines with its docstrings; records and reports are files of their own.
#pragma once

#include <rlslab/adapt/guard_signal.hpp>
#include <rlslab/many/fleet_filters.hpp>
#include <rlslab/many/fleet_records.hpp>
#include <rlslab/many/fleet_steps.hpp>
#include <rlslab/many/threads.hpp>

#include <functional>

namespace rlslab {

/// M filters F, where F is a variant over a Pack, such as Ud<Pack<double, 8>, 4>. Each keeps the bits of the scalar
/// variant on its own rows, while its health is not nonfinite: after that other numbers may be NaN than there. A fleet
/// that was moved from has no filters.
///
/// Rows come as a structure of arrays: psi is M x d, its column i the regressor i of all filters; y has M numbers. A
/// sample with a number that is not finite is missing: its filter stays as it was, and no other filter notices. Time
/// does not pass for it; update it with psi = 0 and y = 0 where it should. Without a prior each filter counts its own
/// rows.
///
/// Filters come and go, and none is renumbered: what remove(i) leaves takes no rows, its samples are not looked at, and
/// add() gives its number away again. Each filter may have a problem of its own, of the same size.
///
/// Memory: bytes_per_filter() for each, what an update reads and changes, without the last gain and the zeros of a
/// triangle (all of F where something is around the variant, or it is not fixed in size and stores a square), with
/// lambda only once lambdas differ; 21 bytes of health and counts; an F for each thread. A row moves that of all
/// through the processor once. An update allocates only when it first meets that many threads; of filters with a guard
/// or a rule also as Guarded and Forgetting say. Source: layout as in arrays of structures of arrays; folklore.
template <KeepsLanesApart F>
class Fleet {
public:
    using scalar = typename F::scalar;
    using pack = scalar;
    using number = typename pack::lane_type;
    static constexpr int lanes = pack::lanes;
    static constexpr std::string_view name = F::name;

    /// make(problem) makes F of a problem of packs and, for filter(i), the filter of numbers of a problem of numbers:
    /// with a guard's options, or a rule's. Throws std::invalid_argument unless filters >= 1, and as make for the
    /// problem.
    template <class Make = detail::MakesFilters<F>>
    Fleet(Index filters, Problem<number> const& problem, Make const& make = {})
        : filters_(checked_count(filters)), make_(make), fresh_(make_(in_packs(problem))),
          size_(Index(fresh_.theta().size())), packs_(fresh_, (filters + lanes - 1) / lanes),
          first_(first_health(problem)), health_(groups(), first_), alive_(groups(), false), begun_(groups(), 0),
          missing_(groups(), 0) {
        if constexpr (detail::HasOneLane<F>) make_one_ = make;
        for (Index i = 0; i < filters; ++i) at(alive_, i) = true;
    }
    /// Filter i of problems[i], all of one size. The fleet's problem, for add() and reset(), is problems[0]. Throws
    /// std::invalid_argument where there is none, and as F for each.
    template <class Make = detail::MakesFilters<F>>
    explicit Fleet(std::span<Problem<number> const> problems, Make const& make = {})
        : Fleet(Index(problems.size()), problems.empty() ? Problem<number>{} : problems[0], make) {
        for (size_t i = 1; i < problems.size(); ++i) reset(Index(i), problems[i]);
    }

    Index filters() const { return packs_.size() == 0 ? 0 : filters_; }  ///< M, with those that were removed
    Index parameters() const { return size_; }                           ///< d
    Index bytes_per_filter() const { return packs_.bytes() / lanes; }
    /// Whether filter i is there: false for what was removed, and beyond the last.
    bool alive(Index i) const { return 0 <= i && i < filters() && at(alive_, i); }

    /// One row for each filter. Returns how many samples were missing. threads: over how many the filters are divided;
    /// no bit depends on it. Throws std::invalid_argument unless psi is M x d and y has M numbers.
    Index update(Eigen::Ref<Matrix<number> const> const& psi, Eigen::Ref<Vector<number> const> const& y,
                 unsigned threads = 1) {
        return update_all<false, false>(psi, y, nullptr, nullptr, threads);
    }
    /// The same with a report of each filter. Throws std::invalid_argument also unless steps has M filters.
    Index update(Eigen::Ref<Matrix<number> const> const& psi, Eigen::Ref<Vector<number> const> const& y,
                 FleetSteps<number>& steps, unsigned threads = 1) {
        expects(steps.filters() == filters_, "steps of as many filters as the fleet has");
        return update_all<true, false>(psi, y, nullptr, &steps, threads);
    }
    /// The same of Weighted filters, with a weight w for each sample; one that is negative or not finite makes it
    /// missing. Of w = 0 psi and y may be anything: time passes. Throws std::invalid_argument also unless w has M
    /// numbers.
    Index update_weighted(Eigen::Ref<Matrix<number> const> const& psi, Eigen::Ref<Vector<number> const> const& y,
                          Eigen::Ref<Vector<number> const> const& w, FleetSteps<number>& steps, unsigned threads = 1)
        requires detail::TakesWeights<F>
    {
        expects(steps.filters() == filters_ && w.size() == filters_, "w and steps of as many as the fleet has filters");
        return update_all<true, true>(psi, y, w.data(), &steps, threads);
    }

    /// The d parameters of filter i; its health: undetermined until its rows determine theta, then the worst of its
    /// steps, of guarded filters the last step whose row was usable, since a guard mends what breaks; its samples.
    /// These throw std::invalid_argument unless alive(i).
    Vector<number> theta(Index i) const {
        check(i);
        auto own = packs_.workspace();
        return packs_.read(i / lanes, own).theta().unaryExpr([lane = int(i % lanes)](pack const& x) {
            return x[lane];
        });
    }
    Health health(Index i) const {
        check(i);
        return at(health_, i);
    }
    FleetCounts counts(Index i) const {
        check(i);
        Index const missing = at(missing_, i);
        return {rows_ - at(begun_, i) - missing, missing};
    }
    /// Of guarded filters: what the last sample of filter i showed, and what its guard counted. Throw
    /// std::invalid_argument unless alive(i).
    GuardSignal signal(Index i) const
        requires detail::IsGuarded<F>
    {
        check(i);
        auto own = packs_.workspace();
        return packs_.read(i / lanes, own).signal()[int(i % lanes)];
    }
    GuardCounts guard_counts(Index i) const
        requires detail::IsGuarded<F>
    {
        check(i);
        auto own = packs_.workspace();
        return packs_.read(i / lanes, own).counts().of_lane(int(i % lanes));
    }
    /// signal(i) of all; none where filter i was removed.
    std::vector<GuardSignal> signals() const
        requires detail::IsGuarded<F>
    {
        std::vector<GuardSignal> out(size_t(filters()), GuardSignal::none);
        auto own = packs_.workspace();
        for (Index i = 0; i < filters(); ++i)
            if (at(alive_, i)) out[size_t(i)] = packs_.read(i / lanes, own).signal()[int(i % lanes)];
        return out;
    }
    /// M x d: row i is theta(i), NaN where filter i was removed.
    Matrix<number> thetas() const {
        Matrix<number> out(filters(), size_);
        auto own = packs_.workspace();
        for (Index g = 0; g < packs_.size(); ++g) {
            auto const& theta = packs_.read(g, own).theta();
            for (Index j = 0; j < size_; ++j)
                for (Index i = g * lanes; i < std::min((g + 1) * lanes, filters_); ++i)
                    out(i, j) = at(alive_, i) ? theta[j][int(i % lanes)] : undefined<number>();
        }
        return out;
    }
    /// Of all filters, with those that were removed.
    FleetCounts counts() const { return counts_; }

    /// A filter more: its number, the lowest that was removed, or M, which grows by one. In the mean O(1), as
    /// std::vector's growth. Throws std::invalid_argument as F for the problem, or where that has another size.
    Index add() { return add(fresh_, first_); }
    Index add(Problem<number> const& problem) { return add(made(problem), first_health(problem)); }
    /// Frees the number of filter i. Throws std::invalid_argument unless alive(i).
    void remove(Index i) {
        reset(i);
        at(alive_, i) = false;
        free_from_ = std::min(free_from_, i);
    }
    /// Filter i begins anew with the fleet's problem, or another. Throws std::invalid_argument unless alive(i), and as
    /// add.
    void reset(Index i) {
        check(i);
        begin(i, fresh_, first_);
    }
    void reset(Index i, Problem<number> const& problem) {
        check(i);
        begin(i, made(problem), first_health(problem));
    }

    /// Filter i as a filter of its own, such as Ud<double, 4>, with its bits on all rows to come; only the gain of the
    /// last row is lost. So save(fleet.filter(i), path) saves one filter. Throws std::invalid_argument unless alive(i).
    auto filter(Index i) const
        requires detail::HasOneLane<F>
    {
        check(i);
        auto own = packs_.workspace();
        detail::LaneRead numbers(int(i % lanes));
        detail::walk(numbers, packs_.read(i / lanes, own));
        One out = make_one_(Problem<number>{.size = size_});
        detail::LaneWritten written(0, true, numbers.values);
        detail::walk(written, out);
        return out;
    }
    /// And back: filter i goes on as this one, whatever its forgetting and prior. Its health is sound, or undetermined
    /// where theta is not finite. Throws std::invalid_argument unless alive(i), for another size, and for a filter in a
    /// state that update() does not leave (a walk of kalman's; rows that information took without a report).
    void put(Index i, typename detail::Beside<F>::type const& one)
        requires detail::HasOneLane<F>
    {
        check(i);
        expects(Index(one.theta().size()) == size_, "a filter of the fleet's size");
        detail::LaneRead numbers(0);
        detail::walk(numbers, one);
        auto own = packs_.workspace();
        F& group = packs_.read(i / lanes, own);
        detail::LaneWritten looking(int(i % lanes), false, numbers.values), keeping = looking;
        keeping.keep = true;
        detail::walk(looking, group);
        expects(looking.same && options_of(one) == options_of(group),
                "a filter as update() leaves it, and of the fleet's options");
        detail::walk(keeping, group);
        if constexpr (detail::IsGuarded<F>) group.forget_signal(lane_mask(i));
        packs_.write_with_constants(i / lanes, group);
        start_counts(i, Vector<number>(one.theta()).allFinite() ? Health::sound : Health::undetermined);
    }

    static constexpr std::string_view layer = "fleet";
    static constexpr int edition = 2;
    static std::array<StateOption, 1> options(auto const& f) { return {{{"filters", double(f.filters_)}}}; }
    static auto state(auto& f) {
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(f)>>) {
            f.workspaces_.clear();  // of the filters before; what is read in has constants of its own
            f.free_from_ = 0;
        }
        return std::tie(f.fresh_, f.packs_, f.first_, f.health_, f.alive_, f.begun_, f.missing_, f.rows_, f.counts_);
    }

private:
    using Mask = typename pack::Mask;
    using One = typename detail::Beside<F>::type;
    template <class X>
    using PerFilter = std::vector<Lanes<X, lanes>>;
    /// Of a thread.
    struct Workspace {
        F filter;
        std::vector<pack> row;
        FleetCounts counts = {};
    };

    static Index checked_count(Index filters) {
        expects(1 <= filters && filters <= std::numeric_limits<Index>::max() / (2 * lanes),
                "a number of filters, at least one");
        return filters;
    }
    size_t groups() const { return size_t(packs_.size()); }
    template <class X>
    static X& at(PerFilter<X>& of, Index i) {
        return of[size_t(i / lanes)].value[size_t(i % lanes)];
    }
    template <class X>
    static X const& at(PerFilter<X> const& of, Index i) {
        return of[size_t(i / lanes)].value[size_t(i % lanes)];
    }
    void check(Index i) const { expects(alive(i), "the number of a filter that is there"); }
    static Health first_health(Problem<number> const& problem) {
        return problem.prior ? Health::sound : Health::undetermined;
    }
    static Problem<pack> in_packs(Problem<number> const& problem) {
        return problem.template mapped<pack>([](number x) { return pack(x); });
    }
    F made(Problem<number> const& problem) const {
        F out = make_(in_packs(problem));
        expects(Index(out.theta().size()) == size_, "a problem of the fleet's size");
        return out;
    }
    Index add(F const& fresh, Health first) {
        expects(packs_.size() > 0, "a fleet that was not moved from");
        while (free_from_ < filters_ && at(alive_, free_from_)) ++free_from_;
        Index const i = free_from_;
        if (i == filters_) {
            if (i % lanes == 0) {
                packs_.append(fresh_);
                health_.emplace_back(first_);
                alive_.emplace_back(false);
                begun_.emplace_back(0);
                missing_.emplace_back(0);
            }
            ++filters_;
        }
        at(alive_, i) = true;
        begin(i, fresh, first);
        return i;
    }
    /// Lane i of the fleet as that of `fresh`, whose lanes are alike.
    void begin(Index i, F const& fresh, Health first) {
        detail::NumbersOfLanes<pack> numbers;
        detail::walk(numbers, fresh);
        detail::LanesPutBack<pack> back(numbers, lane_mask(i));
        auto own = packs_.workspace();
        F& group = packs_.read(i / lanes, own);
        detail::walk(back, group);
        if constexpr (detail::IsGuarded<F>) group.forget_signal(back.mask);
        packs_.write_with_constants(i / lanes, group);
        start_counts(i, first);
    }
    static Mask lane_mask(Index i) {
        Lanes<bool, lanes> out(false);
        out.value[size_t(i % lanes)] = true;
        return Mask(out);
    }
    /// The options that a saved state would compare.
    static std::vector<double> options_of(auto const& f) {
        std::vector<double> out;
        auto const keep = [&out](StateEntry const& entry) {
            if (entry.kind == 'o') out.push_back(entry.value);
        };
        detail::describe(keep, f);
        return out;
    }
    void start_counts(Index i, Health first) {
        at(health_, i) = first;
        at(begun_, i) = rows_;
        at(missing_, i) = 0;
    }
    static void worsen(Lanes<Health, lanes>& health, Lanes<Health, lanes> const& step, Mask const& present,
                       [[maybe_unused]] F const& filter) {
        static Lanes<Health, lanes> const sound(Health::sound);
        if (health.value == sound.value && step.value == sound.value) return;
        for (int i = 0; i < lanes; ++i) {
            Health& mine = health.value[size_t(i)];
            if (!present[i]) continue;
            if constexpr (detail::IsGuarded<F>) {
                if (filter.signal()[i] != GuardSignal::unusable) mine = step[i];
            } else {
                mine = mine == Health::undetermined ? step[i] : worse(mine, step[i]);
            }
        }
    }
    /// The numbers of `count` filters in a row, NaN behind the last.
    static pack loaded(number const* from, Index count) {
        if (count >= lanes) return pack::loaded(from);
        pack out(std::numeric_limits<number>::quiet_NaN());
        for (int i = 0; i < count; ++i) out.set(i, from[i]);
        return out;
    }

    template <bool reports, bool weighs>
    Index update_all(Eigen::Ref<Matrix<number> const> const& psi, Eigen::Ref<Vector<number> const> const& y,
                     number const* w, FleetSteps<number>* steps, unsigned threads) {
        expects(packs_.size() > 0 && psi.rows() == filters_ && psi.cols() == size_ && y.size() == filters_,
                "psi: filters x parameters; y: a number for each filter");
        Index const all = packs_.size(), shares = std::clamp<Index>(Index(threads), 1, all);
        while (Index(workspaces_.size()) < shares)
            workspaces_.push_back({packs_.workspace(), std::vector<pack>(size_t(size_))});
        auto const work = [&](Index share) {
            update_groups<reports, weighs>(workspaces_[size_t(share)], psi, y, w, steps, all * share / shares,
                                           all * (share + 1) / shares);
        };
        detail::among_threads(shares, work);
        ++rows_;
        Index missing = 0;
        for (Index share = 0; share < shares; ++share) {
            missing += workspaces_[size_t(share)].counts.missing;
            counts_.taken += workspaces_[size_t(share)].counts.taken;
        }
        counts_.missing += missing;
        return missing;
    }
    template <bool reports, bool weighs>
    void update_groups(Workspace& own, Eigen::Ref<Matrix<number> const> const& psi,
                       Eigen::Ref<Vector<number> const> const& y, [[maybe_unused]] number const* w,
                       FleetSteps<number>* steps, Index first, Index last) {
        Eigen::Map<Vector<pack>> row(own.row.data(), size_);
        own.counts = {};
        for (Index g = first; g < last; ++g) {
            Index const from = g * lanes, here = std::min<Index>(lanes, filters_ - from);
            pack weight(number(1));
            if constexpr (weighs) weight = loaded(w + from, here);
            Mask present = isfinite(weight) && pack() <= weight;
            auto const sample = [&](number const* of_all) {
                pack x = loaded(of_all + from, here);
                if constexpr (weighs) x = select(weight == pack(), pack(), x);
                present = present && isfinite(x);
                return x;
            };
            pack output = sample(y.data());
            for (Index i = 0; i < size_; ++i) row[i] = sample(psi.col(i).data());
            bool const whole = all(present) && all_alive(g);
            if (!whole) {
                present = present && Mask(alive_[size_t(g)]);
                count_missing(own.counts, g, present);
                if (!any(present)) {
                    if constexpr (reports) report(*steps, from, here, {}, present);
                    continue;
                }
                for (Index i = 0; i < size_; ++i) row[i] = select(present, row[i], pack());
                output = select(present, output, pack());
                if constexpr (weighs) weight = select(present, weight, pack(number(1)));
            } else {
                own.counts.taken += lanes;
            }
            packs_.prefetch_behind(g);
            F& filter = packs_.read(g, own.filter);
            auto const take = [&] {
                if constexpr (weighs) return filter.update(row, output, weight);
                else if constexpr (detail::IsGuarded<F>) return filter.update_lanes(present, row, output);
                else return filter.update(row, output);
            };
            // A guarded filter leaves the other lanes itself; of a record they are not written.
            constexpr bool puts_back = detail::FleetRecords<F>::in_place && !detail::IsGuarded<F>;
            Step<pack> const step = puts_back ? detail::on_lanes<pack>(filter, present, take) : take();
            if (whole) packs_.write(g, filter);
            else packs_.write_some(g, filter, present);
            worsen(health_[size_t(g)], step.health, present, filter);
            if constexpr (reports) report(*steps, from, here, step, present);
        }
    }
    bool all_alive(Index g) const {
        static Lanes<bool, lanes> const every(true);
        return alive_[size_t(g)].value == every.value;
    }
    void count_missing(FleetCounts& counts, Index g, Mask const& present) {
        for (int lane = 0; lane < lanes; ++lane) {
            bool const missing = alive_[size_t(g)][lane] && !present[lane];
            counts.taken += present[lane];
            counts.missing += missing;
            missing_[size_t(g)].value[size_t(lane)] += missing;
        }
    }
    static void report(FleetSteps<number>& steps, Index from, Index count, Step<pack> const& step,
                       Mask const& present) {
        pack const none = undefined<pack>();
        auto const put = [&](Vector<number>& to, pack const& x) {
            pack const seen = select(present, x, none);
            if (count == lanes) std::memcpy(to.data() + from, seen.v, sizeof seen.v);
            else
                for (int i = 0; i < count; ++i) to[from + i] = seen[i];
        };
        put(steps.innovation, step.innovation);
        put(steps.residual, step.residual);
        put(steps.gamma, step.gamma);
        for (int i = 0; i < count; ++i) {
            steps.health[size_t(from + i)] = present[i] ? step.health[i] : Health::nonfinite;
            steps.taken[size_t(from + i)] = present[i];
        }
    }

    Index filters_;
    std::function<F(Problem<pack> const&)> make_;
    std::function<One(Problem<typename One::scalar> const&)> make_one_ = {};
    F fresh_;  // of the fleet's problem
    Index size_;
    detail::FleetRecords<F> packs_;
    std::vector<Workspace> workspaces_ = {};  // one for each thread
    Health first_;                            // of a filter of the fleet's problem that took no row
    PerFilter<Health> health_;
    PerFilter<bool> alive_;
    PerFilter<Index> begun_, missing_;  // rows of the fleet before it; of its own
    Index rows_ = 0, free_from_ = 0;    // no number below free_from_ is free
    FleetCounts counts_;
};

}  // namespace rlslab
