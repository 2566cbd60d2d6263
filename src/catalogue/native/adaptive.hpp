// A filter of a variant that is named while the program runs, in one arithmetic, with all operations that windows,
// guards and rules need.
#pragma once

#include <rlslab/catalogue/native/composition.hpp>
#include <rlslab/catalogue/native/merging.hpp>

#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/certified.hpp>
#include <rlslab/adapt/determined.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/state/state.hpp>

#include <memory>
#include <variant>

namespace rlslab {

/// What a filter can do beside updates.
struct Abilities {
    bool form = false;         ///< discounts, resets, takes another lambda, reports variances
    bool inflates = false;     ///< takes P + c a a'
    bool downdates = false;    ///< takes a row back
    bool information = false;  ///< has psi'P^-1 psi at hand
    bool guardable = false;
    bool certifiable = false;  ///< takes probes
    bool variances = false;    ///< has P_jj and psi'P psi at hand
    bool signals = false;      ///< is a guard
    Index block = 0;           ///< rows that it takes at once; 0: one by one
    bool merges = false;       ///< appends the rows of another
};

template <class F>
inline constexpr bool reports_variances =
    requires(F& f, Regressor<typename F::scalar> psi) { variance(f, Index(0)), variance_along(f, psi); };
template <class F>
constexpr Abilities abilities_by_type() {
    Abilities out{.form = TimeUpdates<F> && reports_variances<F>,
                  .inflates = Inflates<F>,
                  .downdates = Downdates<F>,
                  .information = ReportsInformationAlong<F>,
                  .guardable = Guardable<F>,
                  .certifiable = Certifiable<F>,
                  .variances = reports_variances<F>};
    if constexpr (requires(F& f) { f.signal(); }) out.signals = true;
    if constexpr (TakesBlocks<F>) out.block = F::block;
    out.merges = Merges<F>;
    return out;
}

/// What adapt/ does to a filter beside updates, and what it measures: the function of that name in
/// <rlslab/adapt/time_update.hpp>, remove.hpp, diagnostics.hpp or determined.hpp. rows: as rlslab::process. merge: of a
/// part that merging.hpp expects.
enum class Verb {
    rows,
    set_forgetting,
    discount,
    inflate,
    reset,
    restart,
    cap_row,
    remove,
    pass_time,
    times,
    certify,
    merge
};
enum class Measure {
    variance,
    variance_along,
    information_along,
    watched_variance,
    symmetric_within,
    determined,
    forgetting
};

/// The word of the probes, and what multiplies them by P.
template <class T>
using ProbeWord = typename detail::ProbeOf<T>::type;
template <class T>
using ProbesTimes = detail::CovarianceTimes<std::span<StateVector<ProbeWord<T>>>>;

template <Real T>
class AnyAdaptive;

/// The form of a filter that only the run knows.
template <Real T>
struct AnyForm {
    using scalar = T;
    typename AnyAdaptive<T>::Interface& filter;

