// Recursive least squares from C: every dense variant in float and double, alone, guarded, windowed or with a rule of
// forgetting, and fleets. C99; also valid C++. Link with `pkg-config --libs rlslab-c`. docs/c.md has a first program.
//
// A function returns RLSLAB_OK or the error's code. After an error the filter is as it was, and rlslab_message() says
// why in one line. No function throws, exits, aborts or writes to a stream. A null pointer is an error (RLSLAB_NULL)
// except where "or null" stands. One thread at a time may use a filter; several filters need no lock. A breakdown is a
// result, not an error: see rlslab_step.health. d is the number of parameters; matrices are d x d, by columns.
#ifndef RLSLAB_H
#define RLSLAB_H
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

// Of this header; rlslab_abi() is the library's. It grows when something here is removed or changes its meaning.
#define RLSLAB_ABI 1
int rlslab_abi(void);
char const* rlslab_version(void);  // "0.2.0"
char const* rlslab_message(void);  // of the calling thread's last error; "" before; never null

typedef enum rlslab_status {
    RLSLAB_OK = 0,
    RLSLAB_NULL = 1,     // a pointer is null
    RLSLAB_NAME = 2,     // an unknown name; the message has the list
    RLSLAB_INVALID = 3,  // a number that is refused, or a composition that this variant cannot carry
    RLSLAB_STATE = 4,    // the bytes are no state of such a filter
    RLSLAB_ROOM = 5,     // the room for the state is too small
    RLSLAB_ABILITY = 6,  // what this variant, or a filter composed so, does not do or report
    RLSLAB_MEMORY = 7,
    RLSLAB_INTERNAL = 8  // an error of the library's own; please report it
} rlslab_status;

// Lists of names, in the library's order. HEALTHS and SIGNALS: the place of a name is its number in rlslab_step:
// sound, undetermined, indefinite, nonfinite; none, unusable, breakdown, change, outlier, windup.
typedef enum rlslab_list {
    RLSLAB_VARIANTS = 0,
    RLSLAB_ARITHMETICS = 1,
    RLSLAB_GUARDS = 2,
    RLSLAB_CONTROLS = 3,
    RLSLAB_HEALTHS = 4,
    RLSLAB_SIGNALS = 5
} rlslab_list;
char const* rlslab_name(int list, size_t place);  // null where there is no such list, and from its end on

// What a row did. Of a float filter the numbers are widened.
typedef struct rlslab_step {
    double innovation;  // y - psi'theta before the row
    double residual;    // y - psi'theta after it
    double gamma;       // residual / innovation, in (0, 1]; 1: the guard skipped the row; NaN: a number is not finite
    int32_t health;     // 0: sound; a place in RLSLAB_HEALTHS; of the row: a guard that skips it leaves the filter well
    int32_t signal;     // of the guard: 0: none; a place in RLSLAB_SIGNALS
} rlslab_step;

// Later versions append members. rlslab_defaults(&options, sizeof options) sets all; then `size` alone is needed.
typedef struct rlslab_options {
    size_t bytes;                    // sizeof(rlslab_options)
    size_t size;                     // d >= 1
    double forgetting;               // lambda, 0 < lambda <= 1; 1
    double prior_variance;           // c^2 of P0 = c^2 I; 16384; 0: no prior, which the information forms take
    double const* prior_theta;       // d numbers, or null: 0
    double const* prior_covariance;  // P0, d x d, symmetric, or null: c^2 I
    size_t window;                   // rows; 0: none
    char const* guard;               // "reset" skips bad rows and mends P; a name of RLSLAB_GUARDS, or null: none
    char const* control;             // a name of RLSLAB_CONTROLS (a rule of forgetting), or null: constant
    double const* control_numbers;   // the rule's, in the order of docs/c.md; NaN: its default; or null: all of them
    size_t control_count;            // how many are there
    double largest_variance;  // this to rebuild_rows: the guard's; of P_jj, times the noise's; NaN: 16 times P0's
    double innovation;        // test of outliers, in standard deviations; 0: none; NaN: 6
    double least_noise;       // standard deviation that noise is believed to have at least; NaN: 0
    double asymmetry;         // largest |P_ij - P_ji| / sqrt(P_ii P_jj); NaN: 2^-10
    size_t noise_memory;      // rows that the noise is averaged over; 0: 200
    size_t rebuild_rows;      // kept to rebuild from, by the guards that do; 0: 10 d
} rlslab_options;
rlslab_status rlslab_defaults(rlslab_options* options, size_t bytes);  // what the pointers show is copied when used

