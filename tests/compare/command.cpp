// `rlslab compare` on the command line: the options it requires, its first answer, the files it writes.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/program.hpp"
#include "tests/common/terminal.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <map>
#include <set>
#include <sstream>

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class CompareCommand : public Program {
protected:
    json compared(std::string const& arguments) const {
        Outcome const run = shell("rlslab compare " + arguments + " --json --no-timings");
        EXPECT_LE(run.code, 1) << arguments << run.err;
        if (run.code > 1) return json();
        json const out = json::parse(run.out);
        bool const some =
            std::ranges::any_of(out["recommendation"], [](json const& r) { return !r["variant"].is_null(); });
        EXPECT_EQ(run.code, some ? 0 : 1) << arguments << ": 1 where no variant is recommended";
        return out;
    }
    std::string text(std::string const& arguments) const {
        Outcome const run = shell("rlslab compare " + arguments + " --no-timings");
        EXPECT_LE(run.code, 1) << run.err;
        return run.out;
    }
    static std::string recommended(json const& out, size_t arithmetic) {
        return out["recommendation"][arithmetic]["variant"];
    }
    static std::set<std::string> arithmetics(json const& out) {
        std::set<std::string> names;
        for (json const& r : out["results"]) names.insert(r["arithmetic"]);
        return names;
    }
    /// Two inputs, an output with noise, and the means of all three far from zero.
    void SetUp() override {
        Program::SetUp();
        std::string text = "u,v,y\n";
        double before = 0, x[2] = {0, 0};
        for (int k = 0; k < 60; ++k) {
            int const u = k * 7 % 13, v = k * k % 11;
            double const y = 0.5 * before + 2 * x[0] - x[1] + (k * 5 % 7) / 64.0;
            text += std::to_string(u + 100) + "," + std::to_string(v - 50) + "," + std::to_string(y + 1000) + "\n";
            before = y, x[0] = u, x[1] = v;
        }
        write("two.csv", text);
    }
};

std::string const sales = "'" + root + "/studies/data/sales.csv' --input lead --output sales --order 2";

TEST_F(CompareCommand, AnswersFirstInFloatAndDouble) {
    EXPECT_EQ(arithmetics(compared(sales)), (std::set<std::string>{"float", "double"}));
    std::set<std::string> every;
    for (rlslab::CatalogueEntry const& entry : rlslab::catalogue()) every.emplace(entry.arithmetic->name);
    EXPECT_EQ(arithmetics(compared(sales + " --all")), every);
    EXPECT_EQ(arithmetics(compared(sales + " --arithmetic quad")), std::set<std::string>{"quad"});
    std::string const out = text(sales);
    std::string const in_float = recommended(compared(sales), 0);
    size_t const verdict = out.find("in float   use " + in_float + " "),
                 code = out.find("\n    #include <rlslab/variants/" + in_float + ".hpp>\n"),
                 table = out.find("float, of 7.2");
    ASSERT_EQ(verdict, 0u) << out;
    EXPECT_NE(out.find("\nin double  use " + recommended(compared(sales), 1), verdict), out.npos);
    EXPECT_LT(verdict, code);
    EXPECT_LT(code, table);
    EXPECT_LT(std::count(out.begin(), out.begin() + long(code), '\n'), 14) << "the answer is not on the first screen";
}

