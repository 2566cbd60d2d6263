// Filters by name, and what is refused.
#include <rlslab/catalogue/native/compose.hpp>
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/core/complex.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::native {
namespace {

using Names = std::span<std::string_view const>;

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
    expects(o.prior_variance >= 0 && std::isfinite(o.prior_variance), "a finite prior variance >= 0 (0: no prior)");
    bool const has_prior = o.prior_variance > 0 || o.prior_covariance;
    expects(has_prior || !o.prior_theta, "a prior variance or covariance beside a prior theta");
    if (!has_prior) return out;
    out.prior.emplace();
    if (o.prior_variance > 0) out.prior->variance = o.prior_variance;
    if (o.prior_theta) out.prior->theta = Eigen::Map<Vector<double> const>(o.prior_theta, o.size);
    if (o.prior_covariance)
        out.prior->covariance = Eigen::Map<Matrix<double> const>(o.prior_covariance, o.size, o.size);
    return out;
}

/// The numbers of the rule: those given, and its defaults for others.
std::vector<double> numbers_of(Control const& control, Options const& o, Problem<double> const& problem) {
    std::string const of = "control " + std::string(control.name) + ": ";
    if (o.control_numbers.size() > control.parameters.size())
        refuse(of + "expected at most " + std::to_string(control.parameters.size()) + " numbers, found " +
               std::to_string(o.control_numbers.size()));
    std::vector<double> out;
    for (ControlParameter const& p : control.parameters) {
        double x = out.size() < o.control_numbers.size() ? o.control_numbers[out.size()] : Options::unset;
        if (std::isnan(x)) x = p.start;
        if (std::isnan(x) && p.range.otherwise == RuleDefault::prior_variance && problem.prior)
            x = problem.prior->covariance ? problem.prior->covariance->diagonal().maxCoeff() : problem.prior->variance;
        if (std::isnan(x))
            refuse(of + "expected its number " + std::string(p.name) + ", found " +
                   std::to_string(o.control_numbers.size()) + " numbers");
        bool const above = p.range.positive ? x > p.range.least : x >= p.range.least;
        if (!above || !(x <= p.range.most) || (p.whole && x != std::floor(x)))
            refuse(of + std::string(p.name) + " is out of its range");
        out.push_back(x);
    }
    return out;
}
Composition composition_of(Options const& o, Problem<double> const& problem) {
    expects(o.window >= 0, "a window of rows >= 0 (0: none)");
    Composition out{.control = std::string(o.control),
                    .window = o.window,
                    .guard = std::string(o.guard),
                    .certify = o.certify,
                    .digits = o.digits};
    if (!o.guard.empty()) expect_one_of(guards(), o.guard, "guard");
    else
        expects(std::isnan(o.largest_variance) && std::isnan(o.innovation) && std::isnan(o.least_noise) &&
                    std::isnan(o.asymmetry) && o.noise_memory == 0 && o.rebuild_rows == 0,
                "a guard beside its numbers");
    if (!o.control.empty()) expect_one_of(controls(), o.control, "control");
    if (o.control.empty()) expects(o.control_numbers.empty(), "a control beside its numbers");
    else out.parameters = numbers_of(control_named(o.control), o, problem);
    return out;
}
GuardOptions<double> guard_options_of(Options const& o) {
    GuardOptions<double> out;
    auto const set = [](double& member, double given) {
        if (!std::isnan(given)) member = given;
    };
    set(out.largest_variance, o.largest_variance);
    set(out.innovation, o.innovation);
    set(out.least_noise, o.least_noise);
    set(out.asymmetry, o.asymmetry);
    if (o.noise_memory != 0) out.noise_memory = o.noise_memory;
    out.rebuild_rows = o.rebuild_rows;
    return out;
}

/// Throws std::invalid_argument for a number that is infinite in T.
template <class T>
Problem<T> problem_in(Problem<double> const& problem) {
    return problem.mapped<T>([](double x) {
        expects(std::isfinite(T(x)) || !std::isfinite(x), "numbers in the arithmetic's range");
        return T(x);
    });
}
/// What a plain variant is made from.
Problem<double> problem_of_plain(std::string_view variant, std::string_view arithmetic, Options const& options,
                                 char const* what) {
    expect_one_of(variants(), variant, "variant");
    expect_one_of(arithmetics(), arithmetic, "arithmetic");
    Problem<double> const problem = problem_of(options);
    if (!composition_of(options, problem).empty())
        refuse(std::string("expected ") + what + " of a plain variant: no guard, window, control or probes");
    return problem;
}
std::string no_fleet_of(std::string_view variant) {
    return std::string(variant) + " counts the rows of all filters at once: there is no fleet of it";
}
template <Real T>
std::unique_ptr<Fleet> output_fleet_in(std::string_view variant, Index filters, Index outputs, bool is_complex,
                                       Problem<T> const& problem) {
    if (!is_complex) return output_fleet_named(variant, filters, outputs, problem);
    Problem<Complex<T>> in_complex{.size = problem.size, .forgetting = problem.forgetting};
    if (problem.prior) in_complex.prior->variance = problem.prior->variance;
    else in_complex.prior.reset();
    return output_fleet_named(variant, filters, outputs, in_complex);
}
std::unique_ptr<Fleet> output_fleet(std::string_view variant, std::string_view arithmetic, Index filters, Index outputs,
                                    bool is_complex, Problem<double> const& problem) {
    auto out = arithmetic == ArithmeticTraits<float>::name
                   ? output_fleet_in(variant, filters, outputs, is_complex, problem_in<float>(problem))
                   : output_fleet_in(variant, filters, outputs, is_complex, problem);
    if (!out)
        refuse(is_complex ? no_fleet_of(variant)
                          : std::string(variant) + " reports no P: a fleet of it has one output");
    return out;
}
/// What makes such filters.
template <class T>
std::function<AnyAdaptive<T>()> maker(std::string_view variant, Options const& options) {
    Problem<double> const problem = problem_of(options);
    Composition const composition = composition_of(options, problem);
    if (!composition.empty()) {
        if (std::string const why = contradiction(composition); !why.empty()) refuse(why);
        if (std::string const why = obstacle(composition, variant); !why.empty())
            refuse(std::string(variant) + " cannot be composed so: it " + why);
    }
    return [=, in_T = problem_in<T>(problem), guard = guard_options_of(options), name = std::string(variant)] {
        return composed_around<T>(composition, guard, name, in_T);
    };
}

}  // namespace

