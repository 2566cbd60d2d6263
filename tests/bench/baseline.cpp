// The times on record: read and written, of one kind of machine, added to. The table of times.
#include "bench/baseline.hpp"
#include "bench/by_hand.hpp"
#include "bench/choice.hpp"
#include "bench/measured.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace {

using namespace rlslab::bench;
using testing::ElementsAre;

/// A run: the unit row, in its last repetition so many times as long, and a row whose times are these, both on a clock
/// of its own.
std::string run(std::vector<double> const& times, double clock = 1, double disturbed = 1,
                std::string const& instructions = "avx2") {
    std::string rows;
    for (size_t i = 0; i < times.size(); ++i)
        for (auto const& [name, time] : {std::pair{std::string(unit_row), i + 1 < times.size() ? 10.0 : 10 * disturbed},
                                         std::pair{std::string("update/ud/double/16"), times[i]}})
            rows += fmt::format(
                R"({}{{"run_name": "{}", "run_type": "iteration", "repetition_index": {}, "ns_per_update": {}}})",
                rows.empty() ? "" : ",", name, i, time * clock);
    return R"({"context": {"cpu": "a processor", "compiler": "a compiler", "instructions": ")" + instructions +
           R"("}, "benchmarks": [)" + rows + "]}";
}
std::vector<double> const quiet{100, 101, 102, 100, 103, 101, 102};

/// Google Benchmark writes NaN for the relative scatter of numbers whose mean is 0: thirteen minutes of benchmarks
/// ended in a parse error.
TEST(BenchBaseline, ReadsAnAggregateThatIsNotANumber) {
    std::string text = run(quiet);
    text.insert(text.rfind("]}"),
                R"(,{"run_name": "r", "run_type": "aggregate", "ns_per_update": 0.1, "ns_longest": NaN,
        "digits": -Infinity, "label": "NaN, in words"})");
    EXPECT_EQ(baseline_of(text).rows, baseline_of(run(quiet)).rows);
}
TEST(BenchBaseline, IsReadBackAsItWasWritten) {
    Baselines const made{baseline_of(run(quiet)), baseline_of(run(quiet, 1, 1, "avx512"))};
    Baselines const read = read_baselines(written(made));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].machine, "a processor, avx2, a compiler");
    EXPECT_EQ(read[1].machine, "a processor, avx512, a compiler");
    EXPECT_EQ(read[0].repetitions, 7);
    ASSERT_EQ(read[0].rows.size(), 2u);
    EXPECT_NEAR(read[0].rows.at("update/ud/double/16").greatest, 10.3, 1e-3);
    EXPECT_EQ(written(read), written(made));
    EXPECT_TRUE(read_baselines(written({})).empty());
}
TEST(BenchBaseline, OfOneKindOfMachineLeavesTheOthers) {
    Baselines all{baseline_of(run(quiet)), baseline_of(run(quiet, 1, 1, "avx512"))};
    auto const other = all[1].rows;
    Baseline const now = baseline_of(run({115, 112, 111, 118, 113, 112, 114}));
    record(all, now);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(of_machine(all, now.machine).rows, now.rows);
    EXPECT_EQ(all[1].rows, other);
    record(all, baseline_of(run(quiet, 1, 1, "baseline")));
    EXPECT_EQ(names_of(all),
              "a processor, avx2, a compiler (2 rows); a processor, avx512, a compiler (2 rows); "
              "a processor, baseline, a compiler (2 rows)");
    EXPECT_EQ(names_of({}), "none");
    try {
        of_machine(all, "another, avx2, a compiler");
        FAIL() << "nothing is recorded of it";
    } catch (std::runtime_error const& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(testing::HasSubstr("another, avx2, a compiler"), testing::HasSubstr(names_of(all))));
    }
}
/// Rows of a later run beside those of an earlier one.
TEST(BenchBaseline, TakesNewRowsWhereTheOldOnesStandAsTheyDid) {
    auto const with_new_row = [](double factor) {
        Baseline now = baseline_of(run(quiet, factor));
        now.rows["update/ud/double/16"].middle *= factor;
        now.rows["update/ud_delta/double/16"] = {11, 12, 13};
        return now;
    };
    Baselines all{baseline_of(run(quiet))};
    Baseline const before = all[0];
    EXPECT_THROW(add(all, with_new_row(1.06)), std::runtime_error);
    EXPECT_THROW(add(all, with_new_row(0.94)), std::runtime_error);
    Baseline alone = with_new_row(1);
    alone.rows.erase("update/ud/double/16");
    EXPECT_THROW(add(all, alone), std::runtime_error) << "no old row says how the machine is";
    EXPECT_THROW(add(all, baseline_of(run(quiet, 1, 1, "avx512"))), std::runtime_error) << "another machine";
    EXPECT_EQ(all[0].rows, before.rows);
    add(all, with_new_row(1.04));
    EXPECT_EQ(all[0].rows.size(), 3u);
    EXPECT_EQ(all[0].rows.at("update/ud/double/16"), before.rows.at("update/ud/double/16"));
    EXPECT_EQ(all[0].rows.at("update/ud_delta/double/16").middle, 12);
}
/// The file of the tree: what was recorded is still there.
TEST(BenchBaseline, OfTheTreeIsReadAndWrittenAsItStands) {
    std::string const path = RLSLAB_SOURCE_DIR "/bench/baseline.json";
    std::ifstream file(path);
    std::string const text{std::istreambuf_iterator<char>(file), {}};
    Baselines const all = read_baselines(text);
    ASSERT_FALSE(all.empty());
    for (Baseline const& b : all) EXPECT_EQ(b.rows.count(unit_row), 1u) << b.machine;
    EXPECT_EQ(written(all), text);
}
TEST(BenchBaseline, RefusesWhatCannotBeCompared) {
    EXPECT_THROW(baseline_of(run({100, 100, 100, 100})), std::runtime_error) << "four repetitions";
    EXPECT_THROW(baseline_of(R"({"context": {}, "benchmarks": []})"), std::runtime_error) << "no unit row";
    EXPECT_THROW(baseline_of("not JSON"), std::exception);
    EXPECT_THROW(read_baselines("{}"), std::exception);
}

TEST(BenchTable, HasNanosecondsInTheOrderOfTheRunAndDlibLast) {
    std::string rows;
    auto const add = [&](char const* name, double time, double theta) {
        rows += fmt::format(R"({}{{"run_name": "{}", "ns_per_update": {}, "ns_theta": {}, "digits": 9, "finite": 1}})",
                            rows.empty() ? "" : ",", name, time, theta);
    };
    add("peer/dlib/double/4", 140.4, 1), add("update/ud/double/4", 29.6, 1), add("update/ud/double/64", 1300, 1);
    add("update/conventional/double/16", 80, 1), add("update/qr/double/4", 35, 17.8), add("update/qr/float/16", 3, 3);
    add("block/ud/double/4", 3, 3), add("update/ud/double/8", 3, 3), add("peer/liquid/double/4", 3, 3);
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
    for (auto const& words : std::vector<std::vector<std::string>>{{"--sizes"},
                                                                   {"--csv"},
                                                                   {"--sizes="},
                                                                   {"--sizes=5,"},
                                                                   {"--sizes=0"},
                                                                   {"--sizes=513"},
                                                                   {"--sizes=4.5"},
                                                                   {"--sizes= 4"},
                                                                   {"--sizes=99999999999999999999"},
                                                                   {"--fixed", "--sizes=5"},
                                                                   {"--fixed", "--float"}})
        EXPECT_THROW(chosen(words), std::runtime_error) << fmt::format("{}", fmt::join(words, " "));
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
