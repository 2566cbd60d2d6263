// Two studies that compute in double themselves, at -O3 with all that they include (tests/studies/optimisation.cpp).
#include <rlslab/studies/study_main.hpp>

namespace rlslab::studies {
extern Study const cost_recursion, hilbert;
}

int main(int argc, char** argv) {
    return rlslab::study_main(argc, argv, {rlslab::studies::cost_recursion, rlslab::studies::hilbert});
}
