/* y = 0.8 u(k) - 0.3 u(k-1) and a little noise; one row is wrong. A guard finds it, and the filter goes on. */
#include <rlslab.h>

#include <stdint.h>
#include <stdio.h>

static double draw(void) {
    static uint32_t s = 1;
    s = 1664525u * s + 1013904223u;
    return s / 2147483648.0 - 1;
}

int main(void) {
    rlslab_options options;
    rlslab_filter *filter, *other;
    rlslab_step step;
    rlslab_counts counts;
    double theta[2], psi[2] = {0, 0};
    int row;

    rlslab_defaults(&options, sizeof options);
    options.size = 2;
    options.forgetting = 0.99;
    options.guard = "reset";
    if (rlslab_new("ud", "double", &options, &filter) != RLSLAB_OK) {
        fprintf(stderr, "%s\n", rlslab_message());
        return 1;
    }
    for (row = 0; row < 300; ++row) {
        double y;
        psi[1] = psi[0];
        psi[0] = draw();
        y = 0.8 * psi[0] - 0.3 * psi[1] + 0.01 * draw();
        if (row == 200) y += 5;
        if (rlslab_update(filter, psi, y, &step) != RLSLAB_OK) return 1;
        if (step.signal != 0) printf("row %d: %s\n", row, rlslab_name(RLSLAB_SIGNALS, (size_t)step.signal));
    }
    if (rlslab_theta(filter, theta) != RLSLAB_OK || rlslab_count(filter, &counts, sizeof counts) != RLSLAB_OK)
        return 1;
    printf("theta %.2f %.2f\n", theta[0], theta[1]);
    printf("%d outlier, %s\n", (int)counts.outliers, rlslab_name(RLSLAB_HEALTHS, (size_t)step.health));
    rlslab_free(filter);

    if (rlslab_new("udd", "double", &options, &other) != RLSLAB_OK) printf("%.16s\n", rlslab_message());
    return 0;
}