TEST_F(CompareCommand, ExitsWithOneWhereNoVariantIsRecommended) {
    EXPECT_EQ(shell("rlslab compare " + sales + " --no-timings --variants joseph --arithmetic float").code, 1);
    EXPECT_EQ(shell("rlslab compare " + sales + " --no-timings --variants joseph,ud --arithmetic float").code, 0);
    Outcome const none = shell("rlslab compare " + sales + " --no-timings --arithmetic bfloat16,binary16");
    EXPECT_EQ(none.code, 1) << "each has an answer, none of use";
    EXPECT_THAT(none.out, rlslab::Names("bfloat16 2.4 3"));
    EXPECT_THAT(none.out, Not(HasSubstr(" at least -"))) << "a bound of no digit is none";
    EXPECT_THAT(none.out, Not(HasSubstr("filter(")));
}
TEST_F(CompareCommand, TakesOtherNamesOfArithmetics) {
    for (auto const& [names, own] :
         std::map<std::string, std::set<std::string>>{{"half,single,fp64", {"binary16", "float", "double"}},
                                                      {"fp32", {"float"}},
                                                      {"f32", {"float"}},
                                                      {"binary32", {"float"}},
                                                      {"fp16", {"binary16"}},
                                                      {"f16", {"binary16"}},
                                                      {"float16", {"binary16"}},
                                                      {"bf16", {"bfloat16"}},
                                                      {"f64", {"double"}},
                                                      {"binary64", {"double"}}})
        EXPECT_EQ(arithmetics(compared("two.csv --regressors u --output y --variants ud --arithmetic " + names)), own);
    EXPECT_THAT(shell("rlslab compare two.csv --regressors u --output y --intercept --digits 3 --arithmetic f32").out,
                HasSubstr(" in float"));
}

/// The lines of what stands on the terminal, without colours.
std::vector<std::string> shown_on_a_terminal(std::string const& command, unsigned short columns) {
    std::string text = on_a_terminal(command, {}, columns).text;
    for (size_t at; (at = text.find("\033[")) != text.npos;) text.erase(at, text.find('m', at) + 1 - at);
    std::erase(text, '\r');
    return lines_of(text);
}
TEST_F(CompareCommand, FitsATerminal) {
    std::string const in = "cd '" + folder.string() + "'; '" + program + "' compare two.csv ";
    for (std::string const model : {"--input u,v --output y --order 2 --all",
                                    "--input u,v --output y --order 2 --variants conventional_two_sided,joseph",
                                    "--input u,v --output y --order 2 --p0 1e-9 --detrend",
                                    "--input u,v --output y --order 1 --control kulhavy:0.97 --guard reset"})
        for (unsigned short const columns : std::initializer_list<unsigned short>{80, 95, 110}) {
            auto const lines = shown_on_a_terminal(in + model + " --quiet", columns);
            EXPECT_GT(lines.size(), 20u) << model;
            for (std::string const& line : lines) EXPECT_LE(line.size(), columns) << model;
        }
}
TEST_F(CompareCommand, OfFiveParametersHasFiftyLinesAndTheAnswerFirst) {
    auto const lines = shown_on_a_terminal("'" + program + "' compare --example sales --quiet", 80);
    EXPECT_LE(lines.size(), 50u);
    EXPECT_THAT(lines.front(), testing::StartsWith("in float   use "));
    auto const has = [&](std::string const& variant) {
        return std::ranges::any_of(lines,
                                   [&](auto const& line) { return line.substr(0, 25).find(variant) != line.npos; });
    };
    EXPECT_TRUE(has("conventional ") && has("* ")) << "what most programs have, and what is named";
    EXPECT_FALSE(has("kalman") || has("joseph ")) << "those for studies stand in --csv";
    EXPECT_THAT(text(sales + " --variants kalman,ud"), HasSubstr("\n  kalman ")) << "asked for";
}

/// A prior of 16384 I weighs more than data in small units: such records got no answer. That powers of two change no
/// digit: DefaultPrior.ChangesNoDigitWithTheUnits.
TEST_F(CompareCommand, AnswersInAnyUnits) {
    for (double const unit : {0x1p-20, 1e-3, 1e3}) {
        std::istringstream in(read(fs::path(root) / "studies/data/sales.csv"));
        std::string line, text = "u,y\n";
        std::getline(in, line);
        while (std::getline(in, line))
            text += fmt::format("{},{}\n", std::stod(line) * unit, std::stod(line.substr(line.find(',') + 1)) * unit);
        write("units.csv", text);
        json const out = compared("units.csv --input u --output y --order 2 --arithmetic double");
        EXPECT_FALSE(out["recommendation"][0]["variant"].is_null()) << unit << out["recommendation"][0]["why"];
        EXPECT_LE(out["reference"]["prior_bias"].get<double>(), 1e-3);
    }
}

