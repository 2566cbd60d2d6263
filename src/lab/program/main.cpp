// The rlslab program.
#include "src/lab/program/run.hpp"

int main(int argc, char** argv) {
    rlslab::program::prepare_process();
    return rlslab::program::run({argv + (argc > 0), argv + argc});
}
