// Compositions in the arithmetics in which they exist, behind the interface that measures.
#include <rlslab/catalogue/composed.hpp>

#include <rlslab/catalogue/erase.hpp>
#include <rlslab/catalogue/native/compose.hpp>

namespace rlslab {
namespace {

template <Real T>
class Composed final : public Erased<Assessed<AnyAdaptive<T>>, ComposedFilter> {
    using Base = Erased<Assessed<AnyAdaptive<T>>, ComposedFilter>;
    using Base::filter_;

    /// Of a variant that does not tell its variances.
    static Interval<double> alone(T const& value) {
        double const none = std::numeric_limits<double>::quiet_NaN();
        return {in_double(value), none, none, none};
    }
    static Interval<double> in_doubles(Interval<T> const& i) {
        return {in_double(i.value), in_double(i.deviation), in_double(i.low), in_double(i.high)};
    }

public:
    Composed(AnyAdaptive<T> const& filter, T const& forgetting) : Base({filter, forgetting}, Seed{0}) {}

    std::unique_ptr<AnyFilter> clone() const override { return std::make_unique<Composed>(*this); }
    CompositionCounts counts() const override { return filter_.filter().composition_counts(); }
    std::optional<Certificate<double>> certificate() const override {
        if (filter_.filter().probe_count() == 0) return {};
        auto const found = filter_.filter().certificate();
        return Certificate<double>{in_double(found.estimate), in_double(found.bound), in_double(found.theta),
                                   found.definite};
    }
    double noise_variance() const override {
        return filter_.degrees() > 0 ? in_double(filter_.noise_variance()) : std::nan("");
    }
    Interval<double> interval(Index j, double q) override {
        if (!filter_.filter().abilities().variances) return alone(filter_.theta()[j]);
        return in_doubles(filter_.interval(j, T(q)));
    }
    Interval<double> prediction(Regressor<double> psi, double q) override {
        Vector<T> const row = rounded<T>(psi), theta = filter_.theta();
        if (!filter_.filter().abilities().variances) return alone(dot(row.data(), theta.data(), row.size()));
        return in_doubles(filter_.prediction(row, T(q)));
    }
};

template <Real T>
std::unique_ptr<ComposedFilter> composed_in(Composition const& c, std::string_view variant,
                                            Problem<double> const& given) {
    Problem<T> const problem = problem_as<T>(given);
    return std::make_unique<Composed<T>>(composed_around<T>(c, {}, variant, problem), problem.forgetting);
}

}  // namespace

std::unique_ptr<ComposedFilter> composed(Composition const& composition, std::string_view variant,
                                         std::string_view arithmetic, Problem<double> const& problem) {
    expects(composition.window >= 0, "a window of rows >= 0 (0: none)");
    if (!contradiction(composition).empty() || !obstacle(composition, variant).empty()) return nullptr;
    size_t const numbers = composition.control.empty() ? 0 : control_named(composition.control).parameters.size();
    expects(composition.parameters.size() == numbers, "all numbers of the control, and no more");
    if (arithmetic == "float") return composed_in<float>(composition, variant, problem);
    if (arithmetic == "double") return composed_in<double>(composition, variant, problem);
    if (arithmetic == "reference") return composed_in<Reference>(composition, variant, problem);
    return nullptr;
}

}  // namespace rlslab
