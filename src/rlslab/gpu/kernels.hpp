// The kernels by form and size, as RLSLAB_LANES(form, class, scalar, size) and RLSLAB_TEAM(form, scalar, lanes, size or
// 0 for any): for the device (kernels.cu) and for what stands for it in the tests.
#pragma once

#define RLSLAB_BOTH(NAME, F, D) RLSLAB_LANES(NAME, F, float, D) RLSLAB_LANES(NAME, F, double, D)
#define RLSLAB_WITH_TEAMS(D) \
    RLSLAB_BOTH(ud, Ud, D) RLSLAB_BOTH(ud_delta, UdDelta, D) RLSLAB_BOTH(conventional, Conventional, D)
#define RLSLAB_WITHOUT_TEAMS(D)      \
    RLSLAB_BOTH(carlson, Carlson, D) \
    RLSLAB_BOTH(inverse_qr, InverseQr, D) RLSLAB_BOTH(qr, Qr, D) RLSLAB_BOTH(gentleman, Gentleman, D)
#define RLSLAB_TEAMS_OF(NAME, T, LANES) RLSLAB_TEAM(NAME, T, LANES, 0) RLSLAB_TEAM(NAME, T, LANES, LANES)
#define RLSLAB_TEAMS(NAME)           \
    RLSLAB_TEAMS_OF(NAME, float, 16) \
    RLSLAB_TEAMS_OF(NAME, float, 32) RLSLAB_TEAMS_OF(NAME, double, 16) RLSLAB_TEAMS_OF(NAME, double, 32)
