// Complex filters of the variants in one arithmetic, RLSLAB_NATIVE: float or double, eight at a time.
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/many/complex_fleet.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {
namespace {

/// F is a variant over complex packs.
template <class F>
class ComplexOf final : public ComplexFleet {
    using Filters = rlslab::ComplexFleet<F>;
    using T = typename Filters::real;
    using C = typename Filters::number;
    Problem<C> problem_;  // for reset()
    Filters filters_;
    std::vector<C> psi_, y_, innovation_, residual_;  // of a row of all filters
    std::vector<T> gamma_;
    std::vector<Health> health_;

    /// In place where they are of this arithmetic.
    template <class X>
    static C const* in_arithmetic(X const* from, std::vector<C>& room) {
        if constexpr (std::same_as<X, T>) return reinterpret_cast<C const*>(from);  // may_alias
        for (C& x : room) x = {T(from[0]), T(from[1])}, from += 2;
        return room.data();
    }
    static void copy(std::vector<C> const& from, double*& to) {
        if (!to) return;
        for (C const& x : from) *to++ = double(x.re), *to++ = double(x.im);
    }

public:
    ComplexOf(Index filters, Index outputs, Problem<C> const& problem)
        : ComplexFleet(problem.size, filters, outputs, F::name, ArithmeticTraits<T>::name), problem_(problem),
          filters_(filters, problem, outputs), psi_(std::size_t(filters * problem.size)),
          y_(std::size_t(filters * outputs)), innovation_(y_), residual_(y_), gamma_(std::size_t(filters)),
          health_(std::size_t(filters)) {}

    Index update(Index rows, Numbers psi, Numbers y, Steps const& steps) override {
        expects(rows >= 0, "rows >= 0");
        Steps to = steps;
        Index missing = 0;
        for (Index k = 0; k < rows; ++k) {
            missing += std::visit(
                [&]<class X>(X const* x) {
                    return filters_.update(in_arithmetic(x + 2 * k * Index(psi_.size()), psi_),
                                           in_arithmetic(std::get<X const*>(y) + 2 * k * Index(y_.size()), y_),
                                           {innovation_.data(), residual_.data(), gamma_.data(), health_.data()});
                },
                psi);
            copy(innovation_, to.innovation);
            copy(residual_, to.residual);
            if (to.gamma)
                for (T const& x : gamma_) *to.gamma++ = double(x);
            if (to.health)
                for (Health const x : health_) *to.health++ = std::int32_t(x);
        }
        return missing;
    }
    void theta(double* out) const override {
        for (Index i = 0; i < filters(); ++i)
            for (Index k = 0; k < size(); ++k)
                for (Index j = 0; j < outputs(); ++j) {
                    C const x = filters_.theta(i, k, j);
                    *out++ = double(x.re), *out++ = double(x.im);
                }
    }
    bool reports_covariance() const override { return ReportsCovariance<F>; }
    void matrix(Index filter, double* out) const override {
        auto const found = filters_.matrix(filter);
        for (Index i = 0; i < found.size(); ++i)
            *out++ = double(found.data()[i].re), *out++ = double(found.data()[i].im);
    }
    std::int32_t health(Index filter) const override { return std::int32_t(filters_.health(filter)); }
    void reset() override { filters_ = Filters(filters(), problem_, outputs()); }
    std::size_t save(std::span<std::byte> to) const override {
        return to.empty() ? rlslab::state_size(filters_) : rlslab::save(filters_, to);
    }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(filters_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
    }
    std::unique_ptr<ComplexFleet> clone() const override { return std::make_unique<ComplexOf>(*this); }
};

}  // namespace

template <class T>
std::unique_ptr<ComplexFleet> complex_named(std::string_view variant, Index filters, Index outputs,
                                            Problem<T> const& problem) {
    std::unique_ptr<ComplexFleet> out;
    Problem<Complex<T>> in_complex{.size = problem.size, .forgetting = problem.forgetting};
    if (problem.prior) in_complex.prior->variance = problem.prior->variance;
    else in_complex.prior.reset();
    for_each(Variants<Complex<Pack<T, 8>>>{}, [&]<class F>() {
        if constexpr (ComplexInLockstep<F>)
            if (F::name == variant) out = std::make_unique<ComplexOf<F>>(filters, outputs, in_complex);
    });
    return out;
}
template std::unique_ptr<ComplexFleet> complex_named(std::string_view, Index, Index, Problem<RLSLAB_NATIVE> const&);

}  // namespace rlslab::native
