// A filter by name: plain numbers in and out of the one arithmetic or the other.
#include <rlslab/catalogue/native/compose.hpp>
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>

#include <variant>

namespace rlslab::native {
namespace {

/// A filter of T, and what is reported of it.
template <Real T>
class In {
    static constexpr Index block = 64;  // rows of another arithmetic that are rounded at a time

    std::shared_ptr<std::function<AnyAdaptive<T>()> const> make_;  // of all copies: for reset()
    AnyAdaptive<T> filter_;
    Abilities can_;
    StateVector<T> row_;        // a row in T
    T by_ = T(1);               // what the gain is multiplied by: the last row's root of its weight
    bool passed_over_ = false;  // the last row, whose weight is none
    std::vector<T> rows_;       // of another arithmetic, from the first block of them on
    std::int64_t taken_ = 0;
    Health health_ = Health::sound;

    Step reported(rlslab::Step<T> const& s) {
        health_ = s.health;
        return {double(s.innovation), double(s.residual), double(s.gamma), std::int32_t(s.health), signal()};
    }
    void plain() {
        by_ = T(1);
        passed_over_ = false;
    }
    template <class X>
    Regressor<T> in_T(X const* psi) {
        if constexpr (std::same_as<X, T>) return {psi, size()};
        for (Index i = 0; i < size(); ++i) row_[i] = T(psi[i]);
        return {row_.data(), size()};
    }
    /// Row k of those that are taken together next, times `by`.
    template <class X>
    void gather(Index k, X const* psi, X y, T const& by) {
        Index const at_once = can_.block > 0 ? can_.block : block;
        rows_.resize(std::size_t(at_once * (size() + 1)));
        for (Index i = 0; i < size(); ++i) rows_[std::size_t(k * size() + i)] = by * T(psi[i]);
        rows_[std::size_t(at_once * size() + k)] = by * T(y);
    }
    Step all_gathered(Index rows) {
        Index const at_once = can_.block > 0 ? can_.block : block;
        return all_at_once(rows_.data(), rows, size(), rows_.data() + at_once * size());
    }
    void expect_a_root(char const* without) const {
        if (!stores_a_root())
            refuse(std::string(filter_.variant_name()) + " stores no root: " + without +
                   "; potter, carlson, inverse_qr, ud " +
                   "and their delta forms, qr, gentleman, extended_qr and qr_block do");
    }
    Step all_at_once(T const* psi, Index rows, Index stride, T const* y) {
        taken_ += rows;
        plain();
        return reported(filter_.process({psi, size(), rows, Eigen::OuterStride<>(stride)}, {y, rows}));
    }

public:
    explicit In(std::function<AnyAdaptive<T>()> const& make)
        : make_(std::make_shared<std::function<AnyAdaptive<T>()> const>(make)), filter_(make()),
          can_(filter_.abilities()), row_(filter_.theta().size()) {}

