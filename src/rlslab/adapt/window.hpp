// A filter over a sliding window of rows, which knows when taking rows back has cost it too much and factors the kept
// rows anew.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/state/bounded_count.hpp>
#include <rlslab/adapt/look.hpp>
#include <rlslab/adapt/remove.hpp>

#include <tuple>
#include <vector>

namespace rlslab {

/// When a window factors anew.
template <Field T>
struct WindowOptions {
    Index rows = 500;  ///< W >= 1
    T worse = T(4);  ///< alarm: the expected error exceeds that of a fresh filter on the same rows by this factor, > 1
    Index refactor_every = 0;  ///< and every so many rows; 0: on alarm alone
};

/// The last W rows [psi y] in order, in memory that is taken once.
template <Field T>
class RowRing {
    Index d_;
    detail::MovedSize rows_;
    BoundedCount held_, next_;
    std::vector<T> numbers_;  // d + 1 a row

public:
    /// Throws std::invalid_argument for rows < 0, or more than memory could hold.
    RowRing(Index size, Index rows)
        : d_(size), rows_(rows), held_{0, rows}, next_{0, rows > 0 ? rows - 1 : 0}, numbers_(of(size, rows), T(0)) {}
    Index held() const { return std::min(held_.n, rows_.value); }
    bool full() const { return held_.n == rows_.value; }
    T* row(Index age_from_oldest) {
        return numbers_.data() + (next_.n - held_.n + age_from_oldest + rows_.value) % rows_.value * (d_ + 1);
    }
    /// Where the newest row goes, in place of the oldest where the ring is full.
    void push(T const* psi, T const& y) {
        expects(rows_.value > 0, "a window that was not moved from");
        T* const place = numbers_.data() + next_.n * (d_ + 1);
        for (Index i = 0; i < d_; ++i) place[i] = psi[i];
        place[d_] = y;
        next_.n = (next_.n + 1) % rows_.value;
        if (held_.n < rows_.value) ++held_.n;
    }
    void clear() { held_.n = next_.n = 0; }
    static auto state(auto& r) { return std::tie(r.held_, r.next_, r.numbers_); }

private:
    static size_t of(Index size, Index rows) {
        expects(rows >= 0 && product_fits(size_t(size + 1), size_t(rows)), "kept rows that memory could hold");
        return size_t((size + 1) * rows);
    }
};

namespace detail {
/// sqrt(lambda) as the form holds it, or null.
template <class F>
typename F::scalar const* root_lambda_of(F& f) {
    if constexpr (requires { f.form().root_lambda; }) return &f.form().root_lambda;
    else if constexpr (requires { f.root_lambda(); }) return f.root_lambda();
    else return nullptr;
}
}  // namespace detail

/// F over the last W rows: minimises the J of F's problem as if these were all the rows there are. Each row is taken by
/// F's own update; then the row W steps back, of weight lambda^W, is taken back (docs/theory.md 59).
///
/// An error made at step t, relative to P^-1 = X, is by step k larger by det X_t / det X_k where one direction lost its
/// information and the others kept theirs. Hence the alarm, in O(1) from gamma and alpha^2, which are at hand; V is the
/// expected square of the error, in units of u^2 (docs/theory.md 60):
///
///   (1) row:      V = gamma^2 V + 1          (2) removal: V = (V + noise^2) / alpha^4
///   (3) V > worse^2 V0, V0 what (1) gave for the rows from which F was last factored, or a removal refused: factor the
///     kept rows anew
///   (4) so too where E > worse^2 V0 Y: Y = sum w y^2 over the window bounds |z|^2 = theta'X theta, and E, the square
///       of the error of z in units of u^2, follows (1) and (2) with Y for 1, so that what a large y leaves behind when
///       it has left is seen
///
/// V takes rounding errors for independent. Those of qr in float are not, where lambda is near 1: over windows of 10
/// 000 rows and more its error is up to 70 times a fresh filter's, without an alarm; ud's is not.
///
/// After (3) the state is, bit for bit, that of a fresh F fed these rows; where they do not determine theta without a
/// prior, health says so with this row. A row that is not finite spoils the window
/// while it is in it, as it spoils F, and leaves no trace: the rows are factored anew when the last such row has left.
/// A prior counts from the last factoring on. Memory W (d + 1) numbers and F twice; allocates where it is made and
/// never again (F allowing). Cost of a step: F's update and one removal; factoring takes W updates in one step, the
/// longest of all.
template <Downdates F>
    requires std::same_as<Truth<typename F::scalar>, bool>
class Windowed : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    F start_;
    StateVector<T, detail::size_of<F>> psi_;
    WindowOptions<T> options_;
    RowRing<T> ring_;
    T forgetting_, weight_ = T(1), V_ = T(0), V0_ = T(0);  // lambda, lambda^W, V, V0
    T Y_ = T(0), E_ = T(0);                                // Y, E
    BoundedCount spoilt_;                                  // rows until the last that is not finite has left
    Index since_ = 0, refactored_ = 0;                     // rows since the last factoring

