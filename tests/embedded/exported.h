// Filters exported as C, and rows for them in C and in C++: noise, and among it zeros, subnormal and huge numbers,
// infinities and NaN. The same numbers on every machine.
#ifndef EXPORTED_H
#define EXPORTED_H

#include <stdint.h>
#include <string.h>

enum { hostile_most = 16 };

typedef struct {
    uint32_t drawn;
    int wide; // for double: scales beyond those of float
    double psi[hostile_most], y;
    double lambda, variance; // of a filter that begins now
} hostile_rows;

static inline uint32_t hostile_draw(hostile_rows *r) {
    r->drawn ^= r->drawn << 13;
    r->drawn ^= r->drawn >> 17;
    r->drawn ^= r->drawn << 5;
    return r->drawn;
}
static inline double hostile_noise(hostile_rows *r) { return (double)(int32_t)hostile_draw(r) * 0x1p-31; }
static inline void hostile_begin(hostile_rows *r) {
    static const double lambdas[4] = {1, 0.984375, 0.9, 0.125}, variances[4] = {16384, 1, 1e-6, 1e30};
    r->lambda = lambdas[hostile_draw(r) % 4];
    r->variance = variances[hostile_draw(r) % 8 % 5 % 4];
}
static inline hostile_rows hostile_start(int wide) {
    hostile_rows r;
    memset(&r, 0, sizeof r);
    r.drawn = 2463534242u;
    r.wide = wide;
    hostile_begin(&r);
    return r;
}
// Most rows are noise, so that a filter lives; one of eight is not.
static inline void hostile_next(hostile_rows *r, int d) {
    static const double scales[8] = {0x1p-140, 0x1p-75, 0x1p-20, 0x1p20, 0x1p40, 0x1p62, 0x1p100, 0x1p-149};
    static const double wider[8] = {0x1p-1060, 0x1p-600, 0x1p-40, 0x1p100, 0x1p300, 0x1p510, 0x1p900, 0x1p-1074};
    uint32_t const kind = hostile_draw(r) % 64;
    double scale = 1;
    int i;
    if (kind < 5) {
        uint32_t const which = hostile_draw(r) % 8;
        scale = r->wide ? wider[which] : scales[which];
    }
    for (i = 0; i < d; ++i) r->psi[i] = hostile_noise(r) * scale;
    r->y = hostile_noise(r);
    if (kind == 5) r->y *= 0x1p100;
    if (kind == 6)
        for (i = 0; i < d; ++i) r->psi[i] = 0;
    if (kind == 7) {
        double const zero = 0;
        uint32_t const which = hostile_draw(r) % 16;
        double const bad = which % 2 ? zero / zero : which % 4 ? 1 / zero : -1 / zero;
        if (which == 15) r->y = bad;
        else r->psi[hostile_draw(r) % (uint32_t)d] = bad;
    }
    if (kind == 8)
        for (i = 1; i < d; ++i) r->psi[i] = -0.0;
    if (kind == 9)
        for (i = 1; i < d; ++i) r->psi[i] = r->psi[0];
}

// A digest of numbers, one NaN for all.
static inline void hostile_add(uint64_t *digest, double x) {
    uint64_t bits = 0x7ff8000000000000u;
    if (x == x) memcpy(&bits, &x, sizeof bits);
    *digest = (*digest ^ bits) * 0x100000001b3u;
    *digest ^= *digest >> 29;
}

// DEFINE_RUN(name, NAME, number, d): run_name(rows, patient) is a digest of every number of every step and of every
// state. A filter that has broken down begins anew: at once, its state unseen, or where `patient`, after some rows.
#define DEFINE_RUN(name, NAME, number, d)                                                       \
    static uint64_t run_##name(long rows, int patient) {                                        \
        hostile_rows r = hostile_start(sizeof(number) == 8);                                    \
        uint64_t digest = 0;                                                                    \
        name f;                                                                                 \
        long k;                                                                                 \
        int i, n = ((int)NAME##_STATE_BYTES - 136) / (int)sizeof(number);                       \
        memset(&f, 0, sizeof f);                                                                \
        (void)name##_init(&f, (number)r.lambda, (number)r.variance);                            \
        for (k = 0; k < rows; ++k) {                                                            \
            number psi[d];                                                                      \
            name##_step s;                                                                      \
            hostile_next(&r, d);                                                                \
            for (i = 0; i < d; ++i) psi[i] = (number)r.psi[i];                                  \
            s = name##_update(&f, psi, (number)r.y);                                            \
            hostile_add(&digest, s.innovation);                                                 \
            hostile_add(&digest, s.residual);                                                   \
            hostile_add(&digest, s.gamma);                                                      \
            hostile_add(&digest, (double)s.health);                                             \
            if (patient || s.health != NAME##_NONFINITE) {                                      \
                for (i = 0; i < n; ++i) hostile_add(&digest, ((const number *)(const void *)&f)[i]); \
            }                                                                                   \
            if (k % 97 == 96 || (!patient && s.health == NAME##_NONFINITE)) {                   \
                hostile_begin(&r);                                                              \
                (void)name##_init(&f, (number)r.lambda, (number)r.variance);                    \
            }                                                                                   \
        }                                                                                       \
        return digest;                                                                          \
    }

#endif
