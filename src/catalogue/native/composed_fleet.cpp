// A fleet of filters that are guarded, windowed, ruled or followed by probes: what is around a variant is compiled once
// an arithmetic, and not in lanes, so that they take their rows one after another.
#include <rlslab/catalogue/native/compose.hpp>
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/adapt/weighted.hpp>

namespace rlslab::native {
namespace {

template <Real T>
struct Filters {
    using scalar = T;
    static constexpr std::string_view name = "any", layer = "composed fleet";
    AnyAdaptive<T> fresh;
    std::vector<AnyAdaptive<T>> each;
    std::vector<Health> health;

    std::string_view variant_name() const { return fresh.variant_name(); }
    static std::array<StateOption, 1> options(auto const& f) { return {{{"filters", double(f.each.size())}}}; }
    static auto state(auto& f) { return std::tie(f.fresh, f.each, f.health); }
};

template <Real T>
class ComposedFleet final : public Fleet {
    Filters<T> f_;
    bool const signals_, prior_;
    StateVector<T> row_;

    Health first() const { return prior_ ? Health::sound : Health::undetermined; }
    /// Whether filter m's row was there.
    template <class X>
    bool take(Index m, X const* psi, X y, X const* w, native::Step* told) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        T const output = T(y), weight = w ? T(*w) : T(1);
        for (Index i = 0; i < size(); ++i) row_[i] = T(psi[i]);
        bool const whole = (all_finite(row_) && is_finite(output)) || weight == T(0);
        bool const weighs = T(0) <= weight && is_finite(weight);  // else no signal, as of one filter
        if (told)
            *told = {none, none, none, std::int32_t(Health::nonfinite),
                     signals_ && weighs ? std::int32_t(GuardSignal::unusable) : 0};
        if (!whole || !weighs) return false;
        AnyAdaptive<T>& filter = f_.each[std::size_t(m)];
        Regressor<T> const row(row_.data(), size());
        T by(1);
        auto const step = w ? detail::weighted_row(filter, row_, by, row, output, weight) : filter.update(row, output);
        Health& mine = f_.health[std::size_t(m)];
        if (!signals_) mine = mine == Health::undetermined ? step.health : worse(mine, step.health);
        else if (filter.signal() != GuardSignal::unusable) mine = step.health;
        if (told)
            *told = {double(step.innovation), double(step.residual), double(step.gamma), std::int32_t(step.health),
                     signals_ ? std::int32_t(filter.signal()) : 0};
        return true;
    }

public:
    ComposedFleet(Index filters, AnyAdaptive<T> const& fresh, bool prior)
        : Fleet({fresh.theta().size(), filters, 1, false, fresh.variant_name(), ArithmeticTraits<T>::name}),
          f_{fresh, std::vector<AnyAdaptive<T>>(std::size_t(filters), fresh), {}},
          signals_(f_.fresh.abilities().signals), prior_(prior), row_(size()) {
        f_.health.assign(std::size_t(filters), first());
    }

    Index update(Rows const& rows) override {
        auto const* const given = std::get_if<native::Step*>(&rows.steps);
        native::Step* steps = given ? *given : nullptr;
        Index missing = 0;
        std::visit(
            [&]<class X>(X const* psi) {
                X const *y = std::get<X const*>(rows.y),
                        *w = rows.weighs() ? std::get<X const*>(rows.weights) : nullptr;
                for (Index k = 0; k < rows.count * filters(); ++k, psi += size())
                    missing += !take(k % filters(), psi, y[k], w ? w + k : nullptr, steps ? steps + k : nullptr);
            },
            rows.psi);
        return missing;
    }
    std::int32_t health(Index filter, double* theta) const override {
        auto const& at = f_.each[std::size_t(filter)].theta();
        if (theta)
            for (Index i = 0; i < size(); ++i) theta[i] = double(at[i]);
        return std::int32_t(f_.health[std::size_t(filter)]);
    }
    bool matrix(Index filter, double* out) const override {
        AnyAdaptive<T> const& one = f_.each[std::size_t(filter)];
        auto const found = one.matrix();
        for (Index i = 0; out && i < found.size(); ++i) out[i] = double(found.data()[i]);
        return one.matrix_is_covariance();
    }
    void reset(Index filter) override {
        f_.each[std::size_t(filter)] = f_.fresh;
        f_.health[std::size_t(filter)] = first();
    }
    std::size_t save(std::span<std::byte> to) const override {
        return to.empty() ? rlslab::state_size(f_) : rlslab::save(f_, to);
    }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(f_, from); fault != StateFault::none) refuse(refusal_of(fault, from));
    }
    std::unique_ptr<Fleet> clone() const override { return std::make_unique<ComposedFleet>(*this); }
};

}  // namespace

template <Real T>
std::unique_ptr<Fleet> fleet_of(Index filters, AnyAdaptive<T> const& fresh, bool prior) {
    expects(filters >= 1, "a number of filters, at least one");
    return std::make_unique<ComposedFleet<T>>(filters, fresh, prior);
}
template std::unique_ptr<Fleet> fleet_of(Index, AnyAdaptive<float> const&, bool);
template std::unique_ptr<Fleet> fleet_of(Index, AnyAdaptive<double> const&, bool);

}  // namespace rlslab::native
