// The guarded filters of one arithmetic: included where they are compiled.
#pragma once

#include "studies/adapt/watched.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

namespace rlslab::studies::detail {

template <class F>
concept HasGuard = requires(F const& f) { f.counts(); };

template <class F>
class WatchedAs : public Watched {
    using T = typename F::scalar;
    F filter_;
    std::vector<T> psi_;

    static F made(Problem<double> const& problem, double innovation) {
        Problem<T> const rounded = problem.mapped<T>([](double x) { return T(x); });
        if constexpr (HasGuard<F>) return F(rounded, {.innovation = T(innovation)});
        else return F(rounded);
    }

public:
    WatchedAs(Problem<double> const& problem, double innovation)
        : filter_(made(problem, innovation)), psi_(size_t(problem.size)) {}
    static std::unique_ptr<Watched> make(Problem<double> const& problem, double innovation) {
        return std::make_unique<WatchedAs>(problem, innovation);
    }
    std::unique_ptr<Watched> clone() const override { return std::make_unique<WatchedAs>(*this); }
    GuardSignal update(double const* psi, double y) override {
        for (size_t i = 0; i < psi_.size(); ++i) psi_[i] = T(psi[i]);
        filter_.update(psi_, T(y));
        if constexpr (HasGuard<F>) return filter_.signal();
        else return GuardSignal::none;
    }
    Vector<double> theta() const override {
        return filter_.theta().unaryExpr([](T const& x) { return static_cast<double>(x); });
    }
    double variance(Index j) override {
        using rlslab::watched_variance;
        return static_cast<double>(watched_variance(filter_, j));
    }
    Stored<Reference> stored() const override {
        return filter_.stored().template mapped<Reference>([](T const& x) { return widen(x); });
    }
    GuardCounts counts() const override {
        if constexpr (HasGuard<F>) return filter_.counts();
        else return {};
    }
};

template <class F>
MakeWatched watched_as(std::string_view policy) {
    if (policy == "none") return &WatchedAs<F>::make;
    if (policy == "report") return &WatchedAs<Guarded<F, reporting>>::make;
    if (policy == "reset") return &WatchedAs<Guarded<F, resetting>>::make;
    if (policy == "rebuild") return &WatchedAs<Guarded<F, rebuilding>>::make;
    return nullptr;
}
template <class T>
MakeWatched watched_in(std::string_view variant, std::string_view policy) {
    MakeWatched out = nullptr;
    for_each(TypeList<Conventional<T>, Symmetric<T>, Potter<T>, Carlson<T>, Ud<T>, InverseQr<T>, Qr<T>, Gentleman<T>>{},
             [&]<class F>() {
                 if (F::name == variant) out = watched_as<F>(policy);
             });
    return out;
}

}  // namespace rlslab::studies::detail
