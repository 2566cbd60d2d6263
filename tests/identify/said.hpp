// Records, and what `identify` says of them: as a model, as lines, as a command.
#pragma once

#include "src/lab/identify/structure.hpp"
#include "src/lab/identify/text.hpp"
#include "tests/common/program.hpp"

#include <rlslab/model/difference.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <regex>

namespace rlslab::identify {

inline Signal times(Signal x, double by) {
    for (double& v : x) v *= by;
    return x;
}
inline Signal plus(Signal a, Signal const& b, double by = 1) {
    for (size_t k = 0; k < a.size(); ++k) a[k] += by * b[k];
    return a;
}
/// scale (e[k] + c1 e[k-1] + ...).
inline Signal moving_average(Signal const& e, std::vector<double> const& c, double scale) {
    Signal out(e.size());
    for (size_t k = 0; k < e.size(); ++k) {
        out[k] = e[k];
        for (size_t i = 1; i <= c.size() && i <= k; ++i) out[k] += c[i - 1] * e[k - i];
        out[k] *= scale;
    }
    return out;
}
inline Signal sine(Index n, double omega) {
    Signal out(static_cast<size_t>(n));
    for (size_t k = 0; k < out.size(); ++k) out[k] = std::sin(omega * double(k));
    return out;
}

struct Data {
    std::vector<std::string> names;
    std::vector<Signal> columns;  ///< NaN: an empty cell
    std::string format = "{}";    ///< of the numbers

    std::string csv() const {
        std::string out;
        for (size_t j = 0; j < names.size(); ++j) out += (j ? "," : "") + names[j];
        for (size_t k = 0; k < columns[0].size(); ++k)
            for (size_t j = 0; j < names.size(); ++j) {
                double const x = columns[j][k];
                out += (j ? "," : "\n") + (std::isnan(x) ? "" : fmt::format(fmt::runtime(format), x));
            }
        return out + '\n';
    }
};
inline Data uy(Signal u, Signal y) { return {{"u", "y"}, {std::move(u), std::move(y)}}; }
/// y[k] + a1 y[k-1] + ... = b0 u[k-delay] + ... + e[k].
inline Data simulated(std::vector<double> a, std::vector<double> b, Signal const& u, Signal const& e, int delay = 0) {
    return uy(u, simulate({.a = std::move(a), .b = {std::move(b)}, .delay = delay, .c = 0}, {u}, e));
}
/// Two inputs, u at lags 2 and 3, v at lags 0 and 1, and a constant.
inline Data two_inputs() {
    Signal const u = white_noise(300, Seed{1}), v = prbs(7, 300);
    DifferenceEquation const model{.a = {-1.1, 0.5}, .b = {{0, 0, 1, 0.4}, {0.3, -0.6, 0, 0}}, .delay = 0, .c = 0.4};
    return {{"u", "v", "y"}, {u, v, simulate(model, {u, v}, times(white_noise(300, Seed{2}), 0.2))}};
}

/// u, y of a lightly damped system, with so many decimals: a slow input makes neighbouring columns nearly equal.
inline Data damped(Signal const& u, double noise, int decimals) {
    Data out = simulated({-3.7712, 5.3970, -3.4742, 0.8492}, {0.001, 0.002}, u,
                         times(white_noise(Index(u.size()), Seed{7}), noise));
    out.format = fmt::format("{{:.{}f}}", decimals);
    return out;
}
inline Signal slow_input(Index n) { return coloured_noise(n, {-1.98, 0.9801}, Seed{5}); }

/// Where a NaN or an infinity stands as a number.
inline std::vector<std::string> not_numbers(std::string text) {
    static std::regex const code("<(script|style)(?! type=\"application/json\")[^]*?</(script|style)>"),
        word("[^a-z_](nan|inf|infinity)[^a-z_]", std::regex::icase);
    text = std::regex_replace(text, code, " ");
    std::vector<std::string> out;
    for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at)
        out.push_back(text.substr(size_t(std::max<long>(0, at->position() - 60)), 120));
    return out;
}
/// What every answer keeps: words in place of what is no number, JSON that can be read, pages in UTF-8.
inline void expect_numbers(Identified const& m, std::string const& what) {
    std::string const page = as_page(m);
    for (std::string const& text : {as_table(m), as_json(m), page})
        EXPECT_THAT(not_numbers(text), testing::IsEmpty()) << what;
    EXPECT_TRUE(nlohmann::json::accept(as_json(m))) << what;
    EXPECT_NO_THROW(nlohmann::json(page).dump()) << what << ": not UTF-8";
}

/// The text with "{place:format}" replaced by the number at that place of the JSON.
inline std::string filled(std::string text, nlohmann::json const& from) {
    static std::regex const field("\\{(/[^:]*):([^}]*)\\}");
    for (std::smatch at; std::regex_search(text, at, field);)
        text = at.prefix().str() +
               fmt::format(fmt::runtime("{:" + at.str(2) + "}"),
                           from.at(nlohmann::json::json_pointer(at.str(1))).get<double>()) +
               at.suffix().str();
    return text;
}
inline std::vector<double> values(Identified const& m) {
    std::vector<double> out;
    for (Parameter const& p : m.parameters) out.push_back(p.value);
    return out;
}

/// `identify` on a record, by default the one of two inputs, as a function and as a command.
class Options : public Program {
protected:
    std::string const file = temporary.file(two_inputs().csv());

    Identified of(Data const& record, IdentifyOptions options) const {
        options.output = "y";
        return identify::identify(temporary.file(record.csv(), "record.csv"), options);
    }
    /// Of the input u, unless others are named.
    Identified run(IdentifyOptions options, Data const& record = two_inputs()) const {
        if (options.inputs.empty() && options.regressors.empty()) options.inputs = {"u"};
        return of(record, options);
    }
    /// In words that name the things; "": it is not.
    void is_refused(IdentifyOptions const& options, std::string const& things,
                    Data const& record = two_inputs()) const {
        std::string const message = temporary.without(files::message_of([&] { run(options, record); }));
        if (things.empty()) EXPECT_EQ(message, "no error");
        else EXPECT_THAT(message, Names(things));
    }
};

}  // namespace rlslab::identify
