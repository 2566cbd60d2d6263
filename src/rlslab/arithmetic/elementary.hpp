// Elementary functions of doubles, each result correctly rounded. libm's are not: it has several codes, and the
// processor decides which one runs, and with it the last bit. Everything that computes data or numbers of a table uses
// these.
#pragma once

namespace rlslab::correctly {

/// Rounded to nearest, ties to even. Infinities, NaN, zeros and arguments outside the domain as in C's functions of
/// these names; angles are in radians.
double exp(double x);
double exp2(double x);
double log(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double hypot(double x, double y);
double cos(double x);
double sin(double x);
double atan2(double y, double x);

}  // namespace rlslab::correctly
