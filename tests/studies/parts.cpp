// A run of studies in parts, on one machine or several: every trial once, and the bytes of one run.
#include <rlslab/studies/journal.hpp>
#include <rlslab/studies/run.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "tests/common/program.hpp"

#include <fstream>
#include <mutex>
#include <set>

namespace rlslab::studies {
namespace {

using testing::HasSubstr;

/// Trials that a run has measured, of all studies made here.
struct Measured {
    std::mutex mutex;
    std::multiset<std::string> trials;
};
Study study_of(std::string name, int trials, Measured& measured) {
    return {.name = name,
            .question = "Which part does a trial fall to?",
            .source = "none",
            .formula = "",
            .interpretation = "",
            .factors = {{"n", counted(trials)}},
            .measures = {"draw"},
            .measure =
                [name, &measured](Trial const& trial, TrialOutput& out) {
                    Seed seed = trial.seed({"n"});
                    out({seed.uniform()});
                    std::lock_guard const lock(measured.mutex);
                    measured.trials.insert(name + as_text(trial.value("n")));
                },
            .plots = {},
            .claims = {{"one row a trial",
                        [trials](Table const& t) {
                            return Judgement{t.rows().size() == size_t(trials), ""};
                        },
                        verification("n")}}};
}

struct Parts : Program {
    Measured measured;
    Study const first = study_of("first", 37, measured), second = study_of("second", 5, measured);
    std::vector<Study const*> const both{&first, &second};

