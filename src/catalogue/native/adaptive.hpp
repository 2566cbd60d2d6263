// A filter of a variant that is named while the program runs, in one arithmetic, with all operations that windows,
// guards and rules need.
#pragma once

#include <rlslab/catalogue/native/composition.hpp>

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/state/state.hpp>

#include <memory>

namespace rlslab {

/// What a filter can do beside updates.
struct Abilities {
    bool form = false;         ///< discounts, resets, takes another lambda, reports variances
    bool inflates = false;     ///< takes P + c a a'
    bool downdates = false;    ///< takes a row back
    bool information = false;  ///< has psi'P^-1 psi at hand
    bool guardable = false;
    bool variances = false;  ///< has P_jj and psi'P psi at hand
    bool signals = false;    ///< is a guard
    Index block = 0;         ///< rows that it takes at once; 0: one by one
};

template <class F>
inline constexpr bool reports_variances =
    requires(F& f, Regressor<typename F::scalar> psi) { variance(f, Index(0)), variance_along(f, psi); };
template <class F>
constexpr Index block_of() {
    if constexpr (TakesBlocks<F>) return F::block;
    else return 0;
}
template <class F>
inline constexpr Abilities abilities_by_type{.form = TimeUpdates<F> && reports_variances<F>,
                                             .inflates = Inflates<F>,
                                             .downdates = Downdates<F>,
                                             .information = ReportsInformationAlong<F>,
                                             .guardable = Guardable<F>,
                                             .variances = reports_variances<F>,
                                             .signals = requires(F & f){f.signal();
}  // namespace rlslab
, .block = block_of<F>()
}
;

template <Real T>
class AnyAdaptive;

/// The form of a filter that only the run knows.
template <Real T>
struct AnyForm {
    using scalar = T;
    typename AnyAdaptive<T>::Interface& filter;
};

namespace detail {
/// P, or P^-1, as the variant inside f reports it.
template <class F>
Matrix<typename F::scalar> reported_matrix(F const& f) {
    if constexpr (ReportsCovariance<F>) return f.covariance();
    else if constexpr (ReportsInformation<F>) return f.information();
    else if constexpr (requires { f.matrix(); }) return f.matrix();
    else return reported_matrix(f.filter());
}
}  // namespace detail

/// A value: copies are filters of their own. Around a variant, or around what is composed around one: so a window, a
/// guard or a rule is compiled once an arithmetic, and not once a variant. Each call is one virtual call to F's own
/// text: the bits are those of the type F, and so are the bytes of its state. By its type it models everything that
/// adapt/ asks for. What F cannot do throws std::logic_error: ask `abilities` before composing. An update allocates
/// nothing, F allowing, and neither do theta and gain: views, of what the next call may overwrite.
template <Real T>
class AnyAdaptive {
public:
    using scalar = T;
    static constexpr std::string_view name = "any";
    static constexpr bool hides_its_state = true;
    using View = Eigen::Map<Vector<T> const>;
    using Rows = Eigen::Map<Matrix<T> const, 0, Eigen::OuterStride<>>;

    struct Interface {
        virtual ~Interface() = default;
        virtual std::unique_ptr<Interface> clone() const = 0;
        virtual bool assign(Interface const& other) = 0;
        virtual Abilities abilities() const = 0;
        virtual Step<T> update(Regressor<T> psi, T const& y) = 0;
        virtual Step<T> process(Rows const& psi, View const& y) = 0;
        virtual Step<T> pass_time(StateVector<T>& scratch) = 0;
        virtual Innovation<T> look(Regressor<T> psi, T const& y) = 0;
        virtual Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) = 0;
        virtual View theta() const = 0;
        virtual View gain() const = 0;
        virtual Stored<T> stored() const = 0;
        virtual Matrix<T> matrix() const = 0;
        virtual void set_forgetting(T const& lambda) = 0;
        virtual void discount(T const& lambda) = 0;
        virtual void inflate(T const& c, Regressor<T> a) = 0;
        virtual void reset(T const& variance, Regressor<T> theta) = 0;
        virtual void restart(T const& variance, Regressor<T> theta, T const& lambda) = 0;
        virtual Step<T> cap_row(Regressor<T> psi, T const& y, T const& lambda) = 0;
        virtual Removal<T> remove(Regressor<T> psi, T const& y, T const& w) = 0;
        virtual T variance(Index j) = 0;
        virtual T variance_along(Regressor<T> psi) = 0;
        virtual T information_along(Regressor<T> psi) = 0;
        virtual T watched_variance(Index j) = 0;
        virtual bool symmetric_within(T const& share, Index i, Index j) = 0;
        virtual T const* root_lambda() = 0;
        virtual Index window_rows() const = 0;
        virtual bool follows_a_rule() const = 0;
        virtual bool set_aside() const = 0;
        virtual bool restarted() const = 0;
        virtual bool determined() = 0;
        virtual CompositionCounts counts() const = 0;
        virtual GuardSignal signal() const = 0;
        virtual std::string_view variant_name() const = 0;
        virtual void describe_state(detail::EntryVisitor to) const = 0;
        virtual void walk_state(detail::Measuring& to) const = 0;
        virtual void walk_state(detail::Writing& to) const = 0;
        virtual void walk_state(detail::Reading& to) = 0;
    };

