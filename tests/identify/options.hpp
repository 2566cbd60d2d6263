// A record of two inputs and a model, and `identify` on it, as a function and as a command.
#pragma once

#include "src/lab/identify/structure.hpp"
#include "src/lab/identify/text.hpp"
#include "tests/common/files.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>
#include <sys/wait.h>

namespace rlslab::identify {

/// A remark of this rank that names these things.
MATCHER_P2(Says, rank, things, "") {
    return arg.rank == rank && testing::ExplainMatchResult(Names(things), arg.sentence, result_listener);
}

inline std::string csv(std::vector<Signal> const& columns, std::string header) {
    for (size_t k = 0; k < columns[0].size(); ++k) {
        header += '\n';
        for (size_t j = 0; j < columns.size(); ++j) header += fmt::format("{}{}", j ? "," : "", columns[j][k]);
    }
    return header + '\n';
}

class Options : public testing::Test {
protected:
    files::Folder const folder;
    std::string const file = [this] {
        Signal const u = white_noise(300, Seed{1}), v = prbs(7, 300);
        DifferenceEquation const model{
            .a = {-1.1, 0.5}, .b = {{0, 0, 1, 0.4}, {0.3, -0.6, 0, 0}}, .delay = 0, .c = 0.4};
        Signal xi = white_noise(300, Seed{2});
        for (double& x : xi) x *= 0.2;
        return folder.file(csv({u, v, simulate(model, {u, v}, xi)}, "u,v,y"));
    }();
    Identified run(IdentifyOptions options) const {
        if (options.inputs.empty() && options.regressors.empty()) options.inputs = {"u"};
        options.output = "y";
        return identify(file, options);
    }
    std::string refusal(IdentifyOptions const& options) const {
        return folder.without(files::message_of([&] { run(options); }));
    }
    struct Outcome {
        int code;
        std::string out, err;
    };
    Outcome program(std::string const& words) const {
        auto const text = [](std::filesystem::path const& path) {
            std::ifstream in(path);
            return std::string(std::istreambuf_iterator<char>(in), {});
        };
        int const status = std::system(
            ("cd '" + folder.path.string() + "' && '" RLSLAB_PROGRAM "' identify " + words + " > out.txt 2> err.txt")
                .c_str());
        return {WEXITSTATUS(status), text(folder.path / "out.txt"), text(folder.path / "err.txt")};
    }
};
inline std::vector<double> values(Identified const& m) {
    std::vector<double> out;
    for (Parameter const& p : m.parameters) out.push_back(p.value);
    return out;
}

}  // namespace rlslab::identify