typedef struct rlslab_filter rlslab_filter;

// rlslab_new("ud", "double", &options, &filter): a new filter, or null after an error (NAME, INVALID, MEMORY).
rlslab_status rlslab_new(char const* variant, char const* arithmetic, rlslab_options const* options,
                         rlslab_filter** out);
// The same bits, and probes that follow every row, in double: 1 to 6 of them, 3 where in doubt; 0: none. Not of kalman,
// extended_qr and qr_block. digits > 0: asked of P by the guard, which takes a bound above 10^-digits at every 100th
// row for a breakdown; not in a state.
rlslab_status rlslab_new_certified(char const* variant, char const* arithmetic, rlslab_options const* options,
                                   size_t probes, size_t digits, rlslab_filter** out);
rlslab_status rlslab_copy(rlslab_filter const* filter, rlslab_filter** out);
void rlslab_free(rlslab_filter* filter);                     // or null
rlslab_status rlslab_reset(rlslab_filter* filter);           // as it was made
size_t rlslab_size(rlslab_filter const* filter);             // d; 0 of null
char const* rlslab_variant(rlslab_filter const* filter);     // null of null
char const* rlslab_arithmetic(rlslab_filter const* filter);  // null of null

// One row: psi has d numbers. step: or null. Numbers of the other arithmetic are rounded once. Allocates nothing.
// Without a guard one number that is not finite spoils the filter for good.
rlslab_status rlslab_update(rlslab_filter* filter, double const* psi, double y, rlslab_step* step);
rlslab_status rlslab_update_f32(rlslab_filter* filter, float const* psi, float y, rlslab_step* step);
// Many rows, the oldest first: row k starts at psi + k * stride, stride >= d (0: d). steps: room for all, or null:
// faster, the same bits (qr_block: blocks of 256 rows, whose last bits are others, with the place where a call begins).
// 0 rows: the pointers may be null. INVALID: a stride below d, or more rows than memory has.
rlslab_status rlslab_update_many(rlslab_filter* filter, double const* psi, size_t rows, size_t stride, double const* y,
                                 rlslab_step* steps);
rlslab_status rlslab_update_many_f32(rlslab_filter* filter, float const* psi, size_t rows, size_t stride,
                                     float const* y, rlslab_step* steps);
// The same, row by row (of qr_block, too), and theta after each row: room for rows x d numbers, by rows.
rlslab_status rlslab_update_many_theta(rlslab_filter* filter, double const* psi, size_t rows, size_t stride,
                                       double const* y, rlslab_step* steps, double* theta);
rlslab_status rlslab_update_many_theta_f32(rlslab_filter* filter, float const* psi, size_t rows, size_t stride,
                                           float const* y, rlslab_step* steps, double* theta);
// Time without a row. step: or null.
rlslab_status rlslab_pass_time(rlslab_filter* filter, rlslab_step* step);
// Rows of weights w, 1/v where the noise has v times the variance of the others: sum_i lambda^(k-i) w_i (y_i -
// psi_i'theta)^2. Any filter takes them; its state has the bytes of one that took sqrt(w) psi and sqrt(w) y. w = 1: the
// bits of rlslab_update. w = 0, a missing output: time passes, whatever psi and y are. w < 0, infinite or NaN: nothing
// changes, health is nonfinite. weights: as many as rows, or null: all 1. w is rounded once.
rlslab_status rlslab_update_weighted(rlslab_filter* filter, double const* psi, double y, double weight,
                                     rlslab_step* step);
