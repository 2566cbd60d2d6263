// Several outputs with one regressor: one P and one gain for all of them.
#pragma once

#include <rlslab/adapt/around.hpp>
#include <rlslab/linalg/block_gain.hpp>
#include <rlslab/linalg/reflections.hpp>

#include <array>
#include <new>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace rlslab {

namespace detail {
/// m copies of x, in place where m is fixed.
template <int m, class X>
auto copies_of(Index count, X const& x) {
    if constexpr (m == Dynamic) return std::vector<X>(size_t(count), x);
    else
        return [&x]<size_t... j>(std::index_sequence<j...>) {
            return std::array<X, size_t(m)>{((void)j, x)...};
        }(std::make_index_sequence<size_t(m)>{});
}

/// Whether the rows before determined theta, by the step.
template <class T>
bool was_determined(Step<T> const& step) {
    return !(step.gamma == T(0)) || is_finite(step.innovation);
}

// --- a further right-hand side of a form that solves for theta: z, or b ----------------------------------------------
// take(form, first, psi, y, e, z, x): what the row that F took last does to z; `first` is F's step, e the innovation
// where theta_before found it; x is workspace. thetas_of_sides(form, Z): the columns of Z become thetas.

template <class T, int N>
Step<T> take(RootInformation<T, N> f, Step<T> const& first, Regressor<T>, T y, T const&, StateVector<T, N>& z,
             StateVector<T, N>& x) {
    bool const determined = was_determined(first);
    T eta = y, root_gamma(1);
    Step<T> step;
    if (is_finite(f.u[0])) {
        for (Index i = 0; i < z.size(); ++i) {
            T const t = z[i], turned = f.s[i] * eta;
            z[i] = f.c[i] * t + turned;
            eta -= f.u[i] * t;
        }
        step = if_determined<T>(determined, step_of(eta, first.gamma), y);
    } else {
        for (Index i = 0; i < z.size(); ++i) {
            T const t = f.root_lambda * z[i], up = f.s[i] * eta, down = f.s[i] * t;
            eta = f.c[i] * eta - down;
            z[i] = f.c[i] * t + up;
            root_gamma *= f.c[i];
        }
        step = report_rotated(eta, root_gamma, determined);
    }
    return if_finite<T>(!determined || f.lengths.finite_too(z, x, f.L), step);
}
template <class T, int N>
Step<T> take(UnitInformation<T, N> f, Step<T> const& first, Regressor<T>, T y, T const&, StateVector<T, N>& z,
             StateVector<T, N>& x) {
    bool const determined = was_determined(first);
    T eta = y;
    for (Index i = 0; i < z.size(); ++i) {
        T const t = z[i], turned = f.s[i] * eta;
        z[i] = f.c[i] * t + turned;
        eta -= f.x[i] * t;
    }
    return if_finite<T>(!determined || f.lengths.finite_too(z, x, f.L, f.D),
                        if_determined<T>(determined, step_of(eta, first.gamma)));
}
template <class T, int N>
Step<T> take(LastReflections<T, N> f, Step<T> const& first, Regressor<T>, T y, T const&, StateVector<T, N>& z,
             StateVector<T, N>& x) {
    bool const determined = was_determined(first);
    T eta = y;
    for (Index i = 0; i < z.size(); ++i) {
        z[i] *= f.root_lambda;
        if (f.tau[i] == T(0)) continue;
        T const t = f.tau[i] * (z[i] + f.v[i] * eta);
        z[i] -= t;
        eta -= t * f.v[i];
    }
    return if_finite<T>(!determined || f.lengths.finite_too(z, x, f.L), report_rotated(eta, f.root_gamma, determined));
}
template <class T, int N>
Step<T> take(NormalEquations<T, N> f, Step<T> const& first, Regressor<T> psi, T y, T const& e, StateVector<T, N>& b,
             StateVector<T, N>&) {
    for (Index i = 0; i < b.size(); ++i) {
        T const product = psi[i] * y;
        b[i] = f.lambda * b[i] + product;
    }
    return if_finite<T>(all_finite(b), if_determined<T>(was_determined(first), step_of(e, first.gamma), y));
}
template <class T, int N>
void theta_of_side(NormalEquations<T, N> f, StateVector<T, N>& b) {
    if (!f.solved) f.solve();
    solve_ldl(f.L, f.D, f.positive, b);
}
/// The z, or b, that are the columns of Z become thetas. Each column of L is read once for all; the operations are
/// those of solve_lower_transposed.
template <class F>
void thetas_of_sides(F f, auto&& Z) {
    using T = typename F::scalar;
    Index const d = Z.rows();
    if constexpr (requires { f.b; }) {
        auto b = f.b;
        for (Index j = 0; j < Z.cols(); ++j) {
            for (Index i = 0; i < d; ++i) b[i] = Z(i, j);
            theta_of_side(f, b);
            Z.col(j) = b.view();
        }
    } else {
        for (Index i = d - 1; i >= 0; --i)
            for (Index j = 0; j < Z.cols(); ++j) {
                T* const x = Z.col(j).data();
                if (i + 1 < d) x[i] -= dot(f.L.column(i) + i + 1, x + i + 1, d - i - 1);
                x[i] /= f.L(i, i);
            }
        if constexpr (requires { f.D; })
            for (Index i = 0; i < d; ++i)
                if (f.D[i] == T(0)) Z.row(i).setConstant(undefined<T>());
    }
}
/// What shows F's last row to further right-hand sides.
template <class F>
auto last_row(F& f) {
    if constexpr (requires { f.last_row(); }) return f.last_row();
    else return f.form();
}
/// z, or b, of F.
template <class F>
auto side_of(F& f) {
    if constexpr (requires { f.form().b; }) return f.form().b;
    else if constexpr (requires { last_row(f).z; }) return last_row(f).z;
}
template <class F>
concept SolvesForTheta =
    ReportsInformation<F> &&
    requires(F& f, Step<typename F::scalar> const& step, Regressor<typename F::scalar> psi, typename F::scalar const& y,
             StateVector<typename F::scalar, size_of<F>>& z) { take(last_row(f), step, psi, y, y, z, z); };
}  // namespace detail