/// A slope beside a constant 10^9 times as large: the prior must not decide it.
TEST_F(CompareCommand, ASmallComponentBesideALargeOneIsTheDatas) {
    std::string small = "u,y\n", tiny = small;
    for (int k = 0; k < 100; ++k) {
        double const u = (k * 37 % 101) / 50.0 - 1, e = (k * 53 % 97) / 970.0;
        small += fmt::format("{},{}\n", u, 2 * u + e + 1e9), tiny += fmt::format("{},{:.3e}\n", u, (2 * u + e) * 1e-46);
    }
    write("small.csv", small), write("tiny.csv", tiny);
    json const out = compared("small.csv --regressors u --output y --intercept --arithmetic double");
    EXPECT_LE(out["reference"]["component_bias"].get<double>(), 0.01);
    EXPECT_GE(out["reference"]["agreement"][1].get<double>(), 2);
    EXPECT_THAT(text("tiny.csv --regressors u --output y --intercept --arithmetic float"),
                rlslab::Names("float rounding data theta"));
}
/// NIST's certified coefficients are plain least squares (tests/model/fit.cpp); with any prior there is another
/// minimiser.
TEST_F(CompareCommand, PrintsPlainLeastSquaresBesideTheProblemWithThePrior) {
    std::string const longley = "--example longley --arithmetic double", said = text(longley);
    EXPECT_LE(compared(longley)["reference"]["prior_bias"].get<double>(), 1e-3);
    EXPECT_THAT(said, rlslab::Names("prior P0 s_i"));
    EXPECT_THAT(said, HasSubstr("-3.48226e+06"));
    EXPECT_THAT(text(longley + " --p0 16384"), rlslab::Names("P0 16384 theta 9.8e-01 --p0"));
}
/// The law is tested in prior.cpp; here, that it is in JSON with any prior and in the text with --p0.
TEST_F(CompareCommand, SaysWhatAPriorCosts) {
    for (std::string const prior : {"", " --p0 1e9"}) {
        json const out = compared(sales + " --detrend --all" + prior);
        std::string said;
        for (json const& cost : out["prior_costs"]) {
            said += cost["arithmetic"].get<std::string>() + " " + cost["form"].get<std::string>() + ", ";
            EXPECT_GE(cost["loss"].get<double>(), 0);
            EXPECT_LE(cost["loss"].get<double>(), cost["digits"].get<double>());
        }
        std::string const of_binary16 =
            prior.empty() ? "binary16 symmetric, binary16 joseph, " : "";  // it ends at 65504
        EXPECT_EQ(said, "bfloat16 symmetric, bfloat16 joseph, " + of_binary16 +
                            "float symmetric, float joseph, double symmetric, double joseph, ");
        EXPECT_EQ(out["warnings"].dump().find("costs forms that store P") != std::string::npos, !prior.empty());
    }
    EXPECT_THAT(text(sales + " --detrend --p0 1e9"), rlslab::Names("--p0 symmetric float c^2"));
    for (char const* const without : {" --forgetting 0.99", " --window 50"})
        EXPECT_TRUE(compared(sales + without + " --arithmetic double")["prior_costs"].empty()) << without;
}
/// At the ends of the range of P0, one row, dependent columns, theta = 0: a line of text or a refusal, no NaN.
TEST_F(CompareCommand, HasAnAnswerForAnyPriorAndRecord) {
    write("one.csv", "u,y\n3,6\n");
    write("zero.csv", "u,v,y\n1,2,0\n2,1,0\n3,5,0\n");
    write("rank.csv", "u,v,y\n1,2,1\n2,4,3\n3,6,2\n");
    for (std::string const p0 : {"9.332636185032189e-302", "1.0715086071862673e+301", "1"})
        for (std::string const record : {"one.csv --regressors u", "zero.csv --regressors u,v"}) {
            std::string const said = text(record + " --output y --p0 " + p0);
            for (char const* const wrong : {"nan", "inf"})
                EXPECT_THAT(said, Not(HasSubstr(std::string(" ") + wrong + " "))) << record << p0;
            json const out = compared(record + " --output y --p0 " + p0);
            for (json const& cost : out["prior_costs"])
                EXPECT_TRUE(cost["loss"].is_number() && cost["digits"].is_number()) << record << p0;
        }
    EXPECT_EQ(shell("rlslab compare rank.csv --regressors u,v --output y --p0 1").code, 2);
}

