// What `compare` doubts of a record before it says anything of variants: the sentences of `identify`.
#include "tests/common/program.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/model/difference.hpp>
#include <rlslab/model/signals.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

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
    std::vector<Signal> x;
    for (std::uint64_t i = 0; i < 6; ++i) x.push_back(rlslab::white_noise(n, Seed{20 + i}));
    Signal y(n);
    for (size_t k = 0; k < n; ++k) {
        x[5][k] = 100 + 5 * x[5][k];
        y[k] = 1 + x[0][k] - x[1][k] + 0.5 * x[2][k] + 0.1 * x[5][k] + 0.1 * Seed{k}.bell();
    }
    std::vector<Signal> columns = x;
    columns.push_back(y);
    write("offset.csv", csv("x1,x2,x3,x4,x5,x6,y", columns));
    std::string const model =
        "compare offset.csv --regressors x1,x2,x3,x4,x5,x6 --intercept --output y --variants symmetric "
        "--arithmetic float";
    auto const worst = [](json const& a) { return a["results"][0]["spread"]["worst"]["median"].get<double>(); };
    json const as_it_is = answer(model);
    Signal centred = columns[5];
    for (double& v : centred) v -= 100;
    columns[5] = centred;
    write("offset.csv", csv("x1,x2,x3,x4,x5,x6,y", columns));
    json const without = answer(model);
    std::vector<std::string> const said = as_it_is["warnings"];
    ASSERT_THAT(said, Contains(Names("x6 --detrend")));
    EXPECT_THAT(without["warnings"].get<std::vector<std::string>>(), testing::IsEmpty());
    double told = 0;
    std::string const& sentence = *std::ranges::find_if(said, [](std::string const& s) { return s.starts_with("x6"); });
    ASSERT_EQ(std::sscanf(sentence.c_str() + sentence.find("about "), "about %lf", &told), 1) << sentence;
    EXPECT_GT(worst(without) - worst(as_it_is), 0);
    EXPECT_LT(worst(without) - worst(as_it_is), told + 0.5);
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

/// A record of a second-order system with its times, and what loggers make of it.
class CompareTimes : public CompareDoubts {
protected:
    std::vector<std::string> lines;
    void SetUp() override {
        CompareDoubts::SetUp();
        constexpr int n = 400;
        Signal const u = rlslab::prbs(7, n, 3);
        Signal xi = rlslab::white_noise(n, Seed{41});
        for (double& v : xi) v *= 0.05;
        Signal const y = rlslab::simulate({.a = {-1.5, 0.7}, .b = {{0, 0.5}}, .delay = 0, .c = 0}, {u}, xi);
        for (size_t k = 0; k < n; ++k) lines.push_back(fmt::format("{:.2f},{},{:.5f}\n", 0.01 * double(k), u[k], y[k]));
    }
    void file(std::string const& name, std::vector<std::string> const& rows) const {
        std::string text = "t,u,y\n";
        for (std::string const& row : rows) text += row;
        write(name, text);
    }
    static constexpr char model[] = " --input u --output y --order 2 ";
    json theta(std::string const& words) const {
        return answer("compare " + words + model + "--variants ud")["reference"]["least_squares"];
    }
};

TEST_F(CompareTimes, GapsAndDoublesAndOrderAreSeenAndMended) {
    std::vector<std::string> dropped, emptied, doubled, backward(lines.rbegin(), lines.rend()), shuffled = lines;
    Seed draw{42};
    for (size_t k = 0; k < lines.size(); ++k) {
        bool const gone = k > 5 && k % 37 < 2 && k + 1 < lines.size();
        if (!gone) dropped.push_back(lines[k]);
        emptied.push_back(gone ? fmt::format("{:.2f},,\n", 0.01 * double(k)) : lines[k]);
        doubled.push_back(lines[k]);
        if (k % 40 == 3) doubled.push_back(lines[k]);
        std::swap(shuffled[k], shuffled[size_t(draw.uniform() * double(k + 1))]);
    }
    file("all.csv", lines), file("dropped.csv", dropped), file("emptied.csv", emptied), file("doubled.csv", doubled),
        file("backward.csv", backward), file("shuffled.csv", shuffled);
    json const right = theta("all.csv");
    EXPECT_NE(theta("dropped.csv"), theta("emptied.csv"));
    EXPECT_EQ(theta("dropped.csv --time t"), theta("emptied.csv"));
    EXPECT_EQ(theta("emptied.csv --time t"), theta("emptied.csv"));
    auto const identified = [&](std::string const& file) {
        json out = answer("identify " + file + model);
        return json{out["parameters"], out["samples"], out["warnings"], out["fit"]};
    };
    EXPECT_EQ(identified("dropped.csv --time t"), identified("emptied.csv"));
    EXPECT_THAT(shell("rlslab compare dropped.csv" + std::string(model) + "--time t --variants ud").out,
                HasSubstr(fmt::format("between the {}", dropped.size())));
    for (char const* const name : {"all.csv", "doubled.csv", "backward.csv", "shuffled.csv"}) {
        EXPECT_EQ(theta(name + std::string(" --time t")), right) << name;
        EXPECT_THAT(warnings("compare " + std::string(name) + model + "--time t --variants ud"), testing::IsEmpty())
            << name;
    }
    for (std::string const command : {"compare ", "identify "}) {
        EXPECT_THAT(warnings(command + "all.csv" + model), Not(Contains(HasSubstr("--time"))));
        EXPECT_THAT(warnings(command + "emptied.csv" + model), Not(Contains(HasSubstr("--time"))));
        EXPECT_THAT(warnings(command + "dropped.csv" + model), Contains(Names("t: 10 0.01 --time t")));
        EXPECT_THAT(warnings(command + "doubled.csv" + model), Contains(Names("t: 10 --time t")));
        EXPECT_THAT(warnings(command + "backward.csv" + model), Contains(Names("t: newest --time t")));
        EXPECT_THAT(warnings(command + "shuffled.csv" + model), Contains(Names("t: back --time t")));
    }
    EXPECT_THAT(warnings("compare shuffled.csv --regressors u --output y"), Not(Contains(HasSubstr("--time"))))
        << "no row needs another";
}
TEST_F(CompareTimes, StampsAreReadAsPeopleWriteThem) {
    auto dates = lines;
    for (size_t k = 0; k < dates.size(); ++k) {
        size_t const minute = 20 * 60 + k;  // over midnight
        dates[k] = fmt::format("2024-02-{} {:02}:{:02}:30{}", 28 + minute / 1440, minute % 1440 / 60, minute % 60,
                               lines[k].substr(lines[k].find(',')));
    }
    file("all.csv", dates);
    std::swap(dates[7], dates[300]);
    file("swapped.csv", dates);
    EXPECT_EQ(theta("swapped.csv --time t"), theta("all.csv"));
    EXPECT_THAT(warnings("compare swapped.csv" + std::string(model)), Contains(Names("t: back --time t")));
}

}  // namespace
