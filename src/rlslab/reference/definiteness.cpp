// Health of a stored matrix, decided exactly: balls first, integers where balls cannot.
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>

namespace rlslab {

namespace {

using namespace balls;

bool all_finite(Stored<Reference> const& stored) {
    auto const finite = [](Reference const& x) { return is_finite(x); };
    return std::all_of(stored.F.data(), stored.F.data() + stored.F.size(), finite) &&
           std::all_of(stored.D.data(), stored.D.data() + stored.D.size(), finite);
}

/// A triangle's determinant is its diagonal's product. 0: has a zero there; 1: has none; -1: not a triangle.
int triangle_is_regular(Matrix<Reference> const& F) {
    bool upper = true, lower = true, regular = true;
    for (Index j = 0; j < F.cols(); ++j) {
        for (Index i = 0; i < j; ++i) lower = lower && F(i, j) == 0;
        for (Index i = j + 1; i < F.rows(); ++i) upper = upper && F(i, j) == 0;
        regular = regular && F(j, j) != 0;
    }
    return upper || lower ? int(regular) : -1;
}

/// F + F' = L D L' in place, one column at a time. The number of pivots shown positive before one that is not; that
/// one, in `stop`, either is shown <= 0 or contains zero.
Index positive_pivots(Matrix<Reference> const& F, long bits, Ball& stop) {
    Index const d = F.rows();
    BallMatrix A(d, d);
    BallMatrix const mirrored = exact(F.transpose());
    arb_mat_add(A, exact(F), mirrored, bits);
    for (Index j = 0; j < d; ++j) {
        if (!arb_is_positive(A(j, j))) {
            arb_set(stop, A(j, j));
            return j;
        }
        for (Index i = j + 1; i < d; ++i) {
            Ball l;
            arb_div(l, A(i, j), A(j, j), bits);
            for (Index k = j + 1; k <= i; ++k) arb_submul(A(i, k), l, A(k, j), bits);
        }
    }
    return d;
}

Health definiteness_of_plain(Matrix<Reference> const& F) {
    constexpr long patience = 512;  // bits; beyond, the determinant decides first: no precision would end an exact zero
    Index proven = 0;               // leading minors up to this size are known to be positive
    Ball stop;
    for (long bits = 128;; bits *= 2) {
        Index const j = positive_pivots(F, bits, stop);
        if (j == F.rows()) return Health::sound;
        if (arb_is_nonpositive(stop)) return Health::indefinite;
        if (bits < patience || j < proven) continue;
        // The pivots before are positive, so this one has the sign of its leading minor.
        if (sign_of_leading_minor(F, j + 1) <= 0) return Health::indefinite;
        proven = j + 1;
        if (proven == F.rows()) return Health::sound;
    }
}

}  // namespace

Health definiteness(Stored<Reference> const& stored) {
    expects(stored.F.rows() == stored.F.cols(), "a square F");
    expects(stored.D.size() == 0 || stored.D.size() == stored.F.rows(), "D of F's size");
    if (!all_finite(stored)) return Health::nonfinite;
    if (stored.form == Stored<Reference>::Form::plain) return definiteness_of_plain(stored.F);
    for (Reference const& d : stored.D)
        if (d <= 0) return Health::indefinite;
    int const regular = triangle_is_regular(stored.F);
    bool const yes = regular < 0 ? nonsingular(stored.F) : regular == 1;
    return yes ? Health::sound : Health::indefinite;
}

}  // namespace rlslab
