// A fleet in lockstep behind the interface of plain numbers.
#pragma once

#include <rlslab/catalogue/native/makers.hpp>
#include <rlslab/core/complex.hpp>
#include <rlslab/many/fleet_steps.hpp>
#include <rlslab/state/state.hpp>

namespace rlslab::native {

/// Filters: rlslab::Fleet, whose rows come by columns, or OutputFleet; of variants over packs.
template <class Filters>
class FleetOf final : public Fleet {
    using N = typename Filters::number;
    using T = RealOf<N>;
    using Told = std::conditional_t<ComplexScalar<N>, ComplexStep, native::Step>;
    static constexpr Index parts = ComplexScalar<N> ? 2 : 1;
    static constexpr bool by_columns =
        requires(Filters& f, Matrix<N> const& psi, Vector<N> const& y) { f.update(psi, y); };
    Filters filters_;
    Matrix<N> psi_ = {}, y_ = {};  // a row of all filters that is not in place
    Vector<T> w_ = {};
    FleetSteps<N> steps_{0};

    static auto wide(N const& x) {
        if constexpr (ComplexScalar<N>) return std::complex<double>(double(x.re), double(x.im));
        else return double(x);
    }
    /// In place where they are of this arithmetic: may_alias.
    template <class X>
    static auto const* in_arithmetic(X const* from, Index count, auto& room) {
        using To = typename std::remove_cvref_t<decltype(room)>::Scalar;
        if constexpr (std::same_as<X, T>) return reinterpret_cast<To const*>(from);
        else {
            if (room.size() != count) room.resize(count, 1);
            for (Index i = 0; i < count; ++i) {
                if constexpr (ComplexScalar<To>) room.data()[i] = {T(from[2 * i]), T(from[2 * i + 1])};
                else room.data()[i] = T(from[i]);
            }
            return std::as_const(room).data();
        }
    }
    template <class X>
    Index take(X const* psi, X const* y, X const* w, bool reports) {
        FleetSteps<N>* const steps = reports ? &steps_ : nullptr;
        if constexpr (!by_columns) {
            return filters_.update(in_arithmetic(psi, filters() * size(), psi_),
                                   in_arithmetic(y, filters() * outputs(), y_),
                                   w ? in_arithmetic(w, filters(), w_) : nullptr, steps);
        } else {
            psi_.resize(filters(), size()), y_.resize(filters(), 1), w_.resize(w ? filters() : 0);
            for (Index m = 0; m < filters(); ++m) {
                T const root = w ? square_root(T(w[m])) : T(1);  // (1) and (3) of Weighted; NaN, a missing row: w < 0
                auto const weighed = [&](X x) { return !w ? T(x) : root == T(0) ? T(0) : T(root * T(x)); };
                for (Index i = 0; i < size(); ++i) psi_(m, i) = weighed(psi[m * size() + i]);
                y_(m, 0) = weighed(y[m]);
                if (w) w_[m] = root;
            }
            if (!steps) return filters_.update(psi_, y_.col(0));
            Index const missing = filters_.update(psi_, y_.col(0), *steps);
            for (Index m = 0; m < w_.size(); ++m)
                for (T* x : {&steps->innovation[m], &steps->residual[m]})
                    *x = w_[m] == T(0) ? undefined<T>() : T(*x / w_[m]);
            return missing;
        }
    }

public:
    FleetOf(Index outputs, Problem<N> const& problem, Filters&& filters)
        : Fleet({problem.size, filters.filters(), outputs, ComplexScalar<N>, Filters::name, ArithmeticTraits<T>::name}),
          filters_(std::move(filters)) {}

    Index update(Rows const& rows) override {
        auto const* const given = std::get_if<Told*>(&rows.steps);
        Told* to = given ? *given : nullptr;
        if (to && steps_.filters() == 0) steps_.resize(filters(), outputs());
        Index missing = 0;
        auto const take_all = [&]<class X>(X const* psi) {
            X const *y = std::get<X const*>(rows.y), *w = rows.weighs() ? std::get<X const*>(rows.weights) : nullptr;
            for (Index k = 0; k < rows.count; ++k) {
                missing += take(psi, y, w, to);
                psi += parts * filters() * size(), y += parts * filters() * outputs();
                if (w) w += filters();
                for (Index i = 0; to && i < filters() * outputs(); ++i)
                    *to++ = {wide(steps_.innovation[i]), wide(steps_.residual[i]), double(steps_.gamma[i / outputs()]),
                             std::int32_t(steps_.health[size_t(i)]), 0};
            }
        };
        std::visit(take_all, rows.psi);
        return missing;
    }
    bool matrix(Index filter, double* out) const override {
        auto const one = filters_.filter(filter);
        constexpr bool covariance = ReportsCovariance<std::remove_const_t<decltype(one)>>;
        if (!out) return covariance;
        if constexpr (covariance) copy(one.covariance(), out);
        else copy(one.information(), out);
        return covariance;
    }
    std::int32_t health(Index filter, double* theta) const override {
        if (theta) copy(Matrix<N>(filters_.theta(filter).transpose()), theta);
        return std::int32_t(filters_.health(filter));
    }
    void reset(Index filter) override { filters_.reset(filter); }
    std::size_t save(std::span<std::byte> to) const override {
        return to.empty() ? rlslab::state_size(filters_) : rlslab::save(filters_, to);
    }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(filters_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
    }
    std::unique_ptr<Fleet> clone() const override { return std::make_unique<FleetOf>(*this); }

private:
    static void copy(Matrix<N> const& from, double* to) {
        for (Index i = 0; i < from.size(); ++i) {
            N const x = from.data()[i];
            *to++ = double(real_part(x));
            if constexpr (ComplexScalar<N>) *to++ = double(x.im);
        }
    }
};

}  // namespace rlslab::native
