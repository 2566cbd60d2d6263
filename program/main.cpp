// The rlslab program.
#include "program/run.hpp"

int main(int argc, char** argv) {
    rlslab::prepare_process();
    return rlslab::run({argv + (argc > 0), argv + argc});
}
