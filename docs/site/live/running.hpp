// One filter that runs on the page, and what is measured of it as rows arrive.
#pragma once

#include "docs/site/live/measures.hpp"
#include "docs/site/live/settings.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/relative_errors.hpp>

#include <functional>

namespace rlslab::live {

/// The reference after a row.
struct Exact {
    Vector<Pair> theta;
    Square P;  ///< only where rows are measured
};

/// F, with a random relative error in each number of the gain that it uses to update P: r_i `size`, r nearly normal.
/// size = 0 leaves F's bits.
template <class F>
class WithGainError : public F {
    using T = typename F::scalar;
    double size_;
    Seed seed_{99};
    Matrix<double> relative_;

public:
    explicit WithGainError(Problem<T> const& problem, double size = 0)
        : F(problem), size_(size), relative_(problem.size, 1) {}
    Step<T> commit(Innovation<T> const& row) {
        if (size_ == 0) return F::commit(row);
        for (Index i = 0; i < relative_.rows(); ++i) relative_(i, 0) = size_ * seed_.bell();
        return F::commit(row, RelativeErrors<T>{relative_, std::vector<T>(size_t(relative_.rows()))});
    }
    Step<T> update(Regressor<T> psi, T y) { return commit(F::look(psi, y)); }
};
template <class F>
using Erring = std::conditional_t<GainPerturbable<F>, WithGainError<F>, F>;

/// One theta for all NaN: which of them an operation returns depends on the machine.
inline void add_to(std::uint64_t& hash, double x) {
    std::uint64_t const bits = detail::bits_of(x == x ? x : std::numeric_limits<double>::quiet_NaN());
    for (int i = 0; i < 8; ++i) hash = (hash ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3;
}

class Running {
    using T = VariablePrecision;
    Seed seed_;
    std::function<void(Running&, Regressor<double>, double, Exact const&, bool)> take_;

    template <class F>
    void take(F& filter, Regressor<double> psi, double y, Exact const& exact, bool measured) {
        StochasticStream const stream(seed_);
        Vector<T> row(psi.size());
        for (Index i = 0; i < row.size(); ++i) row[i] = T(psi[i]);
        Health const health = filter.update(row, T(y)).health;
        ++rows;
        UncountedScope<T> const uncounted;
        if (health > Health::undetermined && first_unsound == 0) first_unsound = rows;
        Vector<T> const now = filter.theta();
        double error = 0, size = 0;
        for (Index i = 0; i < now.size(); ++i) {
            theta[size_t(i)] = static_cast<double>(now[i]);
            add_to(hash, theta[size_t(i)]);
            double const e = double(Pair(theta[size_t(i)]) - exact.theta[i]), x = double(exact.theta[i]);
            error += e * e, size += x * x;
        }
        digits = digits_of(error, size);
        if (first_indefinite == 0 && !is_definite(filter.stored())) first_indefinite = rows;
        if constexpr (requires { filter.counts(); }) counts = filter.counts();
        if (!measured) return;
        Square const P = covariance_of_stored(filter.stored());
        covariance_digits = digits_of(P, exact.P, int(now.size()));
        spectrum = eigenvalues(P, int(now.size()));
    }

public:
    double digits = 0;             ///< of theta after the last row, as digits_of
    double covariance_digits = 0;  ///< of P at the last measured row
    std::array<double, most_parameters> spectrum{}, theta{};
    std::uint64_t hash = 0xcbf29ce484222325;                  ///< FNV-1a of theta after every row
    Index rows = 0, first_indefinite = 0, first_unsound = 0;  ///< row numbers from 1; 0: none yet
    GuardCounts counts;                                       ///< zeros without a guard

    template <class F>
    Running(F const& filter, Seed seed)
        : seed_(seed), take_([f = filter](Running& r, auto const&... row) mutable { r.take(f, row...); }) {}
    /// psi and y have the format's bits.
    void update(Regressor<double> psi, double y, Exact const& exact, bool measured) {
        take_(*this, psi, y, exact, measured);
    }
};

/// A running V; with a guard around it as settings.hpp numbers them, 0: none.
template <class V>
Running run(Problem<VariablePrecision> const& problem, double gain_error, int guard, Seed seed) {
    using F = Erring<V>;
    StochasticStream const stream(seed);  // a filter computes when it is made, too
    F const filter = [&] {
        if constexpr (GainPerturbable<V>) return F(problem, gain_error);
        else return F(problem);
    }();
    static_assert(std::size(guards) == 2);
    if (guard == 1) return {Guarded<F, guards[0].policy>(filter, problem), seed};
    if (guard == 2) return {Guarded<F, guards[1].policy>(filter, problem), seed};
    return {filter, seed};
}

}  // namespace rlslab::live
