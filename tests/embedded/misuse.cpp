// Misuse where exceptions are compiled out: with on_misuse.cpp a function of the program's own, without it a trap.
#ifdef __SIZEOF_INT128__  // without it fixed.hpp is refused, by a line of its own
#include <rlslab/arithmetic/fixed.hpp>
#endif
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/variants/ud.hpp>

int main() {
    rlslab::Ud<float, 3> filter({.size = 4});
    return int(filter.theta()[0]);
}
