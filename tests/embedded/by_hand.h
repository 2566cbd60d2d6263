// Recursive least squares with forgetting in UD form, written from Bierman's formulas alone.
//
//   f = U'psi, v = D f, alpha_0 = lambda, and for j = 1 ... n:
//   alpha_j = alpha_{j-1} + f_j v_j,  D_j = D_j alpha_{j-1} / (alpha_j lambda),  k_j = v_j,
//   for i < j:  U_ij' = U_ij - k_i f_j / alpha_{j-1},  k_i += U_ij v_j
//   theta += k (y - psi'theta) / alpha_n
#ifndef BY_HAND_H
#define BY_HAND_H

#define BY_HAND_N 4

typedef struct {
    float lambda;
    float theta[BY_HAND_N];
    float U[BY_HAND_N][BY_HAND_N]; // above the diagonal, which is 1
    float D[BY_HAND_N];
} by_hand;

static void by_hand_init(by_hand *r, float lambda, float variance) {
    int i, j;
    r->lambda = lambda;
    for (i = 0; i < BY_HAND_N; i++) {
        r->theta[i] = 0.0f;
        r->D[i] = variance;
        for (j = 0; j < BY_HAND_N; j++) r->U[i][j] = 0.0f;
    }
}

// Takes one row; returns the innovation y - psi'theta.
static float by_hand_update(by_hand *r, const float psi[BY_HAND_N], float y) {
    float f[BY_HAND_N], v[BY_HAND_N], k[BY_HAND_N];
    float e = y, alpha = r->lambda, gain;
    int i, j;
    for (j = 0; j < BY_HAND_N; j++) {
        float sum = psi[j];
        for (i = 0; i < j; i++) sum += r->U[i][j] * psi[i];
        f[j] = sum;
        v[j] = r->D[j] * sum;
        e -= r->theta[j] * psi[j];
    }
    for (j = 0; j < BY_HAND_N; j++) {
        float beta = alpha, mu;
        alpha += f[j] * v[j];
        mu = f[j] / beta;
        r->D[j] *= beta / (alpha * r->lambda);
        k[j] = v[j];
        for (i = 0; i < j; i++) {
            float u = r->U[i][j];
            r->U[i][j] = u - k[i] * mu;
            k[i] += u * v[j];
        }
    }
    gain = e / alpha;
    for (i = 0; i < BY_HAND_N; i++) r->theta[i] += k[i] * gain;
    return e;
}

#endif
