// identify, excitation and simulate against another program, R 4.2.2 (tests/data/lm.R): coefficients and standard
// errors of its lm on the examples, singular values of its svd, outputs of its filter. For lm the prior is so weak that
// it moves theta by less than the tolerances, which are units of a standard error.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

namespace {

using nlohmann::json;

struct Model {
    char const *example, *words;
    double most;  ///< in standard errors; longley's rows have the condition number 5e9
};
json const& answers_of_r() {
    static json const all = json::parse(std::ifstream(RLSLAB_SOURCE_DIR "/tests/data/lm.json"));
    return all;
}
class Lm : public Program, public testing::WithParamInterface<Model> {};

TEST_P(Lm, HasTheEstimateAndTheStandardErrorsOfR) {
    auto const [example, words, most] = GetParam();
    json const expected = answers_of_r().at(example);
    Outcome const run = shell("rlslab example " + std::string(example) + " | rlslab identify - " + words +
                              " --intercept --keep-mean --validate 0 --p0 1e16 --json --no-timings");
    ASSERT_NE(run.code, 2) << run.err;
    json parameters = json::parse(run.out).at("parameters");
    auto const of = [](json const& parameter) { return parameter.at("of") != "1"; };
    std::stable_sort(parameters.begin(), parameters.end(), [&](json const& a, json const& b) { return of(a) < of(b); });
    ASSERT_EQ(parameters.size(), expected.at("value").size());
    for (size_t i = 0; i < parameters.size(); ++i) {
        double const value = expected.at("value")[i], sd = expected.at("sd")[i];
        EXPECT_NEAR(parameters[i].at("value").get<double>(), value, most * sd) << i;
        EXPECT_NEAR(parameters[i].at("sd").get<double>(), sd, most * sd) << i;
    }
}
/// The recursive residuals from R's fits of all rows before each. With condition number 5e9 the first fits of longley
/// have few digits.
TEST_P(Lm, HasTheSumsOfTheRecursiveResidualsOfR) {
    auto const [example, words, most] = GetParam();
    json const expected = answers_of_r().at(example);
    Outcome const run = shell("rlslab example " + std::string(example) + " | rlslab identify - " + words +
                              " --intercept --keep-mean --validate 0 --json --no-timings");
    ASSERT_NE(run.code, 2) << run.err;
    json const constancy = json::parse(run.out).at("constancy"), cusum = constancy.at("cusum"),
               squares = constancy.at("cusum_of_squares");
    size_t const m = constancy.at("recursive_residuals").size();
    for (size_t i = 1; i <= 4; ++i) {
        size_t const at = (m * i + 3) / 4 - 1;
        EXPECT_NEAR(cusum.at("value")[at].get<double>(), expected.at("cusum")[i - 1].get<double>(), most) << i;
        EXPECT_NEAR(squares.at("value")[at].get<double>(), expected.at("squares")[i - 1].get<double>(), most) << i;
    }
    size_t const crosses = expected.at("crosses");
    json const row = crosses == 0 ? json() : constancy.at("rows")[crosses - 1];
    EXPECT_EQ(cusum.at("crosses_at_row"), row);
    double off = 0;
    for (size_t k = 0; k < m; ++k)
        off = std::max(off, std::abs(squares.at("value")[k].get<double>() - double(k + 1) / double(m)));
    EXPECT_NEAR(off, expected.at("off").get<double>(), most);
    EXPECT_EQ(squares.at("crosses_at_row").is_null(), off <= constancy.at("c0").get<double>());
}
INSTANTIATE_TEST_SUITE_P(Examples, Lm,
                         testing::Values(Model{"sales", "--input lead --output sales --order 2", 1e-10},
                                         Model{"consumption", "--input income --output consumption --order 2", 1e-10},
                                         Model{"sunspots", "--output number --regressors number[k-1..k-3],number[k-9]",
                                               1e-10},
                                         Model{"airquality", "--output Ozone --regressors Solar.R,Wind,Temp", 1e-10},
                                         Model{"longley", "--output y --regressors x1,x2,x3,x4,x5,x6", 1e-6}),
                         [](auto const& model) { return std::string(model.param.example); });

struct Column {
    char const *example, *name;
};
class Svd : public Program, public testing::WithParamInterface<Column> {};

TEST_P(Svd, HasTheExcitationOfR) {
    auto const [example, name] = GetParam();
    json const expected = answers_of_r().at(name);
    Outcome const run =
        shell(fmt::format("rlslab example {} | rlslab excitation - --input {} --max-order 5 --json", example, name));
    ASSERT_EQ(run.code, 0) << run.err;
    json const orders = json::parse(run.out).at("orders");
    ASSERT_EQ(orders.size(), 5u);
    for (size_t n = 0; n < 5; ++n) {
        double const least = expected.at("least")[n], condition = expected.at("condition")[n];
        double const most = 1e-14 * condition * condition;  // of the squares, in which R has its least
        EXPECT_NEAR(orders[n].at("least_eigenvalue").get<double>(), least, most * least) << n;
        EXPECT_NEAR(orders[n].at("condition").get<double>(), condition, 1e-13 * condition * condition) << n;
    }
}
INSTANTIATE_TEST_SUITE_P(Columns, Svd,
                         testing::Values(Column{"sales", "lead"}, Column{"consumption", "income"},
                                         Column{"sunspots", "number"}, Column{"airquality", "Wind"},
                                         Column{"longley", "x2"}),
                         [](auto const& column) { return std::string(column.param.name); });

class Filtered : public Program {};
TEST_F(Filtered, IsASystemAsByR) {
    int number = 0;
    for (char const* words :
         {"--a=-1.5,0.7 --b=1,0.5", "--a=-0.9 --b=0,2 --delay 3 --input white", "--b=1,-1,0.25 --delay 1",
          "--a=-2.1,1.61,-0.441 --b=0.3 --input coloured:-0.9", "--a=0.2,0.9 --b=1 --delay 2 --input steps:5:40"}) {
        Outcome const run = shell(fmt::format("rlslab simulate {} --samples 500 --seed {}", words, ++number));
        ASSERT_EQ(run.code, 0) << run.err;
        std::istringstream lines(run.out);
        std::vector<double> y;
        for (std::string line; std::getline(lines, line);)
            if (!line.starts_with('#') && line != "u,y") y.push_back(std::stod(line.substr(line.find(',') + 1)));
        ASSERT_EQ(y.size(), 500u) << words;
        json const expected = answers_of_r().at(fmt::format("system_{}", number)).at("y");
        size_t at = 0;
        for (size_t const row : {1, 2, 3, 10, 100, 500})
            EXPECT_NEAR(y[row - 1], expected[at++].get<double>(), 1e-12) << words << " row " << row;
    }
}

}  // namespace