    void add(Step<T> const& step, T const& y) {
        T const kept = step.gamma * step.gamma;
        V_ = kept * V_ + T(1);  // (1)
        Y_ = forgetting_ * Y_ + y * y;
        E_ = kept * E_ + Y_;
    }
    Index size() const { return psi_.size(); }
    Regressor<T> row_as_kept() const { return {psi_.data(), size()}; }

public:
    explicit Windowed(Problem<T> const& problem, WindowOptions<T> const& options = {})
        : Windowed(F(problem), problem.forgetting, options) {}
    /// Around a filter that was made with options of its own and has taken no row. `forgetting` is its problem's.
    Windowed(F const& filter, T const& forgetting, WindowOptions<T> const& options = {})
        : detail::AroundFilter<F>(filter), start_(filter), psi_(filter.theta().size()), options_(checked(options)),
          ring_(psi_.size(), options.rows), forgetting_(forgetting), spoilt_{0, options.rows} {
        expects(all(is_forgetting_factor(forgetting)), "0 < forgetting <= 1");
        T const* const root = detail::root_lambda_of(filter_);  // is rounded: W steps wear a row by its square
        T const wear = root ? *root : forgetting;
        for (Index k = 0; k < (root ? 2 : 1) * options.rows; ++k) weight_ *= wear;
    }