    AnyAdaptive<T> const& filter() const { return filter_; }
    Abilities const& can() const { return can_; }
    bool stores_a_root() const { return filter_.stored().form == Stored<T>::Form::factor; }
    Index size() const { return row_.size(); }
    template <class X>
    Step update(X const* psi, X y) {
        ++taken_;
        plain();
        return reported(filter_.update(in_T(psi), T(y)));
    }
    template <class X>
    Step update(X const* psi, X y, X weight) {
        ++taken_;
        T const w = T(weight);
        passed_over_ = !(T(0) <= w && is_finite(w));
        return reported(detail::weighted_row(filter_, row_, by_, in_T(psi), T(y), w));
    }
    template <class X>
    Step update_many(X const* psi, Index rows, Index stride, X const* y, Step* steps) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        if (stride == 0) stride = size();
        expects(rows >= 0 && stride >= size(),
                "rows >= 0, each at least as many numbers apart as there are parameters");
        Step last{none, none, none, 0, 0};
        if (steps) {
            for (Index k = 0; k < rows; ++k) last = steps[k] = update(psi + k * stride, y[k]);
        } else if constexpr (std::same_as<X, T>) {
            if (rows > 0) last = all_at_once(psi, rows, stride, y);
        } else {
            Index const at_once = can_.block > 0 ? can_.block : block;
            for (Index done = 0; done < rows; done += at_once) {
                Index const n = std::min(at_once, rows - done);
                for (Index k = 0; k < n; ++k) gather(k, psi + (done + k) * stride, y[done + k], T(1));
                last = all_gathered(n);
            }
        }
        return last;
    }
    /// Rows of weights above 0 one after another are taken at once, as they come to the filter.
    template <class X>
    Step update_many(X const* psi, Index rows, Index stride, X const* y, X const* weights, Step* steps) {
        if (!weights) return update_many(psi, rows, stride, y, steps);
        if (stride == 0) stride = size();
        Step last = update_many(psi, 0, stride, y, nullptr);
        expects(rows >= 0, "rows >= 0");
        for (Index k = 0; k < rows; ++k) {
            Index n = 0;
            T by = T(1);
            while (!steps && n < (can_.block > 0 ? can_.block : block) && k + n < rows && T(0) < T(weights[k + n]) &&
                   is_finite(T(weights[k + n]))) {
                by = square_root(T(weights[k + n]));
                gather(n, psi + (k + n) * stride, y[k + n], by);
                ++n;
            }
            if (n == 0) {
                last = update(psi + k * stride, y[k], weights[k]);
                if (steps) steps[k] = last;
                continue;
            }
            last = all_gathered(n);
            last.innovation = double(T(T(last.innovation) / by));
            last.residual = double(T(T(last.residual) / by));
            by_ = by;
            k += n - 1;
        }
        return last;
    }
    Step pass_time() {
        plain();
        return reported(filter_.pass_time(row_));
    }
    Removal remove(double const* psi, double y, double weight) {
        if (!can_.downdates)
            refuse(std::string(filter_.variant_name()) +
                   (abilities_of(filter_.variant_name()).abilities.downdates
                        ? " with a window, a guard or a rule takes no row back: it does alone, or with probes"
                        : " takes no row back; all variants but kalman, extended_qr and qr_block do"));
        Regressor<T> const row = in_T(psi);
        T const output = T(y), w = T(weight);
        bool finite = is_finite(output) && is_finite(w) && T(0) <= w;
        for (Index i = 0; i < size(); ++i) finite = finite && is_finite(row[i]);
        if (!finite) return {double(undefined<T>()), double(undefined<T>())};
        if (w == T(0)) return {1, 1};
        auto const out = rlslab::remove(filter_, row, output, w);
        return {double(out.remaining), double(out.noise)};
    }
    void merge(In const& newer) {
        health_ = filter_.merge(newer.filter_);  // throws before anything has changed
        plain();
        if (newer.taken_ > 0) by_ = newer.by_;  // whose row is the last
        taken_ += newer.taken_;
    }
    void variance(double const* Psi, Index rows, Index stride, double* out) const {
        if (!can_.variances)
            refuse(std::string(filter_.variant_name()) +
                   " has psi'P psi not at hand; all variants but kalman, extended_qr and qr_block do");
        if (stride == 0) stride = size();
        expects(rows >= 0 && stride >= size(),
                "rows >= 0, each at least as many numbers apart as there are parameters");
        bool const known = filter_.determined();
        StateVector<T> row(size());
        for (Index k = 0; k < rows; ++k) {
            for (Index i = 0; i < size(); ++i) row[i] = T(Psi[k * stride + i]);
            T const along = known ? variance_along(filter_.form(), Regressor<T>(row.data(), size())) : undefined<T>();
            out[k] = double(along);
        }
    }
    void sample(std::uint64_t seed, Index n, double scale, double* out) const {
        expects(n >= 0 && 0 <= scale && is_finite(T(scale)), "n >= 0 draws, and a finite scale >= 0");
        expect_a_root("no draws");
        if constexpr (std::same_as<T, double>) return rlslab::sample(filter_, seed, n, scale, out);
        std::vector<T> draws(std::size_t(n * size()));
        rlslab::sample(filter_, seed, n, T(scale), draws.data());
        for (T const x : draws) *out++ = double(x);
    }
    Excitation least_excited(double* direction) const {
        expect_a_root("no least excited direction");
        std::vector<T> u(std::size_t(size()), T(0));
        auto const found = rlslab::least_excited(filter_, u.data());
        for (T const x : u) *direction++ = double(x);
        return {double(found.deviation), double(found.ratio)};
    }
    void gain(double* out) const {
        auto const K = filter_.gain();
        for (Index i = 0; i < size(); ++i) out[i] = double(T(by_ * K[i]));
    }
    void load(std::span<std::byte const> from) {
        if (StateFault const fault = rlslab::load(filter_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
        taken_ = 0;
        plain();
        detail::theta_of(filter_, row_);
        bool const known = all_finite(row_) && filter_.determined();
        health_ = known ? Health::sound : Health::undetermined;  // the state has no last row
    }
    std::int32_t health() const { return std::int32_t(health_); }
    std::int32_t signal() const { return can_.signals && !passed_over_ ? std::int32_t(filter_.signal()) : 0; }
    Counts counts() const {
        CompositionCounts const n = filter_.composition_counts();
        return {taken_, n.unusable, n.outliers, n.changes, n.windups, n.breakdowns, n.refactored, n.since};
    }
    void reset() {
        filter_ = (*make_)();
        taken_ = 0;
        plain();
        health_ = Health::sound;
    }
};

void copy(auto const& numbers, double* out) {
    for (Index i = 0; i < numbers.size(); ++i) out[i] = double(numbers.data()[i]);
}

}  // namespace

struct Filter::Inside final : Filter {
    std::variant<In<float>, In<double>> in;
    template <Real T>
    explicit Inside(std::function<AnyAdaptive<T>()> const& make) : in(std::in_place_type<In<T>>, make) {}
};

namespace {

/// What `work` answers of the In that f is.
decltype(auto) of(Filter& f, auto const& work) { return std::visit(work, static_cast<Filter::Inside&>(f).in); }
decltype(auto) of(Filter const& f, auto const& work) {
    return std::visit(work, static_cast<Filter::Inside const&>(f).in);
}
void copy_matrix(Filter const& f, bool covariance, double* out) {
    if (covariance != f.reports_covariance())
        refuse(std::string(f.variant()) +
               (covariance ? " reports information, not covariance" : " reports covariance, not information"));
    of(f, [=](auto const& in) { copy(in.filter().matrix(), out); });
}

}  // namespace

template <Real T>
std::unique_ptr<Filter> filter_of(std::function<AnyAdaptive<T>()> const& make) {
    return std::make_unique<Filter::Inside>(make);
}
template std::unique_ptr<Filter> filter_of(std::function<AnyAdaptive<float>()> const&);
template std::unique_ptr<Filter> filter_of(std::function<AnyAdaptive<double>()> const&);

Index Filter::size() const {
    return of(*this, [](auto const& in) { return in.size(); });
}
std::string_view Filter::variant() const {
    return of(*this, [](auto const& in) { return in.filter().variant_name(); });
}
std::string_view Filter::arithmetic() const {
    return of(*this, []<class T>(In<T> const&) { return ArithmeticTraits<T>::name; });
}
Step Filter::update(double const* psi, double y) {
    return of(*this, [=](auto& in) { return in.update(psi, y); });
}
Step Filter::update(float const* psi, float y) {
    return of(*this, [=](auto& in) { return in.update(psi, y); });
}
Step Filter::update_many(double const* psi, Index rows, Index stride, double const* y, Step* steps) {
    return of(*this, [=](auto& in) { return in.update_many(psi, rows, stride, y, steps); });
}
Step Filter::update_many(float const* psi, Index rows, Index stride, float const* y, Step* steps) {
    return of(*this, [=](auto& in) { return in.update_many(psi, rows, stride, y, steps); });
}
Step Filter::update(double const* psi, double y, double weight) {
    return of(*this, [=](auto& in) { return in.update(psi, y, weight); });
}
Step Filter::update(float const* psi, float y, float weight) {
    return of(*this, [=](auto& in) { return in.update(psi, y, weight); });
}
Step Filter::update_many(double const* psi, Index rows, Index stride, double const* y, double const* weights,
                         Step* steps) {
    return of(*this, [=](auto& in) { return in.update_many(psi, rows, stride, y, weights, steps); });
}
Step Filter::update_many(float const* psi, Index rows, Index stride, float const* y, float const* weights,
                         Step* steps) {
    return of(*this, [=](auto& in) { return in.update_many(psi, rows, stride, y, weights, steps); });
}
Removal Filter::remove(double const* psi, double y, double weight) {
    return of(*this, [=](auto& in) { return in.remove(psi, y, weight); });
}
bool Filter::downdates() const {
    return of(*this, [](auto const& in) { return in.can().downdates; });
}
void Filter::merge(Filter const& newer) {
    if (!of(*this, [](auto const& in) { return in.can().merges; }))
        refuse(std::string(variant()) + " does not merge; qr_block does");
    auto const kind = [](Filter const& f) {
        return std::string(f.variant()) + " in " + std::string(f.arithmetic()) + " with " + std::to_string(f.size()) +
               " parameters";
    };
    if (kind(newer) != kind(*this)) refuse("expected a part of " + kind(*this) + ", found " + kind(newer));
    of(*this, [&]<class T>(In<T>& in) { in.merge(std::get<In<T>>(static_cast<Inside const&>(newer).in)); });
}
Step Filter::pass_time() {
    return of(*this, [](auto& in) { return in.pass_time(); });
}
void Filter::theta(double* out) const {
    of(*this, [=](auto const& in) { copy(in.filter().theta(), out); });
}
void Filter::gain(double* out) const {
    of(*this, [=](auto const& in) { in.gain(out); });
}
bool Filter::reports_covariance() const {
    return of(*this, [](auto const& in) { return in.filter().matrix_is_covariance(); });
}
void Filter::covariance(double* out) const { copy_matrix(*this, true, out); }
void Filter::information(double* out) const { copy_matrix(*this, false, out); }
void Filter::variance(double const* Psi, Index rows, Index stride, double* out) const {
    of(*this, [=](auto const& in) { in.variance(Psi, rows, stride, out); });
}
void Filter::factor(double* out) const {
    of(*this, [=, this](auto const& in) { copy(root_in(in.filter().stored(), variant()), out); });
}
bool Filter::stores_a_root() const {
    return of(*this, [](auto const& in) { return in.stores_a_root(); });
}
void Filter::sample(std::uint64_t seed, Index n, double scale, double* out) const {
    of(*this, [=](auto const& in) { in.sample(seed, n, scale, out); });
}
Excitation Filter::least_excited(double* direction) const {
    return of(*this, [=](auto const& in) { return in.least_excited(direction); });
}
std::size_t Filter::state_size() const {
    return of(*this, [](auto const& in) { return rlslab::state_size(in.filter()); });
}
void Filter::save(std::span<std::byte> to) const {
    of(*this, [=](auto const& in) { rlslab::save(in.filter(), to); });
}
void Filter::load(std::span<std::byte const> from) {
    of(*this, [=](auto& in) { in.load(from); });
}
std::int32_t Filter::health() const {
    return of(*this, [](auto const& in) { return in.health(); });
}
std::int32_t Filter::signal() const {
    return of(*this, [](auto const& in) { return in.signal(); });
}
Counts Filter::counts() const {
    return of(*this, [](auto const& in) { return in.counts(); });
}
Index Filter::probes() const {
    return of(*this, [](auto const& in) { return in.filter().probe_count(); });
}
Certificate Filter::certificate() const {
    return of(*this, [](auto const& in) -> Certificate {
        if (in.filter().probe_count() == 0) refuse("the filter was made without probes: it has no certificate");
        auto const c = in.filter().certificate();
        return {c.estimate, c.bound, c.theta, c.definite};
    });
}
void Filter::reset() {
    of(*this, [](auto& in) { in.reset(); });
}
std::unique_ptr<Filter> Filter::clone() const { return std::make_unique<Inside>(static_cast<Inside const&>(*this)); }

}  // namespace rlslab::native
