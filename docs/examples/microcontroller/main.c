/* A motor's model on a microcontroller, in C: no heap, no libm, no library. The same source runs on the host. */
#include "motor.h"

#include <board.h>

/* The motor: speed_k = a speed_{k-1} + b voltage_{k-1} - c, where c is friction. */
static const float a = 0.95f, b = 0.4f, c = 0.2f;
static motor filter; /* in static memory: nothing else to allocate */

static float noise(void) { /* uniform in [-1, 1) */
    static uint32_t drawn = 1u;
    drawn = (1664525u * drawn) + 1013904223u;
    return (float)(int32_t)drawn * 0x1p-31f;
}

static void print_number(const char *name, float x) { /* three decimals; printf would be larger than the filter */
    char text[16] = {0};
    int at = 15, digits;
    long thousandths = (long)((x < 0.0f ? -x : x) * 1000.0f + 0.5f);
    for (digits = 0; digits < 4 || thousandths > 0; ++digits) {
        if (digits == 3) text[--at] = '.';
        text[--at] = (char)('0' + thousandths % 10);
        thousandths /= 10;
    }
    if (x < 0.0f) text[--at] = '-';
    print(name);
    print(text + at);
    print("\n");
}

int main(void) {
    float speed = 0.0f, voltage = 0.0f;
    const float *theta = filter.theta;
    int k;
    if (!motor_init(&filter, 0.999f, 16384.0f)) return 1;
    for (k = 0; k < 1000; ++k) {
        const float next = a * speed + b * voltage - c + 0.01f * noise();
        const float psi[3] = {speed, voltage, -1.0f};
        if (motor_update(&filter, psi, next).health != MOTOR_SOUND) return 2;
        speed = next;
        if (k % 10 == 0) voltage = 6.0f + 6.0f * noise();
    }
    print_number("a ", theta[0]);
    print_number("b ", theta[1]);
    print_number("c ", theta[2]);
    return 0.94f < theta[0] && theta[0] < 0.96f && 0.39f < theta[1] && theta[1] < 0.41f && 0.15f < theta[2] &&
                   theta[2] < 0.25f
               ? 0
               : 3;
}
