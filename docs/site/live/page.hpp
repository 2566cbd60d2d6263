// The narrow interface between the page and the library: C functions over memory that both sides read. The page calls
// them in WebAssembly, the tests natively; the text is one.
#pragma once

#include <cstdint>

#ifdef __EMSCRIPTEN__
#define RLSLAB_LIVE(name) __attribute__((export_name(#name)))
#else
#define RLSLAB_LIVE(name)
#endif

extern "C" {
/// The lists of settings, guards and variants. setting_range: least, most, step, start.
RLSLAB_LIVE(settings) int live_settings();
RLSLAB_LIVE(setting_name) char const* live_setting_name(int i);
RLSLAB_LIVE(setting_range) double const* live_setting_range(int i);
RLSLAB_LIVE(guards) int live_guards();
/// Of a guard its name on the command line, its constant in C++, or what it does, for 0, 1, 2.
RLSLAB_LIVE(guard_text) char const* live_guard_text(int i, int what);
RLSLAB_LIVE(variants) int live_variants();
RLSLAB_LIVE(variant_name) char const* live_variant_name(int v);
RLSLAB_LIVE(gain_error_applies) int live_gain_error_applies(int v);

/// Memory for n bytes of text, which read_table reads.
RLSLAB_LIVE(text) char* live_text(int n);
/// The number of columns; -1: message() says why not. column_missing: rows without a value; -1: no numbers.
RLSLAB_LIVE(read_table) int live_read_table(int n);
RLSLAB_LIVE(table_rows) int live_table_rows();
RLSLAB_LIVE(column_name) char const* live_column_name(int j);
RLSLAB_LIVE(column_missing) int live_column_missing(int j);
/// Rows of the table from the columns that were added since the last call. Returns d; -1: message(). scale(d) is y's.
RLSLAB_LIVE(add_input) void live_add_input(int column);
RLSLAB_LIVE(make_rows) int live_make_rows(int output, int past, int delays, int constant);
RLSLAB_LIVE(rows_made) int live_rows_made();
/// psi, scaled, and y behind it.
RLSLAB_LIVE(made_row) double const* live_made_row(int k);
RLSLAB_LIVE(rows_skipped) int live_rows_skipped();
RLSLAB_LIVE(regressor_name) char const* live_regressor_name(int i);
RLSLAB_LIVE(scale) double live_scale(int i);

/// Starts anew with the numbers in values(), in the order of the settings, for the variants in the set, a bit each.
/// Returns d; -1: message() says what was expected.
RLSLAB_LIVE(values) double* live_values();
RLSLAB_LIVE(start) int live_start(std::uint32_t chosen);
RLSLAB_LIVE(message) char const* live_message();
/// lambda and P0 as the format holds them.
RLSLAB_LIVE(stored_forgetting) double live_stored_forgetting();
RLSLAB_LIVE(stored_prior) double live_stored_prior();

/// Takes up to n <= 128 rows; returns how many, 0 at the end of a table.
RLSLAB_LIVE(advance) int live_advance(int n);
/// Of the last advance. digits(v): of theta, a number a row. measured(): how many of the rows were measured;
/// measures(): for each of them its number, then for each variant and last the reference: digits of P, and
/// parameters_most() eigenvalues, the largest first; NaN where a variant does not run.
RLSLAB_LIVE(digits) double const* live_digits(int v);
RLSLAB_LIVE(measured) int live_measured();
RLSLAB_LIVE(measures) double const* live_measures();
RLSLAB_LIVE(parameters_most) int live_parameters_most();
/// After the last row: 12 numbers: rows, digits of theta, of P when last measured, the first indefinite row, the first
/// row whose health was not sound (0: none), the guard's rows unusable, outliers, changes, windups, breakdowns; hash of
/// theta after every row, low and high 32 bits. v = variants(): the reference, its rows alone.
RLSLAB_LIVE(summary) double const* live_summary(int v);
/// theta of a variant after the last row; of the reference heads, and tails behind them.
RLSLAB_LIVE(theta) double const* live_theta(int v);
}
