// Compositions in the arithmetics in which they exist, behind the interface that measures.
#include <rlslab/catalogue/composed.hpp>

#include <rlslab/catalogue/erase.hpp>
#include <rlslab/catalogue/reference_compositions.hpp>

namespace rlslab {
namespace {

template <Real T>
class Composed final : public ComposedFilter {
    Assessed<AnyAdaptive<T>> filter_;

    static Vector<T> rounded(Regressor<double> psi) {
        return Eigen::Map<Vector<double> const>(psi.data(), psi.size()).unaryExpr(&round_to<T>);
    }
    static Step<double> in_doubles(Step<T> const& s) {
        return {in_double(s.innovation), in_double(s.residual), in_double(s.gamma), s.health};
    }
    /// Of a variant that does not tell its variances.
    static Interval<double> alone(T const& value) {
        double const none = std::numeric_limits<double>::quiet_NaN();
        return {in_double(value), none, none, none};
    }
    static Interval<double> in_doubles(Interval<T> const& i) {
        return {in_double(i.value), in_double(i.deviation), in_double(i.low), in_double(i.high)};
    }

public:
    Composed(AnyAdaptive<T> const& filter, T const& forgetting) : filter_(filter, forgetting) {}

    Step<double> update(Regressor<double> psi, double y) override {
        return in_doubles(filter_.update(rounded(psi), round_to<T>(y)));
    }
    Step<double> update(Regressor<double>, double, Matrix<double> const&) override {
        throw std::invalid_argument("expected a variant alone: a composition takes no errors in its gain");
    }
    Step<double> update_block(Records const& records, Index first, Index last) override {
        double const none = std::numeric_limits<double>::quiet_NaN();
        Step<double> step{none, none, none};
        for (Index k = first; k < last; ++k) step = update(records.sample(k), records.y[k]);
        return step;
    }
    Vector<Reference> theta() const override { return filter_.theta().unaryExpr(&widened<T>); }
    Vector<Reference> gain() const override { return filter_.gain().unaryExpr(&widened<T>); }
    Stored<Reference> stored() const override { return filter_.stored().template mapped<Reference>(&widened<T>); }
    Stored<double> stored_in_double() const override { return in_double(filter_.stored()); }
    std::unique_ptr<AnyFilter> clone() const override { return std::make_unique<Composed>(*this); }
    std::vector<std::byte> saved() const override { return saved_bytes(filter_); }
    void load(std::span<std::byte const> from) override { load_bytes(filter_, from); }
    CompositionCounts counts() const override { return filter_.filter().composition_counts(); }
    double noise_variance() const override {
        return filter_.degrees() > 0 ? in_double(filter_.noise_variance()) : std::nan("");
    }
    Interval<double> interval(Index j, double q) override {
        if (!filter_.filter().abilities().variances) return alone(filter_.theta()[j]);
        return in_doubles(filter_.interval(j, T(q)));
    }
    Interval<double> prediction(Regressor<double> psi, double q) override {
        Vector<T> const row = rounded(psi), theta = filter_.theta();
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
