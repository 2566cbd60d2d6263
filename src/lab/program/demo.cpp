// rlslab compare in float and double: what ./lab demo shows, from what that needs.
#include "src/lab/program/run.hpp"

int main(int argc, char** argv) { return rlslab::program::run_compare_alone(argc, argv); }
