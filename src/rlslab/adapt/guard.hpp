// A filter that is watched while it runs: data that would spoil it are kept out, trouble is reported, and met as
// configured.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/adapt/guard_policy.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/window.hpp>

#include <algorithm>
#include <tuple>

namespace rlslab {

/// What a guard needs of a filter: e and s before the update, P_jj, a restart, and a row that holds P down.
template <class F>
concept Guardable =
    RecursiveLeastSquares<F> && Real<typename F::scalar> && std::same_as<Truth<typename F::scalar>, bool> &&
    requires(F& f, typename F::scalar x, Regressor<typename F::scalar> a) {
        detail::look_at(f, a, x);
        variance(f, Index(0));
        watched_variance(f, Index(0));
        restart(f, x, a, x);
        cap_row(f, a, x, x);
    };
/// hand_over(): goes on in a sounder variant; false where what was held is lost, or where it has gone on there before.
template <class F>
concept HandsOver = requires(F& f) {
    { f.hand_over() } -> std::same_as<bool>;
};

/// What a guard saw of a row, the worst first.
enum class GuardSignal : unsigned char { none, unusable, breakdown, change, outlier, windup };

constexpr std::string_view name_of(GuardSignal signal) {
    constexpr std::string_view names[] = {"none", "unusable", "breakdown", "change", "outlier", "windup"};
    return names[static_cast<int>(signal)];
}

struct GuardCounts {
    Index rows = 0;      ///< offered
    Index unusable = 0;  ///< not finite, or out of range: skipped
    Index outliers = 0;  ///< failed the innovation test
    Index changes = 0;   ///< 5 outliers among 6 rows
    Index windups = 0;   ///< P_jj > largest_variance
    Index breakdowns =
        0;  ///< a step that is indefinite, not finite, or again undetermined; P_jj <= 0 or not finite; asymmetry

    static auto state(auto& c) { return std::tie(c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns); }
};

template <Field T>
struct GuardOptions {
    T largest_variance = T(0);     ///< of p in (4), in units of the noise's; 0: 16 times the start's
    T innovation = T(6);           ///< c of the innovation test, in standard deviations; 0: none
    T least_noise = T(0);          ///< a standard deviation below which the noise is not believed to be
    Index noise_memory = 200;      ///< rows that the noise's variance is averaged over, >= 1
    T asymmetry = T(1) / T(1024);  ///< |P_ij - P_ji| / sqrt(P_ii P_jj), of a P in full storage
    Index rebuild_rows = 0;        ///< kept for rebuilding; 0: 10 d
};

/// F, with every row looked at before it is committed, and P after it, in O(d) besides the update (d^2/2 more where F
/// holds a factor of P^-1, up to d^2 where it follows a rule):
///
///   (1) y^2 <= 2^(E/2), and 0 < s <= 2^(E/2) and e is finite, or |psi|^2 <= 2^(E/2); else unusable: no bit of F
///       changes. E is the arithmetic's largest exponent
///   (2) e and s of the update; an outlier where e^2 lambda / s > c^2 s2; 5 outliers among 6 rows are a change. What
///       rounding makes of e is allowed for besides. s <= 0 or NaN is left to the step's health
///   (3) the rest of the update; s2 = s2 + (min(gamma e^2, 9 s2) / 0.995 - s2) / memory, from the median of 10 d + 20
///       numbers gamma e^2 on, over 0.455. Until then, and again after a reset, (2) is not made
///   (4) j = k mod d, p = P_jj, or 1/R_jj^2 where F holds a factor of P^-1 (watched_variance): breakdown where p <= 0
///       or is not finite, windup where p > largest_variance; capped by the row sqrt(r) e_j, r = 1/largest_variance -
///       1/p, of output sqrt(r) theta_j. Between two visits p grows by lambda^-d at most
///   (5) P in full storage: breakdown where |P_ij - P_ji| > asymmetry sqrt(P_ii P_jj), one pair a row, all of them in
///       d^2/2 rows
///
/// No row is changed, and a run without a signal leaves F's own bits. No exception, no allocation after it is made
/// (where F's theta() makes none); memory: 12 d + 20 numbers, and the kept rows where the policy rebuilds. 0.995 = E
/// min(x^2, 9) and 0.455 the median of x^2, x normal. Around a rule of forgetting s is that of before the rule.
/// (2) takes P0 at its word: theta0's error beyond c sqrt(P0 s2) makes outliers of the rows that first show it.
/// Thresholds of (2): docs/theory.md 61; of (4) and (5): 88. (3): the form of Gänsler, Gay, Sondhi & Benesty 2000
/// (cited, not read), in squares. Edition 1 had a bound of s, P_jj of every form, and a column of P in (5).
template <Guardable F, GuardPolicy policy = resetting>
    requires(policy.valid() && (!policy.hands_over() || HandsOver<F>))
class Guarded : public detail::AroundFilter<F, true> {
    using T = typename F::scalar;
    using detail::AroundFilter<F, true>::filter_;
    GuardOptions<T> options_;
    T lambda_, limit_, start_ = T(0);                 // of s, y^2 and |psi|^2
    StateVector<T, detail::size_of<F>> psi_, theta_;  // workspace; theta as last seen finite
    GuardCounts counts_;
    GuardSignal signal_ = GuardSignal::none;
    T s2_ = T(0);
    StateVector<T, detail::size_of<F> == Dynamic ? Dynamic : 10 * detail::size_of<F> + 20>
        squares_;  // from which s2 is learnt
    RowRing<T> ring_;
    BoundedCount learnt_, coordinate_;  // rows that s2 was learnt from; j
    BoundedCount apart_;                // i = j + 1 + apart mod d in (5)
    BoundedCount history_{0, 63};       // outliers among the last rows, a bit each, the newest lowest
    bool determined_ = false;           // a step was sound

public:
    static constexpr bool departs = true;  ///< from the problem's J
    static constexpr int edition = 2;