TEST_F(CompareCommand, TakesSeveralInputs) {
    json const arx = compared("two.csv --input u,v --output y --na 1 --nb 1 --delay 1 --intercept"),
               listed = compared("two.csv --regressors 'y[k-1],u[k-1..k-2],v[k-1],v[k-2]' --output y --intercept");
    EXPECT_EQ(arx["data"]["parameters"], (json{"a1", "b0[u]", "b1[u]", "b0[v]", "b1[v]", "c"}));
    EXPECT_EQ(arx["data"]["regressors"], (json{"-y[k-1]", "u[k-1]", "u[k-2]", "v[k-1]", "v[k-2]", "1"}));
    EXPECT_EQ(listed["data"]["regressors"], (json{"1", "y[k-1]", "u[k-1]", "u[k-2]", "v[k-1]", "v[k-2]"}));
    for (size_t i = 0; i < 6; ++i)
        EXPECT_EQ((i == 1 ? "-" : "") + listed["reference"]["least_squares"][i].get<std::string>(),
                  arx["reference"]["least_squares"][(i + 5) % 6])
            << "y[k-1] has its own sign";
    EXPECT_THAT(listed["code"].get<std::string>(), HasSubstr("psi = (1, y[k-1], u[k-1], u[k-2], v[k-1], v[k-2])"));
    EXPECT_EQ(arx["data"]["rows"], listed["data"]["rows"]);
}

TEST_F(CompareCommand, TakesMeansOff) {
    json const off = compared("two.csv --input u,v --output y --na 1 --nb 0 --delay 1 --detrend");
    std::string const code = off["code"];
    double u = 0, v = 0, said[2];  // 60 rows of k*7 % 13 and of k^2 % 11
    for (int k = 0; k < 60; ++k) u += k * 7 % 13 + 100, v += k * k % 11 - 50;
    EXPECT_THAT(code, HasSubstr("the columns as the filter takes them: (u less "));
    ASSERT_EQ(std::sscanf(code.c_str() + code.find("(u less"), "(u less %lf, v less %lf", &said[0], &said[1]), 2);
    EXPECT_EQ(said[0], u / 60);
    EXPECT_EQ(said[1], v / 60);
    EXPECT_NE(off["reference"]["least_squares"],
              compared("two.csv --input u,v --output y --na 1 --nb 0 --delay 1")["reference"]["least_squares"]);
    // What the file has missing is not part of the mean.
    write("gap.csv", "u,y\n1,2\n3,\n,4\n5,6\n2,1\n7,3\n");
    json const gap = compared("gap.csv --regressors u --output y --detrend");
    EXPECT_THAT(gap["code"].get<std::string>(), HasSubstr("(u less 3.6, y less 3.2)"));
    EXPECT_EQ(gap["data"]["skipped"], 2);
    EXPECT_EQ(gap["data"]["rows"], 4);
}

/// tests/embedded links what is printed here, and runs it.
TEST_F(CompareCommand, PrintsTheFilterAloneForOneOfTheDoors) {
    Outcome const board = shell("rlslab compare --example sales --arithmetic float --code board");
    EXPECT_EQ(board.code, 0) << board.err;
    EXPECT_EQ(board.out, read(root + "/tests/embedded/of_compare.txt"));
    std::string const asked = "rlslab compare " + sales + " --variants ud --code ";
    EXPECT_EQ(shell(asked + "cpp").out, compared(sales + " --variants ud")["code"]);
    for (auto const& [options, begin] : {std::pair("--code c", "// C99"),
                                         {"--code python", "import numpy"},
                                         {"--code board --guard report", "// For a microcontroller"}})
        EXPECT_THAT(shell("rlslab compare " + sales + " --variants ud " + options).out, StartsWith(begin));
    // Warnings stand on standard error; where nothing is named there is no code.
    EXPECT_THAT(shell("rlslab compare two.csv --input u --output y --na 1 --nb 0 --delay 1 --code c").err,
                HasSubstr("--detrend"));
    Outcome const none = shell("rlslab compare " + sales + " --arithmetic binary16 --code c");
    EXPECT_EQ(none.code, 1);
    EXPECT_EQ(none.out, "");
    EXPECT_THAT(none.err, HasSubstr("no code: nothing is named in float or double"));
}

