// A filter by name: plain numbers in and out of the one arithmetic or the other.
#include <rlslab/catalogue/native/compose.hpp>
#include <rlslab/catalogue/native/makers.hpp>

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
    StateVector<T> row_;   // a row in T
    std::vector<T> rows_;  // of another arithmetic, from the first block of them on
    std::int64_t taken_ = 0;
    Health health_ = Health::sound;

    Step reported(rlslab::Step<T> const& s) {
        health_ = s.health;
        return {double(s.innovation), double(s.residual), double(s.gamma), std::int32_t(s.health), signal()};
    }
    Step all_at_once(T const* psi, Index rows, Index stride, T const* y) {
        taken_ += rows;
        return reported(filter_.process({psi, size(), rows, Eigen::OuterStride<>(stride)}, {y, rows}));
    }

public:
    explicit In(std::function<AnyAdaptive<T>()> const& make)
        : make_(std::make_shared<std::function<AnyAdaptive<T>()> const>(make)), filter_(make()),
          can_(filter_.abilities()), row_(filter_.theta().size()) {}

    AnyAdaptive<T> const& filter() const { return filter_; }
    Index size() const { return row_.size(); }
    template <class X>
    Step update(X const* psi, X y) {
        ++taken_;
        if constexpr (std::same_as<X, T>) {
            return reported(filter_.update(Regressor<T>(psi, size()), y));
        } else {
            for (Index i = 0; i < size(); ++i) row_[i] = T(psi[i]);
            return reported(filter_.update(Regressor<T>(row_.data(), size()), T(y)));
        }
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
            rows_.resize(std::size_t(at_once * (size() + 1)));
            T* const outputs = rows_.data() + at_once * size();
            for (Index done = 0; done < rows; done += at_once) {
                Index const n = std::min(at_once, rows - done);
                for (Index k = 0; k < n; ++k) {
                    X const* const from = psi + (done + k) * stride;
                    for (Index i = 0; i < size(); ++i) rows_[std::size_t(k * size() + i)] = T(from[i]);
                    outputs[k] = T(y[done + k]);
                }
                last = all_at_once(rows_.data(), n, size(), outputs);
            }
        }
        return last;
    }
    Step pass_time() { return reported(filter_.pass_time(row_)); }
    void load(std::span<std::byte const> from) {
        if (StateFault const fault = rlslab::load(filter_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
        taken_ = 0;
        detail::theta_of(filter_, row_);
        bool const known = all_finite(row_) && filter_.determined();
        health_ = known ? Health::sound : Health::undetermined;  // the state has no last row
    }
    std::int32_t health() const { return std::int32_t(health_); }
    std::int32_t signal() const { return can_.signals ? std::int32_t(filter_.signal()) : 0; }
    Counts counts() const {
        CompositionCounts const n = filter_.composition_counts();
        return {taken_, n.unusable, n.outliers, n.changes, n.windups, n.breakdowns, n.refactored, n.since};
    }
    void reset() {
        filter_ = (*make_)();
        taken_ = 0;
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
Step Filter::pass_time() {
    return of(*this, [](auto& in) { return in.pass_time(); });
}
void Filter::theta(double* out) const {
    of(*this, [=](auto const& in) { copy(in.filter().theta(), out); });
}
void Filter::gain(double* out) const {
    of(*this, [=](auto const& in) { copy(in.filter().gain(), out); });
}
bool Filter::reports_covariance() const {
    return of(*this, [](auto const& in) { return in.filter().matrix_is_covariance(); });
}
void Filter::covariance(double* out) const { copy_matrix(*this, true, out); }
void Filter::information(double* out) const { copy_matrix(*this, false, out); }
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