Names variants() {
    static std::vector<std::string_view> const all = [] {
        std::vector<std::string_view> out;
        for_each(Variants<double>{}, [&]<class F>() { out.push_back(F::name); });
        return out;
    }();
    return all;
}
Names arithmetics() {
    static constexpr std::string_view all[] = {ArithmeticTraits<float>::name, ArithmeticTraits<double>::name};
    return all;
}
Names guards() {
    static auto const all = names_of(guard_policies, &NamedPolicy::name);
    return all;
}
Names controls() {
    static auto const all = names_of(rlslab::controls(), &Control::name);
    return all;
}

std::string_view name_of_health(std::int32_t health) {
    expects(0 <= health && health <= 3, "a health from 0 to 3");
    return name_of(Health(health));
}
std::string_view name_of_signal(std::int32_t signal) {
    expects(0 <= signal && signal <= 5, "a signal from 0 to 5");
    return name_of(GuardSignal(signal));
}

std::string refusal_of(StateFault fault, std::span<std::byte const> from) {
    if (fault == StateFault::no_state) return "the bytes are not a state";
    std::string text = "the state is " + std::string(name_of(fault));
    StateHeader found;
    if (StateHeader::read(from, found) == StateFault::none)
        text += ": " + printable(StateHeader::text(found.variant)) + " in " +
                printable(StateHeader::text(found.arithmetic)) + " with " + std::to_string(found.parameters) +
                " parameters" + (found.lanes > 1 ? ", of a fleet" : "");
    return text;
}

std::unique_ptr<Filter> make(std::string_view variant, std::string_view arithmetic, Options const& options) {
    expect_one_of(variants(), variant, "variant");
    expect_one_of(arithmetics(), arithmetic, "arithmetic");
    return arithmetic == ArithmeticTraits<float>::name ? filter_of<float>(maker<float>(variant, options))
                                                       : filter_of<double>(maker<double>(variant, options));
}

std::unique_ptr<Fleet> make_fleet(std::string_view variant, std::string_view arithmetic, Index filters,
                                  Options const& options, Index outputs) {
    if (outputs != 1) {
        Problem<double> const problem = problem_of_plain(variant, arithmetic, options, "a fleet of several outputs");
        return output_fleet(variant, arithmetic, filters, outputs, false, problem);
    }
    expect_one_of(variants(), variant, "variant");
    expect_one_of(arithmetics(), arithmetic, "arithmetic");
    Problem<double> const problem = problem_of(options);
    bool const floats = arithmetic == ArithmeticTraits<float>::name, prior = problem.prior.has_value();
    if (!composition_of(options, problem).empty())
        return floats ? fleet_of<float>(filters, maker<float>(variant, options)(), prior)
                      : fleet_of<double>(filters, maker<double>(variant, options)(), prior);
    auto out = floats ? fleet_named<float>(variant, filters, problem_in<float>(problem))
                      : fleet_named<double>(variant, filters, problem);
    if (!out) refuse(no_fleet_of(variant));
    return out;
}
std::unique_ptr<Fleet> make_complex(std::string_view variant, std::string_view arithmetic, Index filters, Index outputs,
                                    Options const& options) {
    expects(!options.prior_theta && !options.prior_covariance,
            "complex filters that start with theta0 = 0, P0 = c^2 I");
    Problem<double> const problem = problem_of_plain(variant, arithmetic, options, "complex filters");
    return output_fleet(variant, arithmetic, filters, outputs, true, problem);
}
std::unique_ptr<Outputs> make_outputs(std::string_view variant, std::string_view arithmetic, Index outputs,
                                      Options const& options) {
    Problem<double> const problem = problem_of_plain(variant, arithmetic, options, "several outputs");
    auto out = arithmetic == ArithmeticTraits<float>::name
                   ? outputs_named<float>(variant, outputs, problem_in<float>(problem))
                   : outputs_named<double>(variant, outputs, problem);
    if (!out)
        refuse(std::string(variant) + " has one output; all other variants but kalman and extended_qr take several");
    return out;
}
void use_threads(Index threads) { rlslab::use_threads(threads); }

}  // namespace rlslab::native
