// The fast transversal filter (FTF), 7d: theta in O(d) a row, exponentially unstable.
#pragma once

#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/fast/fast_form.hpp>
#include <rlslab/linalg/kernels.hpp>

namespace rlslab {

/// Propagates the forward predictor a, the backward predictor b, their energies F and B, and the gain. With
/// psi_k = (u_k ... u_{k-d+1}), C = K / gamma (at first 0), gamma = 1, F = delta, B = delta lambda^-d:
///
///   (1) e_f = u_k - a'psi_{k-1},  q = e_f / (lambda F)
///   (2) (E_0 ... E_d) = (q, C - q a),   a += C gamma e_f
///   (3) F' = lambda F + gamma e_f^2,   gamma' = gamma lambda F / F'
///   (4) nu = E_d,  e_b = lambda B nu                              which is u_{k-d} - b'psi_k
///   (5) gamma = gamma' / (1 - gamma' nu e_b)
///   (6) C = (E_0 ... E_{d-1}) + nu b
///   (7) B = lambda B + gamma e_b^2,   b += C gamma e_b
///   (8) e = y - psi_k'theta,   theta += C gamma e
///
/// Unstable in every arithmetic that rounds: by (4), (5) and (7) 1/B = (1/B_old) / lambda - gamma' nu^2, so that an
/// error of 1/B grows by 1/lambda a row, and one of b by lambda^-k B_k / B_0 (docs/theory.md 101). With p bits about
/// p ln 2 / ln(1/lambda) rows are left. The end is gamma outside [0, 1]: health is indefinite. `stabilised_transversal`
/// feeds the error back. After a silence that let F underflow the next sample overflows q: health is nonfinite.
/// Storage 6d; per update 7d + O(1) multiplications and 3 divisions.
/// Source: Cioffi & Kailath 1984 (cited, not read); the lines are derived (docs/theory.md 100).
template <Field T, int N = Dynamic>
class Transversal {
    T lambda_, F_, B_, gamma_ = T(1);
    DelayLine<T, N == Dynamic ? Dynamic : N + 1> line_;
    StateVector<T, N> a_, b_, C_, theta_;
    StateVector<T, N == Dynamic ? Dynamic : N + 1> E_;

public:
    using scalar = T;
    static constexpr std::string_view name = "transversal";

    explicit Transversal(FastProblem<T> const& problem)
        : lambda_(checked(problem, N).forgetting), F_(problem.energy), B_(problem.energy),
          line_((N == Dynamic ? problem.size : N) + 1), a_(problem.size), b_(problem.size), C_(problem.size),
          theta_(problem.size), E_(problem.size + 1) {
        for (Index i = 0; i < size(); ++i) B_ /= lambda_;
    }

    Step<T> update(T const& u, T const& y) {
        Index const d = detail::taps_of(size());
        T const* const x = line_.push(u).data();    // u_k ... u_{k-d}
        T const e = y - dot<N>(theta_.data(), x, d);
        T const e_f = x[0] - dot<N>(a_.data(), x + 1, d), past = lambda_ * F_, q = e_f / past;          // (1)
        T const forward = gamma_ * e_f;
        E_[0] = q;
        for (Index i = 0; i < d; ++i) E_[i + 1] = C_[i] - q * a_[i];                                     // (2)
        add_scaled(a_.data(), forward, C_.data(), d);
        F_ = past + forward * e_f;                                                                       // (3)
        T const longer = gamma_ * (past / F_), nu = E_[d], behind = lambda_ * B_, e_b = behind * nu;     // (4)
        gamma_ = longer / (T(1) - longer * nu * e_b);                                                    // (5)
        T const backward = gamma_ * e_b, residual = gamma_ * e;
        B_ = behind + backward * e_b;
        for (Index i = 0; i < d; ++i) C_[i] = E_[i] + nu * b_[i];                                        // (6)
        add_scaled(b_.data(), backward, C_.data(), d);                                                   // (7)
        add_scaled(theta_.data(), residual, C_.data(), d);                                               // (8)
        return detail::step_of_kept(e, gamma_, is_finite(F_) && is_finite(B_));
    }

    Index size() const { return theta_.size(); }
    auto theta() const { return theta_.view(); }
};
static_assert(HasTaps<Transversal<double>>);

}  // namespace rlslab
