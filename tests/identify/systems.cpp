// Records of known systems, and the sentence that a user should read of each. RLSLAB_SYSTEMS_SEED moves all seeds.
#include "src/lab/identify/roots.hpp"
#include "tests/common/files.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

using testing::Contains;
using testing::Not;

struct Record {
    std::vector<std::string> names;
    std::vector<Signal> columns;
    std::string format = "{}";  ///< of the numbers
};

Seed seed_of(std::uint64_t n) {
    char const* const by = std::getenv("RLSLAB_SYSTEMS_SEED");
    return Seed{n + 1000 * (by ? std::strtoull(by, nullptr, 10) : 0)};
}
Signal white(Index n, std::uint64_t seed, double sd = 1) {
    Signal out = white_noise(n, seed_of(seed));
    for (double& x : out) x *= sd;
    return out;
}
Signal plus(Signal a, Signal const& b, double times = 1) {
    for (size_t k = 0; k < a.size(); ++k) a[k] += times * b[k];
    return a;
}
Signal times(Signal a, double by) {
    for (double& x : a) x *= by;
    return a;
}
Signal ramp(Index n, double step) {
    Signal out(static_cast<size_t>(n));
    for (size_t k = 0; k < out.size(); ++k) out[k] = step * double(k);
    return out;
}
Signal sine(Index n, double omega) {
    Signal out(static_cast<size_t>(n));
    for (size_t k = 0; k < out.size(); ++k) out[k] = std::sin(omega * double(k));
    return out;
}

constexpr Index N = 600;
/// y[k] = 0.8 y[k-1] + 0.5 u[k-1-delay] + e.
Record first_order(Signal const& u, double noise, int delay = 0, std::uint64_t seed = 1) {
    Signal const e = white(Index(u.size()), seed, noise);
    return {{"u", "y"}, {u, simulate({.a = {-0.8}, .b = {{0, 0.5}}, .delay = delay, .c = 0}, {u}, e)}};
}
Signal random_input(std::uint64_t seed = 2) { return white(N, seed); }

Record with(Record r, size_t column, auto const& change) {
    change(r.columns[column]);
    return r;
}
/// y of a first-order system with u = dither - gain y[k-1].
Record closed_loop(double gain, double dither) {
    Signal const e = white(N, 5, 0.1), w = white(N, 6, dither);
    Signal u(static_cast<size_t>(N), 0.0), y = u;
    for (size_t k = 1; k < y.size(); ++k) {
        y[k] = 0.8 * y[k - 1] + 0.5 * u[k - 1] + e[k];
        u[k] = w[k] - gain * y[k - 1];
    }
    return {{"u", "y"}, {u, y}};
}
/// u[k] = dither - 0.5 y[k]: the controller acts on the output of the same row.
Record direct_feedback() {
    Signal const e = white(N, 5, 0.1), w = white(N, 6, 0.02);
    Signal u(static_cast<size_t>(N), 0.0), y = u;
    for (size_t k = 1; k < y.size(); ++k) {
        y[k] = 0.9 * y[k - 1] + u[k - 1] + e[k];
        u[k] = w[k] - 0.5 * y[k];
    }
    return {{"u", "y"}, {u, y}};
}
/// y = y[k-1] + u[k-1] + e: another spread in each part of the record.
Record integrator() {
    Signal const e = white(N, 3, 0.1);
    return {{"u", "y"},
            {random_input(), simulate({.a = {-1}, .b = {{0, 1}}, .delay = 0, .c = 0}, {random_input()}, e)}};
}
Record regression(Signal const& a, Signal const& b, Signal const& c, std::string format = "{}") {
    return {{"a", "b", "c", "y"}, {a, b, c, plus(plus(a, b, -1), white(N, 9, 0.1))}, std::move(format)};
}

struct System {
    std::string name;
    Record record;
    IdentifyOptions options;
    std::vector<std::string> read, not_read;  ///< things that one line names: of the table, or RANK and a warning
};
void PrintTo(System const& s, std::ostream* out) { *out << s.name; }

