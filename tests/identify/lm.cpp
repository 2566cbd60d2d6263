// identify against another program: coefficients and standard errors of R 4.2.2's lm on the examples (tests/data/lm.R).
// The prior is so weak that it moves theta by less than the tolerances, which are units of a standard error.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace {

using nlohmann::json;

struct Model {
    char const *example, *words;
    double most;  ///< in standard errors; longley's rows have the condition number 5e9
};
class Lm : public Program, public testing::WithParamInterface<Model> {};

TEST_P(Lm, HasTheEstimateAndTheStandardErrorsOfR) {
    auto const [example, words, most] = GetParam();
    json const expected = json::parse(read(fs::path(root) / "tests/data/lm.json")).at(example);
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
INSTANTIATE_TEST_SUITE_P(Examples, Lm,
                         testing::Values(Model{"sales", "--input lead --output sales --order 2", 1e-10},
                                         Model{"consumption", "--input income --output consumption --order 2", 1e-10},
                                         Model{"sunspots", "--output number --regressors number[k-1..k-3],number[k-9]",
                                               1e-10},
                                         Model{"airquality", "--output Ozone --regressors Solar.R,Wind,Temp", 1e-10},
                                         Model{"longley", "--output y --regressors x1,x2,x3,x4,x5,x6", 1e-6}),
                         [](auto const& model) { return std::string(model.param.example); });

}  // namespace
