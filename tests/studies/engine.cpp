// The study engine: the same bytes on any number of threads, no trial lost when it is killed, a false claim detected.
// Rounding is defined: no byte of a study's table depends on the level at which it is compiled (-O1; here two at -O3),
// nor on the libm that a processor selects.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/journal.hpp>
#include <rlslab/studies/run.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/verdicts.hpp>
#include "studies/published/fused_double.hpp"
#include "tests/common/program.hpp"

#include <fmt/format.h>

#include <csignal>
#include <fcntl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace rlslab {
using namespace report;
using namespace studies;
namespace {

/// Draws a few numbers; longer trials finish after shorter ones that started later. Fails at trial `fails`, 0: never.
Study toy(int fails = 0) {
    return {.name = "toy",
            .question = "Do bytes depend on threads?",
            .source = "none",
            .formula = "",
            .interpretation = "",
            .factors = {{"word", {"a", "b"}}, {"n", counted(20)}},
            .measures = {"draw", "sum"},
            .measure =
                [fails](Trial const& trial, TrialOutput& out) {
                    if (trial.number("n") == fails) throw std::runtime_error("the machine was switched off");
                    Seed seed = trial.seed({"n"});
                    double sum = 0;
                    for (int k = 0; k < 1000 * (21 - int(trial.number("n"))); ++k) sum += seed.bell();
                    for (int row = 0; row < 3; ++row) out({double(row), sum});
                },
            .plots = {},
            .claims = {{"there are 120 rows",
                        [](Table const& t) {
                            return Judgement{t.rows().size() == 120, ""};
                        },
                        verification("2 x 20 x 3")}}};
}
Outcome run(Study const& study, RunOptions options) { return std::move(run_studies({&study}, options, {}).front()); }

TEST(StudyEngine, NoByteDependsOnTheNumberOfThreads) {
    files::Folder const folder;
    Study const study = toy();
    std::string first;
    for (int threads : {1, 2, 7}) {
        auto const out = folder.path / std::to_string(threads);
        EXPECT_TRUE(run(study, {.threads = threads, .out = out}).holds());
        std::string const text = files::read(out / "toy.csv");
        if (first.empty()) first = text;
        EXPECT_EQ(text, first) << threads;
    }
    EXPECT_NE(first.find("# command: rlslab study toy --budget quick --seed 1\nword,n,draw,sum\na,1,0,"),
              std::string::npos);
}

TEST(StudyEngine, AnInterruptedRunGoesOnAndEndsWithTheSameBytes) {
    files::Folder const folder;
    Study const whole = toy(), broken = toy(13);
    run(whole, {.out = folder.path / "whole"});
    RunOptions const options{.out = folder.path / "resumed"};
    EXPECT_THROW(run(broken, options), std::runtime_error);
    {  // a line that was being written
        std::ofstream file(folder.path / "resumed" / ".trials" / "toy", std::ios::app);
        file << "0123456789abcdef 7|a,8,0,";
    }
    Outcome const outcome = run(whole, options);
    EXPECT_GT(outcome.resumed, 0u);
    EXPECT_LT(outcome.resumed, outcome.trials);
    EXPECT_EQ(files::read(folder.path / "resumed" / "toy.csv"), files::read(folder.path / "whole" / "toy.csv"));
    EXPECT_EQ(run(whole, options).resumed, outcome.trials);
}

TEST(StudyEngine, TrialsOfAnotherSeedOrBudgetAreNotTaken) {
    files::Folder const folder;
    Study const study = toy();
    run(study, {.out = folder.path});
    EXPECT_EQ(run(study, {.seed = 2, .out = folder.path}).resumed, 0u);
    EXPECT_EQ(run(study, {.budget = Budget::full, .seed = 2, .out = folder.path}).resumed, 0u);
}

/// The program itself, killed at moments that fall anywhere in a run, and started again each time.
TEST(StudyEngine, KilledAtAnyMomentAndStartedAgainItEndsWithTheSameBytes) {
    files::Folder const folder;
    auto const start = [&](std::string const& out) {
        pid_t const child = fork();
        if (child == 0) {
            int const null = ::open("/dev/null", O_WRONLY);
            ::dup2(null, 1), ::dup2(null, 2);
            execl(RLSLAB_PROGRAM, "rlslab", "study", "gain_error", "--threads", "2", "--out", out.c_str(), nullptr);
            _exit(127);
        }
        return child;
    };
    auto const finished = [](pid_t child) {
        int status = 0;
        waitpid(child, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    };
    std::string const whole = folder.path / "whole", killed = folder.path / "killed";
    ASSERT_EQ(finished(start(whole)), 0);
    Seed seed{3};
    int kills = 0;
    for (int moment = 0; moment < 10; ++moment) {
        pid_t const child = start(killed);
        std::this_thread::sleep_for(std::chrono::milliseconds(20 + int(100 * seed.uniform())));
        ::kill(child, SIGKILL);
        kills += finished(child) == -1;
    }
    EXPECT_GT(kills, 2);
    EXPECT_EQ(finished(start(killed)), 0);
    EXPECT_EQ(files::read(killed + "/gain_error.csv"), files::read(whole + "/gain_error.csv"));
}

/// What a study of one's own may do: its error is one that begins with the study's name.
TEST(StudyEngine, AnOwnStudyThatIsWrongIsNamed) {
    auto const why = [](std::function<void(Study&)> const& spoilt) {
        files::Folder const folder;
        Study study = toy();
        spoilt(study);
        return files::message_of<std::exception>([&] { run(study, {.out = folder.path}); });
    };
    using Measure = std::function<void(Trial const&, TrialOutput&)>;
    auto const measuring = [](Measure const& measure) { return [measure](Study& s) { s.measure = measure; }; };
    EXPECT_THAT(why(measuring([](Trial const&, TrialOutput&) { throw 5; })), Names("toy trial exception"));
    EXPECT_THAT(why(measuring([](Trial const&, TrialOutput& out) {
                    out({1.0, 2.0, 3.0});
                })),
                Names("toy 2 draw sum 3"));
    EXPECT_THAT(why(measuring([](Trial const& trial, TrialOutput&) { trial.number("word"); })), Names("toy number"));
    EXPECT_THAT(why([](Study& s) { s.claims[0].judge = [](Table const&) -> Judgement { throw 5; }; }),
                Names("toy 120 exception"));
    auto const factors = [](std::vector<Factor> const& list) {
        return [list](Study& s) { s.factors = [list](Budget) { return list; }; };
    };
    EXPECT_THAT(why(factors({{"n", {1.0}}, {"n", {2.0}}})), Names("toy n"));
    EXPECT_THAT(why(factors({{"n", {1.0, 1.0}}, {"word", {"a"}}})), Names("toy n 1"));
    EXPECT_THAT(why(factors({{"n", {}}, {"word", {"a"}}})), Names("toy n"));
    EXPECT_THAT(why(factors({{"n", {1.0}}, {"word", {"a"}}, {"sum", {1.0}}})), Names("toy sum"));
}
/// A word of a table may hold a bar, also as its last letter, or be empty: the journal parts by what CSV forbids.
TEST(StudyEngine, EveryCellOfATableComesBackFromTheJournal) {
    files::Folder const folder;
    Study study = toy();
    study.factors = [](Budget) { return std::vector<Factor>{{"word", {"a|b", "|", "c"}}}; };
    study.measure = [](Trial const& trial, TrialOutput& out) {
        if (trial.text("word") != "c") out({"|", "x|"}), out({"", ""});  // and a trial without rows
    };
    run(study, {.out = folder.path});
    std::string const first = files::read(folder.path / "toy.csv");
    EXPECT_NE(first.find("a|b,|,x|\na|b,,\n|,|,x|\n|,,\n"), std::string::npos) << first;
    Outcome const again = run(study, {.out = folder.path});
    EXPECT_EQ(again.resumed, 3u);
    EXPECT_EQ(files::read(folder.path / "toy.csv"), first);
    std::ofstream(folder.path / ".trials/toy", std::ios::app) << fmt::format("{:016x} x\n", hash("x"));  // no number
    EXPECT_EQ(run(study, {.out = folder.path}).resumed, 3u);
}
TEST(StudyEngine, AFalseClaimIsCaught) {
    files::Folder const folder;
    Study const& study = **std::ranges::find(studies::studies(), "gain_error", &Study::name);
    EXPECT_EQ(verdict_lines(run(study, {.out = folder.path / "true"}), false).find("FAILS"), std::string::npos);
    // A "joseph" that subtracts K psi'P: an error in its gain is of first order.
    std::vector<CatalogueEntry> entries = catalogue();
    for (CatalogueEntry& entry : entries)
        if (entry.variant == "joseph") entry.make = find_entry("symmetric", entry.arithmetic->name)->make;
    Outcome const outcome = run(study, {.out = folder.path / "false", .entries = &entries});
    EXPECT_FALSE(outcome.holds());
    EXPECT_NE(verdict_lines(outcome, false).find("FAILS      finding       Joseph's forms: slope 2.00"),
              std::string::npos);
}

TEST(Findings, AreNotMadeOfNothing) {
    Table const empty({"x", "y"});
    EXPECT_FALSE(within(empty, {}, slope("x", "y"), -1e300, 1e300).holds());
    EXPECT_FALSE(everywhere(empty, "x", "sound").holds());
    Table table({"x", "y", "word"});
    table.add({1.0, 1.0, "a"});
    EXPECT_FALSE(within(table, {}, slope("x", "y"), -1e300, 1e300).holds()) << "one point has no slope";
    table.add({10.0, 100.0, "a"});
    table.add({100.0, 1e4, "a"});
    table.add({100.0, NAN, "a"});
    EXPECT_TRUE(within(table, {"word"}, slope("x", "y"), 1.99, 2.01).holds());
    EXPECT_FALSE(within(table, {}, slope("x", "y"), 2.01, 3).holds());
    EXPECT_THROW(within(table, {}, greatest("word"), 0, 1), std::logic_error);
}

TEST(Tables, ReadBackWhatTheyWrote) {
    Seed seed{5};
    Table table({"a", "b"});
    for (int k = 0; k < 1000; ++k) {
        double const x = std::ldexp(seed.bell(), int(600 * seed.bell()));
        std::string const line = csv_line({x, k % 7 ? "sound" : ""});
        table.add_line(line);
        EXPECT_EQ(std::get<double>(table.rows().back()[0]), x);
    }
    table.add_line(csv_line({INFINITY, -INFINITY}));
    EXPECT_EQ(std::get<double>(table.rows().back()[1]), -INFINITY);
    EXPECT_THROW(csv_line({"a,b"}), std::logic_error);
    EXPECT_THROW(table.number("a"), std::logic_error);
    EXPECT_THROW(table.index("c"), std::logic_error);
}

// --- the same bytes however it is compiled, and on any processor -----------------------------------------------------

class Optimisation : public Program {};

TEST_F(Optimisation, LeavesEachByteOfATable) {
    std::string const words = " study fused_symmetry sliding_window --budget quick --fresh --out ";
    EXPECT_EQ(shell("rlslab" + words + "plain").code, 0);
    EXPECT_NE(shell(std::string(RLSLAB_STUDIES_OPTIMISED) + words + "optimised").code, 2);
    for (std::string const study : {"fused_symmetry", "sliding_window"}) {
        std::string const table = read(folder / "plain" / (study + ".csv"));
        EXPECT_GT(table.size(), 1000u);
        EXPECT_EQ(without_run(table), without_run(read(folder / "optimised" / (study + ".csv")))) << study;
    }
}

std::string const plain = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA ";

class Libm : public Program {};

/// Powers of ten by libm.
constexpr char powers[] = R"(awk 'BEGIN { for (k = 1; k < 30000; ++k) printf "%.17g\n", 10 ^ (-k / 1000) }')";

TEST_F(Libm, OfAnOlderProcessorLeavesTheSameTables) {
    if (shell(powers).out == shell(plain + powers).out) GTEST_SKIP() << "this system's libm is the same either way";
    for (std::string const study : {"residual_size", "sliding_window"}) {
        EXPECT_EQ(shell("rlslab study " + study + " --budget quick --fresh --out here").code, 0);
        EXPECT_EQ(shell(plain + "rlslab study " + study + " --budget quick --fresh --out there").code, 0);
        std::string const table = read(folder / "here" / (study + ".csv"));
        EXPECT_GT(table.size(), 1000u);
        EXPECT_EQ(table, read(folder / "there" / (study + ".csv"))) << study;
    }
}

/// Fused means fused, and every other product is rounded.
TEST(Fused, AProductIsFusedIntoASumAndRoundedElsewhere) {
    using T = FusedDouble;
    Seed seed{3};
    int different = 0;
    for (int n = 0; n < 1000; ++n) {
        double const a = seed.bell(), b = seed.bell(), c = seed.bell(), d = seed.bell();
        T const A(a), B(b), C(c), D(d);
        EXPECT_EQ(double(T(C + A * B)), std::fma(a, b, c));
        EXPECT_EQ(double(T(A * B + C)), std::fma(a, b, c));
        EXPECT_EQ(double(T(C - A * B)), std::fma(-a, b, c));
        EXPECT_EQ(double(T(A * B - C)), std::fma(a, b, -c));
        EXPECT_EQ(double(T(A * B + C * D)), std::fma(c, d, a * b));
        EXPECT_EQ(double(T(A * B - C * D)), std::fma(-c, d, a * b));
        EXPECT_EQ(double(T(A * B)), a * b);
        EXPECT_EQ(double(T(A * B / C)), a * b / c);
        EXPECT_EQ(double(T((A * B) * C)), a * b * c);
        T sum = C;
        sum += A * B;
        sum -= C * D;
        EXPECT_EQ(double(sum), std::fma(-c, d, std::fma(a, b, c)));
        different += std::fma(a, b, c) != c + a * b;
    }
    EXPECT_GT(different, 100) << "or nothing was tested";
}

}  // namespace
}  // namespace rlslab
