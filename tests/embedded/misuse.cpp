// Misuse where exceptions are compiled out: -DHANDLED with a function of the program's own, without it a trap.
#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/variants/ud.hpp>

#include <board.hpp>

#ifdef HANDLED
void rlslab::on_misuse(char const* expected) {
    print("expected ");
    print(expected);
    print("\n");
    stop(3);
}
#endif

int main() {
    rlslab::Ud<float, 3> filter({.size = 4});
    return int(filter.theta()[0]);
}