std::string const clean = "CLEAN";  ///< a line where there are no warnings
char const* const ranks[] = {"TIME",    "DEPENDENCE", "BREAKDOWN", "OUTLIER",   "EXCITATION", "ARITHMETIC", "DELAY",
                             "NOTHING", "ORDER",      "WHITENESS", "CONSTANCY", "HELD_OUT",   "STRUCTURE"};

/// One input u, one output y.
IdentifyOptions arx(IdentifyOptions o = {}) {
    o.inputs = {"u"}, o.output = "y";
    return o;
}
IdentifyOptions list(std::vector<std::string> regressors, std::string variant = "ud") {
    return {.output = "y", .regressors = std::move(regressors), .variant = std::move(variant)};
}

std::vector<System> systems() {
    std::vector<System> out{
        {"clean", first_order(random_input(), 0.1), arx(), {clean}, {}},
        {"second_order_given",
         {{"u", "y"},
          {random_input(),
           simulate({.a = {-1.5, 0.7}, .b = {{0, 1, 0.5}}, .delay = 0, .c = 0}, {random_input()}, white(N, 3, 0.1))}},
         arx({.order = 2}),
         {clean},
         {}},
        // Delays.
        {"delay_too_long",
         first_order(random_input(), 0.1),
         arx({.na = 2, .nb = {0}, .delay = {5}}),
         {"DELAY u 1", "next --delay 1"},
         {}},
        {"delay_too_long_coloured_input",
         first_order(coloured_noise(N, {-0.9}, seed_of(4)), 0.1),
         arx({.na = 1, .nb = {0}, .delay = {5}}),
         {"DELAY u", "next --delay 1"},
         {}},
        {"delay_15", first_order(random_input(), 0.1, 14), arx(), {"DELAY u 15", "next --delay 15"}, {"NOTHING"}},
        {"delay_15_given", first_order(random_input(), 0.1, 14), arx({.delay = {15}}), {clean}, {}},
        {"delay_of_the_second_input",
         [] {
             Signal const u = random_input(), v = white(N, 7);
             Signal shifted(v.size(), 0.0);
             std::copy(v.begin(), v.end() - 12, shifted.begin() + 12);
             return Record{
                 {"u", "v", "y"},
                 {u, v,
                  simulate({.a = {-0.5}, .b = {{0, 1}, {0, 1}}, .delay = 0, .c = 0}, {u, shifted}, white(N, 1, 0.1))}};
         }(),
         {.inputs = {"u", "v"}, .output = "y", .order = 1},
         {"DELAY v", "next --delay 0,13"},
         {"DELAY u", "ORDER u"}},
        {"order_too_low",
         {{"u", "y"},
          {random_input(), simulate({.a = {-1.2, 0.7, -0.2}, .b = {{0, 1, 0.5, -0.4}}, .delay = 0, .c = 0},
                                    {random_input()}, white(N, 3, 0.02))}},
         arx({.order = 1}),
         {"ORDER u", "WHITENESS"},
         {clean}},
        {"order_at_the_limit",
         {{"u", "y"},
          {random_input(), simulate({.a = {-1.2, 0.7, -0.2}, .b = {{1, 1, 0.5, -0.4}}, .delay = 0, .c = 0},
                                    {random_input()}, white(N, 3, 0.02))}},
         arx({.max_order = 2}),
         {"ORDER 2", "next --max-order 4"},
         {}},
        // Nothing to find.
        {"noise_alone", {{"u", "y"}, {random_input(), white(N, 1)}}, arx(), {"NOTHING BIC 0", "next input output"}, {}},
        {"noise_alone_order_given",
         {{"u", "y"}, {random_input(), white(N, 1)}},
         arx({.order = 2}),
         {"NOTHING BIC 0"},
         {clean}},
        {"a_static_gain",
         {{"u", "y"}, {random_input(), plus(times(random_input(), 3), white(N, 1))}},
         arx(),
         {"NOTHING BIC 0", "next --na 0 --nb 0"},
         {}},
        {"past_outputs_alone",
         {{"u", "y"}, {random_input(), coloured_noise(N, {-0.8}, seed_of(1))}},
         arx(),
         {"order 1 BIC"},
         {"NOTHING", "DELAY u", "ORDER u"}},
        // Outliers.
        {"outlier",
         with(first_order(random_input(), 0.1), 1, [](Signal& y) { y[300] += 100; }),
         arx(),
         {"OUTLIER 301 302 20 estimate", "next 301 302 empty"},
         {}},
        {"outlier_guarded",
         with(first_order(random_input(), 0.1), 1, [](Signal& y) { y[300] += 100; }),
         arx({.composition = {.guard = "reset"}}),
         {"OUTLIER 301 302 20", "% outliers", "next 301 302"},
         {clean, "next --guard"}},
        {"outlier_held_out",
         with(first_order(random_input(), 0.1), 1, [](Signal& y) { y[500] += 100; }),
         arx(),
         {"OUTLIER 501 502 held", "next 501"},
         {"OUTLIER estimate"}},
        {"small_outlier",
         with(first_order(white(2000, 2), 0.1), 1, [](Signal& y) { y[300] += 0.8; }),
         arx(),
         {"STRUCTURE 301 302"},
         {"OUTLIER"}},
        {"outlier_of_the_input",
         with(first_order(random_input(), 0.1), 0, [](Signal& u) { u[200] = 100; }),
         arx({.order = 1}),
         {"OUTLIER u 201", "next 201"},
         {"EXCITATION"}},
        {"integrator", integrator(), arx({.order = 1}), {}, {"HELD_OUT level"}},
        {"a_controller_in_the_same_row",
         direct_feedback(),
         arx({.order = 1, .delay = {1}}),
         {"DELAY u controller"},
         {}},
        {"outlier_emptied",
         with(first_order(random_input(), 0.1), 1, [](Signal& y) { y[300] = NAN; }),
         arx(),
         {clean},
         {}},
        // Regressors that depend on one another.
        {"collinear",
         regression(white(N, 1), white(N, 2), plus(white(N, 1), white(N, 2))),
         list({"a", "b", "c"}),
         {"DEPENDENCE a b c", "next leave out"},
         {"--variant"}},
        {"collinear_as_advised",
         regression(white(N, 1), white(N, 2), plus(white(N, 1), white(N, 2))),
         list({"a", "b", "c"}, "potter"),
         {"DEPENDENCE a b c"},
         {"--variant"}},
        {"collinear_to_three_decimals",
         regression(white(N, 1), white(N, 2), plus(white(N, 1), white(N, 2)), "{:.3f}"),
         list({"a", "b", "c"}),
         {"DEPENDENCE a b c", "next leave out"},
         {}},
        {"collinear_with_one_left_out",
         regression(white(N, 1), white(N, 2), plus(white(N, 1), white(N, 2))),
         list({"a", "b"}),
         {clean},
         {}},
        {"one_sine_order_2", first_order(sine(N, 0.3), 0.1), arx({.order = 2}), {"REFUSED 1"}, {}},
        {"one_sine_order_1", first_order(sine(N, 0.3), 0.1), arx({.order = 1}), {clean}, {}},
        {"one_step",
         [] {
             Signal u(static_cast<size_t>(N), 0.0);
             std::fill(u.begin() + 200, u.end(), 1.0);
             return first_order(u, 0.1);
         }(),
         arx({.order = 2}),
         {"EXCITATION u 1", "next input"},
         {}},
        // Constants and offsets.
        {"offset",
         with(first_order(random_input(), 0.1), 1,
              [](Signal& y) {
                  for (double& x : y) x += 1e6;
              }),
         arx(),
         {clean},
         {}},
        {"level_changes",
         with(first_order(random_input(), 0.1), 1,
              [](Signal& y) {
                  for (size_t k = 400; k < y.size(); ++k) y[k] += 20;
              }),
         arx(),
         {"HELD_OUT"},
         {clean}},
        {"drift",
         {{"u", "y"}, {random_input(), plus(first_order(random_input(), 0.1).columns[1], ramp(N, 0.05))}},
         arx({.order = 1}),
         {},
         {clean}},
        // Unstable, closed loop.
        {"unstable",
         [] {
             Signal const u = white(120, 2);
             return Record{{"u", "y"},
                           {u, simulate({.a = {-1.05}, .b = {{0, 0.5}}, .delay = 0, .c = 0}, {u}, white(120, 1, 0.1))}};
         }(),
         arx({.order = 1}),
         {"STRUCTURE pole", "gain u none"},
         {}},
        {"closed_loop_with_dither", closed_loop(0.7, 1), arx(), {clean}, {"DELAY u", "ORDER u"}},
        {"closed_loop_without_dither", closed_loop(0.7, 0), arx({.order = 1}), {"REFUSED"}, {}},
        // Units.
        {"tiny_units",
         with(with(first_order(random_input(), 0.1), 0, [](Signal& u) { u = times(u, 1e-12); }), 1,
              [](Signal& y) { y = times(y, 1e12); }),
         arx(),
         {clean},
         {}},
        {"huge_units",
         with(with(first_order(random_input(), 0.1), 0, [](Signal& u) { u = times(u, 1e12); }), 1,
              [](Signal& y) { y = times(y, 1e-12); }),
         arx(),
         {clean},
         {}},
        // Noise free, coloured noise, a series alone.
        {"noise_free", first_order(random_input(), 0), arx(), {clean, "rounding"}, {"largest correlation"}},
        {"coloured_noise",
         {{"u", "y"}, {random_input(), plus(random_input(), coloured_noise(N, {-0.9}, seed_of(8)), 0.5)}},
         arx({.na = 0, .nb = {0}}),
         {"WHITENESS --delay --forgetting 0.99"},
         {"DELAY u", "ORDER u"}},
        {"a_series_alone",
         {{"y"}, {coloured_noise(N, {-1.2, 0.5}, seed_of(1))}},
         list({"y[k-1..k-2]"}),
         {clean},
         {"NOTHING"}},
        {"missing_values",
         with(with(first_order(random_input(), 0.1), 0, [](Signal& u) { u[100] = u[450] = NAN; }), 1,
              [](Signal& y) { y[200] = y[201] = NAN; }),
         arx({.order = 1}),
         {clean, "7 skipped"},
         {}},
    };
    return out;
}

