/* The loop around an exported filter: DEFINE_RUN(name, NAME, number, d). run_name(rows, patient) is a digest of every
 * number of every step and of every state. A filter that has broken down begins anew: at once, its state unseen, or
 * where `patient`, after some rows. */
#include "hostile.h"

#define DEFINE_RUN(name, NAME, number, d)                                                       \
    static uint64_t run_##name(long rows, int patient) {                                        \
        hostile_rows r = hostile_start(sizeof(number) == 8);                                    \
        uint64_t digest = 0;                                                                    \
        name f;                                                                                 \
        long k;                                                                                 \
        int i, n = (NAME##_STATE_BYTES - 136) / (int)sizeof(number);                            \
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
