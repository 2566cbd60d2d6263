// A filter that is watched while it runs: data that would spoil it are kept out, trouble is reported, and met as
// configured. Longer than 400 lines with its docstrings: one text for numbers and for packs.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/guard_policy.hpp>
#include <rlslab/adapt/guard_signal.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/state/lanes.hpp>

#include <algorithm>

namespace rlslab {

/// What a guard needs of a filter: e and s before the update, P_jj, a restart, and a row that holds P down.
template <class F>
concept Guardable = RecursiveLeastSquares<F> && Real<typename F::scalar> && KeepsItsRows<F> &&
                    requires(F& f, typename F::scalar x, Regressor<typename F::scalar> a) {
                        detail::look_at(f, a, x);
                        variance(f, Index(0));
                        watched_variance(f, Index(0));
                        restart(f, x, a, x);
                        cap_row(f, a, x, x);
                    };

/// F, with every row looked at before it is committed, and P after it, in O(d) besides the update (d^2/2 more where F
/// holds a factor of P^-1, up to d^2 where it follows a rule):
///
///   (1) y^2 <= 2^(E/2), and 0 < s <= 2^(E/2) and e is finite, or |psi|^2 <= 2^(E/2); else unusable: no bit of F
///       changes. E is the arithmetic's largest exponent
///   (2) e and s of the update; an outlier where e^2 lambda / s > c^2 s2; 5 outliers among 6 rows are a change. What
///       rounding makes of e is allowed for besides. s <= 0 or NaN is left to the step's health
///   (3) the rest of the update; s2 = s2 + (min(gamma e^2, 9 s2) / 0.995 - s2) / memory, from the median of 10 d + 20
///       numbers gamma e^2 on, over 0.455; where it is 0, from that of the others times their share. Until then, and
///       again after a reset or a change whose rows are taken, (2) is not made
///   (4) j = k mod d, p = P_jj, or 1/R_jj^2 where F holds a factor of P^-1 (watched_variance): breakdown where p <= 0
///       or is not finite, windup where p > largest_variance; capped by the row sqrt(r) e_j, r = 1/largest_variance -
///       1/p, of output sqrt(r) theta_j. Between two visits p grows by lambda^-d at most
///   (5) P in full storage: breakdown where |P_ij - P_ji| > asymmetry sqrt(P_ii P_jj), one pair a row, all of them in
///       d^2/2 rows
///   (6) a reset: P = v I, v the largest variance at the start or, where less, 2^(3p/4) / |psi|^2 at a change and
///       2^(p/6) / |psi|^2 at a breakdown; psi is the row that showed it, or the largest kept row where the policy
///       rebuilds
///   (7) without a prior no number has theta's units: largest_variance is 2^(E-2), the end of the arithmetic; after a
///       breakdown F is as newly made, and after a change P^-1 is that of the rows sqrt(w_j) e_j alone, of output
///       sqrt(w_j) theta_j, w_j = 2^(-3p/4) max(psi_j^2, 2^(-p/4) / P_jj)
///
///   (8) around probes (Certified), at each `digits.every`-th row that F takes: breakdown where bound > 10^-digits.
///       Then P is (6)'s and the kept rows', and the next bound is of these. What older rows told is forgotten
///
/// (6): the P that broke the filter would break it again. A form that stores P or P^-1 makes an error of u v |psi|^2 in
/// the first row, relative to the P that this row leaves, and where lambda = 1 it stays, while P falls as 1/n: it needs
/// 2^(p/4) and 2^(5p/6) rows of like sizes to grow up to P. theta, which a breakdown leaves as it was last seen, then
/// weighs as 2^(-p/6) of a row.
/// No row is changed, and a run without a signal leaves F's own bits. Units of a column by powers of two scale (7)
/// exactly. No exception, no allocation after it is made (where F's theta() makes none); memory: 12 d + 20 numbers, and
/// the kept rows where the policy rebuilds. 0.995 = E min(x^2, 9) and 0.455 the median of x^2, x normal. Around a rule
/// of forgetting s is that of before the rule.
/// (2) takes P0 at its word: theta0's error beyond c sqrt(P0 s2) makes outliers of the rows that first show it.
/// Of packs: each lane as the scalar guard around its own filter, with signals, counts and a largest_variance of its
/// own (the other options are one for all lanes); no rebuilding. Where not all lanes do the same, a thread allocates
/// at its first such row, and a median is taken in memory that is allocated for it.
/// Thresholds of (2): docs/theory.md 61; of (4) and (5): 88. (3): the form of Gänsler, Gay, Sondhi & Benesty 2000
/// (cited, not read), in squares. Edition 1 had a bound of s, P_jj of every form, and a column of P in (5).
template <Guardable F, GuardPolicy policy = resetting>
    requires(policy.valid() && (std::same_as<Truth<typename F::scalar>, bool> || !policy.rebuilds()))
class Guarded : public detail::AroundFilter<F, true> {
    using T = typename F::scalar;
    using Mask = Truth<T>;  // the lanes in which something is so
    using Count = PerLane<T, Index>;
    using Signal = PerLane<T, GuardSignal>;
    static constexpr bool known_prior = requires(F& f) { f.form().theta; } && !requires(F& f) { f.form().b; };
    static constexpr bool in_packs = !std::same_as<Mask, bool>;
    static constexpr bool certified = !in_packs && requires(F& f) { f.certificate(); };
    using Options = GuardOptions<T, certified>;
    using detail::AroundFilter<F, true>::filter_;
    Options options_;
    T lambda_, limit_, start_ = T(0);                 // limit_ of s, y^2 and |psi|^2; start_ 0: without a prior
    StateVector<T, detail::size_of<F>> psi_, theta_;  // workspace; theta as last seen finite
    GuardCountsOf<Count> counts_;
    Signal signal_ = GuardSignal::none;
    T s2_ = T(0);
    StateVector<T, detail::size_of<F> == Dynamic ? Dynamic : 10 * detail::size_of<F> + 20>
        squares_;  // from which s2 is learnt; in a reset, which forgets them, sqrt(w) of (7) and a row
    RowRing<T> ring_;
    BoundedCountOf<Count> learnt_, coordinate_;  // rows that s2 was learnt from; j
    BoundedCountOf<Count> apart_;                // i = j + 1 + apart mod d in (5)
    BoundedCountOf<Count> history_{0, 63};       // outliers among the last rows, a bit each, the newest lowest
    Mask determined_ = false;                    // a step was sound

public:
    static constexpr bool departs = true;  ///< from the problem's J
    static constexpr int edition = 2;