    /// The variant of that name, which must exist in T. Throws std::invalid_argument as the variant does, or for
    /// another name.
    explicit AnyAdaptive(Problem<T> const& problem, std::string_view variant = "ud")
        : filter_(named(variant, problem)) {}
    /// A copy of this filter; a function, since a constructor from anything would ask whether AnyAdaptive is a filter
    /// to know what it is.
    template <class F>
    static AnyAdaptive around(F const& filter) {
        return AnyAdaptive(interface_around(filter));
    }
    template <class F>
    static std::unique_ptr<Interface> interface_around(F const& filter) {
        return std::make_unique<Around<F>>(filter);
    }
    AnyAdaptive(AnyAdaptive const& other) : filter_(other.filter_->clone()) {}
    AnyAdaptive(AnyAdaptive&&) noexcept = default;
    AnyAdaptive& operator=(AnyAdaptive&&) noexcept = default;
    /// Of the same type in place, without the heap: a window starts anew so.
    AnyAdaptive& operator=(AnyAdaptive const& other) {
        if (!filter_ || !filter_->assign(*other.filter_)) filter_ = other.filter_->clone();
        return *this;
    }

    Step<T> update(Regressor<T> psi, T y) { return filter_->update(psi, y); }
    /// As rlslab::process, without the heap but for what takes blocks.
    Step<T> process(Rows const& psi, View const& y) { return filter_->process(psi, y); }
    Step<T> pass_time(StateVector<T>& scratch) { return filter_->pass_time(scratch); }
    Innovation<T> look(Regressor<T> psi, T y) { return filter_->look(psi, y); }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) { return filter_->commit(row, psi, y); }
    View theta() const { return filter_->theta(); }
    View gain() const { return filter_->gain(); }
    Stored<T> stored() const { return filter_->stored(); }
    Matrix<T> matrix() const { return filter_->matrix(); }  ///< P, or P^-1: as stored() has it
    AnyForm<T> form() { return {*filter_}; }
    Abilities abilities() const { return filter_->abilities(); }
    T const* root_lambda() { return filter_->root_lambda(); }  ///< of the form; null where it holds none
    bool determined() { return filter_->determined(); }        ///< theta, where nothing is composed around the form

    /// What Assessed asks for.
    Index rows() const { return filter_->window_rows(); }
    Index refactored() const { return composition_counts().refactored; }
    bool follows_a_rule() const { return filter_->follows_a_rule(); }
    bool set_aside() const { return filter_->set_aside(); }
    bool restarted() const { return filter_->restarted(); }
    CompositionCounts composition_counts() const { return filter_->counts(); }
    GuardSignal signal() const { return filter_->signal(); }

    /// For rlslab::save and load.
    std::string_view variant_name() const { return filter_->variant_name(); }
    void describe_state(detail::EntryVisitor to) const { filter_->describe_state(to); }
    template <class To>
    void walk_state(To& to) const {
        std::as_const(*filter_).walk_state(to);
    }
    void walk_state(detail::Reading& to) { filter_->walk_state(to); }

    /// Instead of those by form: what is inside may have its own.
    friend T variance(AnyAdaptive& f, Index j) { return f.filter_->variance(j); }
    friend T variance_along(AnyAdaptive& f, Regressor<T> psi) { return f.filter_->variance_along(psi); }
    friend T watched_variance(AnyAdaptive& f, Index j) { return f.filter_->watched_variance(j); }
    friend bool symmetric_within(AnyAdaptive& f, T const& share, Index i, Index j) {
        return f.filter_->symmetric_within(share, i, j);
    }
    friend void restart(AnyAdaptive& f, T const& variance, Regressor<T> theta, T const& lambda) {
        f.filter_->restart(variance, theta, lambda);
    }
    friend Step<T> cap_row(AnyAdaptive& f, Regressor<T> psi, T const& y, T const& lambda) {
        return f.filter_->cap_row(psi, y, lambda);
    }

