// A filter of any type behind the native interface: one virtual call, and no row on the heap.
#pragma once

#include <rlslab/catalogue/native/adaptive.hpp>
#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/core/process.hpp>

#include <functional>

namespace rlslab::native {

[[noreturn]] inline void refuse(std::string const& why) { throw std::invalid_argument(why); }

/// Why bytes are no state for a filter, and of what they are one.
std::string refusal_of(StateFault fault, std::span<std::byte const> from);

/// F is a variant, or AnyAdaptive, which is any composition.
template <class F>
class FilterOf final : public Filter {
    using T = typename F::scalar;
    static constexpr Index block = 64;  // rows of another arithmetic that are rounded at a time

    std::shared_ptr<std::function<F()> const> make_;  // of all copies: for reset()
    F filter_;
    mutable StateVector<T> row_;  // a row in T; theta and the gain where the variant solves for them
    std::vector<T> rows_;         // of another arithmetic, from the first block of them on
    std::int64_t taken_ = 0;
    Health health_ = Health::sound;

    Index d() const { return row_.size(); }
    /// Of the forms that start without a prior.
    bool determined() {
        if constexpr (requires { filter_.form().lengths, filter_.form().D; })
            return filter_.form().lengths.determined(filter_.form().L, filter_.form().D);
        else if constexpr (requires { filter_.form().lengths; })
            return filter_.form().lengths.determined(filter_.form().L);
        else return true;
    }
    Step reported(rlslab::Step<T> const& s) {
        health_ = s.health;
        return {double(s.innovation), double(s.residual), double(s.gamma), std::int32_t(s.health), signal()};
    }
    /// flatten: the update inlined, as where a type is used; half of what the call costs at 4 parameters.
    template <class X>
    [[gnu::flatten]] Step one(X const* psi, X y) {
        ++taken_;
        if constexpr (std::same_as<X, T>) {
            return reported(filter_.update(Regressor<T>(psi, d()), y));
        } else {
            for (Index i = 0; i < d(); ++i) row_[i] = T(psi[i]);
            return reported(filter_.update(Regressor<T>(row_.data(), d()), T(y)));
        }
    }
    /// Rows of T without steps, as `process` takes them.
    Step all_at_once(T const* psi, Index rows, Index stride, T const* y) {
        if constexpr (TakesBlocks<F> || TakesRowsAtOnce<F>) {
            using Rows = Eigen::Map<Matrix<T> const, 0, Eigen::OuterStride<>>;
            taken_ += rows;
            return reported(process(filter_, Rows(psi, d(), rows, Eigen::OuterStride<>(stride)),
                                    Eigen::Map<Vector<T> const>(y, rows)));
        } else {
            if constexpr (Accumulates<F>)
                for (; rows > 1; --rows, psi += stride, ++y, ++taken_) filter_.accumulate(Regressor<T>(psi, d()), *y);
            Step last{};
            for (; rows > 0; --rows, psi += stride, ++y) last = one(psi, *y);
            return last;
        }
    }
    template <class X>
    Step many(X const* psi, Index rows, Index stride, X const* y, Step* steps) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        Index const size = d();
        if (stride == 0) stride = size;
        expects(rows >= 0 && stride >= size, "rows >= 0, each at least as many numbers apart as there are parameters");
        Step last{none, none, none, 0, 0};
        if (steps) {
            for (Index k = 0; k < rows; ++k) last = steps[k] = one(psi + k * stride, y[k]);
        } else if constexpr (std::same_as<X, T>) {
            if (rows > 0) last = all_at_once(psi, rows, stride, y);
        } else {
            Index at_once = block;
            if constexpr (TakesBlocks<F>) at_once = F::block;
            rows_.resize(std::size_t(at_once * (size + 1)));
            T* const outputs = rows_.data() + at_once * size;
            for (Index done = 0; done < rows; done += at_once) {
                Index const n = std::min(at_once, rows - done);
                for (Index k = 0; k < n; ++k) {
                    X const* const from = psi + (done + k) * stride;
                    for (Index i = 0; i < size; ++i) rows_[std::size_t(k * size + i)] = T(from[i]);
                    outputs[k] = T(y[done + k]);
                }
                last = all_at_once(rows_.data(), n, size, outputs);
            }
        }
        return last;
    }
    static void copy(auto const& numbers, double* out) {
        for (Index i = 0; i < numbers.size(); ++i) out[i] = double(numbers.data()[i]);
    }
    void copy_matrix(bool covariance_wanted, double* out) const {
        if (covariance_wanted != reports_covariance())
            refuse(std::string(variant()) + (covariance_wanted ? " reports information, not covariance"
                                                               : " reports covariance, not information"));
        copy(detail::reported_matrix(filter_), out);
    }

public:
    explicit FilterOf(std::function<F()> const& make)
        : make_(std::make_shared<std::function<F()> const>(make)), filter_(make()), row_(filter_.theta().size()) {}

    Index size() const override { return d(); }
    std::string_view variant() const override { return detail::variant_of(filter_); }
    std::string_view arithmetic() const override { return ArithmeticTraits<T>::name; }

    Step update(double const* psi, double y) override { return one(psi, y); }
    Step update(float const* psi, float y) override { return one(psi, y); }
    Step update_many(double const* psi, Index rows, Index stride, double const* y, Step* steps) override {
        return many(psi, rows, stride, y, steps);
    }
    Step update_many(float const* psi, Index rows, Index stride, float const* y, Step* steps) override {
        return many(psi, rows, stride, y, steps);
    }
    Step pass_time() override {
        if constexpr (requires { filter_.pass_time(row_); }) return reported(filter_.pass_time(row_));
        else return reported(detail::pass_time(filter_, row_));
    }

    void theta(double* out) const override {
        detail::theta_of(filter_, row_);
        copy(row_, out);
    }
    void gain(double* out) const override {
        detail::gain_of(filter_, row_);
        copy(row_, out);
    }
    bool reports_covariance() const override {
        if constexpr (ReportsCovariance<F>) return true;
        else if constexpr (ReportsInformation<F>) return false;
        else return filter_.stored().quantity == Stored<T>::Quantity::covariance;
    }
    void covariance(double* out) const override { copy_matrix(true, out); }
    void information(double* out) const override { copy_matrix(false, out); }

    std::size_t state_size() const override { return rlslab::state_size(filter_); }
    void save(std::span<std::byte> to) const override { rlslab::save(filter_, to); }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(filter_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
        taken_ = 0;
        detail::theta_of(filter_, row_);
        health_ = all_finite(row_) && determined() ? Health::sound : Health::undetermined;  // the state has no last row
    }

    std::int32_t health() const override { return std::int32_t(health_); }
    std::int32_t signal() const override {
        if constexpr (requires { filter_.signal(); }) return std::int32_t(filter_.signal());
        else return 0;
    }
    Counts counts() const override {
        Counts out{.rows = taken_};
        if constexpr (requires { filter_.composition_counts(); }) {
            CompositionCounts const n = filter_.composition_counts();
            out.unusable = n.unusable, out.outliers = n.outliers, out.changes = n.changes, out.windups = n.windups;
            out.breakdowns = n.breakdowns, out.refactored = n.refactored, out.since = n.since;
        }
        return out;
    }
    void reset() override {
        filter_ = (*make_)();
        taken_ = 0;
        health_ = Health::sound;
    }
    std::unique_ptr<Filter> clone() const override { return std::make_unique<FilterOf>(*this); }
};

}  // namespace rlslab::native