    explicit Guarded(Problem<T> const& problem, Options const& options = {}) : Guarded(F(problem), problem, options) {}
    /// Around a filter that was made of this problem, with options of its own, and has taken no row.
    Guarded(F const& filter, Problem<T> const& problem, Options const& options = {})
        : detail::AroundFilter<F, true>(filter), options_(options),
          lambda_(checked(problem, int(filter.theta().size())).forgetting),
          limit_(T(std::ldexp(1.0, std::min(max_exponent<T>() / 2, 1000)))), psi_(filter_.theta().size()),
          theta_(psi_.size()), squares_(10 * psi_.size() + 20),
          ring_(psi_.size(),
                policy.rebuilds() ? (options.rebuild_rows > 0 ? options.rebuild_rows : 10 * psi_.size()) : 0),
          learnt_{0, squares_.size()}, coordinate_{0, psi_.size() - 1},
          apart_{0, std::max(psi_.size() / 2, Index(1)) - 1} {
        expects(all(T(0) <= options.largest_variance && T(0) <= options.innovation && T(0) <= options.least_noise),
                "options >= 0");
        expects(all(T(0) < options.asymmetry) && options.noise_memory >= 1 && options.rebuild_rows >= 0,
                "options that make sense");
        if constexpr (certified) options.digits.template check<T, decltype(filter_.certificate().bound)>(psi_.size());
        if constexpr (in_packs)
            for (T const& x : {options.innovation, options.least_noise, options.asymmetry})
                expects(all(x == T(x[0])), "innovation, least_noise and asymmetry that are alike in all lanes");
        for (Index j = 0; problem.prior && j < psi_.size(); ++j) {
            T const v = variance(filter_, j);
            start_ = select(start_ < v, v, start_);
        }
        Mask const none = !(T(0) < start_) || !is_finite(start_), chosen = options_.largest_variance == T(0);
        if (problem.prior && any(none)) start_ = select(none, Prior<T>{}.variance, start_);
        T const most = problem.prior ? T(T(16) * start_) : T(limit_ / T(4) * limit_);
        if (any(chosen)) options_.largest_variance = select(chosen, most, options_.largest_variance);
        if (problem.prior && problem.prior->theta) keep_regressor(Regressor<T>(*problem.prior->theta), theta_);
    }