rlslab_status rlslab_update_weighted_f32(rlslab_filter* filter, float const* psi, float y, float weight,
                                         rlslab_step* step);
rlslab_status rlslab_update_many_weighted(rlslab_filter* filter, double const* psi, size_t rows, size_t stride,
                                          double const* y, double const* weights, rlslab_step* steps);
rlslab_status rlslab_update_many_weighted_f32(rlslab_filter* filter, float const* psi, size_t rows, size_t stride,
                                              float const* y, float const* weights, rlslab_step* steps);

// Takes back a row that the filter holds: weight lambda^n for a row n steps old, times its own. out: 2 numbers or null.
//   out[0]  alpha^2 = 1 - w psi'P psi, of the P before: what remains along psi. <= 0 or NaN: refused, nothing has
//           changed: nothing would remain, w < 0, or a number is not finite
//   out[1]  the error that the removal made, in units of u / alpha^2
// ABILITY: kalman, extended_qr, qr_block, and what has a guard, a window or a control.
rlslab_status rlslab_remove(rlslab_filter* filter, double const* psi, double y, double weight, double* out);
// Appends the rows of `newer`, made with prior_variance 0. ABILITY but of qr_block; INVALID: another arithmetic, size
// or forgetting.
rlslab_status rlslab_merge(rlslab_filter* filter, rlslab_filter const* newer);

rlslab_status rlslab_theta(rlslab_filter const* filter, double* out);  // d numbers
// d numbers, of the last row; after a load, of the row as it came to the filter: 1/sqrt(w) of it where it had a weight.
rlslab_status rlslab_gain(rlslab_filter const* filter, double* out);
// P, or P^-1: a variant reports one of the two; of the other ABILITY.
rlslab_status rlslab_covariance(rlslab_filter const* filter, double* out);
rlslab_status rlslab_information(rlslab_filter const* filter, double* out);
// psi'P psi of each row, a number a row: the variance of psi'theta in units of the noise's. psi, rows and stride as of
// rlslab_update_many. NaN: the rows so far do not determine theta. ABILITY: kalman, extended_qr, qr_block.
rlslab_status rlslab_variance(rlslab_filter const* filter, double const* psi, size_t rows, size_t stride, double* out);
// F, d x d by columns, F F' = P or P^-1: of the variants that store a root (of qr and qr_block F = R'); else ABILITY.
rlslab_status rlslab_factor(rlslab_filter const* filter, double* out);
// n draws of theta + scale S z, S S' = P: n rows of d numbers. scale: the noise's standard deviation. z is nearly
// normal, at most 6 in size, the same of every language and machine; draw k of a seed does not depend on n. NaN: the
// rows do not determine theta, or P is not definite. ABILITY: P or P^-1 is stored itself, and no root. INVALID: a scale
// < 0, infinite or NaN; more draws than memory has.
rlslab_status rlslab_sample(rlslab_filter const* filter, uint64_t seed, size_t n, double scale, double* out);
// Is it excited now? Where the rows in the filter's memory say least. direction: d numbers of length 1. out: 2 numbers.
//   out[0]  the standard deviation of direction'theta, in units of the noise's
//   out[1]  the variance there over the average of all directions, each parameter in units of its own deviation: from
//           1, uncorrelated, to d, all along one; not above the largest there is, by two power steps
// NaN and ABILITY as of rlslab_sample.
rlslab_status rlslab_least_excited(rlslab_filter const* filter, double* direction, double* out);
int32_t rlslab_health(rlslab_filter const* filter);  // of the last row; after a load 0, or 1 if theta is NaN; -1: null
int32_t rlslab_signal(rlslab_filter const* filter);  // of the last row; -1 of null