/// What a row is worth in which an output is missing: NaN, or infinite.
///   drops_the_row   for all outputs: time passes, P -> P / lambda, no theta changes. P is then right for every output
///   stands          for the others nothing changes, bit for bit; the theta of the one that is missing stands, and its
///                   P is too small
enum class MissingOutput : unsigned char { drops_the_row, stands };
/// What a row of a block is worth in which a number is not finite: the block is refused, or the row never came, as a
/// guard has it.
enum class UnusableRows : unsigned char { refuse_the_block, are_left_out };

/// m outputs y_j = psi'theta_j + noise of one psi, each noise white with a variance of its own:
///
///   (1) e_j = y_j - psi'theta_j        (2) F's row: P, and K = P psi        (3) theta_j += K e_j,  residual gamma e_j
///
/// F holds the first theta and is fed y_1; the others need d multiplications for (1) and d for (3) each, in place of a
/// filter. The forms that solve for theta keep z_j = R theta_j (b_j of `information`) in its place, and turn [z_j y_j]
/// as F turned [z_1 y_1]: 4 d multiplications, d^2 / 2 for a theta. Each theta_j and each step is that of an F of its
/// own, bit for bit; of blocks, where neither products nor squares of the rows leave the arithmetic's range.
///
/// Starts all from the problem's theta0. psi may be the gain's own numbers; a psi that is not finite spoils all
/// outputs, as it spoils F. Rows whose variance differs: sqrt(w) psi and sqrt(w) y, one w a row. Correlated noise
/// changes nothing in theta: y = psi'Theta with one psi for all. An output that begins later (a class that was never
/// seen) is one of zeros until then, exactly. M outputs fixed: no heap where F has none; Dynamic: allocates where it is
/// made. Throws std::invalid_argument unless there is an output, for a psi or y of another size, and for
/// MissingOutput::stands where F solves for theta. A step's health is the worse of its own numbers' and F's. Source:
/// folklore; docs/theory.md 64.
template <RecursiveLeastSquares F, int M = Dynamic>
    requires(((ReportsCovariance<F> && TimeUpdates<F>) || detail::SolvesForTheta<F>) &&
             std::same_as<Truth<typename F::scalar>, bool> && !requires { F::departs; } && (M == Dynamic || M >= 1))
