// What is refused, and with which line: tests/data/messages.txt. No other test fixes the English of messages.
// And trouble that people had in public, as small files (tests/data/cases): the right value, or a clear line.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

namespace {

TEST_F(Program, RefusesInTheseWords) {
    for (auto const& [name, text] :
         std::map<std::string, std::string>{{"text", "u,y\n1,2\n3,abc\n"},
                                            {"ragged", "u,y\n1,2\n3\n"},
                                            {"doubt", "u;y\n1,234;2\n2;3\n"},
                                            {"constant", "u,y\n" + rows(40, [](int) { return std::string("1"); })},
                                            {"empty", ""},
                                            {"short", "u,y\n1,2\n"},
                                            {"huge", "u,y\n1,2\n1e308,2\n"},
                                            {"missing", "u,y\n1,\n2,\n4,\n5,\n"},
                                            {"gap", "u,y\n1,2\n,3\n4,5\n"},
                                            {"two", "u,v,y\n1,2,3\n2,1,4\n5,0,1\n7,3,3\n"},
                                            {"word", "t,u,y\n1,1,2\n2,3,1\nsoon,3,4\n4,2,2\n"},
                                            {"untimed", "t,u,y\n1,1,2\n2,3,1\n,3,4\n4,2,2\n"},
                                            {"twice", "t,u,y\n1,1,2\n2,3,1\n2,3,4\n4,2,2\n"}})
        write(name + ".csv", text);
    std::ifstream file(root + "/tests/data/messages.txt");
    std::map<std::string, std::string> short_for;  // at the beginning of a line
    int messages = 0;
    for (std::string line, expected; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '%' && line.substr(2, 3) == " = ") {
            short_for[line.substr(0, 2)] = line.substr(5);
        } else if (line.starts_with("$ ")) {
            std::getline(file, expected);
            Outcome const run = shell(line.substr(2));
            EXPECT_EQ(run.err, expected + "\n") << line;
            EXPECT_EQ(run.code, 2) << line;
            EXPECT_EQ(run.out, "") << line;
            ++messages;
        } else {
            if (auto const it = short_for.find(line.substr(0, 2)); it != short_for.end())
                line.replace(0, 2, it->second);
            size_t const bar = line.find("| ");
            ASSERT_NE(bar, line.npos) << line;
            refused(line.substr(0, bar), line.substr(bar + 2));
            ++messages;
        }
    }
    EXPECT_GE(messages, 150);
    for (auto const& made : fs::directory_iterator(folder))  // but by a study that is refused when it has begun
        EXPECT_TRUE(made.path().extension() == ".csv" || made.path().extension() == ".txt" ||
                    made.path().filename() == "begun")
            << made.path();
}

// --- trouble that people had in public -----------------------------------------------------------------------------

using nlohmann::json;

struct Case {
    char const* words;          // of rlslab compare, behind the name of the file
    std::vector<double> theta;  // exact least squares, all digits that stand here; none: refused
    char const* names = "";     // what the line, or a warning, names
};

