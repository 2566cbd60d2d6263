// The least-squares lattice of a posteriori errors.
#pragma once

#include <rlslab/fast/fast_form.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// Propagates, for each order m = 0 ... d - 1, the correlation Delta of forward and backward errors, their energies F
/// and B, and the joint process' correlation rho. A number with a bar is that of the row before. At first Delta, rho, b
/// are 0, gamma 1, F_m = delta, B_m = delta lambda^-m. Per row f_0 = b_0 = u, gamma_0 = 1, e_0 = y, and for each m:
///
///   (1) B_m = lambda B_m- + b_m^2 / gamma_m
///   (2) rho_m = lambda rho_m- + b_m e_m / gamma_m,   e_{m+1} = e_m - (rho_m / B_m) b_m
///   (3) F_m = lambda F_m- + f_m^2 / gamma_m-
///   (4) Delta_m = lambda Delta_m- + f_m b_m- / gamma_m-
///   (5) f_{m+1} = f_m - (Delta_m / B_m-) b_m-,   b_{m+1} = b_m- - (Delta_m / F_m) f_m
///   (6) gamma_{m+1} = gamma_m - b_m^2 / B_m
///
/// x- : x of the row before. e_d is the a posteriori error, e_d / gamma_d the a priori one. All errors stay bounded for
/// lambda < 1: (1) to (4) forget by lambda. But (6) subtracts: where gamma is small its relative error is large, and it
/// is divided by; a gamma that rounds to 0 or below makes health nonfinite or indefinite: so it does in the first
/// rows if delta is below 2^-p u^2, and after a silence that let B underflow. `error_feedback_lattice` divides by no
/// gamma. Storage 6d; per update 12d multiplications and 5d divisions.
/// Source: Haykin (recursive LSL with a posteriori estimation errors; cited, not read); the lines are derived
/// (docs/theory.md 100).
template <Field T, int N = Dynamic>
class Lattice {
    T lambda_;
    StateVector<T, N> F_, B_, b_, gamma_, Delta_, rho_;

public:
    using scalar = T;
    static constexpr std::string_view name = "lattice";

    explicit Lattice(FastProblem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), F_(problem.size), B_(problem.size), b_(problem.size),
          gamma_(problem.size), Delta_(problem.size), rho_(problem.size) {
        T B = problem.energy;
        for (Index m = 0; m < size(); ++m, B /= lambda_) {
            F_[m] = problem.energy;
            B_[m] = B;
            gamma_[m] = T(1);
        }
    }

    Step<T> update(T const& u, T const& y) {
        T f = u, b = u, gamma = T(1), e = y;
        Truth<T> finite = true;
        Index const d = detail::taps_of(size());
        for (Index m = 0; m < d; ++m) {
            T const b_before = b_[m], B_before = B_[m], gamma_before = gamma_[m], apriori = b / gamma;
            B_[m] = lambda_ * B_before + b * apriori;                                                    // (1)
            T const by_B = b / B_[m];
            rho_[m] = lambda_ * rho_[m] + apriori * e;                                                   // (2)
            e -= rho_[m] * by_B;
            b_[m] = b;
            gamma_[m] = gamma;
            if (m + 1 < d) {
                T const f_apriori = f / gamma_before;
                F_[m] = lambda_ * F_[m] + f * f_apriori;                                                 // (3)
                Delta_[m] = lambda_ * Delta_[m] + f_apriori * b_before;                                  // (4)
                b = b_before - Delta_[m] / F_[m] * f;                                                    // (5)
                f -= Delta_[m] / B_before * b_before;
            }
            finite = finite && is_finite(B_[m]) && is_finite(F_[m]);
            gamma -= by_B * b_[m];                                                                       // (6)
        }
        Step<T> step = step_of(T(e / gamma), gamma);
        step.residual = e;
        return if_finite(finite, step);
    }

    Index size() const { return B_.size(); }
};
static_assert(FastForm<Lattice<double>>);

}  // namespace rlslab
