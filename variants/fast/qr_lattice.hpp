// The QR-decomposition least-squares lattice: rotations alone.
#pragma once

#include <rlslab/fast/fast_form.hpp>
#include <rlslab/linalg/kernels.hpp>
#include <rlslab/linalg/rotations.hpp>

namespace rlslab {

/// Propagates roots of the energies, F_m = phi_m^2 and B_m = beta_m^2, for m = 0 ... d - 1, and the rotated
/// correlations p_f, p_b and p. Errors are angle-normalised: sqrt(gamma) times the a priori ones. x- : x of the row
/// before. At first p_f, p_b, p, b and s are 0, c is 1, phi_m = sqrt(delta), beta_m = sqrt(delta lambda^-m).
/// r = sqrt(lambda). Per row f_0 = b_0 = u, e_0 = y, and for each m, G = [c s; -s c]:
///
///   (1) G (r beta_m-, b_m)' = (beta_m, 0)'                   gives c_m and s_m
///   (2) (p_m, e_{m+1})' = G (r p_m-, e_m)'
///   (3) (p_f, f_{m+1})' = G_m- (r p_f-, f_m)'                the rotation of (1) in the row before
///   (4) H (r phi_m-, f_m)' = (phi_m, 0)',   (p_b, b_{m+1})' = H (r p_b-, b_m-)'
///
///   (5) sqrt(gamma) = c_0 ... c_{d-1},   residual = e_d sqrt(gamma),   innovation = e_d / sqrt(gamma)
///
/// Rotations keep lengths: with 1 - lambda well above u stored numbers stay bounded (docs/theory.md 103). gamma is a
/// square, health is never indefinite. Silence is no breakdown: a rotation of (0, 0) is the identity. The rounded r
/// is a biased root of lambda, as in `qr`. Storage 8d; per update 22d multiplications, 4d divisions, 2d roots.
/// Source: Proudler et al. 1988, Haykin (QRD-LSL; both cited, not read); the lines are derived (docs/theory.md 100).
template <Real T, int N = Dynamic>
class QrLattice {
    T root_lambda_;
    StateVector<T, N> phi_, beta_, b_, c_, s_, p_f_, p_b_, p_;

public:
    using scalar = T;
    static constexpr std::string_view name = "qr_lattice";

    explicit QrLattice(FastProblem<T> const& problem)
        : root_lambda_(square_root(checked(problem, N).forgetting)), phi_(problem.size), beta_(problem.size),
          b_(problem.size), c_(problem.size), s_(problem.size), p_f_(problem.size), p_b_(problem.size),
          p_(problem.size) {
        T B = problem.energy;
        for (Index m = 0; m < size(); ++m, B /= problem.forgetting) {
            phi_[m] = square_root(problem.energy);
            beta_[m] = square_root(B);
            c_[m] = T(1);
        }
    }

    Step<T> update(T const& u, T const& y) {
        T f = u, b = u, e = y, root_gamma = T(1);
        Index const d = detail::taps_of(size());
        for (Index m = 0; m < d; ++m) {
            T const b_before = b_[m];
            Rotation<T> const before{c_[m], s_[m], T(0)}, turn = givens(T(root_lambda_ * beta_[m]), b);  // (1)
            beta_[m] = turn.r;
            apply(turn, p_[m], e);                                                                       // (2)
            b_[m] = b;
            c_[m] = turn.c;
            s_[m] = turn.s;
            root_gamma *= turn.c;
            if (m + 1 < d) {
                Rotation<T> const ahead = givens(T(root_lambda_ * phi_[m]), f);                          // (4)
                phi_[m] = ahead.r;
                b = b_before;
                apply(ahead, p_b_[m], b);
                apply(before, p_f_[m], f);                                                               // (3)
            }
        }
        return report_rotated(e, root_gamma, true);                                                      // (5)
    }

    Index size() const { return beta_.size(); }

private:
    void apply(Rotation<T> const& turn, T& kept, T& error) const {
        T const aged = root_lambda_ * kept, added = turn.s * error, taken = turn.s * aged;
        kept = turn.c * aged + added;
        error = turn.c * error - taken;
    }
};
static_assert(FastForm<QrLattice<double>>);

}  // namespace rlslab