    explicit Guarded(Problem<T> const& problem, GuardOptions<T> const& options = {})
        : Guarded(F(problem), problem, options) {}
    /// Around a filter that was made of this problem, with options of its own, and has taken no row.
    Guarded(F const& filter, Problem<T> const& problem, GuardOptions<T> const& options = {})
        : detail::AroundFilter<F, true>(filter), options_(options),
          lambda_(checked(problem, int(filter.theta().size())).forgetting),
          limit_(T(std::ldexp(1.0, std::min(max_exponent<T>() / 2, 1000)))), psi_(filter_.theta().size()),
          theta_(psi_.size()), squares_(10 * psi_.size() + 20),
          ring_(psi_.size(),
                policy.rebuilds() ? (options.rebuild_rows > 0 ? options.rebuild_rows : 10 * psi_.size()) : 0),
          learnt_{0, squares_.size()}, coordinate_{0, psi_.size() - 1},
          apart_{0, std::max(psi_.size() / 2, Index(1)) - 1} {
        expects(T(0) <= options.largest_variance && T(0) <= options.innovation && T(0) <= options.least_noise,
                "options >= 0");
        expects(T(0) < options.asymmetry && options.noise_memory >= 1 && options.rebuild_rows >= 0,
                "options that make sense");
        for (Index j = 0; problem.prior && j < psi_.size(); ++j) start_ = std::max(start_, variance(filter_, j));
        if (!(T(0) < start_) || !is_finite(start_)) start_ = T(16384);
        if (options_.largest_variance == T(0)) options_.largest_variance = T(16) * start_;
        if (problem.prior && problem.prior->theta) keep_regressor(Regressor<T>(*problem.prior->theta), theta_);
    }

