// Two studies that compute in double themselves, at -O3 with all that they include (tests/studies/engine.cpp).
#include <rlslab/studies/study_main.hpp>

namespace rlslab::studies {
extern Study const fused_symmetry, sliding_window;
}

int main(int argc, char** argv) {
    return rlslab::study_main(argc, argv, {rlslab::studies::fused_symmetry, rlslab::studies::sliding_window});
}
