// Filters by name, and what is refused.
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/adapt/guard.hpp>
#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rlslab::native {
namespace {

using Names = std::span<std::string_view const>;

[[noreturn]] void refuse(std::string const& why) { throw std::invalid_argument(why); }

/// The names of a list, collected once.
template <class List>
std::vector<std::string_view> names_of(List const& list, auto member) {
    std::vector<std::string_view> out;
    for (auto const& one : list) out.push_back(one.*member);
    return out;
}
void expect_one_of(Names names, std::string_view given, char const* what) {
    if (std::ranges::find(names, given) != names.end()) return;
    std::string text = "no " + std::string(what) + " \"" + printable(given) + "\"; there are";
    for (std::string_view const name : names) text += (name == names.front() ? " " : ", ") + std::string(name);
    refuse(text);
}

Problem<double> problem_of(Options const& o) {
    Problem<double> out{.size = o.size, .forgetting = o.forgetting, .prior = std::nullopt};
    expects(o.size >= 1, "size >= 1");
    expects(o.prior_variance >= 0, "prior variance >= 0 (0: no prior)");
    bool const has_prior = o.prior_variance > 0 || o.prior_covariance;
    expects(has_prior || !o.prior_theta, "a prior variance or covariance beside prior theta");
    if (!has_prior) return out;
    out.prior.emplace();
    if (o.prior_variance > 0) out.prior->variance = o.prior_variance;
    if (o.prior_theta) out.prior->theta = Eigen::Map<Vector<double> const>(o.prior_theta, o.size);
    if (o.prior_covariance)
        out.prior->covariance = Eigen::Map<Matrix<double> const>(o.prior_covariance, o.size, o.size);
    return out;
}

template <class T>
std::unique_ptr<Filter> made(std::string_view variant, Options const& options) {
    Problem<T> const problem = problem_of(options).mapped<T>([](double x) { return T(x); });
    auto const& all = makers<T>();
    return std::ranges::find(all, variant, &Maker<T>::variant)->make(problem);
}

}  // namespace

Names variants() {
    static auto const all = names_of(makers<double>(), &Maker<double>::variant);
    return all;
}
Names arithmetics() {
    static constexpr std::string_view all[] = {ArithmeticTraits<float>::name, ArithmeticTraits<double>::name};
    return all;
}

std::string_view name_of_health(std::int32_t health) { return rlslab::name_of(Health(health)); }
std::string_view name_of_signal(std::int32_t signal) {
    constexpr std::string_view names[] = {"none", "unusable", "breakdown", "change", "outlier", "windup"};
    return names[signal];
}

std::unique_ptr<Filter> make(std::string_view variant, std::string_view arithmetic, Options const& options) {
    expect_one_of(variants(), variant, "variant");
    expect_one_of(arithmetics(), arithmetic, "arithmetic");
    return arithmetic == ArithmeticTraits<float>::name ? made<float>(variant, options) : made<double>(variant, options);
}

}  // namespace rlslab::native
