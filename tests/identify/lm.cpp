// identify, excitation and simulate against another program, R 4.2.2 (tests/data/lm.R): coefficients and standard
// errors of its lm on the examples, singular values of its svd, outputs of its filter. For lm the prior is so weak that
// it moves theta by less than the tolerances, which are units of a standard error.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fmt/format.h>

namespace {

using nlohmann::json;

struct Model {
    char const *example, *words, *column;
    double most;  ///< in standard errors; longley's rows have the condition number 5e9
};
class AsByR : public Program, public testing::WithParamInterface<Model> {
protected:
    static json answer(std::string const& to) {
        static json const all = json::parse(std::ifstream(RLSLAB_SOURCE_DIR "/tests/data/lm.json"));
        return all.at(to);
    }
    json said(std::string const& words) const {
        Outcome const run = shell(fmt::format("rlslab example {} | rlslab {} --json", GetParam().example, words));
        EXPECT_NE(run.code, 2) << run.err;
        return json::parse(run.out);
    }
    json identified(std::string const& words) const {
        return said(
            fmt::format("identify - {} --intercept --keep-mean --validate 0 --no-timings {}", GetParam().words, words));
    }
};

TEST_P(AsByR, HasTheEstimateAndTheStandardErrorsOfLm) {
    json const expected = answer(GetParam().example);
    json parameters = identified("--p0 1e16").at("parameters");
    auto const of = [](json const& parameter) { return parameter.at("of") != "1"; };
    std::stable_sort(parameters.begin(), parameters.end(), [&](json const& a, json const& b) { return of(a) < of(b); });
    ASSERT_EQ(parameters.size(), expected.at("value").size());
    for (size_t i = 0; i < parameters.size(); ++i)
        for (char const* const what : {"value", "sd"})
            EXPECT_NEAR(parameters[i].at(what).get<double>(), expected.at(what)[i].get<double>(),
                        GetParam().most * expected.at("sd")[i].get<double>())
                << what << ' ' << i;
}
/// The recursive residuals from R's fits of all rows before each. With condition number 5e9 the first fits of longley
/// have few digits.
TEST_P(AsByR, HasTheSumsOfTheRecursiveResiduals) {
    double const most = GetParam().most;
    json const expected = answer(GetParam().example), constancy = identified("").at("constancy"),
               cusum = constancy.at("cusum"), squares = constancy.at("cusum_of_squares");
    size_t const m = constancy.at("recursive_residuals").size();
    for (size_t i = 1; i <= 4; ++i) {
        size_t const at = (m * i + 3) / 4 - 1;
        EXPECT_NEAR(cusum.at("value")[at].get<double>(), expected.at("cusum")[i - 1].get<double>(), most) << i;
        EXPECT_NEAR(squares.at("value")[at].get<double>(), expected.at("squares")[i - 1].get<double>(), most) << i;
    }
    size_t const crosses = expected.at("crosses");
    EXPECT_EQ(cusum.at("crosses_at_row"), crosses == 0 ? json() : constancy.at("rows")[crosses - 1]);
    double off = 0;
    for (size_t k = 0; k < m; ++k)
        off = std::max(off, std::abs(squares.at("value")[k].get<double>() - double(k + 1) / double(m)));
    EXPECT_NEAR(off, expected.at("off").get<double>(), most);
    EXPECT_EQ(squares.at("crosses_at_row").is_null(), off <= constancy.at("c0").get<double>());
}
TEST_P(AsByR, HasTheExcitationOfSvd) {
    std::string const column = GetParam().column;
    json const expected = answer(column), orders = said("excitation - --max-order 5 --input " + column).at("orders");
    ASSERT_EQ(orders.size(), 5u);
    for (size_t n = 0; n < 5; ++n) {
        double const least = expected.at("least")[n], condition = expected.at("condition")[n];
        double const most = 1e-14 * condition * condition;  // of the squares, in which R has its least
        EXPECT_NEAR(orders[n].at("least_eigenvalue").get<double>(), least, most * least) << n;
        EXPECT_NEAR(orders[n].at("condition").get<double>(), condition, 1e-13 * condition * condition) << n;
    }
}
INSTANTIATE_TEST_SUITE_P(
    Examples, AsByR,
    testing::Values(Model{"sales", "--input lead --output sales --order 2", "lead", 1e-10},
                    Model{"consumption", "--input income --output consumption --order 2", "income", 1e-10},
                    Model{"sunspots", "--output number --regressors number[k-1..k-3],number[k-9]", "number", 1e-10},
                    Model{"airquality", "--output Ozone --regressors Solar.R,Wind,Temp", "Wind", 1e-10},
                    Model{"longley", "--output y --regressors x1,x2,x3,x4,x5,x6", "x2", 1e-6}),
    [](auto const& model) { return std::string(model.param.example); });

TEST_F(Program, FiltersAsRDoes) {
    json const expected = json::parse(std::ifstream(RLSLAB_SOURCE_DIR "/tests/data/lm.json"));
    int number = 0;
    for (char const* words :
         {"--a=-1.5,0.7 --b=1,0.5", "--a=-0.9 --b=0,2 --delay 3 --input white", "--b=1,-1,0.25 --delay 1",
          "--a=-2.1,1.61,-0.441 --b=0.3 --input coloured:-0.9", "--a=0.2,0.9 --b=1 --delay 2 --input steps:5:40"}) {
        Outcome const run = shell(fmt::format("rlslab simulate {} --samples 500 --seed {}", words, ++number));
        ASSERT_EQ(run.code, 0) << run.err;
        std::vector<double> y;
        for (std::string const& line : lines_of(without_run(run.out)))
            if (line != "u,y") y.push_back(std::stod(line.substr(line.find(',') + 1)));
        ASSERT_EQ(y.size(), 500u) << words;
        json const of = expected.at(fmt::format("system_{}", number)).at("y");
        size_t at = 0;
        for (size_t const row : {1, 2, 3, 10, 100, 500})
            EXPECT_NEAR(y[row - 1], of[at++].get<double>(), 1e-12) << words << " row " << row;
    }
}

}  // namespace