private:
    template <class F>
    struct Around;
    std::unique_ptr<Interface> filter_;

    explicit AnyAdaptive(std::unique_ptr<Interface> filter) : filter_(std::move(filter)) {}
    static std::unique_ptr<Interface> named(std::string_view variant, Problem<T> const& problem);
};

template <Real T>
template <class F>
struct AnyAdaptive<T>::Around final : Interface {
    F f;
    static constexpr bool views_theta = !std::same_as<decltype(f.theta()), Vector<T>>,
                          views_gain = !std::same_as<decltype(f.gain()), Vector<T>>;
    mutable StateVector<T> theta_, gain_;  // where f solves for them
    explicit Around(F const& filter)
        : f(filter), theta_(views_theta ? 0 : f.theta().size()), gain_(views_gain ? 0 : f.theta().size()) {}

    [[noreturn]] static void cannot() { throw std::logic_error("no such operation: " + std::string(F::name)); }

    std::unique_ptr<Interface> clone() const override { return std::make_unique<Around>(f); }
    bool assign(Interface const& other) override {
        auto const* const same = dynamic_cast<Around const*>(&other);
        if (same) f = same->f;
        return same != nullptr;
    }
    Abilities abilities() const override { return abilities_by_type<F>; }
    /// flatten: the update inlined, as where a type is used; half of what the call costs at 4 parameters.
    [[gnu::flatten]] Step<T> update(Regressor<T> psi, T const& y) override { return f.update(psi, y); }
    Step<T> process(Rows const& psi, View const& y) override {
        if constexpr (TakesBlocks<F> || TakesRowsAtOnce<F>) return rlslab::process(f, psi, y);
        Step<T> last{undefined<T>(), undefined<T>(), undefined<RealOf<T>>()};
        for (Index k = 0; k < y.size(); ++k) {
            Regressor<T> const row(psi.col(k).data(), psi.rows());
            if constexpr (Accumulates<F>)
                if (k + 1 < y.size()) {
                    f.accumulate(row, y[k]);
                    continue;
                }
            last = f.update(row, y[k]);
        }
        return last;
    }
    Step<T> pass_time(StateVector<T>& scratch) override { return detail::pass_time(f, scratch); }
    Innovation<T> look(Regressor<T> psi, T const& y) override {
        if constexpr (Guardable<F>) return detail::look_at(f, psi, y);
        else cannot();
    }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) override {
        return detail::commit(f, row, psi, y);
    }
    View theta() const override {
        if constexpr (views_theta) {
            return f.theta();
        } else {
            detail::theta_of(f, theta_);
            return theta_.view();
        }
    }
    View gain() const override {
        if constexpr (views_gain) {
            return f.gain();
        } else {
            detail::gain_of(f, gain_);
            return gain_.view();
        }
    }
    Stored<T> stored() const override { return f.stored(); }
    Matrix<T> matrix() const override { return detail::reported_matrix(f); }
    void set_forgetting(T const& lambda) override {
        using rlslab::set_forgetting;
        if constexpr (TimeUpdates<F>) set_forgetting(f, lambda);
        else cannot();
    }
    void discount(T const& lambda) override {
        using rlslab::discount;
        if constexpr (TimeUpdates<F>) discount(f, lambda);
        else cannot();
    }
    void inflate(T const& c, Regressor<T> a) override {
        using rlslab::inflate;
        if constexpr (Inflates<F>) inflate(f, c, a);
        else cannot();
    }
    void reset(T const& variance, Regressor<T> theta) override {
        using rlslab::reset;
        if constexpr (TimeUpdates<F>) reset(f, variance, theta);
        else cannot();
    }
    void restart(T const& variance, Regressor<T> theta, T const& lambda) override {
        using rlslab::restart;
        if constexpr (Guardable<F>) restart(f, variance, theta, lambda);
        else cannot();
    }
    Step<T> cap_row(Regressor<T> psi, T const& y, T const& lambda) override {
        using rlslab::cap_row;
        if constexpr (Guardable<F>) return cap_row(f, psi, y, lambda);
        else cannot();
    }
    Removal<T> remove(Regressor<T> psi, T const& y, T const& w) override {
        using rlslab::remove;
        if constexpr (Downdates<F>) return remove(f, psi, y, w);
        else cannot();
    }
    T variance(Index j) override {
        using rlslab::variance;
        if constexpr (reports_variances<F>) return variance(f, j);
        else cannot();
    }
    T variance_along(Regressor<T> psi) override {
        using rlslab::variance_along;
        if constexpr (reports_variances<F>) return variance_along(f, psi);
        else cannot();
    }
    T information_along(Regressor<T> psi) override {
        using rlslab::information_along;
        if constexpr (ReportsInformationAlong<F>) return information_along(f, psi);
        else cannot();
    }
    T watched_variance(Index j) override {
        using rlslab::watched_variance;
        if constexpr (Guardable<F>) return watched_variance(f, j);
        else cannot();
    }
    /// True of what cannot lose it: a guard then finds nothing, as where it does not look.
    bool symmetric_within(T const& share, Index i, Index j) override {
        using rlslab::symmetric_within;
        if constexpr (requires { symmetric_within(f, share, i, j); }) return symmetric_within(f, share, i, j);
        else return true;
    }
    T const* root_lambda() override { return detail::root_lambda_of(f); }
    Index window_rows() const override { return detail::window_rows(f); }
    bool follows_a_rule() const override { return detail::has_a_rule(f); }
    bool set_aside() const override { return detail::guard_of(f).set_aside(); }
    bool restarted() const override { return detail::guard_of(f).restarted(); }
    bool determined() override {
        if constexpr (requires { f.form().lengths, f.form().D; })
            return f.form().lengths.determined(f.form().L, f.form().D);
        else if constexpr (requires { f.form().lengths; }) return f.form().lengths.determined(f.form().L);
        else return true;
    }
    CompositionCounts counts() const override {
        CompositionCounts out;
        if constexpr (requires { f.filter().composition_counts(); }) out = f.filter().composition_counts();
        if constexpr (requires { f.since(); }) out.refactored = f.refactored(), out.since = f.since();
        if constexpr (requires { f.counts().windups; }) {
            GuardCounts const& n = f.counts();
            out.unusable = n.unusable, out.outliers = n.outliers, out.changes = n.changes, out.windups = n.windups;
            out.breakdowns = n.breakdowns;
        }
        return out;
    }
    GuardSignal signal() const override {
        if constexpr (requires { f.signal(); }) return f.signal();
        else return GuardSignal::none;
    }
    std::string_view variant_name() const override { return detail::variant_of(f); }
    void describe_state(detail::EntryVisitor to) const override { detail::describe(to, f); }
    void walk_state(detail::Measuring& to) const override { detail::walk(to, f); }
    void walk_state(detail::Writing& to) const override { detail::walk(to, f); }
    void walk_state(detail::Reading& to) override { detail::walk(to, f); }
};

