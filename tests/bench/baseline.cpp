// The times on record: of one kind of machine, added to. The table of times. The choice of rows.
#include "bench/by_hand.hpp"
#include "bench/choice.hpp"
#include "bench/results.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace {

using namespace rlslab::bench;
using testing::ElementsAre;

/// A run: the unit row and update/ud/double/16, whose times are these, and another row of one; all on this clock.
std::string run(std::vector<double> const& times, double clock = 1, std::string const& instructions = "avx2",
                std::string const& other = "batch/qr_block/200000x10") {
    std::string rows;
    for (double const time : times)
        for (auto const& [name, of] :
             {std::pair{std::string(unit_row), 10.0}, {"update/ud/double/16", time}, {other, 7}})
            rows += fmt::format(R"({}{{"run_name": "{}", "run_type": "iteration", "ns_per_update": {}}})",
                                rows.empty() ? "" : ",", name, of * clock);
    // Of numbers whose mean is 0 Google Benchmark writes NaN: thirteen minutes of benchmarks ended in a parse error.
    rows += R"(,{"run_name": "r", "run_type": "aggregate", "ns_per_update": 0.1, "ns_longest": NaN, "digits": -Infinity,
        "label": "NaN, in words"})";
    return R"({"context": {"cpu": "a processor", "compiler": "a compiler", "instructions": ")" + instructions +
           R"("}, "benchmarks": [)" + rows + "]}";
}
std::vector<double> const quiet{100, 101, 102, 100, 103, 101, 102};

std::string machine(std::string const& instructions, std::string const& rows) {
    return fmt::format("  \"a processor, {}, a compiler\": {{\n   \"repetitions\": 7,\n   \"rows\": {{\n",
                       instructions) +
           "    \"limit/read_modify_write/8192\": [1,1,1],\n" + rows + "\n   }\n  }";
}
std::string file(std::string const& machines) {
    return "{\n \"unit_row\": \"limit/read_modify_write/8192\",\n \"machines\": {\n" + machines + "\n }\n}\n";
}
std::string const ud = "    \"update/ud/double/16\": [10,10.1,10.3]";

TEST(BenchRecord, HasLeastMedianAndLargestOfAKindOfMachineAndLeavesTheOthers) {
    std::string const one = recorded("", run(quiet, 3), false), two = recorded(one, run(quiet, 1, "avx512"), false);
    EXPECT_EQ(one, file(machine("avx2", ud)));
    EXPECT_EQ(two, file(machine("avx2", ud) + ",\n" + machine("avx512", ud)));
    EXPECT_EQ(recorded(two, run({115, 112, 111, 118, 113, 112, 114}), false),
              file(machine("avx2", "    \"update/ud/double/16\": [11.1,11.3,11.8]") + ",\n" + machine("avx512", ud)));
}
/// Rows of a later run beside those of an earlier one.
TEST(BenchRecord, TakesNewRowsWhereTheOldOnesStandAsTheyDid) {
    auto const later = [](double factor, std::string const& instructions = "avx2") {
        std::vector<double> times = quiet;
        for (double& time : times) time *= factor;
        return run(times, 2, instructions, "update/aa/double/16");
    };
    std::string const before = recorded("", run(quiet), false);
    EXPECT_EQ(recorded(before, later(1.04), true),
              file(machine("avx2", "    \"update/aa/double/16\": [0.7,0.7,0.7],\n" + ud)));
    EXPECT_THROW(recorded(before, later(1.06), true), std::runtime_error);
    EXPECT_THROW(recorded(before, later(0.94), true), std::runtime_error);
    EXPECT_THROW(recorded(file(machine("avx2", "    \"update/b/double/4\": [1,1,1]")), later(1), true),
                 std::runtime_error)
        << "no old row says how the machine is";
    try {
        recorded(before, later(1, "avx512"), true);
        FAIL() << "nothing is recorded of it";
    } catch (std::runtime_error const& error) {
        EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("a processor, avx512, a compiler"),
                                                 testing::HasSubstr("a processor, avx2, a compiler")));
    }
}
/// The file of the tree: what was recorded is still there, as it stands.
TEST(BenchRecord, OfTheTreeIsReadAndWrittenAsItStands) {
    std::ifstream tree(RLSLAB_SOURCE_DIR "/bench/baseline.json");
    std::string const text{std::istreambuf_iterator<char>(tree), {}};
    EXPECT_EQ(recorded(text, run(quiet), false),
              text.substr(0, text.rfind("\n }\n}\n")) + ",\n" + machine("avx2", ud) + "\n }\n}\n");
}
TEST(BenchRecord, RefusesWhatCannotBeCompared) {
    EXPECT_THROW(recorded("", run({100, 100, 100, 100}), false), std::runtime_error) << "four repetitions";
    EXPECT_THROW(recorded("", R"({"context": {}, "benchmarks": []})", false), std::runtime_error) << "no unit row";
    for (std::string const before : {"not JSON", "{}", R"({"unit_row": "another", "machines": {}})"})
        EXPECT_THROW(recorded(before, run(quiet), false), std::exception) << before;
}

