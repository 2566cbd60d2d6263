// What `rlslab excitation` prints is what the library computes.
#include "tests/common/files.hpp"

#include <rlslab/model/excitation.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sys/wait.h>

namespace rlslab {
namespace {

using nlohmann::json;

TEST(ExcitationCommand, PrintsWhatWasWorkedOut) {
    files::Folder const folder;
    std::string text = "u\n";
    Signal x = prbs(5, 40);
    for (double const v : x) text += v > 0 ? "1\n" : "-1\n";
    std::string const file = folder.file(text), out = (folder.path / "out").string();
    auto const run = [&](std::string const& words) {
        int const status = std::system(
            ("'" RLSLAB_PROGRAM "' excitation '" + file + "' --input u " + words + " > '" + out + "' 2>&1").c_str());
        std::ifstream in(out);
        EXPECT_EQ(WEXITSTATUS(status), 0);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    Excitation const e = excitation(x, 4);
    json const said = json::parse(run("--max-order 4 --json"));
    EXPECT_EQ(said["samples"], 40);
    EXPECT_EQ(said["exciting_of_order"], 4);
    EXPECT_EQ(said["exact_order"], 4);
    EXPECT_EQ(said["persistent_order"], 4);
    EXPECT_EQ(said["changes"], e.changes);
    EXPECT_EQ(said["resolution"], e.resolution);
    EXPECT_EQ(said["constant_at_start"], e.constant_at_start);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ(said["orders"][i], (json{{"order", i + 1},
                                           {"least_eigenvalue", e.orders[i].least},
                                           {"condition", e.orders[i].condition},
                                           {"definite", true},
                                           {"resolved", true},
                                           {"rows_that_carry", e.orders[i].carried}}));
    std::string const table = run("--max-order 4");
    EXPECT_THAT(table, Names("exciting 4 model 3"));
    EXPECT_THAT(run("--max-order 50"), Names("exciting 20 19")) << "40 samples: 21 windows of 20";
    text = "u\n";
    for (int k = 0; k < 100; ++k) text += k < 60 ? "0.05\n" : "0.06\n";
    folder.file(text);
    EXPECT_THAT(run("--max-order 4"), Names("exciting 4 1 99 2 once"));
}

}  // namespace
}  // namespace rlslab
