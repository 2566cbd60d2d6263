// Elementary functions of doubles, each result correctly rounded. libm's are not: which of several codes it runs, and so the
// last bit, depends on the processor. What feeds data or tables takes these.
#pragma once

namespace rlslab::correctly {

double exp(double x);
double exp2(double x);
double log(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double hypot(double x, double y);
double cos(double x);
double sin(double x);

}  // namespace rlslab::correctly
