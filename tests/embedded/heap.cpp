// A filter of free size, which asks for memory: on the board it does not link.
#include <rlslab/variants/ud.hpp>

int main() {
    rlslab::Ud<float> filter({.size = 3});
    return int(filter.theta()[0]);
}