// src/catalogue/native/compose.cpp, compiled for both arithmetics, defines these.
template <>
std::unique_ptr<AnyAdaptive<float>::Interface> AnyAdaptive<float>::named(std::string_view, Problem<float> const&);
template <>
std::unique_ptr<AnyAdaptive<double>::Interface> AnyAdaptive<double>::named(std::string_view, Problem<double> const&);

// --- a form that only the run knows ----------------------------------------------------------------------------------

template <Real T>
void set_forgetting(AnyForm<T> f, T const& lambda) {
    f.filter.set_forgetting(lambda);
}
template <Real T>
void discount(AnyForm<T> f, T const& lambda) {
    f.filter.discount(lambda);
}
template <Real T>
void inflate(AnyForm<T> f, T const& c, Regressor<T> a) {
    f.filter.inflate(c, a);
}
template <Real T>
void reset(AnyForm<T> f, T const& variance, Regressor<T> theta) {
    f.filter.reset(variance, theta);
}
template <Real T>
Removal<T> remove(AnyForm<T> f, Regressor<T> psi, T const& y, T const& w) {
    return f.filter.remove(psi, y, w);
}
template <Real T>
T variance(AnyForm<T> f, Index j) {
    return f.filter.variance(j);
}
template <Real T>
T variance_along(AnyForm<T> f, Regressor<T> psi) {
    return f.filter.variance_along(psi);
}
template <Real T>
T information_along(AnyForm<T> f, Regressor<T> psi) {
    return f.filter.information_along(psi);
}
template <Real T>
T watched_variance(AnyForm<T> f, Index j) {
    return f.filter.watched_variance(j);
}
template <Real T>
bool symmetric_within(AnyForm<T> f, T const& share, Index i, Index j) {
    return f.filter.symmetric_within(share, i, j);
}

}  // namespace rlslab
