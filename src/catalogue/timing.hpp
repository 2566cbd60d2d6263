// The clock and the loop behind every quoted time: the rows of the benchmarks and the ns column of `rlslab compare`.
#pragma once

#include <rlslab/core/problem.hpp>

#include <chrono>

namespace rlslab {

/// Makes the compiler assume that x, and everything it points to, is read here. Otherwise it leaves out work whose
/// result is not used.
template <class T>
void do_not_optimize(T const& x) {
    asm volatile("" : : "r"(&x) : "memory");
}

/// The duration of work() in nanoseconds.
template <class Work>
double nanoseconds_of(Work&& work) {
    using Clock = std::chrono::steady_clock;
    auto const start = Clock::now();
    work();
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// Whether theta() is called after each row: variants that solve for it on request do so there.
enum class Theta { unasked, asked };

/// Nanoseconds for rows first ... last-1 (psi is d x N, y has N numbers), one by one; with Theta::unasked by
/// accumulate(psi, y) if the filter has it. F is any type with update(psi, y) and theta(). The caller restarts the
/// filter between stretches: some variants are not finite after a few thousand rows, and arithmetic with NaN takes
/// another time.
template <Theta theta, class F, class T = typename F::scalar>
double stretch(F& filter, Matrix<T> const& psi, Vector<T> const& y, Index first, Index last) {
    return nanoseconds_of([&] {
        for (Index k = first; k < last; ++k) {
            Regressor<T> const row(psi.col(k).data(), psi.rows());
            if constexpr (theta == Theta::unasked && requires { filter.accumulate(row, y[k]); })
                filter.accumulate(row, y[k]);
            else filter.update(row, y[k]);
            if constexpr (theta == Theta::asked) {
                auto const& answer = filter.theta();
                do_not_optimize(answer);
            }
        }
        do_not_optimize(filter);
    });
}

}  // namespace rlslab