    friend void set_forgetting(AnyForm f, T const& lambda) { f.filter.act(Verb::set_forgetting, {.x = &lambda}); }
    friend void discount(AnyForm f, T const& lambda) { f.filter.act(Verb::discount, {.x = &lambda}); }
    friend void inflate(AnyForm f, T const& c, Regressor<T> a) { f.filter.act(Verb::inflate, {.x = &c, .psi = a}); }
    friend void reset(AnyForm f, T const& variance, Regressor<T> theta) {
        f.filter.act(Verb::reset, {.x = &variance, .psi = theta});
    }
    friend Removal<T> remove(AnyForm f, Regressor<T> psi, T const& y, T const& w) {
        return f.filter.act(Verb::remove, {.x = &w, .y = &y, .psi = psi}).removal;
    }
    friend T variance(AnyForm f, Index j) { return f.filter.measure(Measure::variance, {.j = j}); }
    friend T variance_along(AnyForm f, Regressor<T> psi) {
        return f.filter.measure(Measure::variance_along, {.psi = psi});
    }
    friend T information_along(AnyForm f, Regressor<T> psi) {
        return f.filter.measure(Measure::information_along, {.psi = psi});
    }
    friend T watched_variance(AnyForm f, Index j) { return f.filter.measure(Measure::watched_variance, {.j = j}); }
    friend bool symmetric_within(AnyForm f, T const& share, Index i, Index j) {
        return f.filter.measure(Measure::symmetric_within, {.x = &share, .i = i, .j = j}) == T(1);
    }
    friend T forgetting(AnyForm f) { return f.filter.measure(Measure::forgetting, {}); }
    friend void times_covariance(AnyForm f, ProbesTimes<T>& times) { f.filter.act(Verb::times, {.times = &times}); }
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
/// Whether that is P.
template <class F>
bool reports_covariance(F const& f) {
    if constexpr (ReportsCovariance<F> || ReportsInformation<F>) return ReportsCovariance<F>;
    else if constexpr (requires { f.matrix(); }) return f.matrix_is_covariance();
    else return reports_covariance(f.filter());
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

    struct Interface;
    /// Of a verb or a measure, as it needs them.
    struct Arguments {
        T const *x = nullptr, *y = nullptr;
        Regressor<T> psi{static_cast<T const*>(nullptr), 0};
        StateVector<T>* scratch = nullptr;
        Index i = 0, j = 0;
        ProbesTimes<T>* times = nullptr;             ///< of times
        Certificate<ProbeWord<T>>* found = nullptr;  ///< of certify
        Interface const* other = nullptr;            ///< of merge
    };
    struct Outcome {
        Step<T> step{};        ///< of rows, cap_row and pass_time; of merge the health alone
        Removal<T> removal{};  ///< of remove
    };
    /// What a filter says of itself, and Assessed asks for.
    struct Account {
        std::string_view variant;
        Abilities abilities;
        Index window_rows;
        bool follows_a_rule, set_aside, restarted, covariance;
        CompositionCounts counts = {};
        T const* root_lambda;  ///< of the form; null where it holds none
        Index probes;          ///< 0: none
    };
    enum class Part { theta, gain };
    using StateVisitor =
        std::variant<detail::EntryVisitor const*, detail::Measuring*, detail::Writing*, detail::Reading*>;

    struct Interface {
        virtual ~Interface() = default;
        /// In place, without the heap, where `to` is of the same type.
        virtual void copy_to(std::unique_ptr<Interface>& to) const = 0;
        virtual Account account() = 0;
        virtual GuardSignal signal() const = 0;
        virtual Step<T> update(Regressor<T> psi, T const& y) = 0;
        virtual Innovation<T> look(Regressor<T> psi, T const& y) = 0;
        virtual Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) = 0;
        virtual View view(Part part) const = 0;
        /// `whole`: F alone, P or P^-1 as it is reported.
        virtual Stored<T> stored(bool whole) const = 0;
        virtual Outcome act(Verb verb, Arguments const& with) = 0;
        virtual T measure(Measure what, Arguments const& with) = 0;
        virtual void show_state(StateVisitor const& to) = 0;
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
    AnyAdaptive(AnyAdaptive const& other) { other.filter_->copy_to(filter_); }
    AnyAdaptive(AnyAdaptive&&) noexcept = default;
    AnyAdaptive& operator=(AnyAdaptive&&) noexcept = default;
    /// Of the same type without the heap: a window starts anew so.
    AnyAdaptive& operator=(AnyAdaptive const& other) { return other.filter_->copy_to(filter_), *this; }

    Step<T> update(Regressor<T> psi, T y) { return filter_->update(psi, y); }
    /// As rlslab::process, without the heap but for what takes blocks.
    Step<T> process(Rows const& psi, View const& y) {
        Regressor<T> const first(psi.data(), psi.rows());
        return filter_->act(Verb::rows, {.y = y.data(), .psi = first, .i = y.size(), .j = psi.outerStride()}).step;
    }
    Step<T> pass_time(StateVector<T>& scratch) { return filter_->act(Verb::pass_time, {.scratch = &scratch}).step; }
    Innovation<T> look(Regressor<T> psi, T y) { return filter_->look(psi, y); }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) { return filter_->commit(row, psi, y); }
    View theta() const { return filter_->view(Part::theta); }
    View gain() const { return filter_->view(Part::gain); }
    Stored<T> stored() const { return filter_->stored(false); }
    Matrix<T> matrix() const { return filter_->stored(true).F; }  ///< P, or P^-1: as stored() has it
    bool matrix_is_covariance() const { return filter_->account().covariance; }
    AnyForm<T> form() const { return {*filter_}; }
    Abilities abilities() const { return filter_->account().abilities; }
    T const* root_lambda() { return filter_->account().root_lambda; }
    Index probe_count() const { return filter_->account().probes; }
    /// Of probes that there are.
    Certificate<ProbeWord<T>> certificate() const {
        Certificate<ProbeWord<T>> out;
        filter_->act(Verb::certify, {.found = &out});
        return out;
    }
    bool determined() const { return filter_->measure(Measure::determined, {}) == T(1); }
    /// Appends the rows of another of this type, as F does; throws std::invalid_argument for another, or where F does.
    Health merge(AnyAdaptive const& newer) {
        return filter_->act(Verb::merge, {.other = newer.filter_.get()}).step.health;
    }