// What the probes show now of E = Phat P^-1 - I, Phat the filter's P and P that of exact arithmetic: 3 numbers.
//   out[0]  an estimate of ||E||_F, within a factor of 2 in 85 % where 3 probes meet an E of rank one
//   out[1]  above ||E||_F but with probability 0.08^probes; below 1 it proves that Phat is positive definite
//   out[2]  above |thetahat - theta| / |thetahat| wherever out[1] is above ||E||_F
// Infinite where nothing is known. The filter stays as it is. ABILITY: it has no probes.
rlslab_status rlslab_certificate(rlslab_filter const* filter, double* out);

// So far; counts of what is not part of the filter are 0. Later versions append members: bytes is sizeof(it).
typedef struct rlslab_counts {
    int64_t rows;                                              // since it was made, reset or loaded
    int64_t unusable, outliers, changes, windups, breakdowns;  // of the guard; these survive a load
    int64_t refactored, since;                                 // times that the window was factored; rows since then
    int64_t handed_over;                                       // always 0
} rlslab_counts;
rlslab_status rlslab_count(rlslab_filter const* filter, rlslab_counts* out, size_t bytes);

// The state is of the same bytes from every language. load: into a filter of the same variant, arithmetic, size and
// composition. from_state: a new filter, which goes on from the state; its reset has the default forgetting and prior.
// Errors: ROOM, STATE.
size_t rlslab_state_size(rlslab_filter const* filter);  // bytes, 0 of null
rlslab_status rlslab_save(rlslab_filter const* filter, void* to, size_t room);
rlslab_status rlslab_load(rlslab_filter* filter, void const* from, size_t bytes);
rlslab_status rlslab_from_state(void const* from, size_t bytes, rlslab_filter** out);

// M filters of one variant and one problem, which take a row each: several in lockstep, or, with a guard, a window or a
// control, one after another. Not of qr_block.
typedef struct rlslab_fleet rlslab_fleet;
rlslab_status rlslab_fleet_new(char const* variant, char const* arithmetic, size_t filters,
                               rlslab_options const* options, rlslab_fleet** out);
rlslab_status rlslab_fleet_copy(rlslab_fleet const* fleet, rlslab_fleet** out);
// The same of m outputs each, with one P for all: plain variants that report P. Each has the bits of a filter of its
// own, but those behind the first of extended_qr, whose first turns with P.
rlslab_status rlslab_fleet_new_outputs(char const* variant, char const* arithmetic, size_t filters, size_t outputs,
                                       rlslab_options const* options, rlslab_fleet** out);
void rlslab_fleet_free(rlslab_fleet* fleet);             // or null
size_t rlslab_fleet_size(rlslab_fleet const* fleet);     // d; 0 of null
size_t rlslab_fleet_filters(rlslab_fleet const* fleet);  // M; 0 of null
size_t rlslab_fleet_outputs(rlslab_fleet const* fleet);  // m; 0 of null
// psi: M rows of d numbers; y: M rows of m. A row with a number that is not finite is missing: its filter stays as it
// was. missing: how many were, or null.
rlslab_status rlslab_fleet_update(rlslab_fleet* fleet, double const* psi, double const* y, size_t* missing);
rlslab_status rlslab_fleet_update_f32(rlslab_fleet* fleet, float const* psi, float const* y, size_t* missing);
// Rows for each filter, the oldest first, without gaps: psi is rows x M x d, y and steps are rows x M x m, weights rows
// x M, as of rlslab_update_weighted, or null: all 1. steps, missing: or null. 0 rows: the pointers may be null.
rlslab_status rlslab_fleet_update_many(rlslab_fleet* fleet, double const* psi, double const* y, double const* weights,
                                       size_t rows, rlslab_step* steps, size_t* missing);
rlslab_status rlslab_fleet_update_many_f32(rlslab_fleet* fleet, float const* psi, float const* y, float const* weights,
                                           size_t rows, rlslab_step* steps, size_t* missing);
