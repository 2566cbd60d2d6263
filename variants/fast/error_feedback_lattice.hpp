// The least-squares lattice of a priori errors with error feedback.
#pragma once

#include <rlslab/fast/fast_form.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// Propagates, for each order m = 0 ... d - 1, the reflection coefficients k_f and k_b and the regression coefficient h
/// themselves, each corrected by the error that it leaves. x- : x of the row before. At first k_f, k_b, h and beta are
/// 0, gamma 1, F_m = delta, B_m = delta lambda^-m. Per row eta_0 = beta_0 = u, gamma_0 = 1, e_0 = y, and for each m:
///
///   (1) B_m = lambda B_m- + gamma_m beta_m^2
///   (2) e_{m+1} = e_m - h_m- beta_m,                h_m = h_m- + gamma_m beta_m e_{m+1} / B_m
///   (3) F_m = lambda F_m- + gamma_m- eta_m^2
///   (4) eta_{m+1} = eta_m - k_f- beta_m-,           k_f = k_f- + gamma_m- beta_m- eta_{m+1} / B_m-
///   (5) beta_{m+1} = beta_m- - k_b- eta_m,          k_b = k_b- + gamma_m- eta_m beta_{m+1} / F_m
///   (6) gamma_{m+1} = gamma_m - (gamma_m beta_m)^2 / B_m
///
/// e_d is the a priori error. An error of a coefficient is seen in the next error and corrected: it shrinks by about
/// lambda a row (docs/theory.md 103). No line divides by gamma: where it should be 0, in the first rows of a
/// large u, rounding may leave a gamma a little below, and the step is sound. It goes on after a silence, unless B
/// underflowed to 0 itself (lambda <= 1/2): then 0/0, and health is nonfinite.
/// Storage 7d; per update 14d multiplications and 3d divisions.
/// Source: Haykin (recursive LSL with a priori estimation errors and error feedback; cited, not read); the lines are
/// derived (docs/theory.md 100).
template <Field T, int N = Dynamic>
class ErrorFeedbackLattice {
    T lambda_;
    StateVector<T, N> F_, B_, beta_, gamma_, k_f_, k_b_, h_;

public:
    using scalar = T;
    static constexpr std::string_view name = "error_feedback_lattice";

    explicit ErrorFeedbackLattice(FastProblem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), F_(problem.size), B_(problem.size), beta_(problem.size),
          gamma_(problem.size), k_f_(problem.size), k_b_(problem.size), h_(problem.size) {
        T B = problem.energy;
        for (Index m = 0; m < size(); ++m, B /= lambda_) {
            F_[m] = problem.energy;
            B_[m] = B;
            gamma_[m] = T(1);
        }
    }

    Step<T> update(T const& u, T const& y) {
        T eta = u, beta = u, gamma = T(1), e = y;
        Truth<T> finite = true;
        Index const d = detail::taps_of(size());
        for (Index m = 0; m < d; ++m) {
            T const beta_before = beta_[m], B_before = B_[m], gamma_before = gamma_[m], weighed = gamma * beta;
            B_[m] = lambda_ * B_before + weighed * beta;                                                 // (1)
            T const by_B = weighed / B_[m];
            e -= h_[m] * beta;                                                                           // (2)
            h_[m] += by_B * e;
            beta_[m] = beta;
            gamma_[m] = gamma;
            if (m + 1 < d) {
                T const eta_weighed = gamma_before * eta;
                F_[m] = lambda_ * F_[m] + eta_weighed * eta;                                             // (3)
                beta = beta_before - k_b_[m] * eta;                                                      // (5)
                k_b_[m] += eta_weighed / F_[m] * beta;
                eta -= k_f_[m] * beta_before;                                                            // (4)
                k_f_[m] += gamma_before * beta_before / B_before * eta;
            }
            finite = finite && is_finite(B_[m]) && is_finite(F_[m]);
            gamma -= by_B * weighed;                                                                     // (6)
        }
        return detail::step_of_kept(e, gamma, finite, true);
    }

    Index size() const { return B_.size(); }
};
static_assert(FastForm<ErrorFeedbackLattice<double>>);

}  // namespace rlslab
