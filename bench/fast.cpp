// fast/NAME/ARITHMETIC/SIZE: one sample in, the prediction error out, by the fast forms, by variants behind a delay
// line, and by SLICOT's FD01AD. Digits are those of the prediction error in the first row after the scored ones.
#include "bench/rows.hpp"

#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/fast/fast.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/ud.hpp>
#ifdef RLSLAB_BENCH_SLICOT
#include "bench/fd01ad.hpp"
#endif

namespace rlslab::bench {
namespace {

std::vector<Index> const sizes{8, 16, 32, 64, 128, 256};

/// The filters' data with the prior of the fast forms, delta = 1/10: certified anew.
Scenario const& fast_scenario(Index size) {
    static std::map<Index, Scenario> made;
    if (auto const found = made.find(size); found != made.end()) return found->second;
    Scenario out = tapped_delay_line(size);
    Matrix<double> P0 = Matrix<double>::Zero(size, size);
    double p = out.problem.prior->variance;
    for (Index i = 0; i < size; ++i, p *= out.problem.forgetting) P0(i, i) = p;
    out.problem.prior->covariance = P0;
    out.exact = certified(out.problem, out.records, {out.scored}).front();
    return made.emplace(size, std::move(out)).first->second;
}
template <class T>
FastProblem<T> fast_problem(Scenario const& scenario) {
    return {.size = scenario.problem.size,
            .forgetting = T(scenario.problem.forgetting),
            .energy = T(1 / scenario.problem.prior->variance)};
}

/// A variant that is given samples.
template <class F>
class BehindADelayLine {
    using T = typename F::scalar;
    F filter_;
    DelayLine<T> line_;

    static Problem<T> problem_of(FastProblem<T> const& problem) {
        Matrix<T> P0 = Matrix<T>::Zero(problem.size, problem.size);
        T p = T(1) / problem.energy;
        for (Index i = 0; i < problem.size; ++i, p *= problem.forgetting) P0(i, i) = p;
        return {.size = problem.size, .forgetting = problem.forgetting, .prior = Prior<T>{.covariance = P0}};
    }

public:
    using scalar = T;
    static constexpr std::string_view name = F::name;
    explicit BehindADelayLine(FastProblem<T> const& problem) : filter_(problem_of(problem)), line_(problem.size) {}
    Step<T> update(T const& u, T const& y) { return filter_.update(line_.push(u), y); }
    Index size() const { return line_.size(); }
};

template <class F>
class FastRow {
    using T = typename F::scalar;
    Scenario const& scenario_;
    std::vector<T> u_, y_;
    F scored_;
    double digits_;

public:
    explicit FastRow(Scenario const& scenario) : scenario_(scenario), scored_(fast_problem<T>(scenario)) {
        for (Index k = 0; k < scenario.records.rows(); ++k) {
            u_.push_back(T(scenario.records.psi(0, k)));
            y_.push_back(T(scenario.records.y[k]));
        }
        Index const next = scenario.scored;
        for (Index k = 0; k < next; ++k) scored_.update(u_[size_t(k)], y_[size_t(k)]);
        Vector<Reference> const theta = scenario.exact.theta();
        Reference e = Reference(scenario.records.y[next]);
        for (Index i = 0; i < theta.size(); ++i) e -= Reference(scenario.records.psi(i, next)) * theta[i];
        F copy = scored_;
        Reference const found = Reference(double(copy.update(u_[size_t(next)], y_[size_t(next)]).innovation));
        double const apart = std::abs(double(Reference((found - e) / e)));
        digits_ = apart < 1 ? std::min(-std::log10(apart), std::numeric_limits<T>::digits * std::log10(2.0)) : 0;
    }
    void run(benchmark::State& state) const {
        Index const rows = Index(u_.size()) - scenario_.scored;
        F form = scored_;
        bool finite = true;
        time_rows(
            state, rows, [&] { form = scored_; },
            [&] {
                return nanoseconds_of([&] {
                    for (size_t k = size_t(scenario_.scored); k < u_.size(); ++k) {
                        Step<T> const step = form.update(u_[k], y_[k]);
                        do_not_optimize(step);
                        finite = finite && step.health == Health::sound;
                    }
                });
            },
            [&] {
                return Answer{digits_, finite};
            });
        state.SetLabel(F::name == "fd01ad" ? "peer" : "fast form");
    }
};

template <class F>
void add_fast_row() {
    std::string const arithmetic = std::same_as<typename F::scalar, float> ? "float" : "double";
    for (Index const size : sizes)
        add_row("fast/" + std::string(F::name) + "/" + arithmetic + "/" + std::to_string(size),
                [=](benchmark::State& state) {
                    static std::map<Index, FastRow<F>> made;
                    made.try_emplace(size, fast_scenario(size)).first->second.run(state);
                });
}
template <class T>
void add_in() {
    for_each(FastForms<T>{}, []<class F>() { add_fast_row<F>(); });
    add_fast_row<BehindADelayLine<Ud<T>>>();
    add_fast_row<BehindADelayLine<Conventional<T>>>();
}

Rows const added([] {
    add_in<double>();
    add_in<float>();
#ifdef RLSLAB_BENCH_SLICOT
    add_fast_row<Fd01ad>();
#endif
});

}  // namespace
}  // namespace rlslab::bench
