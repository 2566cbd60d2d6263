// The behaviour of the program towards its user: misspelt words, closed pipes, interrupts, help.
#include "src/lab/report/messages.hpp"
#include "tests/common/kept.hpp"
#include "tests/common/program.hpp"
#include "tests/common/terminal.hpp"

#include <rlslab/input/suggestion.hpp>

#include <csignal>
#include <set>

namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Suggestion, IsTheNearestNameOrNone) {
    std::vector<std::string_view> const names{"conventional", "joseph", "qr", "ud", "extended_qr", ""};
    auto const meant = [&](std::string_view asked) { return std::string(rlslab::nearest(asked, names)); };
    EXPECT_EQ(meant("josephs"), "joseph");
    EXPECT_EQ(meant("jsoeph"), "joseph") << "two letters swapped are one mistake";
    EXPECT_EQ(meant("jo"), "joseph") << "begins one name";
    EXPECT_EQ(meant("JOSEPH"), "joseph");
    EXPECT_EQ(meant("ux"), "") << "half of the word is wrong";
    EXPECT_EQ(meant("x"), "");
    EXPECT_EQ(meant(""), "");
    EXPECT_EQ(meant(std::string(1000000, 'j')), "");
    EXPECT_EQ(rlslab::nearest("gain", {"gain_error", "gain_error_size"}), "") << "begins two names";
    EXPECT_EQ(rlslab::nearest("gain_eror", {}), "");
}

// --- pipes, disks ----------------------------------------------------------------------------------------------------

TEST_F(Program, DiesOfAClosedPipeWithoutAWord) {
    // A reader that is gone before the first byte, also where whoever started the program had SIGPIPE ignored.
    for (std::string const before : {"", "trap \"\" PIPE; "})
        for (std::string const command :
             {"list", "list --json", "--help", "compare ok.csv --input u --output y --order 1 --arithmetic double"}) {
            Outcome const run =
                shell("(" + before + "sleep 0.2; rlslab " + command + ") | true; exit ${PIPESTATUS[0]}");
            EXPECT_EQ(run.code, 128 + SIGPIPE) << command;
            EXPECT_EQ(run.err, "") << command;
        }
    EXPECT_EQ(shell("rlslab list | head -1").out,
              "variants                  propagates   a prior   rows at once  in\n");
}
TEST_F(Program, SaysInOneLineWhatItCannotWrite) {
    for (std::string const command :
         {"list", "list --json", "--help", "--version",
          "compare ok.csv --input u --output y --order 1 --arithmetic double", "simulate",
          "excitation ok.csv --input u --max-order 3", "identify ok.csv --input u --output y --order 1"}) {
        Outcome const full = shell("rlslab " + command + " >/dev/full");
        EXPECT_EQ(full.code, 2) << command;
        EXPECT_EQ(full.err, "rlslab: standard output: cannot write: No space left on device\n") << command;
        Outcome const closed = shell("rlslab " + command + " >&-");
        EXPECT_EQ(closed.code, 2) << command;
        EXPECT_EQ(closed.err, "rlslab: standard output: cannot write: Bad file descriptor\n") << command;
    }
}
TEST_F(Program, WritesNothingMeantForAClosedOutputIntoItsFiles) {
    Outcome const closed = shell("rlslab sweep ok.csv --input u --output y --order 1 --vary variant=ud >&-");
    EXPECT_EQ(closed.code, 2);
    EXPECT_EQ(closed.err, "rlslab: standard output: cannot write: Bad file descriptor\n");
    EXPECT_EQ(read(folder / "out/.lock"), "");
}
TEST_F(Program, LeavesNothingHalfWrittenOnAFullDisk) {
    fs::create_directory(folder / "disk");
    if (shell("mount -t tmpfs -o size=64k none disk").code != 0)
        GTEST_SKIP() << "only who may mount can make a small disk";
    for (std::string const command :
         {"study gain_error --out disk/out", "identify ok.csv --input u --output y --order 1 --out disk/out"}) {
        for (int free : {0, 4096, 8192, 40960}) {
            shell("rm -rf disk/*; head -c " + std::to_string(65536 - free) + " /dev/zero >disk/ballast");
            Outcome const run = shell("rlslab " + command);
            EXPECT_EQ(run.code, 2) << command << ", " << free << " bytes free: " << run.err;
            EXPECT_EQ(run.out, "");
            EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
            EXPECT_THAT(run.err, HasSubstr("No space left on device")) << command;
            for (auto const& file : fs::recursive_directory_iterator(folder / "disk")) {
                std::string const name = file.path().filename();
                EXPECT_FALSE(name.ends_with(".new")) << name;
                if (name.ends_with(".json") || name.ends_with(".html")) {
                    EXPECT_THAT(read(file.path()), testing::EndsWith("\n")) << name;
                }
            }
        }
    }
    EXPECT_EQ(shell("umount disk").code, 0);
}

