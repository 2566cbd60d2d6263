// Fleets on a GPU without one: the kernels' bodies on this processor against the library, their PTX as text.
#include "tests/gpu/compared.hpp"

#include <rlslab/gpu/fleet.hpp>
#include <rlslab/variants/ud.hpp>

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

namespace rlslab::gpu {
namespace {

TEST(GpuFleet, HasTheBitsOfTheLibrarysFilters) {
    int count = 0;
    for (std::string_view form : forms)
        for (int d : {4, 8, 16})
            for (bool is_double : {false, true}) {
                Compared const is = compared(form, is_double, d, 128, 150);
                EXPECT_EQ(is.different, 0) << form << " " << is_double << " " << d << ", first " << is.first;
                EXPECT_TRUE(form != "conventional" || is.not_sound > 0) << form << d;  // some rows overflow
                EXPECT_LT(is.not_sound, 64) << form;
                ++count;
            }
    EXPECT_EQ(count, 42);
}
TEST(GpuFleet, HasThemInTeamsOfAnySizeAndWithoutAPrior) {
    for (char const* form : {"ud", "ud_delta", "conventional"})
        for (int d : {9, 12, 17, 24, 31, 32})
            for (bool is_double : {false, true})
                EXPECT_EQ(compared(form, is_double, d, 66, 60).different, 0) << form << " " << is_double << " " << d;
    for (char const* form : {"qr", "gentleman"})
        for (int d : {4, 16}) EXPECT_EQ(compared(form, true, d, 130, 60, false).different, 0) << form << " " << d;
}
/// In tests/gpu/libcuda.cpp the kernel of 5 parameters fuses one operation, that of 6 sums once in another order.
TEST(GpuFleet, AFusedOperationAndAnotherOrderAreSeen) {
    EXPECT_GT(compared("ud", true, 5, 64, 60).different, 10);
    EXPECT_GT(compared("ud", true, 6, 64, 60).different, 40);
}
TEST(GpuFleet, GoesToTheCpuAndBackAndThroughAFile) {
    for (std::string_view form : forms)
        for (int d : {4, 16}) EXPECT_THAT(lost_on_the_way(form, d == 4, d), testing::IsEmpty()) << form << " " << d;
    EXPECT_THAT(lost_on_the_way("ud", true, 20), testing::IsEmpty());
}
TEST(GpuFleet, SaysWhatItDoesNotTake) {
    Problem<double> const four{.size = 4};
    EXPECT_THROW((Fleet<Ud<double>>(0, four)), std::invalid_argument);
    EXPECT_THROW((Fleet<Ud<double>>(10, Problem<double>{.size = 33})), std::invalid_argument);
    Fleet<Ud<double>> fleet(10, four);
    EXPECT_THROW(fleet.update(Matrix<double>(10, 5), Vector<double>(10)), std::invalid_argument);
    EXPECT_THROW(fleet.update(Matrix<double>(10, 4), Vector<double>(9)), std::invalid_argument);
    EXPECT_THROW(fleet.filter(10), std::invalid_argument);
    EXPECT_THROW(fleet.put(0, Ud<double>(Problem<double>{.size = 5})), std::invalid_argument);
    EXPECT_THROW(fleet.put(0, Ud<double>(Problem<double>{.size = 4, .forgetting = 0.5})), std::invalid_argument);
    EXPECT_EQ(driver::device_name(), "host");
    Fleet<Ud<double>> no_kernel_here(10, Problem<double>{.size = 7});
    EXPECT_THROW(no_kernel_here.update(Matrix<double>::Ones(10, 7), Vector<double>::Ones(10)), std::runtime_error);
}
/// What a GPU left, and CI computes again: ./lab gpu compares a GPU with the same file.
TEST(GpuFleet, TheLibraryHasTheDigestsOfAGpu) {
    std::ifstream file(RLSLAB_SOURCE_DIR "/tests/gpu/digests.txt");
    int lines = 0;
    std::string form, arithmetic, digest;
    std::getline(file, form);  // the card
    for (int d; file >> form >> arithmetic >> d >> digest; ++lines) {
        std::uint64_t const own = compared(form, arithmetic == "double", d, 128, 200, true, false).digest;
        EXPECT_EQ(own, std::stoull(digest, nullptr, 16)) << form << " " << arithmetic << " " << d;
    }
    EXPECT_EQ(lines, 42);
}
/// What PTX must not have: a fused or an approximate operation, subnormal numbers as zeros, a function that is nowhere.
std::vector<std::string> faults_of(std::string_view ptx) {
    std::vector<std::string> out;
    for (char const* word : {"fma.", "mad.rn.f", ".approx", ".ftz", ".extern .func"})
        if (ptx.find(word) != ptx.npos) out.push_back(word);
    return out;
}
TEST(GpuKernels, RoundEachOperationOnce) {
    std::string const ptx(driver::ptx());
    EXPECT_THAT(faults_of(ptx), testing::IsEmpty());
    EXPECT_EQ(ptx.find(".version 7"), ptx.npos) << "of a toolkit that happens to be here";
    for (auto const& [was, is] : {std::pair{"mul.rn.f64", "fma.rn.f64"},
                                  {"div.rn.f32", "div.approx.f32"},
                                  {"add.rn.f32", "add.rn.ftz.f32"},
                                  {".weak .func", ".extern .func"}}) {
        std::string changed = ptx;
        std::size_t const at = changed.find(was);
        ASSERT_NE(at, changed.npos) << was;
        EXPECT_THAT(faults_of(changed.replace(at, std::strlen(was), is)), testing::SizeIs(1)) << is;
    }
    // Each sum and product names its rounding: without it the driver may fuse them.
    for (char const* operation : {"add.f", "sub.f", "mul.f", "div.f", "sqrt.f"})
        EXPECT_EQ(ptx.find(operation), ptx.npos) << operation;
}
TEST(GpuKernels, AreThereForEverySize) {
    std::string const ptx(driver::ptx());
    for (std::string_view form : forms)
        for (int d = 1; d <= 32; ++d)
            for (std::string const arithmetic : {"_float_", "_double_"}) {
                bool const in_teams = d > 8 && (form.starts_with("ud") || form == "conventional");
                std::string const size = in_teams ? (d <= 16 ? "team_16_0(" : "team_32_0(") : std::to_string(d) + "(";
                EXPECT_NE(ptx.find(".entry rlslab_" + std::string(form) + arithmetic + size), ptx.npos) << form << d;
            }
}

}  // namespace
}  // namespace rlslab::gpu