class MultiOutput : public detail::AroundFilter<F> {
    using T = typename F::scalar;
    using detail::AroundFilter<F>::filter_;
    static constexpr int N = detail::size_of<F>;
    static constexpr bool solves = !ReportsCovariance<F>;
    template <class X>
    using Row = decltype(detail::copies_of<M>(Index(1), std::declval<X const&>()));
    static constexpr bool by_gain =
        requires(F& f, RowsOf<T> X, OutputsOf<T> y, BlockGain<T>& block) { f.update_block(X, y, block); };
    struct None {};
    StateVector<T, N> psi_;
    Row<StateVector<T, N>> theta_;  // z or b where F solves for theta; the first one's place is workspace
    Row<Step<T>> steps_;
    MissingOutput missing_;
    bool from_zero_;
    Index left_out_ = 0;
    [[no_unique_address]] std::conditional_t<by_gain, BlockGain<T>, None> block_;

    static Index checked(Index outputs) {
        expects(outputs >= 1 && (M == Dynamic || outputs == M), "as many outputs as the type has, at least one");
        return outputs;
    }
    Regressor<T> psi() const { return {psi_.data(), psi_.size()}; }
    StateVector<T, N>& room() { return theta_[0]; }

public:
    explicit MultiOutput(Problem<T> const& problem, Index outputs = M == Dynamic ? 1 : M,
                         MissingOutput missing = MissingOutput::drops_the_row)
        : detail::AroundFilter<F>(F(problem)), psi_(filter_.theta().size()),
          theta_(detail::copies_of<M>(room_for(checked(outputs)), StateVector<T, N>(psi_.size()))),
          steps_(detail::copies_of<M>(outputs, Step<T>{T(0), T(0), T(1)})), missing_(missing),
          from_zero_(starts_at_zero(problem)) {
        expects(!solves || missing != MissingOutput::stands,
                "MissingOutput::drops_the_row: a theta that is solved for cannot stand");
        for (auto& theta : theta_) {
            if constexpr (solves) theta = detail::side_of(filter_);
            else
                for (Index i = 0; i < psi_.size(); ++i) theta[i] = filter_.theta()[i];
        }
    }

    Index outputs() const { return Index(theta_.size()); }

    /// One row: m outputs. The steps are good until the next row. An output that is missing has no innovation and no
    /// residual.
    std::span<Step<T> const> update(Regressor<T> given, Regressor<T> y) {
        expects(outputs() >= 1 && y.size() == outputs(), "as many outputs as there are thetas, at least one");
        keep_regressor(given, psi_);
        bool const complete = whole(y), used = complete || missing_ == MissingOutput::stands;
        if (!used)
            for (Index i = 0; i < psi_.size(); ++i) psi_[i] = T(0);
        for (Index j = 1; j < outputs(); ++j) steps_[size_t(j)].innovation = innovation_of(j, y[j]);  // (1)
        // A first output that is missing is as predicted: e_1 = 0.
        T const first = !used ? T(0) : is_finite(y[0]) ? y[0] : predicted();
        Step<T> const step = filter_.update(psi(), first);  // (2)
        for (Index j = 0; j < outputs(); ++j) {
            bool const there = used && is_finite(y[j]);
            Step<T>& mine = steps_[size_t(j)];
            if (j > 0 && (there || solves)) {
                mine = take(j, step, there ? y[j] : T(0), mine.innovation);  // (3)
                mine.health = worse(mine.health, step.health);
            }
            if (!there) mine = {undefined<T>(), undefined<T>(), step.gamma, step.health};
            else if (j == 0) mine = step;
        }
        return {steps_.data(), steps_.size()};
    }
    std::span<Step<T> const> steps() const { return {steps_.data(), steps_.size()}; }  ///< of the last row

