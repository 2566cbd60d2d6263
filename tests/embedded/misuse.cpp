// Misuse where exceptions are compiled out: with on_misuse.cpp a function of the program's own, without it a trap.
#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/variants/ud.hpp>

int main() {
    rlslab::Ud<float, 3> filter({.size = 4});
    return int(filter.theta()[0]);
}