    Step<T> update(Regressor<T> psi, T y) {
        expects(psi.size() == psi_.size(), "a regressor of the problem's size");
        ++counts_.rows;
        Innovation<T> const row = detail::look_at(filter_, psi, y);
        if (!(T(0) < row.s && row.s <= limit_ && y * y <= limit_ && is_finite(row.e)) && !usable(psi, y)) {  // (1)
            ++counts_.unusable;
            signal_ = GuardSignal::unusable;
            return {undefined<T>(), undefined<T>(), undefined<T>(), Health::nonfinite};
        }
        signal_ = GuardSignal::none;
        if (armed() && is_outlier(psi, y, row)) {  // (2)
            if (changed()) return restart_at(psi, y);
            if constexpr (policy.outlier == Action::skip) return {row.e, row.e, T(1), Health::sound};
        }
        if constexpr (policy.rebuilds()) keep_regressor(psi, psi_);  // which may be the gain's own numbers
        return watch(detail::commit(filter_, row, psi, y), y);
    }
    /// Time without a row: F's row with psi = 0. P_jj is looked at; nothing is tested, and nothing learnt of the noise.
    Step<T> pass_time() {
        signal_ = GuardSignal::none;
        detail::fill(psi_, T(0));
        return watch(filter_.update(kept_row(), T(0)), T(0), false);
    }
    static constexpr std::string_view layer = "guard";
    static std::array<StateOption, 9> options(auto const& g) {
        return {{{"on_outlier", double(policy.outlier)},
                 {"on_change", double(policy.change)},
                 {"on_windup", double(policy.windup)},
                 {"on_breakdown", double(policy.breakdown)},
                 {"innovation", static_cast<double>(g.options_.innovation)},
                 {"least_noise", static_cast<double>(g.options_.least_noise)},
                 {"noise_memory", double(g.options_.noise_memory)},
                 {"asymmetry", static_cast<double>(g.options_.asymmetry)},
                 {"rows", double(g.counts_.rows), true}}};
    }
    static auto state(auto& g) {
        return std::tie(g.filter_, g.theta_, g.ring_, g.counts_, g.lambda_, g.start_, g.options_.largest_variance,
                        g.s2_, g.squares_, g.learnt_, g.coordinate_, g.apart_, g.history_, g.determined_);
    }

    /// Of the filter inside.
    friend T variance(Guarded& g, Index j) { return variance(g.filter_, j); }
    friend T watched_variance(Guarded& g, Index j) { return watched_variance(g.filter_, j); }
    friend T variance_along(Guarded& g, Regressor<T> psi) { return variance_along(g.filter_, psi); }

