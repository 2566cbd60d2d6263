// Records, options, and the sentences that a user should read of them. RLSLAB_SYSTEMS_SEED moves the seeds of white().
#include "tests/identify/said.hpp"

#include <cstdlib>

namespace rlslab {
using namespace identify;
using namespace report;
namespace {

Seed seed_of(std::uint64_t n) {
    char const* const by = std::getenv("RLSLAB_SYSTEMS_SEED");
    return Seed{n + 1000 * (by ? std::strtoull(by, nullptr, 10) : 0)};
}
Signal white(Index n, std::uint64_t seed, double sd = 1) { return times(white_noise(n, seed_of(seed)), sd); }
Signal noise(Index n, std::uint64_t seed, double sd = 1) { return times(white_noise(n, Seed{seed}), sd); }
template <class X>
X changed(X x, auto const& change) {
    change(x);
    return x;
}
Data with(Data r, size_t column, auto const& change) {
    change(r.columns[column]);
    return r;
}

constexpr Index N = 600;
Signal random_input(std::uint64_t seed = 2) { return white(N, seed); }
/// y[k] = 0.8 y[k-1] + 0.5 u[k-1-delay] + e.
Data first_order(Signal const& u, double sd, int delay = 0, std::uint64_t seed = 1) {
    return simulated({-0.8}, {0, 0.5}, u, white(Index(u.size()), seed, sd), delay);
}
/// b begins at lag 0 or 1.
Data third_order(Signal const& u, Signal const& e, double b0 = 0) {
    return simulated({-1.2, 0.7, -0.2}, {b0, 1, 0.5, -0.4}, u, e);
}
/// y[k] = a y[k-1] + b u[k-1] + e with u[k] = dither - gain y[k-lag]; lag 0: of the same row.
Data closed_loop(double a, double b, double gain, size_t lag, double dither) {
    Signal const e = white(N, 5, 0.1), w = white(N, 6, dither);
    Signal u(static_cast<size_t>(N), 0.0), y = u;
    for (size_t k = 1; k < y.size(); ++k) {
        y[k] = a * y[k - 1] + b * u[k - 1] + e[k];
        u[k] = w[k] - gain * y[k - lag];
    }
    return uy(u, y);
}
/// y[k] = a y[k-1] + b u[k-1] + e, where a and b may depend on k.
Data varying(Signal const& u, auto const& a, auto const& b, auto const& e) {
    Signal y(u.size(), 0.0);
    for (size_t k = 1; k < y.size(); ++k) y[k] = a(k) * y[k - 1] + b(k) * u[k - 1] + e(k);
    return uy(u, y);
}
/// A gain of 0.5, from sample `change` on 0.9.
Data changing(size_t change) {
    Signal const e = noise(N, 2, 0.1);
    return varying(
        noise(N, 1), [&](size_t k) { return k < change ? 0.5 : 0.9; }, [](size_t) { return 1; },
        [&](size_t k) { return e[k]; });
}
Data regression(Signal const& c, std::string format = "{}") {
    Signal const a = white(N, 1), b = white(N, 2);
    return {{"a", "b", "c", "y"}, {a, b, c, plus(plus(a, b, -1), white(N, 9, 0.1))}, std::move(format)};
}
/// One input u, one output y.
IdentifyOptions arx(IdentifyOptions o = {}) {
    o.inputs = {"u"}, o.output = "y";
    return o;
}
IdentifyOptions series(IdentifyOptions o = {}) {
    o.output = "y";
    return o;
}
IdentifyOptions list(std::vector<std::string> regressors, std::string variant = "ud") {
    return {.output = "y", .regressors = std::move(regressors), .variant = std::move(variant)};
}

/// What is said, separated by |: things that a line names. Lines are those of the table and of JSON; a RANK and its
/// warning, HINT_RANK and its hint; CLEAN, if there are no warnings; REFUSED and why. Behind ! no line names them,
/// behind "once" one does, behind = one has this text. PAGE: a text of the page; FIGURE: one of its figures.
/// {place:format} is a number of JSON.
struct System {
    std::string name;
    Data record;
    IdentifyOptions options;
    std::string says;
    std::vector<double> theta = {};  ///< the true parameters, as far as they are known
};
void PrintTo(System const& s, std::ostream* out) { *out << s.name; }

void delays_and_orders(auto const& row) {
    Signal const u = random_input();
    row("clean", first_order(u, 0.1), arx(), "CLEAN");
    row("second_order_given", simulated({-1.5, 0.7}, {0, 1, 0.5}, u, white(N, 3, 0.1)), arx({.order = 2}), "CLEAN");
    row("second_order_found", simulated({-1.5, 0.7}, {1, 0.5, 0}, prbs(9, 3000), noise(3000, 3, 0.1)), arx(),
        "CLEAN | structure order 2 | FIGURE poles", {-1.5, 0.7, 1, 0.5});
    for (bool const detrend : {true, false})
        row(detrend ? "second_order_without_noise" : "second_order_without_noise_with_its_means",
            simulated({-1.5, 0.7}, {1, 0.5, 0}, prbs(10, 1000), Signal(1000, 0.0)), arx({.detrend = detrend}),
            "CLEAN | structure order 2", {-1.5, 0.7, 1, 0.5});
    row("delay_too_long", first_order(u, 0.1), arx({.na = 2, .nb = {0}, .delay = {5}}), "DELAY u 1 | next --delay 1");
    row("delay_too_long_coloured_input", first_order(coloured_noise(N, {-0.9}, seed_of(4)), 0.1),
        arx({.na = 1, .nb = {0}, .delay = {5}}), "DELAY u | next --delay 1");
    row("delay_15", first_order(u, 0.1, 14), arx(), "DELAY u 15 | next --delay 15 | !NOTHING");
    row("delay_15_given", first_order(u, 0.1, 14), arx({.delay = {15}}), "CLEAN");
    Signal const v = white(N, 7);
    Signal shifted(v.size(), 0.0);
    std::copy(v.begin(), v.end() - 12, shifted.begin() + 12);
    row("delay_of_the_second_input",
        {{"u", "v", "y"},
         {u, v, simulate({.a = {-0.5}, .b = {{0, 1}, {0, 1}}, .delay = 0, .c = 0}, {u, shifted}, white(N, 1, 0.1))}},
        {.inputs = {"u", "v"}, .output = "y", .order = 1}, "DELAY v | next --delay 0,13 | !DELAY u | !ORDER u");
    Signal const late_u = prbs(9, 900);
    Data const late = simulated({-0.8}, {1, 0.5}, late_u, noise(900, 4, 0.05), 3);
    row("a_delay_that_leading_zeros_show", late, arx({.order = 4}),
        "HINT_DELAY 3 u 0 --delay | hint: 0 is possible for the first 3 coefficients | next: --delay 3");
    row("that_delay_given", late, arx({.order = 1, .delay = {3}}), "CLEAN | !HINT_DELAY | b0 u[k-3]", {-0.8, 1});
    row("that_delay_given_in_part", late, arx({.order = 2, .delay = {2}}), "HINT_DELAY u 0 --delay 3");
    row("order_too_low", third_order(u, white(N, 3, 0.02)), arx({.order = 1}), "ORDER u | WHITENESS | !CLEAN");
    row("order_at_the_limit", third_order(u, white(N, 3, 0.02), 1), arx({.max_order = 2}),
        "ORDER 2 | structure order 2 | next --max-order 4");
    Data const third = third_order(late_u, noise(900, 1, 0.05));
    row("order_below_the_limit", third, arx({.max_order = 6}), "CLEAN | structure order 3");
    row("order_given_is_no_limit", third, arx({.order = 2}), "!ORDER 2");
    row("order_that_the_input_limits",
        third_order(plus(sine(900, 0.3), sine(900, 0.9)), times(coloured_noise(900, {-0.5}, Seed{1}), 0.05)),
        arx({.detrend = false}), "ORDER 3 input | EXCITATION u 4 3 | exciting_of_order 4 | structure order 3");
    Data const quiet = third_order(late_u, noise(900, 3, 0.02));
    row("residuals_that_follow_the_input", quiet, arx({.order = 1}),
        "ORDER past u --order 2 | white false | !WHITENESS 25 --delay --forgetting 0.99");
    row("residuals_of_the_order", quiet, arx({.order = 3}), "CLEAN | white true");
    Data const one = simulated({-0.8}, {1, 0.5}, late_u, noise(900, 4, 0.3));
    row("poles_and_zeros_that_cancel", one, arx({.order = 2}), "STRUCTURE pole zero --order 1");
    row("none_that_cancel", one, arx({.order = 1}), "CLEAN");
    row("poles_and_zeros_that_cancel_in_na_and_nb", one, arx({.na = 2, .nb = {2}}), "STRUCTURE pole zero --na --nb");
    // (1 - 0.8/z)(1 + 1/z + 0.8/z^2): noise of order 2 beside a path of order 1, which alone is not white.
    row("poles_and_zeros_that_model_the_noise",
        simulated({-0.8 + 1.0, 0.8 - 0.8, -0.64}, {1, 1.0, 0.8}, late_u, noise(900, 6, 0.3)), arx({.order = 3}),
        "HINT_STRUCTURE 3 pole zero 1 | !STRUCTURE pole zero");
}

void noise_and_nothing(auto const& row) {
    Signal const u = random_input();
    row("noise_alone", uy(u, white(N, 1)), arx(), "NOTHING BIC 0 | next input output");
    row("noise_alone_order_given", uy(u, white(N, 1)), arx({.order = 2}), "NOTHING BIC 0 | !CLEAN");
    row("noise_of_a_series", {{"y"}, {noise(300, 1)}}, series(), "NOTHING past of y predicts nothing");
    row("a_static_gain", uy(u, plus(times(u, 3), white(N, 1))), arx(), "NOTHING BIC 0 | next --na 0 --nb 0");
    row("past_outputs_alone", uy(u, coloured_noise(N, {-0.8}, seed_of(1))), arx(),
        "order 1 BIC | !NOTHING | !DELAY u | !ORDER u");
    row("noise_free", first_order(u, 0), arx(), "CLEAN | rounding | !largest correlation");
    Data const exact = simulated({-0.5}, {0, 2}, prbs(6, 100), Signal(100, 0.0));
    row("noise_free_has_no_verdict_of_constancy", exact, arx({.order = 1, .sample_time = 0.5}),
        "constancy null | !constancy: | !FIGURE constancy", {-0.5, 0, 2});
    row("coloured_noise", uy(u, plus(u, coloured_noise(N, {-0.9}, seed_of(8)), 0.5)), arx({.na = 0, .nb = {0}}),
        "WHITENESS --delay --forgetting 0.99 | !DELAY u | !ORDER u");
    row("coloured_noise_of_an_impulse_response",
        simulated({}, {1, 0.5}, prbs(9, 900), times(coloured_noise(900, {-0.9}, Seed{3}), 0.3)),
        arx({.na = 0, .nb = {1}}), "WHITENESS 25 --delay --forgetting 0.99 | white false");
    row("coloured_noise_beyond_the_region_of_convergence",
        simulated({-1.5, 0.7}, {0, 1, 0.5}, noise(3000, 4), moving_average(noise(3000, 1004), {1.6, 0.8}, 0.5)),
        arx({.na = 2, .nb = {1}, .delay = {1}, .noise_model = 2}),
        "the recursion may converge slowly or not at all | converges false");
    Data const past{{"y"}, {coloured_noise(N, {-1.2, 0.5}, seed_of(1))}};
    row("a_series_alone", past, list({"y[k-1..k-2]"}), "CLEAN | !NOTHING | = y[k] + a1 y[k-1] + a2 y[k-2] = c + e[k]");
    row("a_series_by_its_order", past, series({.order = 2}),
        "no input: y is predicted from its own past alone | structure order 2 | inputs [] | simulated null | "
        "!FIGURE step | FIGURE poles",
        {-1.2, 0.5});
    row("a_series_by_its_na", past, series({.na = 2}), "structure na = 2", {-1.2, 0.5});
    Signal e = noise(900, 5);
    for (size_t k = 2; k < e.size(); ++k) e[k] += 1.2 * e[k - 1] - 0.6 * e[k - 2];
    for (bool const detrend : {true, false})
        row(detrend ? "a_series_of_order_2" : "a_series_of_order_2_with_its_mean", {{"y"}, {e}},
            series({.max_order = 6, .detrend = detrend}),
            fmt::format("structure order 2 | = 0 {} {{/orders/0/aic:.5g}} | = 6 {} {{/orders/6/aic:.5g}}", int(detrend),
                        6 + detrend),
            {-1.2, 0.6});
    row("an_impulse", {{"y"}, {changed(Signal(140, 0.0), [](Signal& y) { y[4] = 19.68; })}}, series({.order = 1}),
        "held out: - one step");
    row("an_impulse_without_a_part_held_out", {{"y"}, {changed(Signal(140, 0.0), [](Signal& y) { y[4] = 19.68; })}},
        series({.order = 1, .detrend = false, .validate = 0}), "OUTLIER row 5 100 | !beyond rounding");
}

void outliers_and_gaps(auto const& row) {
    Data const good = first_order(random_input(), 0.1);
    Data const spike = with(good, 1, [](Signal& y) { y[300] += 100; });
    row("outlier", spike, arx(), "OUTLIER 301 302 20 estimate | next 301 302 empty");
    row("outlier_guarded", spike, arx({.composition = {.guard = "reset"}}),
        "OUTLIER 301 302 20 | % outliers | next 301 302 | !CLEAN | !next --guard");
    row("outlier_held_out", with(good, 1, [](Signal& y) { y[500] += 100; }), arx(),
        "OUTLIER 501 502 held | next 501 | !OUTLIER estimate");
    row("small_outlier", with(first_order(white(2000, 2), 0.1), 1, [](Signal& y) { y[300] += 0.8; }), arx(),
        "STRUCTURE 301 302 | !OUTLIER");
    row("a_wrong_cell_held_out", with(good, 0, [](Signal& u) { u[500] = 1e16; }), arx({.order = 1}),
        "OUTLIER 502 held | !DEPENDENCE");
    row("outlier_of_the_input", with(good, 0, [](Signal& u) { u[200] = 100; }), arx({.order = 1}),
        "OUTLIER u 201 | next 201 | !EXCITATION");
    row("outlier_emptied", with(good, 1, [](Signal& y) { y[300] = NAN; }), arx(), "CLEAN");
    row("missing_values",
        with(with(good, 0, [](Signal& u) { u[100] = u[450] = NAN; }), 1, [](Signal& y) { y[200] = y[201] = NAN; }),
        arx({.order = 1}), "CLEAN | 7 skipped");
    row("offset", with(good, 1, [](Signal& y) { y = plus(y, Signal(y.size(), 1e6)); }), arx(), "CLEAN");
    row("level_changes",
        with(good, 1,
             [](Signal& y) {
                 for (size_t k = 400; k < y.size(); ++k) y[k] += 20;
             }),
        arx(), "HELD_OUT | !CLEAN");
    row("drift",
        with(good, 1,
             [](Signal& y) {
                 for (size_t k = 0; k < y.size(); ++k) y[k] += 0.05 * double(k);
             }),
        arx({.order = 1}), "!CLEAN");
    Data dropped{{"time [s]", "u", "y"}, {{}, {}, {}}, "{}"};
    for (size_t k = 0; k < 300; ++k)
        if (k < 4 || k % 29 > 1) {
            dropped.columns[0].push_back(0.1 * double(k));
            for (size_t j : {0u, 1u}) dropped.columns[j + 1].push_back(good.columns[j][k]);
        }
    row("rows_that_a_logger_dropped", dropped, arx({.order = 1}), "TIME time 10 0.1 --time | next: --time 'time [s]'");
    for (double const by : {1e-12, 1e12})
        row(by < 1 ? "tiny_units" : "huge_units",
            with(with(good, 0, [&](Signal& u) { u = times(u, by); }), 1, [&](Signal& y) { y = times(y, 1 / by); }),
            arx(), "CLEAN");
    for (size_t const constant : {20u, 21u})
        row(fmt::format("a_standstill_of_{}_samples", constant),
            third_order(changed(noise(N, 5), [&](Signal& u) { std::fill_n(u.begin(), constant, 0.5); }),
                        noise(N, 1, 0.05)),
            arx({.order = 3}),
            fmt::format("constant_at_start {} | {}WHITENESS u 21 400", constant, constant == 21 ? "" : "!"));
}

void regressors_that_depend(auto const& row) {
    Signal const sum = plus(white(N, 1), white(N, 2));
    row("collinear", regression(sum), list({"a", "b", "c"}), "DEPENDENCE a b c | next leave out | !--variant");
    row("collinear_as_advised", regression(sum), list({"a", "b", "c"}, "potter"), "DEPENDENCE a b c | !--variant");
    row("collinear_to_three_decimals", regression(sum, "{:.3f}"), list({"a", "b", "c"}),
        "DEPENDENCE a b c | next leave out");
    row("collinear_with_one_left_out", regression(sum), list({"a", "b"}), "CLEAN");
    auto const poor = [](Signal const& u) { return simulated({-0.8}, {1, 0.5}, u, noise(N, 4)); };
    row("one_sine_order_3", poor(sine(N, 0.3)), arx({.order = 3, .detrend = false}), "REFUSED order 3 1");
    row("a_constant", poor(Signal(N, 1.0)), arx({.order = 2, .detrend = false}), "REFUSED order 1");
    row("one_sine_order_chosen", poor(sine(N, 0.3)), arx({.detrend = false}), "EXCITATION u 2 1 | !structure order 2");
    row("one_sine_order_2", first_order(sine(N, 0.3), 0.1), arx({.order = 2}), "REFUSED 1");
    row("one_sine_order_1", first_order(sine(N, 0.3), 0.1), arx({.order = 1}), "CLEAN");
    Signal step(static_cast<size_t>(N), 0.0);
    std::fill(step.begin() + 200, step.end(), 1.0);
    row("one_step", first_order(step, 0.1), arx({.order = 2}), "EXCITATION u 1 | next input");
    row("columns_nearly_equal", damped(slow_input(1024), 0, 6), arx({.order = 10}), "of 22 parameters | !--variant ud");
}

void other_systems(auto const& row) {
    auto const always = [](double x) { return [x](size_t) { return x; }; };
    row("integrator", simulated({-1}, {0, 1}, random_input(), white(N, 3, 0.1)), arx({.order = 1}), "!HELD_OUT level");
    row("unstable", simulated({-1.05}, {0, 0.5}, white(120, 2), white(120, 1, 0.1)), arx({.order = 1}),
        "STRUCTURE pole | gain u none | !time constant");
    row("closed_loop_with_dither", closed_loop(0.8, 0.5, 0.7, 1, 1), arx(), "CLEAN | !DELAY u | !ORDER u");
    row("closed_loop_without_dither", closed_loop(0.8, 0.5, 0.7, 1, 0), arx({.order = 1}), "REFUSED");
    row("a_controller_in_the_same_row", closed_loop(0.9, 1, 0.5, 0, 0.02), arx({.order = 1, .delay = {1}}),
        "DELAY u controller");
    row("a_gain_that_changes_its_sign",
        varying(
            noise(N, 2), always(0), [](size_t k) { return k < 400 ? 1 : -1; },
            [](size_t k) { return 0.01 * Seed{k}.bell(); }),
        arx({.order = 1}),
        "HELD_OUT {/fit/held_out_one_step:.3g} --order --validate --forgetting 0.99 | once HELD_OUT | warning: held "
        "out");
    row("predicted_but_not_simulated",
        varying(noise(N, 2, 0.01), always(1), always(1), [](size_t k) { return 0.3 * Seed{k}.bell(); }),
        arx({.order = 1}), "HELD_OUT simulates {/fit/held_out_simulated:.3g} | !HELD_OUT --validate");
    // A mean that is summed up leaves rounding of a level, and a spread of rounding is none.
    for (double const level : {20.0, 20.3, 20.25, 0.1, 1e6 + 0.1}) {
        Signal u(900, 0.0);
        std::ranges::copy(prbs(7, 500), u.begin());
        Signal y = simulated({-0.8}, {0, 0.5}, u, Signal(900, 0.0)).columns[1];
        for (size_t k = 0; k < y.size(); ++k) y[k] = k < 600 ? y[k] + level + 1e-4 * Seed{k}.bell() : level;
        row(fmt::format("held_out_at_rest_at_{}", int(100 * level)), uy(u, y), arx({.order = 1}),
            "HELD_OUT y does not change there | held out: - one step | !do not use it there", {-0.8, 0, 0.5});
    }
    IdentifyOptions const timed = arx({.order = 1, .sample_time = 0.5});
    row("parameters_that_change", changing(200), timed,
        "CONSTANCY parameters row {/constancy/cusum_of_squares/farthest_at_row:.0f} 99.5 --window --forgetting | = "
        "squares crosses its 5 % line, and the one at 1 %, at row {/constancy/cusum_of_squares/crosses_at_row:.0f} "
        "(22.5 s) | PAGE crosses at row {/constancy/cusum_of_squares/crosses_at_row:.0f} (");
    row("parameters_that_do_not_change", changing(600), timed, "!CONSTANCY");
    row("parameters_that_are_followed", changing(200), arx({.order = 1, .forgetting = 0.98, .sample_time = 0.5}),
        "!CONSTANCY");
    row("a_name_in_latin_1", {{"T\xb0", "y"}, {noise(200, 3), noise(200, 4)}},
        {.inputs = {"T\xb0"}, .output = "y", .order = 1}, "!REFUSED");
    auto const equation = [&](std::string const& name, IdentifyOptions o, std::string const& says) {
        if (o.regressors.empty()) o.inputs = {"u"};
        o.output = "y";
        row("equation_" + name, two_inputs(), o, "y[k] + a1 y[k-1] " + says);
    };
    equation("of_order_1", {.order = 1}, "= b0 u[k] + b1 u[k-1] + c + e[k]");
    equation("without_a_constant", {.order = 2, .detrend = false},
             "+ a2 y[k-2] = b0 u[k] + b1 u[k-1] + b2 u[k-2] + e[k]");
    equation("of_order_4", {.order = 4, .delay = {3}, .detrend = false},
             "+ ... + a4 y[k-4] = b0 u[k-3] + ... + b4 u[k-7] + e[k]");
    equation("of_two_past_outputs_and_a_delay", {.order = 3, .delay = {2}}, "| b0 u[k-2]");
    equation("of_an_order_that_is_chosen", {.max_order = 3, .delay = {2}}, "| c 1");
    row("an_impulse_response", two_inputs(), arx({.na = 0, .nb = {12}, .detrend = false}),
        "of 13 parameters | poles []", {NAN, NAN, 1, 1.5});
    Signal const u = prbs(9, 1500), v = white_noise(1500, Seed{5});
    DifferenceEquation const of_two{.a = {-0.8}, .b = {{1, 0.5}, {-2, 0.25}}, .delay = 0, .c = 0};
    row("two_inputs_without_noise", {{"u", "v", "y"}, {u, v, simulate(of_two, {u, v}, Signal(1500, 0.0))}},
        {.inputs = {"u", "v"}, .output = "y", .order = 1}, "b0[v] v[k] | of 6 parameters", {-0.8, 1, 0.5, -2, 0.25});
    row("two_inputs", two_inputs(), {.inputs = {"u", "v"}, .output = "y", .na = 2, .nb = {1, 1}, .delay = {2, 0}},
        "structure na = 2, nb = 1, delay 2,0 | = y[k] + a1 y[k-1] + a2 y[k-2] = b0[u] u[k-2] + b1[u] u[k-3] + b0[v] "
        "v[k] + b1[v] v[k-1] + c + e[k]",
        {-1.1, 0.5, 1, 0.4, 0.3, -0.6});
    equation("of_a_list", {.regressors = {"v[k-2]", "y[k-1]", "y[k-3]", "u"}, .intercept = true},
             "+ a3 y[k-3] = b2[v] v[k-2] + b0[u] u[k] + c + e[k]");
}

/// The numbers of the table beside those of JSON.
void printed(auto const& row) {
    IdentifyOptions const uv{.inputs = {"u", "v"}, .output = "y"};
    auto const with = [&](auto const& set) { return changed(uv, set); };
    row("every_line_of_two_inputs", two_inputs(), with([](auto& o) { o.order = 3, o.confidence = 0.99; }),
        "= 300 samples: {/fitted:.0f} rows fitted, the last 100 samples held out; means taken off: u "
        "{/inputs/0/mean:.5g}, v {/inputs/1/mean:.5g}, y {/output_mean:.5g} | = ud in double, lambda = 1, prior "
        "P0_ii = (c / s_i)^2, c = 2^ | = input v: excites enough for every order tried (exciting of order "
        "{/inputs/1/exciting_of_order:.0f} at least) | = order 3 (given) | = parameter of estimate sd 99 % interval | "
        "= a2 y[k-2] {/parameters/1/value:.6g} {/parameters/1/sd:.2g} {/parameters/1/low:.5g} ... "
        "{/parameters/1/high:.5g} | = b3[v] v[k-3] {/parameters/10/value:.6g} {/parameters/10/sd:.2g} "
        "{/parameters/10/low:.5g} ... {/parameters/10/high:.5g} | = poles: {/poles/0/0:.4f} +- {/poles/0/1:.4f}i | = "
        "), {/poles/2/0:.4f}; slowest: time constant | = steady-state gain of u: {/inputs/0/gain:.5g} (sd "
        "{/inputs/0/gain_sd:.2g}) | = steady-state gain of v: {/inputs/1/gain:.5g} (sd {/inputs/1/gain_sd:.2g}) | = "
        "fit: {/fit/one_step:.2f} % one step ahead; held out: {/fit/held_out_one_step:.2f} % one step ahead, "
        "{/fit/held_out_simulated:.2f} % simulated (0 %: no better than the mean) | = residuals: sigma^2 = "
        "{/sigma2:.4g}; they pass for white: p = {/whiteness/p:.3g} >= {/whiteness/level:g} (Ljung-Box: Q = "
        "{/whiteness/Q:.4g}, {/whiteness/lags:.0f} lags, {/whiteness/degrees_of_freedom:.0f} degrees of freedom) | = "
        "criteria: AIC {/criteria/aic:.6g}, BIC {/criteria/bic:.6g}, FPE {/criteria/fpe:.4g}, of 12 parameters over "
        "{/fitted:.0f} rows | = arithmetic: ud agrees with the certified minimiser in {/digits/theta:.3g} of 15.9 "
        "digits ({/digits/worst:.3g} in its worst component); kappa = {/condition:.3g} | = (99 % bound {/bound:.2g}) | "
        "breakdown null");
    row("orders_of_two_inputs", two_inputs(), with([](auto& o) { o.max_order = 4; }),
        "= 1 6 {/orders/1/aic:.5g} {/orders/1/bic:.5g} {/orders/1/fpe:.3g} {/orders/1/whiteness:.2g} "
        "{/orders/1/held_out:.2f} % | = * {/order:.0f} {/orders/3/parameters:.0f} {/orders/3/aic:.5g} | = 4 15 "
        "{/orders/4/aic:.5g} {/orders/4/bic:.5g} | = ; AIC says {/suggested/aic:.0f}, BIC {/suggested/bic:.0f}, FPE "
        "{/suggested/fpe:.0f}, F-test {/suggested/f_test:.0f}");
    row("orders_with_forgetting", two_inputs(), with([](auto& o) { o.max_order = 4, o.forgetting = 0.98; }),
        "criteria: none | residuals: no verdict | !residuals: p | = , all orders fitted without forgetting); AIC says");
    row("seconds_and_hertz", two_inputs(), with([](auto& o) {
            o.order = 2, o.delay = {2, 0}, o.sample_time = 0.25;
        }),
        "= 300 samples, one each 0.25 s: | = delay of u: 0.5 s (2 samples) | Hz sd | !cycles | PAGE frequency in hertz "
        "| PAGE time in seconds | !PAGE cycles per sample | FIGURE step | FIGURE frequency | FIGURE frequency-2 | "
        "FIGURE poles | FIGURE constancy | FIGURE output | !noise_model | !instruments");
    Signal const e = noise(900, 1002);
    row("a_noise_model_and_instruments",
        simulated({-1.5, 0.7}, {0, 1, 0.5}, noise(900, 2), moving_average(e, {0.7}, 0.5)),
        arx({.na = 2, .nb = {1}, .delay = {1}, .noise_model = 1, .instruments = 2}),
        "= noise model: C e with C of order {/noise_model/order:.0f}, by extended least squares over "
        "{/noise_model/rows:.0f} rows | = a1 y[k-1] {/noise_model/parameters/0/value:.6g} "
        "{/noise_model/parameters/0/sd:.2g} {/noise_model/parameters/0/least_squares:.6g} "
        "{/noise_model/parameters/0/shift:.2g} | = c1 e[k-1] {/noise_model/parameters/5/value:.6g} "
        "{/noise_model/parameters/5/sd:.2g} - - | = their residuals: sigma^2 = {/noise_model/sigma2:.4g}; they pass "
        "for white: p = {/noise_model/whiteness/p:.3g} | = at every w (at most {/noise_model/farthest_from_1:.3g}): "
        "the recursion converges there | converges true | = instruments: the equation's inputs and constant, and "
        "further past of each input ({/instruments/further_lags:.0f} lags), over {/instruments/rows:.0f} rows | = b1 "
        "u[k-2] {/instruments/parameters/3/value:.6g} {/instruments/parameters/3/sd:.2g} | = their residuals: sigma^2 "
        "= {/instruments/sigma2:.4g}; not white | PAGE {/noise_model/parameters/1/value:.6g} | PAGE "
        "{/instruments/parameters/1/value:.6g}");
}

std::vector<System> systems() {
    std::vector<System> out;
    auto const row = [&](std::string name, Data record, IdentifyOptions options, std::string says,
                         std::vector<double> theta = {}) {
        out.push_back({std::move(name), std::move(record), std::move(options), std::move(says), std::move(theta)});
    };
    delays_and_orders(row), noise_and_nothing(row), outliers_and_gaps(row), regressors_that_depend(row);
    other_systems(row), printed(row);
    return out;
}

char const* const ranks[] = {"TIME",    "DEPENDENCE", "BREAKDOWN", "OUTLIER",   "EXCITATION", "ARITHMETIC", "DELAY",
                             "NOTHING", "ORDER",      "WHITENESS", "CONSTANCY", "HELD_OUT",   "STRUCTURE"};
class Systems : public testing::TestWithParam<System> {};

TEST_P(Systems, SayWhatAUserShouldRead) {
    System const& s = GetParam();
    files::Folder const folder;
    std::string const file = folder.file(s.record.csv());
    std::string said, json, page;
    std::string const refusal = files::message_of([&] {
        Identified const m = identify::identify(file, s.options);
        said = (m.warnings().empty() ? "CLEAN\n" : "") + as_table(m);
        for (Remark const& r : m.remarks)
            said += fmt::format("\n{}{} {}", r.hint ? "HINT_" : "", ranks[size_t(r.rank)], r.sentence);
        json = as_json(m), page = as_page(m);
        EXPECT_TRUE(!m.options.inputs.empty() || page.find("simulated") == page.npos);
        expect_numbers(m, s.name);
        for (Parameter const& p : m.parameters) EXPECT_TRUE(p.sd > 0 && p.lower < p.upper) << p.name;
        for (size_t i = 0; i < s.theta.size(); ++i)
            if (!std::isnan(s.theta[i])) {
                EXPECT_NEAR(m.parameters[i].value, s.theta[i], 5 * m.parameters[i].sd + 1e-12) << m.parameters[i].name;
            }
    });
    if (said.empty()) said = "REFUSED " + refusal;
    said = std::regex_replace(said, std::regex("\n    (?! )| +"), " ");  // lines that go on, and columns
    std::vector<std::string> const lines = lines_of(said + '\n' + json);
    std::istringstream all(filled(s.says, nlohmann::json::parse(json.empty() ? "{}" : json)));
    for (std::string things; std::getline(all, things, '|');) {
        things = things.substr(things.find_first_not_of(' '));
        things.erase(things.find_last_not_of(' ') + 1);
        bool const is_not = things.starts_with('!');
        std::string const first = things.substr(is_not, things.find(' ') - is_not),
                          rest = things.substr(std::min(things.size(), is_not + first.size() + 1));
        auto const named = [](std::string const& by) { return testing::Matches(Names(by)); };
        bool const is = first == "PAGE"     ? page.find(rest) != page.npos
                        : first == "FIGURE" ? page.find("<figure id=\"" + rest + '"') != page.npos
                        : first == "once"   ? std::ranges::count_if(lines, named(rest)) == 1
                        : first == "="      ? said.find(rest) != said.npos
                                            : std::ranges::any_of(lines, named(things.substr(is_not)));
        EXPECT_NE(is, is_not) << things << "\nin\n" << said;
    }
}
INSTANTIATE_TEST_SUITE_P(Known, Systems, testing::ValuesIn(systems()),
                         [](auto const& system) { return system.param.name; });

}  // namespace
}  // namespace rlslab