class Systems : public testing::TestWithParam<System> {};

TEST_P(Systems, SayWhatAUserShouldRead) {
    System const& s = GetParam();
    files::Folder const folder;
    std::string text;
    for (size_t j = 0; j < s.record.names.size(); ++j) text += (j ? "," : "") + s.record.names[j];
    for (size_t k = 0; k < s.record.columns[0].size(); ++k)
        for (size_t j = 0; j < s.record.names.size(); ++j) {
            double const x = s.record.columns[j][k];
            text += (j ? "," : "\n") + (std::isnan(x) ? "" : fmt::format(fmt::runtime(s.record.format), x));
        }
    std::string said;
    std::string const file = folder.file(text + '\n');
    std::string const refusal = files::message_of([&] {
        Identified const m = identify::identify(file, s.options);
        said = (m.warnings().empty() ? clean + '\n' : "") + as_table(m);
        for (Remark const& r : m.remarks)
            said += fmt::format("\n{} {}", r.hint ? "HINT" : ranks[size_t(r.rank)], r.sentence);
        EXPECT_FALSE(as_page(m).empty() || as_json(m).empty());
    });
    if (said.empty()) said = "REFUSED " + refusal;
    for (size_t at = 0; (at = said.find("\n    ", at)) != said.npos;) said.replace(at, 5, " ");  // lines that go on
    std::vector<std::string> lines;
    std::istringstream in(said);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    for (std::string const& things : s.read) EXPECT_THAT(lines, Contains(Names(things)));
    for (std::string const& things : s.not_read) EXPECT_THAT(lines, Not(Contains(Names(things))));
}
INSTANTIATE_TEST_SUITE_P(Known, Systems, testing::ValuesIn(systems()),
                         [](auto const& system) { return system.param.name; });

}  // namespace
}  // namespace rlslab
