// Two filters that must be one: what each row leaves of either, number by number, and the first bit in which they part.
// A filter's type is instantiated for the numbers alone; what compares them is compiled once.
#pragma once

#include <rlslab/adapt/guard_signal.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/records.hpp>
#include <rlslab/state/lanes.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::twins {

/// Numbers under names. One NaN is as good as another; zeros have signs.
class Left {
    std::vector<std::pair<std::string_view, std::size_t>> parts_;
    std::vector<double> numbers_;
    void wide(Reference x);

public:
    /// x, all numbers of x, or its lane, under this name.
    template <class X>
    Left& add(std::string_view name, X const& x, int lane = 0) {
        parts_.emplace_back(name, numbers_.size());
        put(x, lane);
        return *this;
    }
    template <class X>
    void put(X const& x, int lane = 0) {
        if constexpr (std::is_enum_v<X> || std::integral<X> || std::same_as<X, float> || std::same_as<X, double>) {
            numbers_.push_back(static_cast<double>(x));
        } else if constexpr (requires { x(0, 0), x.cols(); }) {
            for (Index j = 0; j < x.cols(); ++j)
                for (Index i = 0; i < x.rows(); ++i) put(x(i, j), lane);
        } else if constexpr (requires { x.begin(), x.end(); }) {
            for (auto const& one : x) put(one, lane);
        } else if constexpr (requires { x[lane]; }) {
            put(x[lane]);
        } else {
            wide(Reference(widen(x)));
        }
    }
    std::vector<double> of(std::string_view name) const;
    friend std::string parted(Left const& a, Left const& b, std::string const& at);
};
/// "" or "gain[2]: 0x1.8p+1 and 0x1.9p+1"; `at` stands before the colon.
std::string parted(Left const& a, Left const& b, std::string const& at = "");

/// One for each row.
using Trace = std::vector<Left>;
/// "" or "gain[2] at row 31: 0x1.8p+1 and 0x1.9p+1".
std::string parted(Trace const& a, Trace const& b);
/// Fails the test where they part.
void expect_one(std::string_view what, Left const& a, Left const& b);
void expect_one(std::string_view what, Trace const& a, Trace const& b);
void expect_one(std::string_view what, std::vector<Trace> const& a, std::vector<Trace> const& b);

inline std::vector<Index> numbers_of(GuardCounts const& c) {
    return {c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns};
}
/// A filter of floats may keep bounds in double, a pack of them in float: no bit of the answers depends on them.
template <class F>
constexpr bool may_keep_bounds = !requires(F f) { f.form(); } || requires(F f) { f.form().lengths; };

/// Everything that a filter shows after a step, of one lane where it has lanes. What is stored is left out where theta
/// is not finite: NaN then spreads to numbers that nothing reads.
template <class F, class S>
Left left_by(F const& f, S const& step, int lane = 0, bool with_state = false) {
    Left out;
    out.add("innovation", step.innovation, lane).add("residual", step.residual, lane);
    out.add("gamma", step.gamma, lane).add("health", step.health, lane);
    out.add("theta", f.theta(), lane);
    for (double const x : out.of("theta"))
        if (x - x != 0) return out;
    if constexpr (requires { f.gain(); }) out.add("gain", f.gain(), lane);
    if constexpr (requires { f.stored().F; }) {
        auto const stored = f.stored();
        out.add("F", stored.F, lane).add("D", stored.D, lane);
    }
    if constexpr (requires { f.signal(), f.noise_variance(); }) {
        out.add("signal", f.signal(), lane).add("noise", f.noise_variance(), lane);
        if constexpr (requires { f.counts().rows[lane]; }) out.add("counts", numbers_of(f.counts().of_lane(lane)));
        else out.add("counts", numbers_of(f.counts()));
    }
    if constexpr (requires(detail::LaneRead r) { detail::walk(r, f); })
        if (with_state) {
            detail::LaneRead numbers(lane);
            detail::walk(numbers, f);
            out.add("state", numbers.values);
        }
    return out;
}

/// The k-th row. w is its weight, for those that take one.
template <class T>
struct Row {
    Vector<T> psi;
    T y = T(0), w = T(1);
    Index k = 0;
};
using Rows = std::vector<Row<double>>;
template <class T>
Row<T> row_in(Row<double> const& row) {
    auto const number = [](double x) { return T(x); };
    return {row.psi.unaryExpr(number), T(row.y), T(row.w), row.k};
}

/// The rows of one filter: silent for long stretches, with outliers, changes for ever, numbers out of range, and none.
struct Lively {
    Seed seed;
    Index d = 3;
    double beyond = 0;  ///< a number out of range, if there is to be one
    bool nan = false;
    double sign = 1;
    int silent = 0;
    Index k = 0;
    Row<double> next();
};
Rows taken(Lively source, Index count);

/// The problem in T.
template <class T>
Problem<T> in(Problem<double> const& problem) {
    return problem.mapped<T>([](double x) { return T(x); });
}

struct Update {
    template <class F, class T>
    auto operator()(F& f, Row<T> const& row) const {
        return f.update(row.psi, row.y);
    }
};
/// act(f, row) takes each row.
template <class F, class Act = Update>
Trace trace(F const& start, Rows const& rows, bool with_state = false, Act const& act = {}) {
    F f = start;
    Trace out;
    for (Row<double> const& row : rows) {
        auto const step = act(f, row_in<typename F::scalar>(row));
        out.push_back(left_by(f, step, 0, with_state));
    }
    return out;
}
/// Of each lane, which has rows of its own.
template <class F, class Act = Update>
std::vector<Trace> traces(F const& start, std::vector<Rows> const& rows, bool with_state = false, Act const& act = {}) {
    F f = start;
    using P = typename F::scalar;
    using T = typename P::lane_type;
    std::vector<Trace> out(rows.size());
    for (std::size_t k = 0; k < rows[0].size(); ++k) {
        Row<P> all{Vector<P>(rows[0][k].psi.size()), P(T(0)), P(T(0)), Index(k)};
        for (int lane = 0; lane < P::lanes; ++lane) {
            Row<double> const& mine = rows[std::size_t(lane)][k];
            for (Index j = 0; j < all.psi.size(); ++j) all.psi[j].set(lane, T(mine.psi[j]));
            all.y.set(lane, T(mine.y)), all.w.set(lane, T(mine.w));
        }
        auto const step = act(f, all);
        for (int lane = 0; lane < P::lanes; ++lane)
            out[std::size_t(lane)].push_back(left_by(f, step, lane, with_state));
    }
    return out;
}

}  // namespace rlslab::twins
