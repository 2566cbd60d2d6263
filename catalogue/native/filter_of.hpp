// A filter of any type behind the native interface: one virtual call, and no row on the heap.
#pragma once

#include <rlslab/adapt/guard.hpp>
#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/state/state.hpp>

#include <stdexcept>
#include <string>

namespace rlslab::native {

template <class F>
class FilterOf final : public Filter {
    using T = typename F::scalar;
    static constexpr Index block = 64;  // rows of another arithmetic that are rounded at a time
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    F made_, filter_;
    StateVector<T> row_;
    std::vector<T> rows_;  // of another arithmetic, from the first block of them on
    std::int64_t taken_ = 0;
    Health health_ = Health::sound;

    GuardSignal last_signal() const {
        if constexpr (requires { filter_.signal(); }) return filter_.signal();
        else return GuardSignal::none;
    }
    Step reported(rlslab::Step<T> const& s) {
        health_ = s.health;
        return {double(s.innovation), double(s.residual), double(s.gamma), std::int32_t(s.health),
                std::int32_t(last_signal())};
    }
    template <class X>
    Step one(X const* psi, X y) {
        ++taken_;
        if constexpr (std::same_as<X, T>) {
            return reported(filter_.update(Regressor<T>(psi, row_.size()), y));
        } else {
            for (Index i = 0; i < row_.size(); ++i) row_[i] = T(psi[i]);
            return reported(filter_.update(Regressor<T>(row_.data(), row_.size()), T(y)));
        }
    }
    /// Rows of T without steps, as `process` takes them.
    Step all_at_once(T const* psi, Index rows, Index stride, T const* y) {
        if constexpr (TakesBlocks<F> || TakesRowsAtOnce<F>) {
            Eigen::Map<Matrix<T> const, 0, Eigen::OuterStride<>> const rows_of(psi, row_.size(), rows,
                                                                               Eigen::OuterStride<>(stride));
            taken_ += rows;
            return reported(process(filter_, rows_of, Eigen::Map<Vector<T> const>(y, rows)));
        } else {
            if constexpr (Accumulates<F>)
                for (; rows > 1; --rows, psi += stride, ++y, ++taken_)
                    filter_.accumulate(Regressor<T>(psi, row_.size()), *y);
            Step last{};
            for (; rows > 0; --rows, psi += stride, ++y) last = one(psi, *y);
            return last;
        }
    }
    template <class X>
    Step many(X const* psi, Index rows, Index stride, X const* y, Step* steps) {
        Index const d = row_.size();
        if (stride == 0) stride = d;
        expects(rows >= 0 && stride >= d, "rows >= 0, each at least as many numbers apart as there are parameters");
        Step last{none, none, none, 0, 0};
        if (steps) {
            for (Index k = 0; k < rows; ++k) last = steps[k] = one(psi + k * stride, y[k]);
        } else if constexpr (std::same_as<X, T>) {
            if (rows > 0) last = all_at_once(psi, rows, stride, y);
        } else {
            Index at_once = block;
            if constexpr (TakesBlocks<F>) at_once = F::block;
            rows_.resize(size_t(at_once * (d + 1)));
            T* const outputs = rows_.data() + at_once * d;
            for (Index done = 0; done < rows; done += at_once) {
                Index const n = std::min(at_once, rows - done);
                for (Index k = 0; k < n; ++k) {
                    X const* const from = psi + (done + k) * stride;
                    for (Index i = 0; i < d; ++i) rows_[size_t(k * d + i)] = T(from[i]);
                    outputs[k] = T(y[done + k]);
                }
                last = all_at_once(rows_.data(), n, d, outputs);
            }
        }
        return last;
    }
    static void copy(auto const& numbers, double* out) {
        for (Index i = 0; i < numbers.size(); ++i) out[i] = double(numbers.data()[i]);
    }
    void copy_matrix(bool covariance_wanted, double* out) const {
        if (covariance_wanted != reports_covariance())
            throw std::invalid_argument(std::string(variant()) + (covariance_wanted
                                                                      ? " reports information, not covariance"
                                                                      : " reports covariance, not information"));
        if constexpr (ReportsCovariance<F>) copy(Matrix<T>(filter_.covariance()), out);
        else copy(Matrix<T>(filter_.information()), out);
    }

public:
    explicit FilterOf(F const& filter) : made_(filter), filter_(filter), row_(filter.theta().size()) {}

    Index size() const override { return row_.size(); }
    std::string_view variant() const override { return F::name; }
    std::string_view arithmetic() const override { return ArithmeticTraits<T>::name; }

    Step update(double const* psi, double y) override { return one(psi, y); }
    Step update(float const* psi, float y) override { return one(psi, y); }
    Step update_many(double const* psi, Index rows, Index stride, double const* y, Step* steps) override {
        return many(psi, rows, stride, y, steps);
    }
    Step update_many(float const* psi, Index rows, Index stride, float const* y, Step* steps) override {
        return many(psi, rows, stride, y, steps);
    }
    Step pass_time() override { return reported(detail::pass_time(filter_, row_)); }

    void theta(double* out) const override { copy(filter_.theta(), out); }
    void gain(double* out) const override { copy(filter_.gain(), out); }
    bool reports_covariance() const override { return ReportsCovariance<F>; }
    void covariance(double* out) const override { copy_matrix(true, out); }
    void information(double* out) const override { copy_matrix(false, out); }

    std::size_t state_size() const override { return rlslab::state_size(filter_); }
    void save(std::span<std::byte> to) const override { rlslab::save(filter_, to); }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(filter_, from); fault != StateFault::none)
            throw std::invalid_argument("the state is " + std::string(name_of(fault)));
        taken_ = 0;
        health_ = Health::sound;
    }

    std::int32_t health() const override { return std::int32_t(health_); }
    std::int32_t signal() const override { return std::int32_t(last_signal()); }
    Counts counts() const override { return {.rows = taken_}; }
    void reset() override {
        filter_ = made_;
        taken_ = 0;
        health_ = Health::sound;
    }
    std::unique_ptr<Filter> clone() const override { return std::make_unique<FilterOf>(*this); }
};

}  // namespace rlslab::native
