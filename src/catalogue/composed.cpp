// Compositions in the arithmetics in which they exist, behind the interface that measures.
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/catalogue/composed.hpp>
#include <rlslab/catalogue/erase.hpp>
#include <rlslab/catalogue/native/compose.hpp>

namespace rlslab {
namespace {

template <Real T>
class Composed final : public Erased<Assessed<AnyAdaptive<T>>, ComposedFilter> {
    using Base = Erased<Assessed<AnyAdaptive<T>>, ComposedFilter>;
    using Base::filter_;

public:
    Composed(AnyAdaptive<T> const& filter, T const& forgetting) : Base({filter, forgetting}, Seed{0}) {}

    std::unique_ptr<AnyFilter> clone() const override { return std::make_unique<Composed>(*this); }
    ComposedFilter::Account account() const override {
        auto const& inside = filter_.filter();
        double const noise = filter_.degrees() > 0 ? in_double(filter_.noise_variance()) : std::nan("");
        if (inside.probe_count() == 0) return {inside.composition_counts(), {}, noise};
        auto const c = inside.certificate();
        return {inside.composition_counts(),
                {{in_double(c.estimate), in_double(c.bound), in_double(c.theta), c.definite}},
                noise};
    }
    Interval<double> interval(std::variant<Index, Regressor<double>> const& of, double q) override {
        auto const* const j = std::get_if<Index>(&of);
        Vector<T> const theta = filter_.theta(), row = j ? Vector<T>() : rounded<T>(std::get<1>(of));
        double const none = std::numeric_limits<double>::quiet_NaN();
        if (!filter_.filter().abilities().variances)
            return {in_double(j ? theta[*j] : dot(row.data(), theta.data(), row.size())), none, none, none};
        Interval<T> const i = j ? filter_.interval(*j, T(q)) : filter_.prediction(row, T(q));
        return {in_double(i.value), in_double(i.deviation), in_double(i.low), in_double(i.high)};
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
