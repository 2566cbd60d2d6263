// The program of rlslab_add_bench: the variants, Eigen's textbook form and a class of one's own.
#include "bench/choice.hpp"

#include <cstdio>
#include <exception>
#include <vector>

int main(int argc, char** argv) try {
    std::vector<char*> words(argv, argv + argc);
    char mine[] = "--mine";
    words.insert(words.begin() + (argc > 0), mine);
    words.push_back(nullptr);
    return rlslab::bench::run_rows(argc + 1, words.data());
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 2;
}
