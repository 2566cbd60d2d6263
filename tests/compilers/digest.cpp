// Prints what each variant computes, a line each: two compilers must print the same. Stochastic rounding shows an order
// of evaluation that the language leaves open, because every operation draws.
#include "tests/compilers/everything.hpp"

#include <cstdio>

using namespace rlslab;

template <class T>
void every_variant(char const* arithmetic) {
    for_each(Variants<T>{}, [&]<class F>() {
        Seed draws{1};
        StochasticStream const stream(draws);
        std::uint64_t const digest = everything::digest_of<F>().value;
        // SplitMix64 counts in steps of an odd number: times its inverse, the state is the number of draws.
        std::printf("%s %s %016llx %llu\n", std::string(F::name).c_str(), arithmetic,
                    static_cast<unsigned long long>(digest),
                    static_cast<unsigned long long>((draws.state - 1) * 0xf1de83e19937733d));
    });
}

int main() {
    every_variant<Chopped<binary16, Rounding::stochastic>>("binary16-stochastic");
    every_variant<double>("double");
}
