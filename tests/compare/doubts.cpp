// What `compare` doubts of a record before it says anything of variants: the sentences of `identify`.
#include "tests/common/program.hpp"

#include <rlslab/model/difference.hpp>
#include <rlslab/model/signals.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <map>

namespace {

using nlohmann::json;
using rlslab::Names;
using rlslab::Seed;
using rlslab::Signal;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class CompareDoubts : public Program {
protected:
    static std::string csv(std::string text, std::vector<Signal> const& columns) {
        for (size_t k = 0; k < columns[0].size(); ++k)
            for (size_t j = 0; j < columns.size(); ++j) text += fmt::format("{}{}", j == 0 ? '\n' : ',', columns[j][k]);
        return text + '\n';
    }
    json answer(std::string const& words) const {
        Outcome const run = shell("rlslab " + words + " --json --no-timings");
        EXPECT_LE(run.code, 1) << words << run.err;
        return run.code > 1 ? json() : json::parse(run.out);
    }
    std::vector<std::string> warnings(std::string const& words) const { return answer(words)["warnings"]; }
};

/// A column that stands still has no mean but itself: what a computed mean leaves of it would pass for a regressor.
TEST_F(CompareDoubts, AConstantColumnIsRefusedWhateverItsValue) {
    Signal const x = rlslab::white_noise(120, Seed{1}), e = rlslab::white_noise(120, Seed{2});
    Signal y(120);
    for (size_t k = 0; k < 120; ++k) y[k] = 2 * x[k] + 0.1 * e[k] + 3;
    for (double const c : {0.5, 7.0, 0.1, 0.0125, 273.15, 1.0 / 3, 3.14159, 1e9 + 0.1, -0.7, 1e-30}) {
        write("still.csv", csv("c,x,y", {Signal(120, c), x, y}));
        refused("compare still.csv --regressors c,x --output y --detrend", "constant: c");
    }
    write("gaps.csv", "c,x,y\n0.1,1,2\n,2,3\n0.1,4,4\n0.1,3,9\n0.1,7,5\n");
    refused("compare gaps.csv --regressors c,x --output y --detrend", "constant: c");
}

/// R 1.2 ohm, L 3.5 mH, k 0.045 at 1 kHz; every column with noise, some cells empty, and a spike of 45 A.
TEST_F(CompareDoubts, ASpikeIsNamedAsIdentifyNamesItAndTheGuardStays) {
    constexpr int n = 5000;
    Signal const level = rlslab::random_steps(n, 20, 200, Seed{11});
    Seed noise{12};
    double current = 0, speed = 0;
    auto const text = [&](double spike) {
        std::string out = "voltage,speed,current";
        noise = Seed{12}, current = 0, speed = 0;
        for (int k = 0; k < n; ++k) {
            double const voltage = 12 * level[size_t(k)];
            out += fmt::format(
                "\n{:.4f},{},{}", voltage + 0.01 * noise.bell(),
                k % 500 == 7 ? "" : fmt::format("{:.3f}", speed + 0.2 * noise.bell()),
                k % 901 == 3 ? "" : fmt::format("{:.4f}", current + 0.01 * noise.bell() + (k == 4000 ? spike : 0)));
            double const before = current;
            current += 1e-3 * (voltage - 1.2 * current - 0.045 * speed) / 3.5e-3;
            speed += 1e-3 * (0.045 * before - 2e-4 * speed) / 2e-4;
        }
        return out + '\n';
    };
    write("motor.csv", text(45)), write("clean.csv", text(0));
    std::string const model = " --output current --regressors current[k-1],voltage[k-1],speed[k-1]";
    auto const said = warnings("compare motor.csv --variants ud --forgetting 0.999" + model),
               by_identify = warnings("identify motor.csv --validate 0 --keep-mean --forgetting 0.999" + model);
    EXPECT_THAT(said, Contains(Names("4001 4002 standard deviations --guard reset")));
    EXPECT_THAT(by_identify, Contains(said.front())) << "the same words and numbers";
    EXPECT_THAT(warnings("compare motor.csv --variants ud --guard reset" + model),
                Contains(testing::AllOf(Names("4001 the guard"), Not(HasSubstr("--guard")))));
    EXPECT_THAT(warnings("compare clean.csv --variants ud --forgetting 0.999" + model), testing::IsEmpty());
    json const three = answer("compare motor.csv --arithmetic float --digits 3" + model);
    EXPECT_TRUE(three["digits"]["advice"]["guarded"]) << "the guard worked";
    EXPECT_THAT(three["code"].get<std::string>(), HasSubstr("rlslab::Guarded<"));
    EXPECT_THAT(three["digits"]["warnings"].get<std::vector<std::string>>(), Contains(Names("4001")));
}

/// Six regressors and a constant; one of them lies at 100 +- 5. A form that stores P loses, at most what is said.
TEST_F(CompareDoubts, AnOffsetIsSaidToCostWhatItCosts) {
    constexpr int n = 500;
    std::vector<Signal> columns;
    for (std::uint64_t i = 0; i < 6; ++i) columns.push_back(rlslab::white_noise(n, Seed{20 + i}));
    for (double& v : columns[5]) v *= 5;
    Signal y(n);
    for (size_t k = 0; k < n; ++k)
        y[k] = 11 + columns[0][k] - columns[1][k] + 0.5 * columns[2][k] + 0.1 * columns[5][k] + 0.1 * Seed{k}.bell();
    columns.push_back(y);
    double worst[2];
    std::vector<std::string> said[2];
    for (int off : {0, 1}) {
        for (double& v : columns[5]) v += 100 * off;
        write("offset.csv", csv("x1,x2,x3,x4,x5,x6,y", columns));
        json const a = answer(
            "compare offset.csv --regressors x1,x2,x3,x4,x5,x6 --intercept --output y --variants "
            "symmetric --arithmetic float");
        worst[off] = a["results"][0]["spread"]["worst"]["median"], said[off] = a["warnings"];
    }
    EXPECT_THAT(said[0], testing::IsEmpty());
    ASSERT_THAT(said[1], Contains(Names("x6 --detrend")));
    double told = 0;
    std::string const& sentence =
        *std::ranges::find_if(said[1], [](std::string const& s) { return s.starts_with("x6"); });
    ASSERT_EQ(std::sscanf(sentence.c_str() + sentence.find("about "), "about %lf", &told), 1) << sentence;
    EXPECT_GT(worst[0] - worst[1], 0);
    EXPECT_LT(worst[0] - worst[1], told + 0.5);
}

/// A column that is another plus 2, beside a constant; and shares that add to 1.
TEST_F(CompareDoubts, DependenceButForRoundingIsNamedAsIdentifyNamesIt) {
    constexpr int n = 200;
    std::vector<Signal> x(5, Signal(n));
    Seed seed{31};
    for (size_t k = 0; k < n; ++k) {
        for (size_t i = 0; i < 3; ++i) x[i][k] = seed.uniform();
        x[3][k] = x[2][k] + 2;
        x[4][k] = 1 + x[0][k] - x[1][k] + 2 * x[2][k] + 0.1 * seed.bell();
    }
    write("two.csv", csv("x1,x2,x3,x4,y", x));
    std::string const model = " two.csv --output y --intercept --regressors ";
    auto const said = warnings("compare" + model + "x1,x2,x3,x4"),
               by_identify = warnings("identify" + model + "x1,x2,x3,x4 --keep-mean --validate 0");
    ASSERT_THAT(said, Contains(Names("x3[k], x4[k] rounding")));
    EXPECT_THAT(by_identify, Contains(Names("x3[k], x4[k] rounding")));
    EXPECT_THAT(warnings("compare" + model + "x1,x2,x3"), testing::IsEmpty());
    for (size_t k = 0; k < n; ++k) {
        double const sum = x[0][k] + x[1][k] + x[2][k];
        for (size_t i = 0; i < 3; ++i) x[i][k] /= sum;
    }
    write("two.csv", csv("x1,x2,x3,x4,y", x));
    EXPECT_THAT(warnings("compare" + model + "x1,x2,x3"), Contains(Names("x1[k], x2[k], x3[k] rounding")));
}

/// A record of a second-order system with its times, and what loggers make of it. Sentences: tests/input/times.cpp.
TEST_F(CompareDoubts, GapsAndDoublesAndOrderAreSeenAndMendedByTime) {
    constexpr int n = 400;
    Signal const u = rlslab::prbs(7, n, 3);
    Signal xi = rlslab::white_noise(n, Seed{41});
    for (double& v : xi) v *= 0.05;
    Signal const y = rlslab::simulate({.a = {-1.5, 0.7}, .b = {{0, 0.5}}, .delay = 0, .c = 0}, {u}, xi);
    std::vector<std::string> lines, dropped, emptied, doubled, dates, swapped;
    for (size_t k = 0; k < n; ++k) {
        std::string const rest = fmt::format(",{},{:.5f}\n", u[k], y[k]);
        bool const gone = k > 5 && k % 37 < 2 && k + 1 < n;
        size_t const minute = 20 * 60 + k;  // over midnight
        lines.push_back(fmt::format("{:.2f}{}", 0.01 * double(k), rest));
        if (!gone) dropped.push_back(lines[k]);
        emptied.push_back(gone ? fmt::format("{:.2f},,\n", 0.01 * double(k)) : lines[k]);
        doubled.insert(doubled.end(), k % 40 == 3 ? 2 : 1, lines[k]);
        dates.push_back(
            fmt::format("2024-02-{} {:02}:{:02}:30{}", 28 + minute / 1440, minute % 1440 / 60, minute % 60, rest));
    }
    std::vector<std::string> const backward(lines.rbegin(), lines.rend());
    swapped = dates;
    std::swap(swapped[7], swapped[300]);
    std::string const model = " --input u --output y --order 2 ";
    auto const theta = [&](std::string const& words) {
        return answer("compare " + words + model + "--variants ud")["reference"]["least_squares"];
    };
    struct {
        std::string name;
        std::vector<std::string> rows;
        char const *names, *is;  // what the warning names without --time; what the file is with it
    } const files[] = {{"all", lines, "", "all"},
                       {"emptied", emptied, "", "emptied"},
                       {"dropped", dropped, "t: 10 0.01 --time t", "emptied"},
                       {"doubled", doubled, "t: 10 --time t", "all"},
                       {"backward", backward, "t: newest --time t", "all"},
                       {"dates", dates, "", "dates"},
                       {"swapped", swapped, "t: back --time t", "dates"}};
    std::map<std::string, json> plain;
    for (auto const& [name, rows, names, is] : files) {
        write(name + ".csv", fmt::format("t,u,y\n{}", fmt::join(rows, "")));
        plain[name] = theta(name + ".csv");
        EXPECT_EQ(theta(name + ".csv --time t"), plain[is]) << name;
        for (std::string const command : {"compare ", "identify "})
            EXPECT_THAT(warnings(command + name + ".csv" + model),
                        *names ? testing::Matcher<std::vector<std::string>>(Contains(Names(names)))
                               : testing::Matcher<std::vector<std::string>>(Not(Contains(HasSubstr("--time")))))
                << name;
    }
    EXPECT_NE(plain["dropped"], plain["emptied"]);
    EXPECT_THAT(shell("rlslab compare dropped.csv" + model + "--time t --variants ud").out,
                HasSubstr(fmt::format("between the {}", dropped.size())));
    EXPECT_THAT(warnings("compare swapped.csv --regressors u --output y"), Not(Contains(HasSubstr("--time"))))
        << "no row needs another";
}

}  // namespace