TEST_F(Program, WhatAKilledRunWasWritingIsRemovedByTheNext) {
    fs::create_directories(folder / "out/.trials");
    // 999999999 is beyond the greatest process id of Linux; 1 is there.
    for (char const* name :
         {"a.csv.999999999.new", ".trials/b.999999999.new", "a.csv.1.new", "a.new", "999999999.new.csv"})
        write(std::string("out/") + name, "x");
    ASSERT_EQ(shell("rlslab study slicot --out out").code, 0);
    std::set<std::string> left;
    for (auto const& file : fs::recursive_directory_iterator(folder / "out"))
        if (file.path().string().find(".new") != std::string::npos) left.insert(file.path().filename());
    EXPECT_THAT(left, testing::ElementsAre("999999999.new.csv", "a.csv.1.new", "a.new"));
}
TEST_F(Program, AFileBeyondTheLimitIsAnErrorLikeAnyOther) {
    Outcome const run = shell("ulimit -f 8; rlslab identify ok.csv --input u --output y --order 1 --out out");
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, rlslab::Names("large"));
    for (auto const& file : fs::recursive_directory_iterator(folder / "out"))
        EXPECT_FALSE(file.path().string().ends_with(".new")) << file.path();
}

// --- terminals -------------------------------------------------------------------------------------------------------