    Step<T> update(Regressor<T> psi, T y) { return update_lanes(true, psi, y); }
    /// A row for the filters of these lanes. For the others there was none: their steps tell nothing.
    Step<T> update_lanes(Truth<T> const& lanes, Regressor<T> psi, T const& y) {
        expects(psi.size() == psi_.size(), "a regressor of the problem's size");
        count(counts_.rows, lanes);
        Innovation<T> const row = detail::look_at(filter_, psi, y);
        Mask goes = lanes && T(0) < row.s && row.s <= limit_ && y * y <= limit_ && is_finite(row.e);
        if (!all(goes)) goes = goes || (lanes && usable(psi, y));  // (1)
        Step<T> step{undefined<T>(), undefined<T>(), undefined<T>(), Health::nonfinite};
        if (Mask const unusable = lanes && !goes; any(unusable)) {
            count(counts_.unusable, unusable);
            tell(unusable, GuardSignal::unusable);
        }
        if (!any(goes)) return step;
        tell(goes, GuardSignal::none);
        Mask restarts = false;
        if (Mask const tested = goes && armed(); any(tested)) {
            Mask const out = outliers(tested, psi, y, row);  // (2)
            if (any(out)) {
                restarts = changed(out);
                goes = goes && !restarts;
                if constexpr (policy.outlier == Action::skip) {
                    Mask const skipped = out && !restarts;
                    step = select(skipped, Step<T>{row.e, row.e, T(1), Health::sound}, step);
                    goes = goes && !skipped;
                    if (!any(goes || restarts)) return step;
                }
            }
        }
        if (policy.rebuilds() || any(restarts)) keep_regressor(psi, psi_);  // which may be the gain's own numbers
        if (all(goes)) {                                                    // without a copy of the step
            step = detail::commit(filter_, row, psi, y);
        } else if (any(goes)) {
            Step<T> const taken =
                detail::on_lanes<T>(filter_, goes, [&] { return detail::commit(filter_, row, psi, y); });
            step = select(goes, taken, step);
        }
        if (any(restarts)) step = select(restarts, restarted_at(restarts, y), step);
        step = watch(restarts || goes, step, psi, y);
        if (any(restarts)) tell(restarts, GuardSignal::change);
        return step;
    }
    /// Time without a row: F's row with psi = 0. P_jj is looked at; nothing is tested, and nothing learnt of the noise.
    Step<T> pass_time() {
        signal_ = GuardSignal::none;
        detail::fill(psi_, T(0));
        return watch(true, filter_.update(kept_row(), T(0)), {psi_.data(), Index(0)}, T(0), false);
    }
    static constexpr std::string_view layer = "guard";
    static std::array<StateOption, 9> options(auto const& g) {
        return {{{"on_outlier", double(policy.outlier)},
                 {"on_change", double(policy.change)},
                 {"on_windup", double(policy.windup)},
                 {"on_breakdown", double(policy.breakdown)},
                 {"innovation", static_cast<double>(detail::of_lane(g.options_.innovation, 0))},
                 {"least_noise", static_cast<double>(detail::of_lane(g.options_.least_noise, 0))},
                 {"noise_memory", double(g.options_.noise_memory)},
                 {"asymmetry", static_cast<double>(detail::of_lane(g.options_.asymmetry, 0))},
                 {"rows", double(detail::of_lane(g.counts_.rows, 0)), true}}};
    }
    static auto state(auto& g) {
        return std::tie(g.filter_, g.theta_, g.ring_, g.counts_, g.lambda_, g.start_, g.options_.largest_variance,
                        g.s2_, g.squares_, g.learnt_, g.coordinate_, g.apart_, g.history_, g.determined_);
    }

    /// Of the filter inside.
    friend T variance(Guarded& g, Index j) { return variance(g.filter_, j); }
    friend T watched_variance(Guarded& g, Index j) { return watched_variance(g.filter_, j); }
    friend T variance_along(Guarded& g, Regressor<T> psi) { return variance_along(g.filter_, psi); }