    Step<T> update(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);  // which may be the gain's own numbers
        return step(filter_.update(row_as_kept(), y), y);
    }
    /// In two steps (look.hpp).
    Innovation<T> look(Regressor<T> psi, T y) {
        keep_regressor(psi, psi_);
        return detail::look_at(filter_, row_as_kept(), y);
    }
    Step<T> commit(Innovation<T> const& row, Regressor<T>, T const& y) {
        return step(detail::commit(filter_, row, row_as_kept(), y), y);
    }
    static constexpr std::string_view layer = "window";
    static std::array<StateOption, 4> options(auto const& w) {
        return {{{"rows", double(w.options_.rows)},
                 {"worse", static_cast<double>(w.options_.worse)},
                 {"refactor_every", double(w.options_.refactor_every)},
                 {"rows_held", double(w.rows()), true}}};
    }
    static auto state(auto& w) {
        return std::tie(w.filter_, w.start_, w.ring_, w.forgetting_, w.weight_, w.V_, w.V0_, w.Y_, w.E_, w.spoilt_,
                        w.since_, w.refactored_);
    }
    Index rows() const { return ring_.held(); }       ///< in the window
    Index refactored() const { return refactored_; }  ///< times that the kept rows were factored anew
    Index since() const { return since_; }         ///< rows since then, those that it kept apart; since the start: all
    bool spoilt() const { return spoilt_.n > 0; }  ///< a row that is not finite is in the window
    T grown() const { return V_ / V0_; }  ///< V / V0, which (3) watches; undefined before the window is first full

    /// F anew from the kept rows, oldest first; the last one's step. Undefined numbers where no row is kept.
    Step<T> refactor() {
        Step<T> last{undefined<T>(), undefined<T>(), undefined<T>(), Health::undetermined};
        filter_ = start_;
        V_ = Y_ = E_ = T(0);
        for (Index k = 0; k < ring_.held(); ++k) {
            T const* const row = ring_.row(k);
            last = filter_.update(Regressor<T>(row, size()), row[size()]);
            add(last, row[size()]);
        }
        V0_ = V_;
        since_ = 0;
        ++refactored_;
        return last;
    }

    /// What a guard calls on a window. `restart`: no row is kept, and the window's prior is from now on this theta and
    /// variance; lambda is the window's own. `cap_row`: the row is none of the window; it counts until the kept rows
    /// are next factored anew.
    friend T variance(Windowed& w, Index j)
        requires ReportsVariances<F>
    {
        return variance(w.filter_, j);
    }
    friend T variance_along(Windowed& w, Regressor<T> psi)
        requires ReportsVariances<F>
    {
        return variance_along(w.filter_, psi);
    }
    friend T watched_variance(Windowed& w, Index j)
        requires ReportsVariances<F>
    {
        return watched_variance(w.filter_, j);
    }
    friend bool symmetric_within(Windowed& w, T const& share, Index i, Index j)
        requires MayLoseSymmetry<F>
    {
        return symmetric_within(w.filter_, share, i, j);
    }
    friend void restart(Windowed& w, T const& variance, Regressor<T> theta, T const&)
        requires TimeUpdates<F>
    {
        reset(w.start_, variance, theta);  // theta may be the filter's own
        w.filter_ = w.start_;
        w.ring_.clear();
        w.V_ = w.V0_ = w.Y_ = w.E_ = T(0);
        w.since_ = w.spoilt_.n = 0;
    }
    friend Step<T> cap_row(Windowed& w, Regressor<T> psi, T const& y, T const& lambda)
        requires TimeUpdates<F>
    {
        return cap_row(w.filter_, psi, y, lambda);
    }

private:
    static WindowOptions<T> const& checked(WindowOptions<T> const& options) {
        expects(options.rows >= 1, "a window of at least one row");
        expects(T(1) < options.worse, "an alarm at more than 1 times a fresh filter's error");
        expects(options.refactor_every >= 0, "a schedule of >= 0 rows");
        return options;
    }
    /// What follows F's step of the row in psi_.
    Step<T> step(Step<T> out, T const& y) {
        bool const finite = all_finite(psi_) && is_finite(y);
        add(out, y);
        ++since_;
        bool alarm = false;
        bool const leaves = ring_.full();
        if (leaves && spoilt_.n == 0) {
            T const* const oldest = ring_.row(0);
            Removal<T> const removal = remove(filter_, Regressor<T>(oldest, size()), oldest[size()], weight_);
            T const remaining = removal.remaining * removal.remaining;
            T const made = removal.noise * removal.noise, most = options_.worse * options_.worse * V0_,
                    left = oldest[size()];
            V_ = (V_ + made) / remaining;  // (2)
            E_ = (E_ + made * Y_) / remaining;
            Y_ -= weight_ * (left * left);
            T const remains = T(0) < Y_ ? Y_ : T(0);  // rounding may leave less than nothing
            alarm = removal.refused() || !(V_ <= most) || !(E_ / most <= remains);  // (3), (4)
        } else if (!leaves) {
            V0_ = V_;
        }
        ring_.push(psi_.data(), y);
        if (spoilt_.n > 0 && --spoilt_.n == 0) alarm = true;
        if (!finite) spoilt_.n = options_.rows;
        if (spoilt_.n > 0 || !(alarm || (options_.refactor_every > 0 && since_ >= options_.refactor_every))) return out;
        refactor();
        if constexpr (requires { detail::look_at(filter_, row_as_kept(), y); })
            if (out.health == Health::sound)  // what the kept rows no longer determine, F would say with the next one
                if (T const e = detail::look_at(filter_, row_as_kept(), y).e; !(e == e))
                    out.health = Health::undetermined;
        return out;
    }
};

}  // namespace rlslab