    /// k rows at once, the oldest first: X is d x k, Y k x m. Of qr_block and joseph_rank_two. With a number that is
    /// not finite the block is refused, nothing changes, and nonfinite is returned; or such rows are left out, and
    /// counted.
    /// Returns the worst health of the rows; of qr_block the last one's. steps() stay. Throws std::invalid_argument for
    /// other sizes, or k = 0.
    Health update_block(RowsOf<T> X, Eigen::Ref<Matrix<T> const> const& Y,
                        UnusableRows unusable = UnusableRows::refuse_the_block)
        requires(by_gain || TakesBlocks<F>)
    {
        expects(Y.cols() == outputs() && Y.rows() == X.cols() && X.rows() == psi_.size() && Y.rows() >= 1,
                "a block of d x k regressors and k x m outputs, k >= 1");
        std::vector<Index> usable;
        for (Index k = 0; k < X.cols(); ++k)
            if (whole(X.col(k)) && whole(Y.row(k))) usable.push_back(k);
        if (Index(usable.size()) == X.cols()) return take_block(X, Y);
        if (unusable == UnusableRows::refuse_the_block) return Health::nonfinite;
        left_out_ += X.cols() - Index(usable.size());
        if (usable.empty()) return Health::nonfinite;
        Matrix<T> const some = X(Eigen::all, usable), some_outputs = Y(usable, Eigen::all);
        return take_block(some, some_outputs);
    }
    Index left_out() const { return left_out_; }  ///< rows of blocks, since it was made; not in a state

    /// Appends the rows of `newer`, outputs of this problem that started without prior, as F merges. Returns the health
    /// of all rows together.
    Health merge(MultiOutput const& newer)
        requires requires(F& f, FurtherSides<T> const& sides) { f.merge(f, sides); }
    {
        expects(newer.outputs() == outputs(), "as many outputs");
        Health const health = filter_.merge(newer.filter_, {sides(newer), sides(*this)});
        return sides_stand(health) ? health : Health::nonfinite;
    }

    /// Outputs that were zeros until now, exactly. The problem must start at theta0 = 0. Invalidates steps().
    void add_outputs(Index more)
        requires(M == Dynamic)
    {
        expects(more >= 0 && from_zero_, "outputs that begin at theta0 = 0");
        room_for(Index(size_t(outputs()) + size_t(more)));  // without overflow: a sum of 2^63 and more is no room
        theta_.resize(theta_.size() + size_t(more), StateVector<T, N>(psi_.size()));
        steps_.resize(theta_.size(), {T(0), T(0), T(1)});
    }