TEST_F(Program, ShowsProgressOnTerminalsOnlyAndNotWhenItIsToBeQuiet) {
    // A study of several seconds: progress begins after one.
    std::string const command =
        "cd '" + folder.string() + "'; '" + program + "' study accuracy_steps --fresh --threads 1 --out out";
    Screen const seen = on_a_terminal(command);
    EXPECT_EQ(seen.code, 0);
    EXPECT_THAT(seen.text, HasSubstr("studying "));
    EXPECT_THAT(seen.text, HasSubstr("are expected to be wrong\r\n")) << "the folder, of any length, has its own line";
    EXPECT_THAT(seen.text, testing::ContainsRegex("\r {14,}\r")) << "the line of progress is wiped off when it is over";
    EXPECT_THAT(on_a_terminal(command + " --quiet").text, Not(HasSubstr("studying ")));
    EXPECT_THAT(on_a_terminal(command + " 2>/dev/null").text, Not(HasSubstr("studying ")));
    Outcome const piped = shell("rlslab study accuracy_steps --fresh --threads 1 --out out");
    EXPECT_EQ(piped.err, "") << "a log wants no progress";
    EXPECT_THAT(piped.out, HasSubstr("expected to be wrong"));
}
TEST_F(Program, ColoursTerminalsUnlessToldOtherwise) {
    std::string const compare = " compare ok.csv --input u --output y --order 1 --arithmetic double --no-timings ",
                      in = "cd '" + folder.string() + "'; ";
    auto const coloured = [](std::string const& text) { return text.find("\033[") != std::string::npos; };
    auto const on_terminal = [&](std::string const& line) {
        Screen const seen = on_a_terminal(in + line);
        EXPECT_EQ(seen.code, 0) << line << seen.text;
        return coloured(seen.text);
    };
    EXPECT_TRUE(on_terminal(program + compare));
    EXPECT_TRUE(on_terminal(program + compare + "--color=auto"));
    EXPECT_FALSE(on_terminal(program + compare + "--color=never"));
    EXPECT_FALSE(on_terminal(program + " --color never" + compare)) << "also before the command";
    EXPECT_FALSE(on_terminal("NO_COLOR=1 " + program + compare));
    EXPECT_TRUE(on_terminal("NO_COLOR= " + program + compare)) << "empty is as if it were not there";
    EXPECT_TRUE(on_terminal("NO_COLOR=1 " + program + compare + "--color=always"))
        << "an option is nearer than the environment";
    EXPECT_FALSE(on_terminal("TERM=dumb " + program + compare));
    EXPECT_FALSE(coloured(shell("rlslab" + compare).out));
    EXPECT_TRUE(coloured(shell("rlslab" + compare + "--color=always").out));
    EXPECT_TRUE(coloured(shell("rlslab --color always" + compare).out));
    for (std::string const format : {"--json", "--csv"})
        EXPECT_FALSE(coloured(shell("rlslab" + compare + "--color=always " + format).out));
    EXPECT_TRUE(coloured(shell("rlslab study slicot --out out --color=always").out));
    for (std::string const command : {"list", "simulate --samples 30", "excitation ok.csv --input u", "--version"})
        for (std::string const option : {"--quiet", "--color=never"}) {
            EXPECT_EQ(shell("rlslab " + option + " " + command).code, 0) << option << " " << command;
            EXPECT_EQ(shell("rlslab " + command + " " + option).code, 0) << command << " " << option;
        }
}

/// The first hundredth of a stage says nothing of the rest: half an hour was promised where two minutes were left.
TEST(Progress, PromisesATimeFromATenthOn) {
    EXPECT_EQ(rlslab::report::progress_text("reference", 0.099, 100), "reference   9 %");
    EXPECT_EQ(rlslab::report::progress_text("reference", 0.1, 100), "reference  10 %, 15 min left");
    EXPECT_EQ(rlslab::report::progress_text("comparing", 0.5, 30), "comparing  50 %, 30 s left");
    EXPECT_EQ(rlslab::report::progress_text("comparing", 0.5, 4), "comparing  50 %");
    EXPECT_EQ(rlslab::report::progress_text("comparing", 1, 100), "comparing 100 %");
}

// --- interrupted -----------------------------------------------------------------------------------------------------

TEST_F(Program, InterruptedAStudySaysHowToGoOn) {
    std::string const study = "'" + program + "' study definiteness --threads 1 --out ",
                      in = "cd '" + folder.string() + "'; exec ";
    Screen const stopped = on_a_terminal(in + study + "out", [](std::string const& text) {
        return text.find(" %") == text.npos ? "" : "\003";
    });  // Ctrl-C
    EXPECT_EQ(stopped.code, 128 + SIGINT) << stopped.text;
    EXPECT_THAT(stopped.text, HasSubstr("\nrlslab: stopped"));
    EXPECT_THAT(stopped.text, rlslab::Names("trials out"));
    EXPECT_GT(fs::file_size(folder / "out/.trials/definiteness"), 1000u) << "some trials were finished";
    EXPECT_FALSE(fs::exists(folder / "out/definiteness.csv"));
    for (auto const& file : fs::recursive_directory_iterator(folder / "out"))
        EXPECT_FALSE(file.path().string().ends_with(".new")) << file.path();
    ASSERT_EQ(on_a_terminal(in + study + "out").code, 0);
    ASSERT_EQ(on_a_terminal(in + study + "whole").code, 0);
    EXPECT_EQ(read(folder / "out/definiteness.csv"), read(folder / "whole/definiteness.csv"));
}