/// Values by rationals or numpy, without our code; a value given with fewer digits is compared in those.
std::vector<Case> const cases{
    // Fortran's exponents
    {"s01_fortran_d.csv --regressors u,v --output y", {}, "s01_fortran_d.csv:2 1 u 2.135025329003D-01"},
    {"s01_fortran_no_letter.csv --regressors u,v --output y", {}, "s01_fortran_no_letter.csv:2 1 u 2.135025329003-001"},
    // marks between thousands
    {"s02_apostrophe_groups.csv --regressors menge,stueck --output preis", {}, "2 3 preis 3'384"},
    {"s02_nbsp_groups.csv --regressors menge,stueck --output preis", {}, "2 3 preis 384"},
    {"s02_point_groups_tab.csv --regressors menge,stueck --output preis", {}, "2 3 preis 3.384 925 2 --decimal"},
    {"s02_point_groups_bar.csv --regressors menge,stueck --output preis", {}, "2 3 preis 3.384 925 2 --decimal"},
    {"s02_point_groups_blank.txt --regressors menge,stueck --output preis", {}, "2 3 preis 3.384 925 2 --decimal"},
    {"s02_point_groups_tab.csv --regressors stueck --output preis", {}, "2 3 preis 3.384 925 2 --decimal"},
    // rows of units and of types
    {"s03_units_row.csv --input u --output y --na 1 --nb 0 --delay 1", {}, "2 2 u V units delete"},
    {"s03_units_and_types_rows.csv --input u --output y --na 1 --nb 0 --delay 1", {}, "2 2 u V units delete"},
    // words of missing values
    {"s04_historian.csv --input u --output y --na 1 --nb 0 --delay 1", {}, "42 3 y No Data --missing"},
    {"s04_msvc_nan.csv --input u --output y --na 1 --nb 0 --delay 1", {}, "42 3 y -1.#IND --missing"},
    {"s04_historian.csv --input u --output y --na 1 --nb 0 --delay 1 --missing \"No Data,Bad,I/O Timeout\"",
     {-0.8002416279276966, 0.4998968514871879}},
    {"s04_msvc_nan.csv --input u --output y --na 1 --nb 0 --delay 1 --missing \"-1.#IND,1.#QNAN,nan(ind)\"",
     {-0.8002097796969688, 0.4998543519780854}},
    // two columns of one name
    {"s05_twice_named.csv --regressors t --output value", {}, "1 t 1 3"},
    // identifiers like 12E12
    {"s06_ids.tsv --regressors a --output b", {2.0006207427686045}},
    {"s06_ids.tsv --regressors id --output b", {}, "2 1 id 0047583311587DD90005"},
    // samples that the logger dropped, as empty rows and as gaps in time; stamps twice
    {"s07_dropped_as_empty.csv --input u --output y --na 2 --nb 0 --delay 1", {-1.49994859, 0.69983250, 0.49981625}},
    {"s07_dropped.csv --time t --input u --output y --na 2 --nb 0 --delay 1",
     {-1.4999485908053045, 0.6998324957241239, 0.4998162463684447}},
    {"s07_dropped.csv --input u --output y --na 2 --nb 0 --delay 1",
     {-1.3619343164123192, 0.6050270669307205, 0.614403261861861},
     "t: 71 steps 0.01 --time t"},
    {"s07_duplicated_stamps.csv --time t --input u --output y --na 2 --nb 0 --delay 1",
     {-1.499365, 0.699399, 0.500058}},
    {"s07_duplicated_stamps.csv --input u --output y --na 2 --nb 0 --delay 1",
     {-1.4812558562825877, 0.6748429643889211, 0.4920977860783708},
     "t: 22 rows --time t"},
    // empty cells between tabs, cells of a blank
    {"s08_empty_between_tabs.tsv --regressors a,b --output c", {1.001241254929883, -3.002231535961559}},
    {"s08_empty_spaces.csv --regressors a,b --output c", {1.001241254929883, -3.002231535961559}},
    // TRUE, 12.5%, $1,234.50
    {"s09_booleans.csv --regressors pump,a --output z", {}, "2 1 pump TRUE"},
    {"s09_percent.csv --regressors valve,a --output z", {}, "2 1 valve 68.7%"},
    {"s09_currency.csv --regressors price,a --output z", {}, "2 1 price $1,276.88"},
    // dummies with a constant
    {"s10_dummies.csv --regressors x,da,db --intercept --output y", {}, "dependent 3 4"},
    {"s10_plus_two.csv --regressors x1,x2,x3 --intercept --output y",
     {0.9894342634863174, 0.975987883387077, -0.9756556923481196, 2.0208709316757707}},
    // years with a constant
    {"s12_years.csv --regressors year,miles --intercept --output price",
     {-1409540.0331094302, 706.3333863524359, -0.019551452553601335}},
    // a series that is constant
    {"s13_constant_series.csv --regressors y[k-1] --output y --detrend", {}, "rank y[k-1]"},
    // more b than a, b that begins late, a pure delay, a negative pole
    {"s14_nb_above_na.csv --input u --output y --na 1 --nb 2", {-0.50025, 0.99972, -1.99997, 3.00027}},
    {"s14_no_b_before_delay.csv --input u --output y --na 2 --nb 0 --delay 2", {-0.00205, 0.24865, 0.79931}},
    {"s14_pure_delay.csv --input u --output y --na 0 --nb 3", {-0.000425, -0.000146, 0.000309, 0.499142}},
    {"s14_negative_pole.csv --input u --output y --na 1 --nb 0 --delay 1", {0.59966, 1.00078}},
    // zeros before the signal begins
    {"s15_zeros_first.csv --regressors \"far[k..k-3]\" --output mic",
     {0.5958102030296313, -0.3006505603415474, 0.10018279381156997, 0.05028819404345457}},
    // times out of order
    {"s16_times_out_of_order.csv --time t --input u --output y --na 1 --nb 0 --delay 1",
     {-0.8024438285147956, 0.9963719777523057}},
    {"s16_times_out_of_order.csv --input u --output y --na 1 --nb 0 --delay 1",
     {-0.10668278006796546, -0.07151895449445576},
     "t: 145 299 --time t"},
    // integers, logicals and singles, rows and columns in .mat
    {"s17_int16.mat --input u --output y --na 1 --nb 0 --delay 1", {-0.7015132482, 0.2660958681}},
    {"s17_logical_single.mat --input u --output y --na 1 --nb 0 --delay 1", {-0.76700885, 0.40730739}},
    {"s17_row_and_column.mat --input u --output y --na 1 --nb 0 --delay 1", {-0.7015118766, 0.3991439146}},
    // Elsewhere: s10_plus_two with all four, s13 (below), s11 (python/test_composed.py), s18, s19 (adapt/assessed.cpp).
};

