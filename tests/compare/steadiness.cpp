// The recommendation on real records hardly depends on the last row: when lambda or the length of the record changes a
// little, the variant that was recommended before stays within a digit of the one that is now, or the spread printed
// shows why.
#include "tests/common/program.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <sstream>

namespace {

using nlohmann::json;

struct Source {
    char const *file, *input, *output;
    int order;
};

class Steadiness : public Program, public testing::WithParamInterface<Source> {
protected:
    std::vector<std::string> lines;  // the header first
    void SetUp() override {
        fs::path const file = fs::path(root) / GetParam().file;
        if (!fs::exists(file)) GTEST_SKIP() << "left out: " << GetParam().file << " is not here";
        std::istringstream text(read(file));
        for (std::string line; std::getline(text, line);) lines.push_back(line);
    }
    json compared(size_t rows, double lambda) const {
        std::string text;
        for (size_t k = 0; k <= rows; ++k) text += lines[k] + '\n';
        write("record.csv", text);
        std::ostringstream command;
        command << "rlslab compare record.csv --input " << GetParam().input << " --output " << GetParam().output
                << " --order " << GetParam().order << " --forgetting " << lambda
                << " --arithmetic float,double --no-timings --json";
        Outcome const run = shell(command.str());
        EXPECT_EQ(run.code, 0) << run.err;
        return json::parse(run.out);
    }
    static std::map<std::string, std::string> recommended(json const& comparison) {
        std::map<std::string, std::string> out;
        for (json const& r : comparison["recommendation"])
            out[r["arithmetic"]] = r["variant"].is_null() ? "" : r["variant"].get<std::string>();
        return out;
    }
    /// Digits that the variant loses in one of the three measures to the best that broke down nowhere, by the medians
    /// printed.
    static double loss(json const& comparison, std::string const& arithmetic, std::string const& variant) {
        double most = 0;
        for (char const* of : {"theta", "worst", "covariance"}) {
            double best = -INFINITY, own = -INFINITY;
            for (json const& r : comparison["results"]) {
                bool const takes_rows = !r["operations"].is_null() && r["variant"] != "qr_block";
                if (r["arithmetic"] != arithmetic || r["broken"] > 0 || !takes_rows ||
                    r["spread"][of]["median"].is_null())
                    continue;
                best = std::max(best, r["spread"][of]["median"].get<double>());
                if (r["variant"] == variant) own = r["spread"][of]["median"];
            }
            most = std::max(most, best - own);
        }
        return most;
    }
    /// Whether the printed spreads of the two variants lie apart in one of the three measures, or one of them broke
    /// down.
    static bool told_apart(json const& comparison, std::string const& arithmetic, std::string const& a,
                           std::string const& b) {
        std::map<std::string, json> found;
        for (json const& r : comparison["results"])
            if (r["arithmetic"] == arithmetic) found[r["variant"]] = r;
        if (found.at(a).value("broken", 0) > 0 || found.at(b).value("broken", 0) > 0) return true;
        for (char const* of : {"theta", "worst", "covariance"}) {
            json const none, x = found.at(a).value("spread", none), y = found.at(b).value("spread", none);
            if (!x.is_null() && !y.is_null() && (x[of]["high"] < y[of]["low"] || y[of]["high"] < x[of]["low"]))
                return true;
        }
        return false;
    }
    static void expect_steady(json const& one, json const& other, std::string const& what) {
        auto const a = recommended(one), b = recommended(other);
        EXPECT_NE(a.at("double"), "") << what;
        for (auto const& [arithmetic, variant] : a) {
            std::string const& now = b.at(arithmetic);
            if (variant == now || variant.empty() || now.empty()) continue;
            if (told_apart(one, arithmetic, variant, now) || told_apart(other, arithmetic, variant, now)) continue;
            // A digit: from low to high the spreads are about as wide, and such a part of it their medians move.
            EXPECT_LT(loss(other, arithmetic, variant) - loss(other, arithmetic, now), 0.95)
                << what << ": in " << arithmetic << " " << variant << ", then " << now
                << ", and the spread does not show why";
        }
    }
};

TEST_P(Steadiness, InStepsOfFiveThousandthsInLambda) {
    size_t const rows = lines.size() - 1;
    json before;
    for (double const lambda : {0.97, 0.975, 0.98, 0.985, 0.99, 0.995, 1.0}) {
        json now = compared(rows, lambda);
        if (!before.is_null()) expect_steady(before, now, "lambda = " + std::to_string(lambda));
        before = std::move(now);
    }
}
TEST_P(Steadiness, OverOnePercentOfTheRecord) {
    size_t const rows = lines.size() - 1;
    for (double const lambda : {1.0, 0.98}) {
        json const whole = compared(rows, lambda);
        for (double const part : {0.99, 0.998}) {
            size_t const some = size_t(part * double(rows));
            expect_steady(whole, compared(some, lambda),
                          "lambda = " + std::to_string(lambda) + ", " + std::to_string(some) + " rows of " +
                              std::to_string(rows));
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Records, Steadiness,
                         testing::Values(Source{"studies/data/sales.csv", "lead", "sales", 2},
                                         Source{"../shared/data/gas_furnace.csv", "u", "y", 4},
                                         Source{"../shared/data/hair_dryer.csv", "u", "y", 4},
                                         Source{"../shared/data/heat_exchanger.csv", "u", "y", 2}),
                         [](auto const& source) { return fs::path(source.param.file).stem().string(); });

}  // namespace
