/* The lines of tests/portability/digest.cpp, which has what is computed, from C. */
#include <rlslab.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { d = 5, rows = 1000, half = 500 };

static double records[rows][d + 1]; /* psi, then y */

static void make_records(void) {
    uint32_t s = 1;
    int k, i;
    for (k = 0; k < rows; ++k)
        for (i = 0; i <= d; ++i) {
            s = 1664525u * s + 1013904223u;
            records[k][i] = (double)(s >> 8) / 8388608.0 - 1;
        }
}

static uint64_t hashes[2];
static void add(double const* x, int count) {
    uint64_t const multipliers[] = {257, 65599};
    uint64_t bits;
    int n, i, h;
    for (n = 0; n < count; ++n) {
        memcpy(&bits, x + n, sizeof bits);
        for (i = 0; i < 8; ++i, bits >>= 8)
            for (h = 0; h < 2; ++h) hashes[h] = (multipliers[h] * hashes[h] + (bits & 255)) % 4294967291u;
    }
}

static void require(rlslab_status status) {
    if (status == RLSLAB_OK) return;
    fprintf(stderr, "%s\n", rlslab_message());
    exit(1);
}

static void transfer(rlslab_filter* filter, char const* folder, int save) {
    static char bytes[4096];
    char path[4096];
    size_t const size = rlslab_state_size(filter);
    FILE* file;
    sprintf(path, "%.4000s/%s.%s", folder, rlslab_variant(filter), rlslab_arithmetic(filter));
    file = fopen(path, save ? "wb" : "rb");
    if (!file || size > sizeof bytes) exit(1);
    if (save) {
        require(rlslab_save(filter, bytes, sizeof bytes));
        if (fwrite(bytes, 1, size, file) != size) exit(1);
    } else {
        require(rlslab_load(filter, bytes, fread(bytes, 1, sizeof bytes, file)));
    }
    fclose(file);
}

static void process(char const* variant, char const* arithmetic, char const* verb, char const* folder) {
    rlslab_options options;
    rlslab_filter* filter;
    double theta[d], gain[d], matrix[d * d];
    int k, from = 0;
    require(rlslab_defaults(&options, sizeof options));
    options.size = d;
    options.forgetting = 0.9921875;
    require(rlslab_new(variant, arithmetic, &options, &filter));
    if (strcmp(verb, "load") == 0) transfer(filter, folder, 0), from = half;
    for (k = from; k < rows; ++k) {
        if (k == half && strcmp(verb, "save") == 0) transfer(filter, folder, 1);
        require(rlslab_update(filter, records[k], records[k][d], NULL));
    }
    require(rlslab_theta(filter, theta));
    require(rlslab_gain(filter, gain));
    if (rlslab_covariance(filter, matrix) == RLSLAB_ABILITY) require(rlslab_information(filter, matrix));
    hashes[0] = hashes[1] = 1;
    add(theta, d);
    add(gain, d);
    add(matrix, d * d);
    printf("%s %s %08lx%08lx\n", variant, arithmetic, (unsigned long)hashes[0], (unsigned long)hashes[1]);
    rlslab_free(filter);
}

int main(int count, char** arguments) {
    char const *variant, *arithmetic;
    size_t v, a;
    make_records();
    for (a = 0; (arithmetic = rlslab_name(RLSLAB_ARITHMETICS, a)); ++a)
        for (v = 0; (variant = rlslab_name(RLSLAB_VARIANTS, v)); ++v)
            process(variant, arithmetic, count > 1 ? arguments[1] : "", count > 2 ? arguments[2] : "");
    return 0;
}