    GuardSignal signal() const { return signal_; }  ///< what the last row showed
    /// Whether the last row tells nothing of the noise; and whether the filter started anew at it.
    bool set_aside() const { return signal_ != GuardSignal::none && signal_ != GuardSignal::windup; }
    bool restarted() const {
        return (signal_ == GuardSignal::change && policy.change == Action::reset) ||
               (signal_ == GuardSignal::breakdown && policy.breakdown != Action::report);
    }
    GuardCounts const& counts() const { return counts_; }
    T noise_variance() const { return s2_; }  ///< s2; 0 until it is known

private:
    /// Else e or s out of range is the state's fault.
    bool usable(Regressor<T> psi, T const& y) const {
        return dot(psi.data(), psi.data(), psi.size()) <= limit_ && y * y <= limit_;
    }
    bool armed() const { return T(0) < options_.innovation && learnt_.n == squares_.size(); }
    Regressor<T> kept_row() const { return {psi_.data(), psi_.size()}; }
    bool is_outlier(Regressor<T> psi, T const& y, Innovation<T> const& row) {
        if (!(T(0) < row.s) || !is_finite(row.s) || !(row.e == row.e)) return false;
        T const least = options_.least_noise * options_.least_noise, s2 = s2_ < least ? least : s2_,
                most = options_.innovation * options_.innovation, left = row.e * row.e * lambda_;
        bool out = !(left <= most * (s2 * row.s));  // an overflow on the left, too
        if (out) {
            T const rounding = T(8 * epsilon<T>()), size = dot(psi.data(), psi.data(), psi.size()),
                    made = rounding * rounding * (y * y + size * dot(theta_, theta_));
            out = !(left <= most * (s2 * row.s + made));
        }
        history_.n = (history_.n << 1 | Index(out)) & 63;
        if (out) {
            ++counts_.outliers;
            signal_ = GuardSignal::outlier;
        }
        return out;
    }
    /// 5 of the last 6: a change, at once where the filter keeps to what it knew before.
    bool changed() {
        Index out = 0;
        for (Index bits = history_.n; bits != 0; bits >>= 1) out += bits & 1;
        if (out < 5) return false;
        ++counts_.changes;
        signal_ = GuardSignal::change;
        history_.n = 0;
        return policy.change == Action::reset;
    }
    Step<T> restart_at(Regressor<T> psi, T const& y) {
        keep_regressor(psi, psi_);
        auto const theta = filter_.theta();
        reset_to(Regressor<T>(theta));
        Step<T> const step = watch(filter_.update(kept_row(), y), y);
        signal_ = GuardSignal::change;
        return step;
    }
    void reset_to(Regressor<T> theta) {
        restart(filter_, start_, theta, lambda_);
        s2_ = T(0);
        learnt_.n = 0;
        history_.n = 0;
    }
    /// What follows F's step of a row; where the policy rebuilds, psi_ is the row.
    Step<T> watch(Step<T> const& step, T const& y, bool learns = true) {
        if constexpr (policy.rebuilds()) ring_.push(psi_.data(), y);
        bool broken = step.health != Health::sound && (determined_ || step.health != Health::undetermined);
        if (step.health == Health::sound) {
            determined_ = true;
            if (learns) learn(step.innovation * step.residual);  // (3)
            broken = !is_covariance(coordinate_.n);
        }
        if (broken) repair();
        if (coordinate_.n + 1 < psi_.size()) ++coordinate_.n;
        else coordinate_.n = 0, apart_.n = apart_.n + 1 < psi_.size() / 2 ? apart_.n + 1 : 0;
        return step;
    }
    void learn(T const& square) {
        if (!is_finite(square) || !(T(0) <= square)) return;
        if (learnt_.n == squares_.size()) {
            T const most = T(9) * s2_, clipped = square < most ? square : most;
            s2_ += (clipped / T(0.995) - s2_) / T(double(options_.noise_memory));
            return;
        }
        squares_[learnt_.n++] = square;
        if (learnt_.n < squares_.size()) return;
        T* const middle = squares_.data() + learnt_.n / 2;
        std::nth_element(squares_.data(), middle, squares_.data() + learnt_.n);
        s2_ = *middle / T(0.455);
    }
    /// (4) and (5); false where P is none.
    bool is_covariance(Index j) {
        T const p = watched_variance(filter_, j);
        if (!(T(0) < p) || !is_finite(p)) return false;
        if constexpr (requires { symmetric_within(filter_, p, j, j); }) {
            Index const next = j + 1 + apart_.n, i = next < psi_.size() ? next : next - psi_.size();
            if (!symmetric_within(filter_, options_.asymmetry, i, j)) return false;
        }
        if (p > options_.largest_variance) {
            ++counts_.windups;
            if (signal_ == GuardSignal::none) signal_ = GuardSignal::windup;
            if constexpr (policy.windup == Action::cap) cap(j, p);
        }
        if (j == 0) {
            detail::theta_of(filter_, psi_);
            if (all_finite(psi_)) theta_ = psi_;
        }
        return true;
    }
    void cap(Index j, T const& p) {
        T const root = square_root(T(T(1) / options_.largest_variance - T(1) / p));
        detail::fill(psi_, T(0));
        psi_[j] = root;
        T const output = root * filter_.theta()[j];
        cap_row(filter_, kept_row(), output, lambda_);
    }
    /// The kept rows anew; without them where they are what broke the filter.
    void rebuild() {
        Health worst = Health::sound;
        for (Index k = 0; k < ring_.held(); ++k) {
            T const* const row = ring_.row(k);
            worst = worse(worst, filter_.update(Regressor<T>(row, psi_.size()), row[psi_.size()]).health);
        }
        if (worst == Health::sound) return;
        ring_.clear();
        reset_to(Regressor<T>(theta_.data(), theta_.size()));
    }
    void repair() {
        ++counts_.breakdowns;
        signal_ = GuardSignal::breakdown;
        if constexpr (policy.hands_over())
            if (filter_.hand_over()) return;
        if constexpr (policy.breakdown != Action::report) {
            reset_to(Regressor<T>(theta_.data(), theta_.size()));
            if constexpr (policy.rebuilds()) rebuild();
        }
    }
};

}  // namespace rlslab
