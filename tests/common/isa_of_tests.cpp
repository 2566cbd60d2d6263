// Runs the tests of a program with the kernels of an earlier instruction set than the machine's best:
// RLSLAB_TEST_ISA=baseline|avx2|avx512.
#include "tests/common/each_isa.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string_view>

namespace rlslab {
namespace {

struct IsaOfTests : testing::Environment {
    void SetUp() override {
        char const* const asked = std::getenv("RLSLAB_TEST_ISA");
        if (asked == nullptr) return;
        for (Isa isa : all_isas)
            if (asked == std::string_view(name_of(isa)) && isa <= kernels::best_isa()) {
                kernels::isa = isa;
                return;
            }
        std::cerr << "skipped: this machine does not have the instruction set RLSLAB_TEST_ISA=" << asked << '\n';
        std::exit(4);
    }
};
[[maybe_unused]] testing::Environment* const registered = testing::AddGlobalTestEnvironment(new IsaOfTests);

}  // namespace
}  // namespace rlslab
