// Recursive least squares: ud, 3 parameters, in float. Written by
//
//   rlslab export c --variant ud --size 3 --arithmetic float --name motor
//
// from the variant's page, by running it with a scalar that records its operations. Write it again instead of changing
// it. C99 or C++; no heap, no recursion, no goto, no libm. A filter takes 80 bytes.
//
//   static motor filter;
//   motor_init(&filter, 0.99f, 1000.0f)    begins: lambda, and c^2 of P0 = c^2 I
//   motor_update(&filter, psi, y)    takes a row of 3 numbers and its output, and returns a motor_step
//
// Where a step's health is not MOTOR_SOUND, theta, K and P may not be used.
//
// The bits are those of the C++ filter while each operation is rounded once, to nearest, and subnormal numbers are
// kept. gcc reads no STDC pragma against fusing: -std=c99 does not fuse, with -std=gnu99 and in C++ functions are
// compiled with fp-contract=off and are then not inlined. -std=c99 -ffp-contract=fast leaves other bits.
//
// Rules of MISRA C:2012 that cppcheck's addon finds broken: 10.4 (health by ?:), 21.15 (memcpy).
#ifndef MOTOR_H
#define MOTOR_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math hides infinities and NaN, and changes the order of operations"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "operations are kept longer than their type: other bits (x87: -mfpmath=sse)"
#endif
#if defined(FLT_MANT_DIG) && (FLT_MANT_DIG != 24)
#error "a float is no IEEE float"
#endif
#if defined(__clang__) || !defined(__GNUC__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__cplusplus) || !defined(__STRICT_ANSI__)
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#endif

typedef enum { MOTOR_SOUND, MOTOR_UNDETERMINED, MOTOR_INDEFINITE, MOTOR_NONFINITE } motor_health;

// Squares are stored by columns.
typedef struct {
    float lambda;
    float correction;
    float theta[3];
    float D[3];
    float K[3];
    float U[9];
} motor;

typedef struct {
    float innovation; // y - psi'theta before the row
    float residual;   // and after it
    float gamma;      // lambda / (lambda + psi'P psi)
    motor_health health;
} motor_step;

// False: not 0 < lambda <= 1, or not 0 < variance; f is as it was.
static inline bool motor_init(motor *f, float lambda, float variance) {
    bool valid;
    valid = ((0.0f < lambda) && (lambda <= 1.0f)) && (0.0f < variance);
    if (valid) {
        int i;
        f->lambda = lambda;
        f->correction = (1.0f - f->lambda) / f->lambda;
        for (i = 0; i < 3; ++i) {
            f->theta[i] = 0.0f;
            f->K[i] = 0.0f;
            f->D[i] = 0.0f;
        }
        for (i = 0; i < 9; ++i) {
            f->U[i] = 0.0f;
        }
        for (i = 0; i < 3; ++i) {
            f->U[(4 * i)] = 1.0f;
            f->D[i] = variance;
        }
    }
    return valid;
}

// psi is no part of f.
static inline motor_step motor_update(motor *f, const float psi[3], float y) {
    motor_step step;
    float w0[3];
    float w1[3];
    float w2[3];
    float w3[3];
    float w4[3];
    float x0;
    float x1;
    float x2;
    float x3;
    float x4;
    float x5;
    float x6;
    bool t0;
    int i;
    int j;
    x0 = y - (((psi[0] * f->theta[0]) + (psi[2] * f->theta[2])) + (psi[1] * f->theta[1]));
    step.innovation = x0;
    w0[0] = f->U[0] * psi[0];
    w0[1] = (f->U[3] * psi[0]) + (f->U[4] * psi[1]);
    w0[2] = ((f->U[6] * psi[0]) + (f->U[8] * psi[2])) + (f->U[7] * psi[1]);
    for (i = 0; i < 3; ++i) {
        w1[i] = f->D[i] * w0[i];
        w4[i] = w0[i] * w1[i];
    }
    x1 = w4[0];
    for (i = 0; i < 2; ++i) {
        x2 = f->lambda + x1;
        w4[i] = x2;
        w3[i + 1] = x2;
        x1 = x1 + w4[i + 1];
    }
    x1 = f->lambda + x1;
    w4[2] = x1;
    w3[0] = f->lambda;
    for (i = 0; i < 3; ++i) {
        w2[i] = w0[i] / w3[i];
        x4 = w3[i] / w4[i];
        x5 = f->D[i] * x4;
        f->D[i] = x5 + (x5 * f->correction);
    }
    t0 = true;
    for (i = 0; i < 3; ++i) {
        x2 = 0.0f;
        for (j = 0; j < (3 - i); ++j) {
            x3 = f->U[(4 * i) + (3 * j)];
            f->U[(4 * i) + (3 * j)] = x3 - (x2 * w2[i + j]);
            x2 = x2 + (x3 * w1[i + j]);
        }
        x6 = x2;
        f->K[i] = x6 / x1;
        f->theta[i] = f->theta[i] + (f->K[i] * x0);
        t0 = t0 && ((f->theta[i] - f->theta[i]) == 0.0f);
    }
    x2 = f->lambda / x1;
    step.gamma = x2;
    step.residual = x2 * x0;
    step.health = (t0 ? (((x1 - x1) == 0.0f) ? ((((x0 - x0) == 0.0f) && ((x2 - x2) == 0.0f)) ? (((x2 < 0.0f)
            || (1.0f < x2)) ? MOTOR_INDEFINITE : MOTOR_SOUND) : MOTOR_NONFINITE) : MOTOR_NONFINITE) :
            MOTOR_NONFINITE);
    return step;
}

