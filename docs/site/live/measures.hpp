// What the page shows of a P: whether it is definite, its digits, its eigenvalues. Computed in 106 bits from the stored
// numbers, so that the measurement adds no error that could be seen.
#pragma once

#include <rlslab/arithmetic/pair.hpp>
#include <rlslab/core/stored.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

namespace rlslab::live {

inline constexpr int most_parameters = 12;
using Numbers = std::array<Pair, most_parameters>;
/// The first d x d numbers are used.
using Square = std::array<Numbers, most_parameters>;

inline bool all_finite(Square const& A, int d) {
    for (int i = 0; i < d; ++i)
        for (int j = 0; j < d; ++j)
            if (!isfinite(A[i][j])) return false;
    return true;
}
inline void symmetrise(Square& A, int d) {
    for (int i = 0; i < d; ++i)
        for (int j = 0; j < i; ++j) A[i][j] = A[j][i] = (A[i][j] + A[j][i]) * Pair(0.5);
}
/// Whether all pivots of A = L D L' are positive; L and D take its place. d^3/6 multiplications.
inline bool factor(Square& A, int d) {
    bool positive = true;
    for (int j = 0; j < d; ++j) {
        positive = positive && A[j][j] > Pair(0);
        for (int i = j + 1; i < d; ++i) {
            Pair const l = A[i][j] / A[j][j];
            for (int k = j + 1; k <= i; ++k) A[i][k] -= l * A[k][j];
        }
        for (int i = j + 1; i < d; ++i) A[i][j] /= A[j][j];
    }
    return positive;
}
/// (L D L')^-1 of the lower triangle L, whose diagonal is used unless `unit`.
inline Square inverse(Square const& L, Numbers const& D, int d, bool unit) {
    Square G{}, out{};
    for (int j = 0; j < d; ++j)
        for (int i = j; i < d; ++i) {
            Pair sum(i == j ? 1 : 0);
            for (int k = j; k < i; ++k) sum -= L[i][k] * G[k][j];
            G[i][j] = unit ? sum : sum / L[i][i];
        }
    for (int i = 0; i < d; ++i)
        for (int j = 0; j <= i; ++j) {
            Pair sum(0);
            for (int k = i; k < d; ++k) sum += G[k][i] * G[k][j] / D[k];
            out[i][j] = out[j][i] = sum;
        }
    return out;
}

/// What is stored, widened. Without D it is a vector of ones.
template <class T>
void widen(Stored<T> const& stored, Square& F, Numbers& D) {
    int const d = int(stored.F.rows());
    for (int i = 0; i < d; ++i) {
        D[i] = stored.D.size() > 0 ? Pair(static_cast<double>(stored.D[i])) : Pair(1);
        for (int j = 0; j < d; ++j)
            if constexpr (std::same_as<T, Pair>) F[i][j] = stored.F(i, j);
            else F[i][j] = Pair(static_cast<double>(stored.F(i, j)));
    }
}
/// Whether the symmetric part of P is positive definite; of a factor without D: whether it is finite, and where it is
/// of P^-1 without a zero on the diagonal.
template <class T>
bool is_definite(Stored<T> const& stored) {
    int const d = int(stored.F.rows());
    Square F;
    Numbers D;
    widen(stored, F, D);
    if (!all_finite(F, d)) return false;
    if (stored.form == Stored<T>::Form::plain) {
        symmetrise(F, d);
        return factor(F, d);
    }
    for (int i = 0; i < d; ++i)
        if (!isfinite(D[i]) || !(D[i] > Pair(0)) ||
            (stored.quantity == Stored<T>::Quantity::information && F[i][i] == Pair(0)))
            return false;
    return true;
}
/// The symmetric part of P. A stored P^-1 is inverted; where it has no inverse, numbers are not finite.
template <class T>
Square covariance_of_stored(Stored<T> const& stored) {
    int const d = int(stored.F.rows());
    Square F;
    Numbers D;
    widen(stored, F, D);
    bool const plain = stored.form == Stored<T>::Form::plain,
               information = stored.quantity == Stored<T>::Quantity::information;
    if (plain) {
        symmetrise(F, d);
        if (!information) return F;
        factor(F, d);
        for (int i = 0; i < d; ++i) D[i] = F[i][i];
    }
    if (information) return inverse(F, D, d, plain);
    Square out{};
    for (int i = 0; i < d; ++i)
        for (int j = 0; j <= i; ++j) {
            Pair sum(0);
            for (int k = 0; k < d; ++k) sum += F[i][k] * D[k] * F[j][k];
            out[i][j] = out[j][i] = sum;
        }
    return out;
}

inline constexpr double most_digits = 32;
/// -log10(error / size), at most most_digits; NaN where the error is not finite.
inline double digits_of(double squared_error, double squared_size) {
    double const relative = std::sqrt(squared_error / squared_size);
    if (squared_error == 0) return most_digits;
    return std::isfinite(relative) ? std::min(most_digits, -std::log10(relative))
                                   : std::numeric_limits<double>::quiet_NaN();
}
/// In the Frobenius norm.
inline double digits_of(Square const& P, Square const& exact, int d) {
    double error = 0, size = 0;
    for (int i = 0; i < d; ++i)
        for (int j = 0; j < d; ++j) {
            double const e = double(P[i][j] - exact[i][j]), x = double(exact[i][j]);
            error += e * e, size += x * x;
        }
    return digits_of(error, size);
}

/// The eigenvalues of a symmetric A, the largest first, by Jacobi's rotations; NaN where A is not finite. Rotations end
/// where |a_pq| <= 2^-100 sqrt|a_pp a_qq|: small eigenvalues of a graded matrix keep their digits.
inline std::array<double, most_parameters> eigenvalues(Square A, int d) {
    std::array<double, most_parameters> out;
    out.fill(std::numeric_limits<double>::quiet_NaN());
    if (!all_finite(A, d)) return out;
    bool rotated = true;
    for (int sweep = 0; rotated && sweep < 40; ++sweep) {
        rotated = false;
        for (int p = 0; p < d; ++p)
            for (int q = p + 1; q < d; ++q) {
                double const apq = double(A[p][q]);
                if (std::abs(apq) <=
                        0x1p-100 * std::sqrt(std::abs(double(A[p][p]))) * std::sqrt(std::abs(double(A[q][q]))) ||
                    apq == 0)
                    continue;
                rotated = true;
                Pair const ratio = (A[q][q] - A[p][p]) / (Pair(2) * A[p][q]), size = ratio < Pair(0) ? -ratio : ratio;
                Pair t = Pair(1) / (size + sqrt(Pair(1) + size * size));
                if (!isfinite(t)) t = Pair(0);
                if (ratio < Pair(0)) t = -t;
                Pair const c = Pair(1) / sqrt(Pair(1) + t * t), s = c * t, step = t * A[p][q];
                A[p][p] -= step, A[q][q] += step;
                A[p][q] = A[q][p] = Pair(0);
                for (int i = 0; i < d; ++i) {
                    if (i == p || i == q) continue;
                    Pair const x = A[i][p], y = A[i][q];
                    A[i][p] = A[p][i] = c * x - s * y;
                    A[i][q] = A[q][i] = s * x + c * y;
                }
            }
    }
    for (int i = 0; i < d; ++i) out[i] = double(A[i][i]);
    std::sort(out.begin(), out.begin() + d, std::greater<>());
    return out;
}

}  // namespace rlslab::live
