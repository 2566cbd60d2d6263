// Fleets of the variants in one arithmetic, RLSLAB_NATIVE: float or double, eight filters at a time.
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/many/fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {
namespace {

/// F is a variant over a Pack.
template <class F>
class FleetOf final : public Fleet {
    using Filters = rlslab::Fleet<F>;
    using T = typename Filters::number;
    Filters filters_;
    Matrix<T> psi_;  // M x d: column i is the regressor i of all filters
    Vector<T> y_;
    FleetSteps<T> steps_;

public:
    FleetOf(Index filters, Problem<T> const& problem)
        : Fleet(problem.size, filters, F::name, ArithmeticTraits<T>::name), filters_(filters, problem),
          psi_(filters, problem.size), y_(filters), steps_(0) {}

    Index update(Numbers psi, Numbers y, Step* steps) override {
        auto const row_of_each = [&](auto const* rows) {
            for (Index m = 0; m < psi_.rows(); ++m) {
                for (Index i = 0; i < psi_.cols(); ++i) psi_(m, i) = T(rows[m * psi_.cols() + i]);
                y_[m] = T(std::get<decltype(rows)>(y)[m]);
            }
        };
        std::visit(row_of_each, psi);
        if (!steps) return filters_.update(psi_, y_);
        if (steps_.filters() != filters()) steps_.resize(filters());
        Index const missing = filters_.update(psi_, y_, steps_);
        for (Index m = 0; m < filters(); ++m)
            steps[m] = {double(steps_.innovation[m]), double(steps_.residual[m]), double(steps_.gamma[m]),
                        std::int32_t(steps_.health[size_t(m)]), 0};
        return missing;
    }
    bool matrix(Index filter, double* out) const override {
        auto const one = filters_.filter(filter);
        constexpr bool covariance = ReportsCovariance<std::remove_const_t<decltype(one)>>;
        Eigen::Map<Matrix<double>> to(out, size(), size());
        if constexpr (covariance) to = one.covariance().template cast<double>();
        else to = one.information().template cast<double>();
        return covariance;
    }
    std::int32_t health(Index filter, double* theta) const override {
        if (theta) Eigen::Map<Vector<double>>(theta, size()) = filters_.theta(filter).template cast<double>();
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
};

}  // namespace

template <class T>
std::unique_ptr<Fleet> fleet_named(std::string_view variant, Index filters, Problem<T> const& problem) {
    std::unique_ptr<Fleet> out;
    for_each(Variants<Pack<T, 8>>{}, [&]<class F>() {
        if constexpr (KeepsLanesApart<F>)
            if (F::name == variant) out = std::make_unique<FleetOf<F>>(filters, problem);
    });
    return out;
}
template std::unique_ptr<Fleet> fleet_named(std::string_view, Index, Problem<RLSLAB_NATIVE> const&);

}  // namespace rlslab::native
