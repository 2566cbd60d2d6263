// Puts a filter of any type behind the erased boundary, and makes its entry for the catalogue.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/concept.hpp>
#include <rlslab/erased.hpp>
#include <rlslab/linalg/reflections.hpp>

#include <chrono>

namespace rlslab {

/// While one is alive the thread's stochastic roundings draw from the seed; nothing in other arithmetics.
template <class Scalar>
struct Draws {
    explicit Draws(Seed&) {}
};
template <Format F>
struct Draws<Chopped<F, Rounding::stochastic>> : StochasticStream {
    using StochasticStream::StochasticStream;
};

/// A datum as T stores it. Data are rounded to nearest whatever the rounding of the operations: the same bits are then
/// given to the reference.
template <class Scalar>
struct Datum {
    static constexpr bool stochastic = false;
    static double round(double x) { return std::same_as<Scalar, float> ? double(float(x)) : x; }
};
template <Format F, Rounding R>
struct Datum<Chopped<F, R>> {
    static constexpr bool stochastic = R == Rounding::stochastic;
    static double round(double x) { return static_cast<double>(Chopped<F>(x)); }
};

template <class T>
T datum(double x) {
    return T(Datum<T>::round(x));
}

/// The problem with every number as T stores it.
template <class T>
Problem<T> converted(Problem<double> const& problem) {
    Problem<T> out{.size = problem.size, .forgetting = datum<T>(problem.forgetting), .prior = std::nullopt};
    if (problem.prior) {
        out.prior = Prior<T>{.variance = datum<T>(problem.prior->variance)};
        if (problem.prior->theta) out.prior->theta = problem.prior->theta->unaryExpr(&datum<T>);
        if (problem.prior->covariance) out.prior->covariance = problem.prior->covariance->unaryExpr(&datum<T>);
    }
    return out;
}

template <class T>
Reference widened(T const& x) {
    return widen(x);
}
template <class T>
double in_double(T const& x) {
    return static_cast<double>(x);
}

/// Folds rows first ... last-1 into f as it likes them best; the last step, or the health that theta shows after blocks.
template <class F, class T = typename F::scalar>
Step<T> feed(F& f, Rows<T> const& psi, Vector<T> const& y) {
    if constexpr (TakesBlocks<F>) {
        for (Index k = 0; k < y.size(); k += F::block) {
            Index const rows = std::min(F::block, y.size() - k);
            f.absorb(psi.middleCols(k, rows), y.segment(k, rows));
        }
        Vector<T> const theta = f.theta();
        bool finite = true;
        for (Index i = 0; i < theta.size(); ++i) finite = finite && is_finite(theta[i]);
        return {undefined<T>(), undefined<T>(), undefined<T>(), finite ? Health::sound : Health::nonfinite};
    } else {
        Step<T> step{};
        for (Index k = 0; k < y.size(); ++k) step = f.update({psi.col(k).data(), psi.rows()}, y[k]);
        return step;
    }
}

template <RecursiveLeastSquares F>
class Erased final : public AnyFilter {
    using T = typename F::scalar;
    F filter_;
    Seed seed_;

    static Step<double> step_in_double(Step<T> const& s) {
        return {in_double(s.innovation), in_double(s.residual), in_double(s.gamma), s.health};
    }

public:
    /// Starting from a prior takes arithmetic too.
    static std::unique_ptr<AnyFilter> make(Problem<double> const& problem, Seed seed) {
        Draws<T> const draws(seed);
        return std::make_unique<Erased>(F(converted<T>(problem)), seed);
    }
    Erased(F filter, Seed seed) : filter_(std::move(filter)), seed_(seed) {}

    Step<double> update(Regressor<double> psi, double y) override {
        Vector<T> const row = Eigen::Map<Vector<double> const>(psi.data(), psi.size()).unaryExpr(&datum<T>);
        Draws<T> const draws(seed_);
        return step_in_double(filter_.update(row, datum<T>(y)));
    }
    Step<double> absorb(Records const& records, Index first, Index last) override {
        Rows<T> const psi = records.psi.middleCols(first, last - first).unaryExpr(&datum<T>);
        Vector<T> const y = records.y.segment(first, last - first).unaryExpr(&datum<T>);
        Draws<T> const draws(seed_);
        return step_in_double(feed(filter_, psi, y));
    }
    // Reports draw from a copy of the seed: asking does not change what follows.
    Vector<Reference> theta() const override {
        Seed copy = seed_;
        Draws<T> const draws(copy);
        return Vector<T>(filter_.theta()).unaryExpr(&widened<T>);
    }
    Vector<Reference> gain() const override {
        Seed copy = seed_;
        Draws<T> const draws(copy);
        return Vector<T>(filter_.gain()).unaryExpr(&widened<T>);
    }
    Stored<Reference> stored() const override { return filter_.stored().template mapped<Reference>(&widened<T>); }
    Stored<double> stored_in_double() const override {
        return filter_.stored().template mapped<double>(&in_double<T>);
    }
    std::unique_ptr<AnyFilter> clone() const override { return std::make_unique<Erased>(*this); }
};

template <class F>
double nanoseconds(Problem<double> const& problem, Records const& records, Seed seed) {
    using T = typename F::scalar;
    using Clock = std::chrono::steady_clock;
    using Nanoseconds = std::chrono::duration<double, std::nano>;
    constexpr double enough = 5e5, stretch_at_least = 16;    // ns of undisturbed timing in all, rows a stretch
    constexpr int at_least = 8;                              // stretches: others disturb some of them
    Rows<T> const psi = records.psi.unaryExpr(&datum<T>);
    Vector<T> const y = records.y.unaryExpr(&datum<T>);
    Index stretch = std::min<Index>(records.rows(), Index(stretch_at_least));
    if constexpr (TakesBlocks<F>) stretch = std::min<Index>(records.rows(), F::block);
    Draws<T> const draws(seed);
    double best = std::numeric_limits<double>::infinity();
    int stretches = 0;
    auto const wanted = [&] { return stretches < at_least || best * double(stretches * stretch) < enough; };
    do {
        F filter(converted<T>(problem));
        for (Index k = 0; k + stretch <= records.rows() && wanted(); k += stretch) {
            Rows<T> const some_psi = psi.middleCols(k, stretch);
            Vector<T> const some_y = y.segment(k, stretch);
            auto const start = Clock::now();
            if constexpr (TakesBlocks<F>)
                feed(filter, some_psi, some_y);    // ends with theta()
            else
                for (Index i = 0; i < stretch; ++i) {
                    filter.update({some_psi.col(i).data(), some_psi.rows()}, some_y[i]);
                    auto const theta = filter.theta();
                    asm volatile("" : : "r"(theta.data()) : "memory");    // it is wanted
                }
            double const took = Nanoseconds(Clock::now() - start).count();
            best = std::min(best, took / double(stretch));
            ++stretches;
        }
    } while (wanted());
    return best;
}

/// F's line of the catalogue.
template <RecursiveLeastSquares F>
Entry entry_of(Arithmetic const* arithmetic) {
    Index block = 1;
    if constexpr (TakesBlocks<F>) block = F::block;
    return {F::name, arithmetic, StartsWithoutPrior<F>, block, ReportsCovariance<F> ? "covariance" : "information",
            &Erased<F>::make, &nanoseconds<F>};
}

/// T as data.
template <class T>
Arithmetic arithmetic_of() {
    using Traits = ArithmeticTraits<T>;
    return {Traits::name, Traits::digits, Traits::min_exp, Traits::max_exp, Datum<T>::stochastic, &Datum<T>::round};
}

}  // namespace rlslab
