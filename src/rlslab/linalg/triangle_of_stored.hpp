// From one stored form of P to another: factors are handed on, neither P nor its inverse is made on the way.
#pragma once

#include <rlslab/core/stored.hpp>
#include <rlslab/linalg/rotations.hpp>
#include <rlslab/linalg/triangles.hpp>

namespace rlslab {

/// P = F diag(D) F', F upper triangular; or P^-1 so, F lower triangular. From what a filter stores, and to what another
/// does:
///
///   (1) plain P or P^-1: Cholesky without roots, d^3/6; fails from about kappa(R)^2 u = 1 on, 2 log10 kappa digits of
///     its inverse are lost
///   (2) a full square root S: S T upper triangular by rotations from the right, T orthogonal, d^3; P = (S T)(S T)'
///   (3) between P and P^-1: F^-T for F, 1/D for D, d^3/6; log10 kappa digits at worst, usually none
///   (4) a unit triangle from a root: D_j = D_j F_jj^2, column j over F_jj; a root from a unit triangle: column j times
///     sqrt(D_j)
///
/// Complex numbers: a factor has to be triangular already, with a real diagonal.
/// definite: no pivot of what is given is zero or negative; once turned, that every pivot is positive and every number
/// finite, too. Source: Bierman 1977; Golub & Van Loan 2013.
template <Scalar T, int N = Dynamic>
class Triangle {
    void triangularise() {
        if constexpr (Real<T>) {
            for (Index i = D.size() - 1; i > 0; --i)
                for (Index j = 0; j < i; ++j) {
                    Rotation<T> const turn = givens(F(i, i), F(i, j));
                    for (Index k = 0; k <= i; ++k) {
                        T const up = turn.s * F(k, j), turned = turn.c * F(k, i) + up, down = turn.s * F(k, i);
                        F(k, j) = turn.c * F(k, j) - down;
                        F(k, i) = turned;
                    }
                    F(i, j) = T(0);
                }
        }
    }
    void invert() {
        StateMatrix<T, N> const from = F;
        Index const d = D.size();
        F = StateMatrix<T, N>(d);
        for (Index j = 0; j < d; ++j) {
            D[j] = RealOf<T>(1) / D[j];
            F(j, j) = T(RealOf<T>(1) / real_part(from(j, j)));
            if (covariance)  // column j of F^-T is row j of F^-1, by F^-1 F = I
                for (Index i = j + 1; i < d; ++i)
                    F(i, j) = -(conjugate(dot(F.column(j) + j, from.column(i) + j, i - j)) / real_part(from(i, i)));
            else
                for (Index i = j - 1; i >= 0; --i)
                    F(i, j) =
                        -(conjugate(dot(F.column(j) + i + 1, from.column(i) + i + 1, j - i)) / real_part(from(i, i)));
        }
        covariance = !covariance;
    }
    void scale_column(Index j, RealOf<T> const& by, bool divide) {
        for (Index i = covariance ? 0 : j; i < (covariance ? j + 1 : D.size()); ++i)
            F(i, j) = divide ? T(F(i, j) / by) : T(F(i, j) * by);
    }

public:
    bool covariance;  ///< of P, F upper; else of P^-1, F lower
    StateMatrix<T, N> F;
    StateVector<RealOf<T>, N> D;  ///< ones for a root
    Truth<T> definite = true;

    explicit Triangle(Stored<T> const& stored)
        : covariance(stored.quantity == Stored<T>::Quantity::covariance), F(stored.F.rows()), D(stored.F.rows()) {
        Index const d = D.size();
        if (stored.form == Stored<T>::Form::plain) {  // (1)
            StateMatrix<T, N> X(d);
            for (Index j = 0; j < d; ++j)
                for (Index i = 0; i < d; ++i) X(i, j) = stored.F(i, j);
            definite = covariance ? factor_udu(stored.F, F, D) : factor_ldl(X, F, D);
            return;
        }
        Truth<T> triangular = true;
        for (Index j = 0; j < d; ++j) {
            D[j] = stored.D.size() > 0 ? stored.D[j] : RealOf<T>(1);
            definite = definite && !(D[j] < RealOf<T>(0)) && !(D[j] == RealOf<T>(0));
            for (Index i = 0; i < d; ++i) {
                F(i, j) = stored.F(i, j);
                if (covariance ? j < i : i < j) triangular = triangular && (F(i, j) == T(0) || !is_finite(F(i, j)));
            }
        }
        for (Index j = 0; j < d; ++j) definite = definite && !(triangular && F(j, j) == T(0));
        if constexpr (ComplexScalar<T>)
            for (Index j = 0; j < d; ++j)
                expects(all(F(j, j).im == RealOf<T>(0)), "a triangular factor with a real diagonal");
        if (all(triangular)) return;
        expects(covariance && stored.D.size() == 0 && Real<T>,
                "a triangular factor: upper of P, lower of its inverse; or a square root of P");
        triangularise();  // (2)
    }

    /// The same of P or of P^-1, by a unit triangle or by a root.
    Triangle& turn_into(bool of_covariance, bool unit) {
        if (covariance != of_covariance) invert();  // (3)
        for (Index j = 0; j < D.size(); ++j) {      // (4)
            RealOf<T> const pivot = real_part(F(j, j));
            if (unit && !all(pivot == RealOf<T>(1))) {
                scale_column(j, pivot, true);
                D[j] *= pivot * pivot;
            }
            if constexpr (RootedScalar<T>) {
                if (!unit && !all(D[j] == RealOf<T>(1))) {
                    scale_column(j, square_root(D[j]), false);
                    D[j] = RealOf<T>(1);
                }
            }
            definite = definite && RealOf<T>(0) < D[j] && is_finite(D[j]) && !(F(j, j) == T(0));
            for (Index i = 0; i < D.size(); ++i) definite = definite && is_finite(F(i, j));
        }
        return *this;
    }
};

/// Whether what is stored is a unit triangle and D, or is made one first; else it is a root.
template <class T>
bool by_unit_triangle(Stored<T> const& stored) {
    return stored.form == Stored<T>::Form::plain || stored.D.size() > 0;
}

/// The prior's stored form turned into another. Throws std::invalid_argument where it is not definite; numbers that
/// overflow on the way are let in, as from any prior.
template <int N, Scalar T>
Triangle<T, N> start_triangle(Prior<T> const& prior, bool of_covariance, bool unit) {
    Triangle<T, N> out(*prior.stored);
    expects(all(out.definite), "a positive definite prior covariance");
    out.turn_into(of_covariance, unit);
    return out;
}

}  // namespace rlslab