// --- help ------------------------------------------------------------------------------------------------------------

std::vector<std::string> const commands{"compare",    "study", "merge",  "identify", "simulate",
                                        "excitation", "state", "export", "list",     "help"};

TEST_F(Program, HelpFitsATerminalAndIsTheSameHoweverItIsAskedFor) {
    std::string const whole = shell("rlslab --help").out;
    EXPECT_EQ(shell("rlslab help").out, whole);
    EXPECT_EQ(shell("rlslab -h").out, whole);
    for (std::string const code : {"  0  ", "  1  ", "  2  ", "  130  ", "  141  "})
        EXPECT_THAT(whole, HasSubstr(code)) << "exit codes are explained";
    for (std::string const& command : commands) {
        EXPECT_THAT(whole, HasSubstr("\n  " + command + " "));
        Outcome const help = shell("rlslab help " + command);
        EXPECT_EQ(help.code, 0);
        EXPECT_EQ(help.err, "");
        EXPECT_EQ(shell("rlslab " + command + " --help").out, help.out);
        EXPECT_EQ(shell("rlslab --help " + command).out, help.out);
        EXPECT_EQ(shell("rlslab " + command + " --bogus=1 some words --color=wrong -h").out, help.out)
            << "who asks for help gets it";
        EXPECT_THAT(help.out, HasSubstr("\nUsage: rlslab " + command));
        EXPECT_THAT(help.out, Not(HasSubstr("\n\n\n")));
        for (std::string const& line : lines_of(help.out + whole)) EXPECT_LE(line.size(), 79u) << line;
    }
    for (std::string const& line : lines_of(shell("rlslab list").out)) EXPECT_LE(line.size(), 79u) << line;
}
TEST_F(Program, SaysWhatIsInAState) {
    std::string const whole = rlslab::files::kept(RLSLAB_SOURCE_DIR "/tests/data/states.txt").at("ud-double");
    write("whole.state", whole);
    Outcome const run = shell("rlslab state whole.state");
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.out, "a state of ud in double with 4 parameters: format 2, 376 bytes\nud, edition 1\n");
    write("short.state", whole.substr(0, 200));
    refused("state short.state", "short.state 200");
}
TEST_F(Program, AnInputThatIdentifiesNoModelIsAnAnswerThatIsNo) {
    write("constant.csv", "u\n1\n1\n1\n1\n1\n1\n1\n1\n");
    Outcome const run = shell("rlslab excitation constant.csv --input u --max-order 3");
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.out, rlslab::Names("no model"));
}
TEST_F(Program, HasAManualPageThatGroffReadsWithoutAWarning) {
    std::string const page = shell("rlslab man").out;
    for (std::string const& command : commands) {
        EXPECT_THAT(page, HasSubstr("\n.SS rlslab " + command)) << command;
        for (std::string const& line : lines_of(shell("rlslab help " + command).out))
            if (line.starts_with("  --")) {
                std::string name;
                for (char c : line.substr(2, line.find_first_of(" ,=", 3) - 2))
                    name += c == '-' ? "\\-" : std::string(1, c);
                EXPECT_THAT(page, HasSubstr("\\fB" + name + "\\fR")) << command << line;
            }
    }
    if (shell("command -v groff").code != 0) GTEST_SKIP() << "no groff";
    Outcome const read_by_groff = shell("rlslab man | groff -man -Tutf8 -ww -z");
    EXPECT_EQ(read_by_groff.out + read_by_groff.err, "");
    for (std::string const& line : lines_of(shell("rlslab man | MANWIDTH=80 groff -man -Tascii -P-cbou").out))
        EXPECT_LE(line.size(), 80u) << line;
}

// --- completions -----------------------------------------------------------------------------------------------------