// Of filter m < M: d x m numbers, by rows; P, or P^-1, of the other ABILITY; the worst health of its rows, of a guarded
// filter that of the last usable row, -1 where there is no such filter; as it was made.
rlslab_status rlslab_fleet_theta(rlslab_fleet const* fleet, size_t m, double* out);
rlslab_status rlslab_fleet_covariance(rlslab_fleet const* fleet, size_t m, double* out);
rlslab_status rlslab_fleet_information(rlslab_fleet const* fleet, size_t m, double* out);
int32_t rlslab_fleet_health(rlslab_fleet const* fleet, size_t m);
rlslab_status rlslab_fleet_reset(rlslab_fleet* fleet, size_t m);
size_t rlslab_fleet_state_size(rlslab_fleet const* fleet);  // bytes, 0 of null
rlslab_status rlslab_fleet_save(rlslab_fleet const* fleet, void* to, size_t room);
rlslab_status rlslab_fleet_load(rlslab_fleet* fleet, void const* from, size_t bytes);

// m outputs of one regressor: one P and one gain for all, whatever the noise of each. Of plain variants, all but kalman
// and extended_qr: no guard, window or control.
typedef struct rlslab_outputs rlslab_outputs;
rlslab_status rlslab_outputs_new(char const* variant, char const* arithmetic, size_t outputs,
                                 rlslab_options const* options, rlslab_outputs** out);
rlslab_status rlslab_outputs_copy(rlslab_outputs const* filter, rlslab_outputs** out);
void rlslab_outputs_free(rlslab_outputs* filter);            // or null
rlslab_status rlslab_outputs_reset(rlslab_outputs* filter);  // as it was made, with as many outputs as now
size_t rlslab_outputs_size(rlslab_outputs const* filter);    // d; 0 of null
size_t rlslab_outputs_count(rlslab_outputs const* filter);   // m; 0 of null
// One row: d and m numbers. steps: room for m, or null. A y that is not finite: the row is lost for all outputs and its
// time passes; a psi that is not spoils all.
rlslab_status rlslab_outputs_update(rlslab_outputs* filter, double const* psi, double const* y, rlslab_step* steps);
rlslab_status rlslab_outputs_update_f32(rlslab_outputs* filter, float const* psi, float const* y, rlslab_step* steps);
// Many rows, the oldest first: row k is d numbers from X + k * X_stride (0: d) and m from Y + k * Y_stride (0: m).
// qr_block takes 256 at a time and joseph_rank_two 64, X where it stands if it is of the filter's arithmetic; the
// others row by row. A number that is not finite: INVALID, the message names the row, and none was taken. leave_out
// other than 0: such rows are left out, as if they had never come, bit for bit. 0 rows: the pointers may be null.
rlslab_status rlslab_outputs_update_many(rlslab_outputs* filter, double const* X, size_t X_stride, double const* Y,
                                         size_t Y_stride, size_t rows, int leave_out);
rlslab_status rlslab_outputs_update_many_f32(rlslab_outputs* filter, float const* X, size_t X_stride, float const* Y,
                                             size_t Y_stride, size_t rows, int leave_out);
// `more` outputs behind the last, as if their y had been 0 in all rows so far. INVALID where theta0 is not 0.
rlslab_status rlslab_outputs_add(rlslab_outputs* filter, size_t more);
// The rows of `newer`, made without a prior (prior_variance 0), behind those taken. ABILITY but of qr_block.
rlslab_status rlslab_outputs_merge(rlslab_outputs* filter, rlslab_outputs const* newer);
rlslab_status rlslab_outputs_theta(rlslab_outputs const* filter, double* out);  // d x m, by rows: out[i * m + j]
// P, or P^-1, and F with F F' equal to it, of the variants that store a root (of qr_block F = R'); else ABILITY.
rlslab_status rlslab_outputs_covariance(rlslab_outputs const* filter, double* out);
rlslab_status rlslab_outputs_information(rlslab_outputs const* filter, double* out);
rlslab_status rlslab_outputs_factor(rlslab_outputs const* filter, double* out);
int32_t rlslab_outputs_health(rlslab_outputs const* filter);     // of the last row, or block of rows; -1 of null
int64_t rlslab_outputs_left_out(rlslab_outputs const* filter);   // rows since it was made, reset or loaded; -1 of null
size_t rlslab_outputs_state_size(rlslab_outputs const* filter);  // bytes, 0 of null
rlslab_status rlslab_outputs_save(rlslab_outputs const* filter, void* to, size_t room);
rlslab_status rlslab_outputs_load(rlslab_outputs* filter, void const* from, size_t bytes);
// So many threads, 1 to 1024, share the work on a block of rows from now on, in all filters; 1 at the start. The bits
// are the same. While no filter is at work.
rlslab_status rlslab_use_threads(size_t threads);