    Index rows() const { return filter_->account().window_rows; }
    Index refactored() const { return composition_counts().refactored; }
    bool follows_a_rule() const { return filter_->account().follows_a_rule; }
    bool set_aside() const { return filter_->account().set_aside; }
    bool restarted() const { return filter_->account().restarted; }
    CompositionCounts composition_counts() const { return filter_->account().counts; }
    GuardSignal signal() const { return filter_->signal(); }

    /// For rlslab::save and load.
    std::string_view variant_name() const { return filter_->account().variant; }
    void describe_state(detail::EntryVisitor to) const { filter_->show_state(&to); }
    void walk_state(auto& to) const { filter_->show_state(&to); }

    /// What is inside may have its own.
    friend void restart(AnyAdaptive& f, T const& variance, Regressor<T> theta, T const& lambda) {
        f.filter_->act(Verb::restart, {.x = &variance, .y = &lambda, .psi = theta});
    }
    friend Step<T> cap_row(AnyAdaptive& f, Regressor<T> psi, T const& y, T const& lambda) {
        return f.filter_->act(Verb::cap_row, {.x = &lambda, .y = &y, .psi = psi}).step;
    }

private:
    template <class F>
    struct Around;
    std::unique_ptr<Interface> filter_;

    explicit AnyAdaptive(std::unique_ptr<Interface> filter) : filter_(std::move(filter)) {}
    static std::unique_ptr<Interface> named(std::string_view variant, Problem<T> const& problem);  // composing.hpp
};

template <Real T>
template <class F>
struct AnyAdaptive<T>::Around final : Interface {
    F f;
    static constexpr bool views_theta = !std::same_as<std::remove_cvref_t<decltype(f.theta())>, Vector<T>>,
                          views_gain = !std::same_as<std::remove_cvref_t<decltype(f.gain())>, Vector<T>>;
    mutable StateVector<T> theta_, gain_;  // where f solves for them
    explicit Around(F const& filter)
        : f(filter), theta_(views_theta ? 0 : f.theta().size()), gain_(views_gain ? 0 : f.theta().size()) {}

    [[noreturn]] static void cannot() { throw std::logic_error("no such operation: " + std::string(F::name)); }