    RunOptions into(std::string const& name) const { return {.out = folder / name}; }
    std::string tables(std::string const& name) const {
        return read(folder / name / "first.csv") + read(folder / name / "second.csv");
    }
};

TEST_F(Parts, AreForgottenWithTheWhole) {
    run_part(both, into("a"), {1, 2}, {});
    measured.trials.clear();
    forget_trials(folder / "a/.trials", "first");
    run_studies(both, into("a"), {});
    EXPECT_GE(measured.trials.size(), 37u);
    EXPECT_LT(measured.trials.size(), 42u);  // those of the second are kept
}
TEST_F(Parts, TakeEachTrialOnceAndGiveTheBytesOfOneRun) {
    run_studies(both, into("whole"), {});
    auto const all = measured.trials;
    ASSERT_EQ(all.size(), 42u);
    for (int const of : {2, 3, 5, 41, 60}) {
        measured.trials.clear();
        std::string const out = "of" + std::to_string(of);
        for (int number = of; number >= 1; --number) {
            Share const share = run_part(both, into(out), {number, of}, {});
            EXPECT_EQ(share.all, 42u);
            EXPECT_EQ(share.resumed, 0u);
            EXPECT_GE(share.own, size_t(42 / of)) << of;
            EXPECT_LE(share.own, size_t(42 / of + 1)) << of;
            EXPECT_FALSE(fs::exists(folder / out / "first.csv"));
        }
        EXPECT_EQ(measured.trials, all) << of;
        auto const outcomes = run_studies(both, into(out), {});
        EXPECT_EQ(outcomes[0].resumed + outcomes[1].resumed, 42u) << of;
        EXPECT_EQ(measured.trials, all) << of;
        EXPECT_EQ(tables(out), tables("whole")) << of;
    }
}

TEST_F(Parts, GoOnInAnyNumberOfParts) {
    run_studies(both, into("whole"), {});
    run_part(both, into("out"), {2, 3}, {});
    fs::path const trials = folder / "out" / ".trials";
    std::ofstream(trials / "first.2-of-3", std::ios::app) << "0123456789abcdef 1|1,0.";  // killed while it was written
    fs::create_symlink("/dev/zero", trials / "first.3-of-3");                            // has no end
    measured.trials.clear();
    size_t resumed = 0;
    for (int number : {1, 2, 3, 4}) resumed += run_part(both, into("out"), {number, 4}, {}).resumed;
    EXPECT_EQ(resumed, 14u);
    EXPECT_EQ(measured.trials.size(), 42u - 14u);
    run_studies(both, into("out"), {});
    EXPECT_EQ(tables("out"), tables("whole"));
    fs::remove(trials / "first.3-of-3");
    for (auto const& file : fs::directory_iterator(trials))
        EXPECT_EQ(file.path().filename().string().find("-of-"), std::string::npos) << file.path();
}

TEST_F(Parts, TrialsOfAnotherSeedAreNotTaken) {
    RunOptions other = into("out");
    other.seed = 2;
    run_part(both, other, {1, 2}, {});
    EXPECT_EQ(run_part(both, into("out"), {1, 2}, {}).resumed, 0u);
}

TEST_F(Parts, OneRunOfAPartAtATimeAndNoneBesideTheWhole) {
    FolderLock const part(folder, {1, 2});
    EXPECT_NO_THROW(FolderLock(folder, {2, 2}));
    EXPECT_THROW(FolderLock(folder, {1, 2}), InputError);
    EXPECT_THROW(FolderLock(folder, {}), InputError);
}

TEST_F(Parts, AreMergedFromFoldersOfTheirOwn) {
    auto const run = [&](std::string const& words) { return shell("rlslab study slicot " + words); };
    ASSERT_EQ(run("--out whole").code, 0);
    ::Outcome const half = run("--part 1/2 --out a");
    ASSERT_EQ(half.code, 0) << half.err;
    EXPECT_THAT(half.err, Names("part 1 2"));
    EXPECT_EQ(half.out, "");
    ::Outcome const early = shell("rlslab merge a --out merged");
    EXPECT_EQ(early.code, 2);
    EXPECT_THAT(early.err, Names("trials slicot"));
    EXPECT_FALSE(fs::exists(folder / "merged")) << "nothing is written before all are there";
    ASSERT_EQ(run("--part 2/2 --out b").code, 0);
    ::Outcome const merged = shell("rlslab merge a b --out merged");
    EXPECT_EQ(merged.code, 0) << merged.err;
    for (char const* file : {"slicot.csv", "verdicts.json", "verdicts.csv", "report.html"})
        EXPECT_EQ(read(folder / "merged" / file), read(folder / "whole" / file)) << file;
}

TEST_F(Parts, RefuseWhatDoesNotFit) {
    ASSERT_EQ(shell("rlslab study slicot --part 1/2 --out a").code, 0);
    ASSERT_EQ(shell("rlslab study slicot --part 2/2 --seed 2 --out b").code, 0);
    refused("merge a b --out c", "b");
    std::string const run = read(folder / "a" / ".trials" / "run.json");
    for (std::string const bad : {R"({})", R"([1])", R"({"studies": [1], "budget": "quick", "seed": 1})",
                                  R"({"studies": [], "budget": "quick", "seed": 1})",
                                  R"({"studies": ["../../x"], "budget": "quick", "seed": 1})",
                                  R"({"studies": ["bierman"], "budget": "x", "seed": 1})",
                                  R"({"studies": ["bierman"], "budget": "quick", "seed": -1})",
                                  R"({"studies": ["bierman"], "budget": "quick", "seed": 1.5})"}) {
        write("a/.trials/run.json", bad);
        refused("merge a --out c", "a/.trials/run.json --part");
    }
    fs::remove(folder / "a" / ".trials" / "run.json");
    fs::create_directory(folder / "a" / ".trials" / "run.json");
    refused("merge a --out c", "a/.trials/run.json --part");
    fs::remove(folder / "a" / ".trials" / "run.json");
    write("a/.trials/run.json", run);
    refused("study slicot --part 2/2 --seed 3 --out a", "a");
    refused("merge a --out \"\"", "--out");
    EXPECT_FALSE(fs::exists(folder / "c"));
}

TEST_F(Parts, AreNotMergedIntoAFolderThatAnotherRunIsWriting) {
    run_part(both, into("a"), {1, 2}, {});
    run_part(both, into("a"), {2, 2}, {});
    fs::create_directory(folder / "busy");
    FolderLock const other(folder / "busy");
    EXPECT_THROW(merge_parts(both, into("busy"), {folder / "a"}), InputError);
    EXPECT_FALSE(fs::exists(folder / "busy" / ".trials"));
    EXPECT_NO_THROW(merge_parts(both, into("free"), {folder / "a"}));
}

/// Trials of another program look like those of another seed: what no run of this program can use is refused, and
/// stays.
TEST_F(Parts, NothingIsLostWhereTheTrialsAreOfAnotherRun) {
    for (std::string const part : {"1", "2"})
        ASSERT_EQ(shell("rlslab study slicot --part " + part + "/2 --out p" + part).code, 0);
    auto const with_seed_2 = [&](std::string const& file) {
        std::string text = read(folder / file);
        text.replace(text.find("\"seed\": 1"), 9, "\"seed\": 2");
        write(file, text);
    };
    with_seed_2("p1/.trials/run.json");
    with_seed_2("p2/.trials/run.json");
    std::string const before = read(folder / "p1" / ".trials" / "slicot.1-of-2");
    refused("merge p1 p2 --out p1", "p1/.trials/slicot.1-of-2");
    EXPECT_EQ(read(folder / "p1" / ".trials" / "slicot.1-of-2"), before);
    ASSERT_EQ(shell("rlslab study slicot --seed 2 --out p2").code, 0);
    EXPECT_TRUE(fs::exists(folder / "p2" / ".trials" / "slicot.2-of-2")) << "a part of another run is not removed";
}

#ifdef RLSLAB_MPI
/// Ranks that share the folder, started again with another number of them after one was killed.
TEST_F(Parts, RanksOfAnMpiJobGiveTheBytesOfOneRun) {
    auto const ranks = [&](int number, std::string const& words) {
        return shell(on_ranks(number, RLSLAB_MPI " " + words));
    };
    ASSERT_EQ(shell("rlslab study slicot --out whole").code, 0);
    std::string const whole = read(folder / "whole" / "slicot.csv");
    for (int const number : {1, 2, 3, 4}) {
        std::string const out = "ranks" + std::to_string(number);
        ::Outcome const run = ranks(number, "study slicot --out " + out);
        EXPECT_EQ(run.code, 0) << run.err;
        EXPECT_EQ(read(folder / out / "slicot.csv"), whole) << number;
    }
    EXPECT_NE(shell("(sleep 0.5; pkill -KILL -n -f \"study gain_error --out killed\") & " +
                    on_ranks(2, RLSLAB_MPI " study gain_error --out killed"))
                  .code,
              0);
    EXPECT_EQ(ranks(3, "study gain_error --out killed").code, 0);
    ASSERT_EQ(shell("rlslab study gain_error --out other").code, 0);
    EXPECT_EQ(read(folder / "killed" / "gain_error.csv"), read(folder / "other" / "gain_error.csv"));
    for (std::string const option : {"--part 1/2", "--fresh"}) {
        ::Outcome const refused = ranks(2, "study slicot " + option);
        EXPECT_EQ(refused.err.find("does not go with ranks"), refused.err.rfind("does not go with ranks"))
            << refused.err;
        EXPECT_NE(refused.code, 0);
    }
    std::string const help = ranks(2, "study --help").out;
    EXPECT_EQ(help.find("Usage: "), help.rfind("Usage: ")) << help;
    EXPECT_NE(help.find("Usage: "), help.npos);
    ::Outcome const wrong = ranks(2, "study slicot --budget slow");
    EXPECT_NE(wrong.code, 0);
    EXPECT_EQ(wrong.err.find("--budget: expected"), wrong.err.rfind("--budget: expected")) << wrong.err;
}
#else
TEST(Mpi, Ranks) { GTEST_SKIP() << "MPI was not found (Debian: libopenmpi-dev, openmpi-bin)"; }
#endif

}  // namespace
}  // namespace rlslab::studies