// M filters of complex numbers, of m outputs each: psi' is the conjugate transpose, and y = psi'theta. A complex number
// is two, its real part first, as in double _Complex and std::complex<double>. Of plain variants but qr_block, with
// theta0 = 0 and P0 = c^2 I; several outputs are of the variants that report P.
typedef struct rlslab_complex rlslab_complex;
rlslab_status rlslab_complex_new(char const* variant, char const* arithmetic, size_t filters, size_t outputs,
                                 rlslab_options const* options, rlslab_complex** out);
rlslab_status rlslab_complex_copy(rlslab_complex const* filter, rlslab_complex** out);
void rlslab_complex_free(rlslab_complex* filter);             // or null
rlslab_status rlslab_complex_reset(rlslab_complex* filter);   // as it was made
size_t rlslab_complex_size(rlslab_complex const* filter);     // d; 0 of null
size_t rlslab_complex_filters(rlslab_complex const* filter);  // M; 0 of null
size_t rlslab_complex_outputs(rlslab_complex const* filter);  // m; 0 of null
// What rows did; each array has room, or is null. NaN, and health 3, where a row was missing.
typedef struct rlslab_complex_steps {
    double *innovation, *residual;  // rows x M x m complex numbers
    double* gamma;                  // rows x M
    int32_t* health;                // rows x M: the worst of a filter's outputs
} rlslab_complex_steps;
// Rows for each filter, the oldest first: psi is rows x M x d and y rows x M x m complex numbers, without gaps. A row
// with a number that is not finite is missing: its filter stays as it was. missing: how many were, or null. steps: or
// null. 0 rows: the pointers may be null.
rlslab_status rlslab_complex_update(rlslab_complex* filter, double const* psi, double const* y, size_t rows,
                                    rlslab_complex_steps const* steps, size_t* missing);
rlslab_status rlslab_complex_update_f32(rlslab_complex* filter, float const* psi, float const* y, size_t rows,
                                        rlslab_complex_steps const* steps, size_t* missing);
// The same with rows x M weights, as of rlslab_update_weighted, or null.
rlslab_status rlslab_complex_update_weighted(rlslab_complex* filter, double const* psi, double const* y,
                                             double const* weights, size_t rows, rlslab_complex_steps const* steps,
                                             size_t* missing);
rlslab_status rlslab_complex_update_weighted_f32(rlslab_complex* filter, float const* psi, float const* y,
                                                 float const* weights, size_t rows, rlslab_complex_steps const* steps,
                                                 size_t* missing);
rlslab_status rlslab_complex_theta(rlslab_complex const* filter, double* out);  // M x d x m complex numbers
// P, or P^-1, of filter i, d x d complex numbers by columns; of the other ABILITY.
rlslab_status rlslab_complex_covariance(rlslab_complex const* filter, size_t i, double* out);
rlslab_status rlslab_complex_information(rlslab_complex const* filter, size_t i, double* out);
// Of filter i: 1 until its rows determine theta, then the worst of its rows; -1 where there is none.
int32_t rlslab_complex_health(rlslab_complex const* filter, size_t i);
size_t rlslab_complex_state_size(rlslab_complex const* filter);  // bytes, 0 of null
rlslab_status rlslab_complex_save(rlslab_complex const* filter, void* to, size_t room);
rlslab_status rlslab_complex_load(rlslab_complex* filter, void const* from, size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