TEST_F(CompareCommand, WritesAPageThatLoadsNothing) {
    Outcome const run = shell("rlslab compare " + sales + " --no-timings --out made/here");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("\nmade/here/compare.html\n"));
    std::set<std::string> files;
    for (auto const& file : fs::directory_iterator(folder / "made/here")) files.insert(file.path().filename());
    EXPECT_EQ(files, (std::set<std::string>{"compare.csv", "compare.html", "compare.json", "filter.cpp"}));
    EXPECT_EQ(read(folder / "made/here/compare.json"), shell("rlslab compare " + sales + " --no-timings --json").out);
    EXPECT_EQ(read(folder / "made/here/compare.csv"), shell("rlslab compare " + sales + " --no-timings --csv").out);
    EXPECT_EQ(read(folder / "made/here/filter.cpp"), json::parse(read(folder / "made/here/compare.json"))["code"]);
    std::string const page = read(folder / "made/here/compare.html");
    for (char const* figure : {"along", "spread-float", "spread-double", "cost"})
        EXPECT_THAT(page, HasSubstr("<figure id=\"" + std::string(figure) + "\">"));
    std::string const best = recommended(json::parse(read(folder / "made/here/compare.json")), 0);
    for (std::string const& said :
         {std::string("as stored: lambda 1, rank 5 of 5"), std::string("<th>asymmetry</th>"),
          "<tr class=\"strong\"><td>★ " + best + "</td>", std::string("class=\"strong\"><svg class=\"key\""),
          std::string("Not drawn: qr_sparse, cholesky_sparse"), std::string(" digits below the best form in "),
          "digits of theta, float (24 bits): ★ " + best + ", in the code"})
        EXPECT_THAT(page, HasSubstr(said));
    for (char const* loads : {"src=", "<link", "@import", "url("}) EXPECT_THAT(page, Not(HasSubstr(loads)));
    EXPECT_THAT(page,
                HasSubstr("<pre>#include &lt;rlslab/variants/" + best + ".hpp&gt;\n\n// sales[k] = psi&#39;theta"));
    for (char const* nothing : {"nan", "inf<", "-inf"}) EXPECT_THAT(page, Not(HasSubstr(nothing)));
    shell("rlslab compare " + sales + " --no-timings --out again --threads 1");
    EXPECT_EQ(read(folder / "again/compare.html"), page);
    shell("rlslab compare " + sales + " --variants conventional,joseph,ud --arithmetic bfloat16,float --out broken");
    EXPECT_THAT(read(folder / "broken/compare.html"), rlslab::Names("conventional indefinite"));
}
TEST_F(CompareCommand, CertifySetsWhatProbesShowBesideTheTruth) {
    json const out = compared(sales + " --certify");
    int seen = 0;
    for (json const& r : out["results"]) {
        json const& probes = r["probes"];
        if (probes.is_null()) continue;
        ++seen;
        double const estimate = probes["estimate"], bound = probes["bound"];
        EXPECT_LT(estimate, bound) << r["variant"];
        EXPECT_EQ(probes["truth"].is_null(), r["variant"] == "information");
        double const truth = probes["truth"].is_null() ? estimate : probes["truth"].get<double>();
        EXPECT_LT(truth, bound) << r["variant"];
        if (r["arithmetic"] == "float") {
            EXPECT_TRUE(truth / 5 < estimate && estimate < 5 * truth) << r["variant"] << estimate << ' ' << truth;
        }
    }
    EXPECT_EQ(seen, 30);
    EXPECT_FALSE(compared(sales)["results"][0].contains("probes"));
    EXPECT_THAT(text(sales + " --certify"), HasSubstr("above it in 0 of 28 filters"));
    EXPECT_THAT(shell("rlslab compare " + sales + " --certify --csv --no-timings").out,
                HasSubstr(",predicted_at_least,probes_estimate,probes_bound,probes_truth\n"));
    for (char const* other : {"--digits 3", "--window 40", "--guard reset"})
        refused("compare " + sales + " --certify " + other, "--certify");
}

}  // namespace