TEST(BenchTable, HasNanosecondsInTheOrderOfTheRunAndDlibLast) {
    std::string rows;
    auto const add = [&](char const* name, double time, double theta) {
        rows += fmt::format(R"({}{{"run_name": "{}", "ns_per_update": {}, "ns_theta": {}, "digits": 9, "finite": 1}})",
                            rows.empty() ? "" : ",", name, time, theta);
    };
    add("peer/dlib/double/4", 140.4, 1), add("update/ud/double/4", 29.6, 1), add("update/ud/double/64", 1300, 1);
    add("update/conventional/double/16", 80, 1), add("update/qr/double/4", 35, 17.8), add("update/qr/float/16", 3, 3);
    add("block/ud/double/4", 3, 3), add("update/ud/double/8", 3, 3), add("peer/gsl/double/4", 3, 3);
    auto const table = [](std::string const& of) {
        return table_of_times(run_of(
            R"({"context": {"cpu": "a processor", "instructions": "avx2", "compiler": "g++",
                "date": "2026-11-23T01:02"}, "benchmarks": [)" +
            of + "]}"));
    };
    add("large/ud/double/1024", 83200, 1), add("large/ud_rows_known/double/512", 3, 1);
    EXPECT_EQ(table(rows),
              "| ns an update, `double` | 4 | 8 | 16 | 32 | 64 | 128 | 256 | taps at 48 kHz | at 16 kHz |\n"
              "|---|---|---|---|---|---|---|---|---|---|\n"
              "| `ud` | 30 | 3 | | | 1300 | | | 406 | 846 |\n"  // a slope of 3/2: 64 (20833 / 1300)^(2/3)
              "| `conventional` | | | 80 | | | | | > 16 | > 16 |\n"
              "| `qr` * | 35 | | | | | | | > 4 | > 4 |\n"
              "| dlib's `rls` | 140 | | | | | | | > 4 | > 4 |\n"
              "\na processor, avx2, g++, 2026-11-23. *: without solving for theta. Taps: the most parameters whose "
              "update ends before the next sample, one core doing nothing else; > where larger filters were not "
              "timed.\n");
    EXPECT_THROW(table(""), std::runtime_error);
}

/// Which of some rows are there with these options; what is said of options that cannot be used.
std::vector<std::string> chosen(std::vector<std::string> words) {
    std::vector<char*> argv;
    words.insert(words.begin(), "rlslab_bench");
    for (std::string& word : words) argv.push_back(word.data());
    int argc = int(argv.size());
    choice() = {};
    take_choice(argc, argv.data());
    std::vector<std::string> out(argv.data() + 1, argv.data() + argc);
    for (char const* row :
         {"update/ud/double/5", "update/ud/double/4", "update/ud/float/5", "fixed/ud/double/4", "peer/dlib/double/5",
          "peer/mine/float/4", "peer/qr/2000x5", "block/ud/double/5", "limit/5"})
        if (choice().has(row)) out.push_back(row);
    return out;
}
TEST(BenchChoice, IsOfRowsAtTheSizesAskedFor) {
    EXPECT_EQ(chosen({"--benchmark_filter=ud"}).size(), 10u) << "all rows and the option of Google Benchmark";
    EXPECT_THAT(chosen({"--mine", "--x"}), ElementsAre("--x", "update/ud/double/4", "peer/mine/float/4"));
    EXPECT_THAT(chosen({"--sizes", "12,5"}), ElementsAre("update/ud/double/5", "peer/dlib/double/5"));
    EXPECT_EQ(choice().sizes, (std::vector<rlslab::Index>{5, 12}));
    EXPECT_THAT(chosen({"--sizes=5", "--float"}), ElementsAre("update/ud/float/5", "peer/dlib/double/5"));
    EXPECT_THAT(chosen({"--sizes=5", "--float", "--double"}),
                ElementsAre("update/ud/double/5", "update/ud/float/5", "peer/dlib/double/5"));
    EXPECT_THAT(chosen({"--fixed", "--csv=x.csv"}), ElementsAre("fixed/ud/double/4", "peer/mine/float/4"));
    EXPECT_EQ(choice().csv, "x.csv");
}
TEST(BenchChoice, SaysWhatIsExpected) {
    for (std::string const wrong :
         {"--sizes", "--csv", "--sizes=", "--sizes=5,", "--sizes=0", "--sizes=513", "--sizes=4.5", "--sizes= 4",
          "--sizes=99999999999999999999", "--fixed;--sizes=5", "--fixed;--float"})
        EXPECT_THROW(chosen(split(wrong, ';')), std::runtime_error) << wrong;
}

}  // namespace

// --- The hand-written loops that the benchmarks time have the bits of the library. -----------------------------------
namespace {

using namespace rlslab;
namespace by_hand = rlslab::bench::by_hand;

template <class Ours, class Hand>
void expect_the_same_bits(Index size) {
    Problem<double> const problem{.size = size, .forgetting = 0.99, .prior = Prior<double>{.variance = 10}};
    Ours ours(problem);
    Hand hand(problem);
    Seed seed{3};
    Vector<double> psi(size);
    for (int k = 0; k < 500; ++k) {
        for (double& x : psi) x = seed.bell();
        double const y = seed.bell();
        ours.update(psi, y);
        hand.update(psi, y);
        ASSERT_EQ(Vector<double>(ours.theta()), Vector<double>(hand.theta())) << Ours::name << ' ' << size << ' ' << k;
    }
}
template <int N>
void compare_all() {
    expect_the_same_bits<Conventional<double, N>, by_hand::Conventional<N>>(N);
    expect_the_same_bits<Symmetric<double, N>, by_hand::Symmetric<N>>(N);
    expect_the_same_bits<Ud<double, N>, by_hand::Ud<N>>(N);
    expect_the_same_bits<Potter<double, N>, by_hand::Potter<N>>(N);
    expect_the_same_bits<Carlson<double, N>, by_hand::Carlson<N>>(N);
    expect_the_same_bits<Ud<double>, by_hand::Ud<N>>(N);
}

TEST(ByHand, LoopsHaveTheBitsOfTheLibrary) {
    compare_all<2>();
    compare_all<3>();
    compare_all<4>();
    compare_all<5>();
    compare_all<6>();
}

}  // namespace