/// What bash offers for the last of the words, as its function is called by bash.
class Completion : public Program {
protected:
    std::string offered(std::string const& words) const {
        Outcome const run =
            shell("source <(rlslab completion bash); COMP_WORDS=(" + words +
                  "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _rlslab; printf \"%s \" \"${COMPREPLY[@]}\"");
        EXPECT_EQ(run.code, 0) << words;
        EXPECT_EQ(run.err, "") << words;
        return run.out;
    }
};
TEST_F(Completion, OffersCommandsOptionsAndNames) {
    EXPECT_EQ(offered("rlslab co"), "compare ");
    EXPECT_EQ(offered("rlslab \"\""),
              "compare sweep study merge identify simulate excitation state export list example cite help ");
    EXPECT_EQ(offered("rlslab help ex"), "excitation export example ");
    EXPECT_EQ(offered("rlslab --ver"), "--version ");
    EXPECT_EQ(offered("rlslab study gain_e"), "gain_error gain_error_size gain_error_definiteness ");
    EXPECT_EQ(offered("rlslab study gain_error slic"), "slicot ");
    EXPECT_EQ(offered("rlslab study --bu"), "--budget ");
    EXPECT_EQ(offered("rlslab --color never study --budget f"), "full ");
    EXPECT_EQ(offered("rlslab study --budget = f"), "full ") << "= is a word of its own to bash";
    EXPECT_EQ(offered("rlslab study --budget ="), "quick full ");
    EXPECT_EQ(offered("rlslab compare ok.csv --variants jos"), "joseph joseph_rank_two ");
    EXPECT_EQ(offered("rlslab compare ok.csv --variants = ud,car"), "ud,carlson ud,carlson_delta ");
    EXPECT_EQ(offered("rlslab compare ok.csv --arithmetic q"), "quad ");
    EXPECT_EQ(offered("rlslab identify ok.csv --variant u"), "ud ud_delta ");
    EXPECT_EQ(offered("rlslab compare ok"), "ok.csv ");
    EXPECT_EQ(offered("rlslab compare ok.csv --output \"\""), "u y ") << "columns of the file";
    EXPECT_EQ(offered("rlslab compare ok.csv --regressors u,"), "u,u u,y ");
    EXPECT_EQ(offered("rlslab compare --out"), offered("rlslab compare ok.csv --out"));
    fs::create_directory(folder / "here");
    EXPECT_EQ(offered("rlslab study --out h"), "here ");
    EXPECT_EQ(offered("rlslab compare ok.csv --order \"\""), " ") << "a number has no names";
    EXPECT_EQ(offered("rlslab study --thr"), "--threads ");
    EXPECT_EQ(offered("rlslab sweep ok.csv --vary f"), "forgetting= ");
}
TEST_F(Completion, WorksInZsh) {
    if (shell("command -v zsh").code != 0) GTEST_SKIP() << "no zsh";
    shell("rlslab completion zsh >_rlslab");
    EXPECT_EQ(shell("zsh -n _rlslab").err, "");
    write(".zshrc",
          "PS1=; setopt no_beep; fpath=($PWD $fpath); autoload -U compinit; compinit -u -D; rlslab() { print -r -- ran "
          "$* } ; print ready\n");
    auto const completed = [&](std::string const& line) {
        bool typed = false;
        return on_a_terminal("cd '" + folder.string() + "'; ZDOTDIR=$PWD exec zsh -i",
                             [&](std::string const& text) {
                                 if (typed || text.find("ready") == text.npos) return std::string();
                                 typed = true;
                                 return line + "\nexit\n";
                             })
            .text;
    };
    EXPECT_THAT(completed("rlslab exc\t ok.c\t --inp\tu"), HasSubstr("ran excitation ok.csv --input=u"));
    EXPECT_THAT(completed("rlslab study slic\t --fr\t"), HasSubstr("ran study slicot --fresh"));
    EXPECT_THAT(completed("rlslab compare ok.csv --variants=ud,carl\t"),
                HasSubstr("ran compare ok.csv --variants=ud,carlson"));
}

}  // namespace
