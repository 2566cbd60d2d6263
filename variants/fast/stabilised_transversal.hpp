// The fast transversal filter with feedback of its numerical errors, 8d.
#pragma once

#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/fast/fast_form.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// `transversal` with two numbers computed in two ways. In exact arithmetic they agree; their difference is rounding,
/// and is fed back:
///
///   (1) to (3) of transversal.hpp                                 F, gamma', E, a
///   (4) nu = E_d,  s = lambda B nu,  f = u_{k-d} - b'psi_k         two values of e_b
///       e_1 = s + 3/2 (f - s),   e_2 = s + 5/2 (f - s)
///   (5) g = gamma' / (1 - gamma' nu f)
///   (6) C = (E_0 ... E_{d-1}) + nu b
///   (7) B = lambda B + g e_2^2,   b += C g e_1
///   (8) gamma = lambda^d B / F                                    det of the matrix of order d + 1 in two ways
///   (9) e = y - psi_k'theta,   theta += C gamma e
///
/// In the mean an error of b shrinks by 1 - (1 - lambda)/2 a row and one of B / F by 1 - 4 (1 - lambda)
/// (docs/theory.md 102); with gains of 1 in (4) that of b would not shrink. In the mean alone: its mean square needs
/// 1 - lambda below 0.44 / (d + 2) (1 / (4 d) was tried, with d = 8), and with lambda = 1 nothing shrinks. Outside of
/// that it ends as `transversal` does, gamma outside [0, 1]. A silence that lets F and B underflow ends it, too: (8) is
/// then a quotient of subnormal numbers. Storage 6d; per update 8d + O(1) multiplications and 4 divisions.
/// Source: Slock & Kailath 1991 (abstract read). Gains 3/2, 5/2 and 1 as in a program of Diniz's Algorithm 8.2, which
/// computes gamma = 1 / (1 + C'psi) in place of (8). The rates are derived (docs/theory.md 102).
template <Field T, int N = Dynamic>
class StabilisedTransversal {
    T lambda_, power_ = T(1), F_, B_, gamma_ = T(1);
    DelayLine<T, N == Dynamic ? Dynamic : N + 1> line_;
    StateVector<T, N> a_, b_, C_, theta_;
    StateVector<T, N == Dynamic ? Dynamic : N + 1> E_;

public:
    using scalar = T;
    static constexpr std::string_view name = "stabilised_transversal";

    explicit StabilisedTransversal(FastProblem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), F_(problem.energy), B_(problem.energy),
          line_((N == Dynamic ? problem.size : N) + 1), a_(problem.size), b_(problem.size), C_(problem.size),
          theta_(problem.size), E_(problem.size + 1) {
        for (Index i = 0; i < size(); ++i) {
            B_ /= lambda_;
            power_ *= lambda_;
        }
    }

    Step<T> update(T const& u, T const& y) {
        Index const d = detail::taps_of(size());
        T const* const x = line_.push(u).data();    // u_k ... u_{k-d}
        T const e = y - dot<N>(theta_.data(), x, d), f = x[d] - dot<N>(b_.data(), x, d);
        T const e_f = x[0] - dot<N>(a_.data(), x + 1, d), past = lambda_ * F_, q = e_f / past;          // (1)
        T const forward = gamma_ * e_f;
        E_[0] = q;
        for (Index i = 0; i < d; ++i) E_[i + 1] = C_[i] - q * a_[i];                                     // (2)
        add_scaled(a_.data(), forward, C_.data(), d);
        F_ = past + forward * e_f;                                                                       // (3)
        T const longer = gamma_ * (past / F_), nu = E_[d], behind = lambda_ * B_, s = behind * nu, apart = f - s;
        T const e_1 = s + T(1.5) * apart, e_2 = s + T(2.5) * apart;                                      // (4)
        T const g = longer / (T(1) - longer * nu * f);                                                   // (5)
        B_ = behind + g * e_2 * e_2;
        for (Index i = 0; i < d; ++i) C_[i] = E_[i] + nu * b_[i];                                        // (6)
        T const backward = g * e_1;
        add_scaled(b_.data(), backward, C_.data(), d);                                                   // (7)
        gamma_ = power_ * (B_ / F_);                                                                     // (8)
        T const residual = gamma_ * e;
        add_scaled(theta_.data(), residual, C_.data(), d);                                               // (9)
        return detail::step_of_kept(e, gamma_, is_finite(F_) && is_finite(B_));
    }

    Index size() const { return theta_.size(); }
    auto theta() const { return theta_.view(); }
};
static_assert(HasTaps<StabilisedTransversal<double>>);

}  // namespace rlslab