    void copy_to(std::unique_ptr<Interface>& to) const override {
        if (auto* const same = dynamic_cast<Around*>(to.get())) same->f = f;
        else to = std::make_unique<Around>(f);
    }
    Account account() override {
        auto const& guard = detail::guard_of(f);
        Account out{.variant = detail::variant_of(f),
                    .abilities = abilities_by_type<F>(),
                    .window_rows = detail::window_rows(f),
                    .follows_a_rule = detail::has_a_rule(f),
                    .set_aside = guard.set_aside(),
                    .restarted = guard.restarted(),
                    .covariance = detail::reports_covariance(f),
                    .root_lambda = detail::root_lambda_of(f),
                    .probes = detail::probes_of(f)};
        if constexpr (requires { f.filter().composition_counts(); }) out.counts = f.filter().composition_counts();
        if constexpr (requires { f.since(); }) out.counts.refactored = f.refactored(), out.counts.since = f.since();
        if constexpr (requires { f.counts().windups; }) {
            GuardCounts const& n = f.counts();
            out.counts.unusable = n.unusable, out.counts.outliers = n.outliers, out.counts.changes = n.changes;
            out.counts.windups = n.windups, out.counts.breakdowns = n.breakdowns;
        }
        return out;
    }
    GuardSignal signal() const override {
        if constexpr (requires { f.signal(); }) return f.signal();
        else return GuardSignal::none;
    }
    /// flatten: the update inlined, as where a type is used; half of what the call costs at 4 parameters.
    [[gnu::flatten]] Step<T> update(Regressor<T> psi, T const& y) override { return f.update(psi, y); }
    Step<T> process(Rows const& psi, View const& y) {
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
    Innovation<T> look(Regressor<T> psi, T const& y) override {
        if constexpr (Guardable<F>) return detail::look_at(f, psi, y);
        else cannot();
    }
    Step<T> commit(Innovation<T> const& row, Regressor<T> psi, T const& y) override {
        return detail::commit(f, row, psi, y);
    }
    View view(Part part) const override {
        if (part == Part::theta) {
            if constexpr (views_theta) return f.theta();
            else return detail::theta_of(f, theta_), theta_.view();
        }
        if constexpr (views_gain) return f.gain();
        else return detail::gain_of(f, gain_), gain_.view();
    }
    Stored<T> stored(bool whole) const override {
        return whole ? Stored<T>{{}, {}, detail::reported_matrix(f)} : f.stored();
    }
    Outcome act(Verb verb, [[maybe_unused]] Arguments const& with) override {
        if (verb == Verb::rows)
            return {.step = process({with.psi.data(), with.psi.size(), with.i, Eigen::OuterStride<>(with.j)},
                                    {with.y, with.i})};
        if (verb == Verb::pass_time) return {.step = detail::pass_time(f, *with.scratch)};
        if constexpr (requires { f.certificate(); })
            if (verb == Verb::certify) return *with.found = f.certificate(), Outcome{};
        if constexpr (Certifiable<F>)
            if (verb == Verb::times) return (*with.times)(f.form()), Outcome{};
        if constexpr (TimeUpdates<F>) {
            if (verb == Verb::set_forgetting) return set_forgetting(f, *with.x), Outcome{};
            if (verb == Verb::discount) return discount(f, *with.x), Outcome{};
            if (verb == Verb::reset) return reset(f, *with.x, with.psi), Outcome{};
        }
        if constexpr (Inflates<F>)
            if (verb == Verb::inflate) return inflate(f, *with.x, with.psi), Outcome{};
        if constexpr (Guardable<F>) {
            if (verb == Verb::restart) return restart(f, *with.x, with.psi, *with.y), Outcome{};
            if (verb == Verb::cap_row) return {.step = cap_row(f, with.psi, *with.y, *with.x)};
        }
        if constexpr (Downdates<F>)
            if (verb == Verb::remove) return {.removal = remove(f, with.psi, *with.y, *with.x)};
        if constexpr (Merges<F>)
            if (verb == Verb::merge) {
                auto const* const part = dynamic_cast<Around const*>(with.other);
                expects(part != nullptr, "a part of the same type");
                expect_newer_part(f, part->f);
                return {.step = {T(0), T(0), RealOf<T>(1), part == this ? f.merge(F(f)) : f.merge(part->f)}};
            }
        cannot();
    }
    T measure(Measure what, [[maybe_unused]] Arguments const& with) override {
        if constexpr (reports_variances<F>) {
            if (what == Measure::variance) return variance(f, with.j);
            if (what == Measure::variance_along) return variance_along(f, with.psi);
        }
        if constexpr (Guardable<F>)
            if (what == Measure::watched_variance) return watched_variance(f, with.j);
        if constexpr (ReportsInformationAlong<F>)
            if (what == Measure::information_along) return information_along(f, with.psi);
        if (what == Measure::symmetric_within) {
            if constexpr (requires { symmetric_within(f, *with.x, with.i, with.j); })
                return T(symmetric_within(f, *with.x, with.i, with.j) ? 1 : 0);
            else return T(1);  // cannot lose it: a guard finds nothing, as where it does not look
        }
        if (what == Measure::determined) return T(detail::is_determined(f) ? 1 : 0);
        if constexpr (Certifiable<F>)
            if (what == Measure::forgetting) return detail::forgetting_of(f.form());
        cannot();
    }
    void show_state(StateVisitor const& visitor) override {
        auto const show = [this]<class To>(To* to) {
            if constexpr (std::same_as<To, detail::EntryVisitor const>) detail::describe(*to, f);
            else if constexpr (std::same_as<To, detail::Reading>) detail::walk(*to, f);
            else detail::walk(*to, std::as_const(f));
        };
        std::visit(show, visitor);
    }
};

}  // namespace rlslab