TEST_F(Program, SaysTheRightValueOrAClearLineForEveryCase) {
    for (Case const& one : cases) {
        std::string const command = "compare " + root + "/tests/data/cases/" + one.words;
        if (one.theta.empty()) {
            refused(command, one.names);
            continue;
        }
        Outcome const run = shell("rlslab " + command + " --variants ud --arithmetic double --no-timings --json");
        ASSERT_EQ(run.code, 0) << run.err << command;
        json const answer = json::parse(run.out), said = answer["reference"]["least_squares"];
        if (*one.names) {
            EXPECT_THAT(answer["warnings"].dump(), rlslab::Names(one.names)) << command;
        }
        ASSERT_EQ(said.size(), one.theta.size()) << command;
        for (size_t j = 0; j < one.theta.size(); ++j) {
            // Half a unit of the last digit that stands in the table, or of binary64's sixteenth.
            std::string const shown = json(one.theta[j]).dump();
            size_t const digits = shown.size() - std::min(shown.find('.'), shown.size()) - 1;
            double const unit = std::max(std::pow(10., -double(digits)), 4e-16 * std::abs(one.theta[j]));
            EXPECT_NEAR(std::stod(said[j].get<std::string>()), one.theta[j], 0.51 * unit) << command;
        }
    }
}

TEST_F(Program, ColumnsThatDependButForRoundingAreNamed) {
    Outcome const run = shell("rlslab compare " + root +
                              "/tests/data/cases/s10_plus_two.csv "
                              "--regressors x1,x2,x3,x4 --intercept --output y --no-timings --json");
    EXPECT_EQ(run.code, 1) << run.err;
    EXPECT_THAT(json::parse(run.out)["warnings"].dump(), rlslab::Names("1 x3[k] x4[k] rounding"));
}
TEST_F(Program, IdentifySaysWhyASeriesHasNoModel) {
    std::string const at = "identify " + root + "/tests/data/cases/";
    refused(at + "s13_constant_series.csv --output y", "y does not change");
    refused(at + "s13_one_impulse.csv --output y", "y 11 10 --max-order --order");
    Outcome const run = shell("rlslab " + at + "s13_alternating.csv --output y --json");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(json::parse(run.out)["order"], 1) << "y[k] = 2 m - y[k-1], exactly";
}

// --- names of columns before the syntax of lags ----------------------------------------------------------------------

TEST_F(Program, ANameOfTheFileGoesBeforeTheSyntaxOfLags) {
    std::string text = "k,y,y[k-1],Speed [rpm],[5],[°C],[k]\n";
    for (int k = 0; k < 30; ++k)
        text += std::to_string(k) + "," + std::to_string(k * k % 17) + "," + std::to_string(k * 7 % 13) + "," +
                std::to_string(k * 5 % 11) + "," + std::to_string(k % 3) + "," + std::to_string(k * k % 7) + "," +
                std::to_string(k % 5) + "\n";
    write("design.csv", text);
    write("preamble.csv", "Logger X100\nSerial 1234\n\n" + text);
    auto const said = [&](std::string const& words) {
        Outcome const run = shell("rlslab compare " + words + " --output y --variants ud --arithmetic double --json");
        EXPECT_EQ(run.code, 0) << run.err << words;
        return run.code == 0 ? json::parse(run.out) : json();
    };
    for (std::string const file : {"design.csv", "preamble.csv"}) {
        json const column = said(file + " --regressors y[k-1]"), lag = said(file + " --regressors y[k-1..k-1]");
        EXPECT_EQ(column["data"]["rows"], 30) << "the file's column";
        EXPECT_EQ(column["data"]["regressors"][0], "y[k-1][k]");
        EXPECT_EQ(lag["data"]["rows"], 29) << "the computed lag";
        EXPECT_NE(column["reference"]["theta"], lag["reference"]["theta"]);
        for (std::string const name : {"Speed [rpm]", "[5]", "[°C]", "[k]"})
            EXPECT_EQ(said(file + " --regressors \"" + name + "\"")["data"]["rows"], 30) << name;
    }
    EXPECT_EQ(said("- --regressors y[k-1] <design.csv")["data"]["rows"], 30) << "standard input is read once";
    refused("compare design.csv --output y --regressors \"Speed [rmp]\"", "--regressors Speed [rmp]");
}

}  // namespace