// The state in the bytes of rlslab's format (docs/state.md): C++ goes on from them, and this from C++'s.
#define MOTOR_STATE_BYTES 216u

static const uint8_t motor_head[132] = {
    0x89u, 0x52u, 0x4cu, 0x53u, 0x0du, 0x0au, 0x1au, 0x0au, 0x02u, 0x00u, 0x01u, 0x00u, 0x18u, 0x00u, 0x00u, 0x00u,
    0x82u, 0xffu, 0xffu, 0xffu, 0x7fu, 0x00u, 0x00u, 0x00u, 0x03u, 0x00u, 0x00u, 0x00u, 0x3du, 0x01u, 0xc2u, 0x8bu,
    0xd8u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x75u, 0x64u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u,
    0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u,
    0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x66u, 0x6cu, 0x6fu, 0x61u, 0x74u, 0x00u, 0x00u, 0x00u,
    0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u,
    0x01u, 0x00u, 0x00u, 0x00u, 0x66u, 0x75u, 0x64u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u,
    0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u, 0x00u,
    0x00u, 0x00u, 0xf0u, 0x3fu
};

static inline uint32_t motor_checksum(const uint8_t *bytes, uint32_t count) {
    uint32_t rest = 0xffffffffu;
    uint32_t i;
    uint32_t bit;
    for (i = 0u; i < count; ++i) {
        rest ^= bytes[i];
        for (bit = 0u; bit < 8u; ++bit) {
            rest = ((rest & 1u) != 0u) ? ((rest >> 1) ^ 0xedb88320u) : (rest >> 1);
        }
    }
    return ~rest;
}
static inline void motor_put_number(uint8_t *to, float x) {
    uint32_t bits;
    uint32_t i;
    (void)memcpy(&bits, &x, sizeof bits);
    for (i = 0u; i < 4u; ++i) {
        to[i] = (uint8_t)((bits >> (8u * i)) & 0xffu);
    }
}
static inline float motor_number_at(const uint8_t *from) {
    uint32_t bits = 0u;
    float x;
    uint32_t i;
    for (i = 0u; i < 4u; ++i) {
        bits |= ((uint32_t)from[i]) << (8u * i);
    }
    (void)memcpy(&x, &bits, sizeof x);
    return x;
}

static inline void motor_save(const motor *f, uint8_t bytes[MOTOR_STATE_BYTES]) {
    uint32_t sum;
    uint32_t at = 132u;
    uint32_t i;
    (void)memcpy(bytes, motor_head, 132u);
    motor_put_number(&bytes[at], f->lambda);
    at += 4u;
    motor_put_number(&bytes[at], f->correction);
    at += 4u;
    for (i = 0u; i < 3u; ++i) {
        motor_put_number(&bytes[at], f->theta[i]);
        at += 4u;
    }
    for (i = 0u; i < 3u; ++i) {
        motor_put_number(&bytes[at], f->D[i]);
        at += 4u;
    }
    for (i = 0u; i < 3u; ++i) {
        motor_put_number(&bytes[at], f->K[i]);
        at += 4u;
    }
    for (i = 0u; i < 9u; ++i) {
        motor_put_number(&bytes[at], f->U[i]);
        at += 4u;
    }
    sum = motor_checksum(bytes, at);
    for (i = 0u; i < 4u; ++i) {
        bytes[at + i] = (uint8_t)((sum >> (8u * i)) & 0xffu);
    }
}
// False: no state of this variant, arithmetic and size, or a damaged one; f is as it was.
static inline bool motor_load(motor *f, const uint8_t bytes[MOTOR_STATE_BYTES]) {
    const uint32_t sum = motor_checksum(bytes, MOTOR_STATE_BYTES - 4u);
    bool valid = memcmp(bytes, motor_head, 132u) == 0;
    uint32_t at = 132u;
    uint32_t i;
    for (i = 0u; i < 4u; ++i) {
        valid = valid && (bytes[(MOTOR_STATE_BYTES - 4u) + i] == (uint8_t)((sum >> (8u * i)) & 0xffu));
    }
    if (valid) {
        f->lambda = motor_number_at(&bytes[at]);
        at += 4u;
        f->correction = motor_number_at(&bytes[at]);
        at += 4u;
        for (i = 0u; i < 3u; ++i) {
            f->theta[i] = motor_number_at(&bytes[at]);
            at += 4u;
        }
        for (i = 0u; i < 3u; ++i) {
            f->D[i] = motor_number_at(&bytes[at]);
            at += 4u;
        }
        for (i = 0u; i < 3u; ++i) {
            f->K[i] = motor_number_at(&bytes[at]);
            at += 4u;
        }
        for (i = 0u; i < 9u; ++i) {
            f->U[i] = motor_number_at(&bytes[at]);
            at += 4u;
        }
    }
    return valid;
}

#if defined(__GNUC__) && !defined(__clang__) && (defined(__cplusplus) || !defined(__STRICT_ANSI__))
#pragma GCC pop_options
#endif
#endif
