// The clock and the loop that every quoted time comes from: the benchmarks' rows and the ns column of `rlslab compare`.
#pragma once

#include <rlslab/core/problem.hpp>

#include <chrono>

namespace rlslab {

/// Makes the compiler believe that what x points to or holds is read: work nobody looks at is otherwise left out.
template <class T>
void wanted(T const& x) {
    asm volatile("" : : "r"(&x) : "memory");
}

/// Nanoseconds that work() took.
template <class Work>
double nanoseconds_of(Work&& work) {
    using Clock = std::chrono::steady_clock;
    auto const start = Clock::now();
    work();
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// Whether theta() is asked for after each row: variants that solve for it on request pay there.
enum class Theta { unasked, asked };

/// Nanoseconds for rows first ... last-1, one by one; where theta is not asked for, without a report if that is dear (f.take,
/// see Accumulates). Anything with update(psi, y) and theta() will do. The caller restarts
/// the filter between stretches: some variants stop being finite after a few thousand rows, and NaN is fast.
template <Theta theta, class F, class T = typename F::scalar>
double stretch(F& filter, Matrix<T> const& psi, Vector<T> const& y, Index first, Index last) {
    return nanoseconds_of([&] {
        for (Index k = first; k < last; ++k) {
            Regressor<T> const row(psi.col(k).data(), psi.rows());
            if constexpr (theta == Theta::unasked && requires { filter.accumulate(row, y[k]); }) filter.accumulate(row, y[k]);
            else filter.update(row, y[k]);
            if constexpr (theta == Theta::asked) {
                auto const& answer = filter.theta();
                wanted(answer);
            }
        }
        wanted(filter);
    });
}

}  // namespace rlslab