    /// d x m, a column an output.
    Matrix<T, N, M> theta() const {
        Matrix<T, N, M> out(psi_.size(), outputs());
        out.col(0) = filter_.theta();
        for (Index j = 1; j < outputs(); ++j) out.col(j) = theta_[size_t(j)].view();
        if constexpr (solves)  // which reads the filter
            detail::thetas_of_sides(detail::last_row(const_cast<F&>(filter_)), out.rightCols(outputs() - 1));
        return out;
    }
    /// theta of one output, good until the next row.
    Regressor<T> theta_of(Index j) const
        requires(!solves)
    {
        return j == 0 ? Regressor<T>(filter_.theta()) : Regressor<T>(theta_[size_t(j)].data(), psi_.size());
    }
    auto covariance() const
        requires(!solves)
    {
        return Matrix<T, N>(filter_.covariance());
    }
    static constexpr std::string_view layer = "outputs";
    static std::array<StateOption, 2> options(auto const& f) {
        return {{{"outputs", double(f.outputs())}, {"missing", double(f.missing_)}}};
    }
    static auto state(auto& f) { return std::tie(f.filter_, f.theta_); }

private:
    /// Whether the z, and theta where F determines it, of all outputs but the first are finite. Solved for theta are
    /// those alone whose z is beyond the root of the largest number: of others R^-1 would be as large, and so K.
    bool sides_stand(Health health)
        requires(solves)
    {
        auto const f = detail::last_row(filter_);
        T const root = static_cast<T>(std::ldexp(1.0, std::min(max_exponent<T>() / 2, 500)));
        for (size_t j = 1; j < theta_.size(); ++j) {
            bool small = true;
            for (Index i = 0; i < psi_.size(); ++i) small = small && absolute(theta_[j][i]) < root;
            if (!small && (!all_finite(theta_[j]) ||
                           (health != Health::undetermined && !f.lengths.finite_too(theta_[j], room(), f.L))))
                return false;
        }
        return true;
    }
    static bool starts_at_zero(Problem<T> const& problem) {
        if (!problem.prior || !problem.prior->theta) return true;
        bool out = true;
        for (T const& x : *problem.prior->theta) out = out && x == T(0);
        return out;
    }
    /// The z of all outputs but the first.
    static auto sides(auto& of) {
        std::vector<decltype(of.theta_[0].data())> out;
        for (size_t j = 1; j < of.theta_.size(); ++j) out.push_back(of.theta_[j].data());
        return out;
    }
    static bool whole(auto const& x) {
        bool out = true;
        for (Index i = 0; i < x.size(); ++i) out = out && is_finite(T(x[i]));
        return out;
    }
    /// Throws std::bad_alloc for thetas that memory cannot hold, before it is asked for them one by one.
    Index room_for(Index outputs) const {
        if constexpr (M == Dynamic) {  // a vector's own numbers beside its entry and what the heap keeps of it
            size_t const each = (size_t(psi_.size()) + 8) * sizeof(T) + sizeof(StateVector<T>) + sizeof(Step<T>) + 64;
            if (size_t(outputs) > PTRDIFF_MAX / each) throw std::bad_alloc();
            std::vector<char>().reserve(size_t(outputs) * each);
        }
        return outputs;
    }
    Health take_block(RowsOf<T> X, Eigen::Ref<Matrix<T> const> const& Y) {
        Index const others = outputs() - 1;
        bool taken = true;
        Health health;
        if constexpr (by_gain) {
            health = filter_.update_block(X, Y.col(0), block_);
            if (health == Health::nonfinite || others == 0) return health;
            Matrix<T> Theta(psi_.size(), others), E = Y.rightCols(others);
            for (Index j = 0; j < others; ++j) Theta.col(j) = theta_[size_t(j + 1)].view();
            block_.take_outputs({X.data(), 1, X.outerStride()}, {Theta.data(), 1, Theta.rows()},
                                {E.data(), 1, E.rows()}, others);
            for (Index j = 0; j < others; ++j)
                for (Index i = 0; i < psi_.size(); ++i)
                    taken = is_finite(theta_[size_t(j + 1)][i] = Theta(i, j)) && taken;
        } else {
            std::vector<T*> const z = sides(*this);
            std::vector<T const*> y;
            for (Index j = 1; j < outputs(); ++j) y.push_back(Y.col(j).data());
            health = filter_.update_block(X, Y.col(0), {y, z});
            taken = sides_stand(health);
        }
        return taken ? health : Health::nonfinite;
    }
    T predicted() const {
        auto const theta = filter_.theta();
        return dot(theta.data(), psi_.data(), psi_.size());
    }
    T innovation_of(Index j, T const& y) {
        if constexpr (!solves) return innovation(y, psi(), theta_[size_t(j)]);
        else if constexpr (requires { filter_.form().b; }) {
            room() = theta_[size_t(j)];
            detail::theta_of_side(filter_.form(), room());
            return innovation(y, psi(), room());
        } else return T(0);
    }
    Step<T> take(Index j, Step<T> const& step, T const& y, T const& e) {
        StateVector<T, N>& theta = theta_[size_t(j)];
        if constexpr (solves) return detail::take(detail::last_row(filter_), step, psi(), y, e, theta, room());
        else {
            auto const K = filter_.gain();
            add_scaled(theta.data(), e, K.data(), theta.size());
            return if_finite<T>(all_finite(theta), step_of(e, step.gamma));
        }
    }
};

}  // namespace rlslab