    PerLane<T, GuardSignal> const& signal() const { return signal_; }  ///< what the last row showed; g.signal()[lane]
    /// Whether the last row tells nothing of the noise; and whether the filter started anew at it.
    bool set_aside() const
        requires(!in_packs)
    {
        return signal_ != GuardSignal::none && signal_ != GuardSignal::windup;
    }
    bool restarted() const
        requires(!in_packs)
    {
        return (signal_ == GuardSignal::change && policy.change == Action::reset) ||
               (signal_ == GuardSignal::breakdown && policy.breakdown != Action::report);
    }
    GuardCountsOf<PerLane<T, Index>> const& counts() const { return counts_; }  ///< g.counts().rows[lane]
    T noise_variance() const { return s2_; }                                    ///< s2; 0 until it is known
    /// As if the filters of these lanes had been shown no row.
    void forget_signal(Truth<T> const& lanes) { tell(lanes, GuardSignal::none); }

private:
    static void count(Count& of, Mask const& lanes) {
        detail::each_lane<T>(lanes, [&](int i) { ++detail::of_lane(of, i); });
    }
    void tell(Mask const& lanes, GuardSignal signal) { signal_ = select(lanes, Signal(signal), signal_); }
    /// work(n, lanes) for each value n that the count has in these lanes, and where.
    template <class Work>
    static void each_value(BoundedCountOf<Count> const& of, Mask const& lanes, Work work) {
        if constexpr (!in_packs) {
            if (lanes) work(of.n, lanes);
        } else if (all(detail::equal_to<T>(of.n, of.n[0]))) {
            if (any(lanes)) work(of.n[0], lanes);
        } else {
            for (Index n = 0; n <= of.most; ++n)
                if (Mask const here = lanes && detail::equal_to<T>(of.n, n); any(here)) work(n, here);
        }
    }
    /// Else e or s out of range is the state's fault.
    Mask usable(Regressor<T> psi, T const& y) const {
        return dot(psi.data(), psi.data(), psi.size()) <= limit_ && y * y <= limit_;
    }
    Mask learnt() const { return detail::equal_to<T>(learnt_.n, squares_.size()); }
    Mask armed() const { return T(0) < options_.innovation && learnt(); }
    Regressor<T> kept_row() const { return {psi_.data(), psi_.size()}; }
    Mask outliers(Mask const& lanes, Regressor<T> psi, T const& y, Innovation<T> const& row) {
        Mask const tested = lanes && T(0) < row.s && is_finite(row.s) && row.e == row.e;
        if (!any(tested)) return tested;
        T const least = options_.least_noise * options_.least_noise, s2 = select(s2_ < least, least, s2_),
                most = options_.innovation * options_.innovation, left = row.e * row.e * lambda_;
        Mask out = tested && !(left <= most * (s2 * row.s));  // an overflow on the left, too
        if (any(out)) {
            T const rounding = T(8 * epsilon<T>()), size = dot(psi.data(), psi.data(), psi.size()),
                    made = rounding * rounding * (y * y + size * dot(theta_, theta_));
            out = out && !(left <= most * (s2 * row.s + made));
        }
        if (any(out) || !all(detail::equal_to<T>(history_.n, 0)))
            detail::each_lane<T>(tested, [&](int i) {
                Index& bits = detail::of_lane(history_.n, i);
                bits = (bits << 1 | Index(detail::of_lane(out, i))) & 63;
            });
        count(counts_.outliers, out);
        tell(out, GuardSignal::outlier);
        return out;
    }
    /// 5 of the last 6: a change, at once where the filter keeps to what it knew before. Where it restarts.
    Mask changed(Mask const& lanes) {
        PerLane<T, bool> five = false;
        detail::each_lane<T>(lanes, [&](int i) {
            Index out = 0;
            for (Index bits = detail::of_lane(history_.n, i); bits != 0; bits >>= 1) out += bits & 1;
            detail::of_lane(five, i) = out >= 5;
        });
        Mask const changes(five);
        count(counts_.changes, changes);
        tell(changes, GuardSignal::change);
        constexpr bool resets = policy.change == Action::reset;
        if (resets || policy.outlier != Action::skip) forget(changes);  // s2 may be that of rows without noise
        else history_.n = select(changes, Count(0), history_.n);
        return changes && Mask(resets);
    }
    /// (6), of 2^bits; 0 without a prior.
    T variance_for(Regressor<T> psi, int bits) {
        T largest = dot(psi.data(), psi.data(), psi.size());
        if constexpr (policy.rebuilds())
            for (Index k = 0; k < ring_.held(); ++k) {
                T const size = dot(ring_.row(k), ring_.row(k), psi_.size());
                largest = select(largest < size, size, largest);
            }
        T const most = T(std::ldexp(1.0, bits)) / largest;
        return select(most < start_ && T(0) < most, most, start_);
    }
    /// From theta as it is, and the row that was kept.
    Step<T> restarted_at(Mask const& lanes, T const& y) {
        int const p = significand_bits<T>();
        T const v = variance_for(kept_row(), 3 * p / 4), part = square_root(T(std::ldexp(1.0, -(3 * p / 4))));
        Mask const bare = lanes && start_ == T(0);
        for (Index j = 0; !known_prior && any(bare) && j < psi_.size(); ++j) {  // (7)
            T const told = T(std::ldexp(1.0, -(p / 4))) / variance(filter_, j), size = psi_[j] * psi_[j];
            T const most = select(size < told && is_finite(told), told, size);
            squares_[j] = select(bare, T(part * square_root(most)), squares_[j]);
        }
        auto const theta = filter_.theta();
        detail::on_lanes<T>(filter_, lanes, [&] { restart(filter_, v, Regressor<T>(theta), lambda_); });
        for (Index j = 0; !known_prior && any(bare) && j < psi_.size(); ++j) {
            determined_ = determined_ && (!bare || T(0) < squares_[j]);
            hold(squares_.data() + psi_.size(), j, squares_[j], theta[j], bare);
        }
        return detail::on_lanes<T>(filter_, lanes, [&] { return filter_.update(kept_row(), y); });
    }
    void forget(Mask const& lanes) {
        s2_ = select(lanes, T(0), s2_);
        learnt_.n = select(lanes, Count(0), learnt_.n);
        history_.n = select(lanes, Count(0), history_.n);
    }
    void reset_to_last_finite(Mask const& lanes, T const& variance) {
        detail::on_lanes<T>(filter_, lanes,
                            [&] { restart(filter_, variance, Regressor<T>(theta_.data(), theta_.size()), lambda_); });
        determined_ = determined_ && !(lanes && start_ == T(0));
        forget(lanes);
    }
    /// What follows F's step of a row; where the policy rebuilds, psi_ is the row.
    Step<T> watch(Mask const& lanes, Step<T> const& step, Regressor<T> psi, T const& y, bool learns = true) {
        if constexpr (policy.rebuilds()) ring_.push(psi_.data(), y);
        Mask const sound = lanes && detail::equal_to<T>(step.health, Health::sound);
        Mask broken = lanes && !sound;
        if (any(broken)) broken = broken && (determined_ || !detail::equal_to<T>(step.health, Health::undetermined));
        if (any(sound)) {
            determined_ = determined_ || sound;
            if (learns) learn(sound, step.innovation * step.residual);  // (3)
            each_value(coordinate_, sound,
                       [&](Index j, Mask const& here) { broken = broken || no_covariance(j, here); });
            if constexpr (certified) broken = broken || (learns && lacks_digits());
        }
        if (any(broken)) repair(broken, psi);
        detail::each_lane<T>(lanes, [this](int i) {
            Index &j = detail::of_lane(coordinate_.n, i), &apart = detail::of_lane(apart_.n, i);
            if (j + 1 < psi_.size()) ++j;
            else j = 0, apart = apart + 1 < psi_.size() / 2 ? apart + 1 : 0;
        });
        return step;
    }
    void learn(Mask const& lanes, T const& square) {
        Mask const told = lanes && is_finite(square) && T(0) <= square, known = told && learnt();
        if (any(known)) {
            T const most = T(9) * s2_, clipped = select(square < most, square, most);
            T next = s2_;
            next += (clipped / T(0.995) - s2_) / T(double(options_.noise_memory));
            s2_ = select(known, next, s2_);
        }
        detail::each_lane<T>(told && !known, [&](int i) {
            Index& n = detail::of_lane(learnt_.n, i);
            put(squares_[n++], i, detail::of_lane(square, i));
            if (n < squares_.size()) return;
            put(s2_, i, noise_of(i));
        });
    }
    template <class X>
    static void put(T& to, int lane, X const& x) {
        if constexpr (in_packs) to.set(lane, x);
        else to = x;
    }
    /// Of a lane, whose squares it orders anew. Where more than half are 0, of an output in steps, say: the median of
    /// the others times their share.
    auto noise_of(int lane) {
        auto const middle = [n = squares_.size()](auto* numbers) {
            using Number = std::remove_reference_t<decltype(*numbers)>;
            std::nth_element(numbers, numbers + n / 2, numbers + n);
            if (!(numbers[n / 2] == Number(0))) return Number(numbers[n / 2] / Number(0.455));
            Index const others = n - Index(std::count(numbers, numbers + n, Number(0)));
            std::nth_element(numbers, numbers + (n - 1 - others / 2), numbers + n);
            return Number(numbers[n - 1 - others / 2] * Number(double(others)) / Number(double(n)));
        };
        if constexpr (!in_packs) {
            return middle(squares_.data());
        } else {
            std::vector<typename T::lane_type> own;
            for (Index k = 0; k < squares_.size(); ++k) own.push_back(squares_[k][lane]);
            auto const out = middle(own.data());
            for (Index k = 0; k < squares_.size(); ++k) squares_[k].set(lane, own[size_t(k)]);
            return out;
        }
    }
    /// (4) and (5) of these lanes: where P is none.
    Mask no_covariance(Index j, Mask const& lanes) {
        T const p = watched_variance(filter_, j);
        Mask good = lanes && T(0) < p && is_finite(p);
        if constexpr (requires { symmetric_within(filter_, p, j, j); })
            each_value(apart_, good, [&](Index apart, Mask const& here) {
                Index const next = j + 1 + apart, i = next < psi_.size() ? next : next - psi_.size();
                good = good && (!here || symmetric_within(filter_, options_.asymmetry, i, j));
            });
        if (Mask const high = good && options_.largest_variance < p; any(high)) {
            count(counts_.windups, high);
            tell(high && detail::equal_to<T>(signal_, GuardSignal::none), GuardSignal::windup);
            if constexpr (policy.windup == Action::cap)
                hold(psi_.data(), j, square_root(T(T(1) / options_.largest_variance - T(1) / p)), filter_.theta()[j],
                     high);
        }
        if (j == 0 && any(good)) {
            detail::theta_of(filter_, psi_);
            Mask const finite = good && all_finite(psi_);
            if (all(finite)) theta_ = psi_;
            else if (any(finite))
                for (Index i = 0; i < psi_.size(); ++i) theta_[i] = select(finite, psi_[i], theta_[i]);
        }
        return lanes && !good;
    }
    /// (8). Of a certificate that has ended nothing is known; an infinite bound of another is none.
    bool lacks_digits() {
        if (!(options_.digits.wanted > 0) || policy.taken(counts_) % options_.digits.every != 0) return false;
        auto found = filter_.certificate();
        for (int i = 0; i < options_.digits.wanted; ++i) found.bound *= 10;
        return !found.ended && !(found.bound <= 1);
    }
    /// The row root e_j, of output root theta_j.
    void hold(T* row, Index j, T const& root, T const& theta, Mask const& lanes) {
        for (Index i = 0; i < psi_.size(); ++i) row[i] = select(lanes, i == j ? root : T(0), row[i]);
        T const output = root * theta;
        auto const add = [&] { return cap_row(filter_, {row, psi_.size()}, output, lambda_); };
        detail::on_lanes<T>(filter_, lanes, add);
    }
    /// The kept rows anew; without them where they are what broke the filter.
    void rebuild(T const& variance)
        requires(policy.rebuilds())
    {
        Health worst = Health::sound;
        for (Index k = 0; k < ring_.held(); ++k) {
            T const* const row = ring_.row(k);
            Health const health = filter_.update(Regressor<T>(row, psi_.size()), row[psi_.size()]).health;
            determined_ = determined_ || health == Health::sound;
            if (determined_ || health != Health::undetermined) worst = worse(worst, health);
        }
        if (worst == Health::sound) return;
        ring_.clear();
        reset_to_last_finite(true, variance);
    }
    void repair(Mask const& lanes, Regressor<T> psi) {
        count(counts_.breakdowns, lanes);
        tell(lanes, GuardSignal::breakdown);
        if constexpr (policy.breakdown != Action::report) {
            T const variance = variance_for(psi, significand_bits<T>() / 6);
            reset_to_last_finite(lanes, variance);
            if constexpr (policy.rebuilds()) rebuild(variance);
        }
    }
};

namespace detail {
template <HasOneLane F, GuardPolicy policy>
struct OneLane<Guarded<F, policy>> {
    using type = Guarded<OneLaneOf<F>, policy>;
};
}  // namespace detail

}  // namespace rlslab
