// Families of variants: what belongs together looks alike in figures.
#pragma once

namespace rlslab {

/// The members of a family share a colour; each has a place of its own there, which gives it its mark and dash.
struct Family {
    enum Kind : unsigned char {
        conventional,      ///< P - K (P psi)', all of P
        symmetric,         ///< the same of one triangle
        joseph,            ///< Joseph's products
        root,              ///< a square root of P
        ud,                ///< U and D of P, or a triangle by rotations
        normal_equations,  ///< P^-1, and its Cholesky factor
        qr,                ///< the triangle R of P^-1 by rotations
        wide_qr,           ///< R with its inverse, or of blocks
        other
    } kind = other;
    int place = 0;
};

}  // namespace rlslab
