// The products of scatter.hpp in balls, repeated with more digits of P until they are sharp.
#include <rlslab/reference/scatter.hpp>

#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <optional>

namespace rlslab {
namespace {

using namespace balls;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr long sharp_bits = 40;

double rounded(arb_srcptr x) { return arf_get_d(arb_midref(x), ARF_RND_NEAR); }
bool sharp(arb_srcptr x) { return arb_is_zero(x) || arb_rel_accuracy_bits(x) >= sharp_bits; }

/// sum_i w_i^p = (1 - lambda^pk) / (1 - lambda^p).
Ball weight(double lambda, ulong p, Index k, long bits) {
    if (lambda == 1) return Ball(double(k));
    Ball const one(1.0);
    Ball l(lambda), power, below;
    arb_pow_ui(l, l, p, bits);
    arb_pow_ui(power, l, ulong(k), bits);
    arb_sub(power, one, power, bits);
    arb_sub(below, one, l, bits);
    arb_div(power, power, below, bits);
    return power;
}

/// y'Wy - 2 theta'b + theta'G theta, [G b; b' y'Wy] the weighted Gram matrix; 0 where nothing is left of y'Wy.
double residual_sum(BallMatrix const& gram, BallMatrix const& theta, long bits, bool& good) {
    Index const d = theta.rows();
    Ball J, inner;
    arb_set(J, gram(d, d));
    for (Index i = 0; i < d; ++i) {
        arb_mul_si(inner, gram(i, d), -2, bits);
        for (Index j = 0; j < d; ++j) arb_addmul(inner, gram(i, j), theta(j, 0), bits);
        arb_addmul(J, theta(i, 0), inner, bits);
    }
    Magnitude most, least;
    arb_get_mag(most, J);
    arb_get_mag_lower(least, gram(d, d));
    mag_mul_2exp_si(least, least, -150);
    if (mag_cmp(most, least) <= 0) return 0;
    good = good && sharp(J);
    return rounded(J);
}

Scatter without(Index d, bool last) {
    return {nan, nan, nan, Vector<double>::Constant(d, nan),
            last ? Matrix<double>(Matrix<double>::Constant(d, d, nan)) : Matrix<double>()};
}

/// tr A B.
Ball trace_of_product(BallMatrix const& A, BallMatrix const& B, long bits) {
    Ball out;
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.rows(); ++j) arb_addmul(out, A(i, j), B(j, i), bits);
    return out;
}

/// Of the weighted Gram matrices with w, w^2, w^3: the last two are the first where lambda = 1.
struct Weighted {
    BallMatrix const &gram, &squared, &cubed;
    Ball sum, sum_of_squares;
};

/// The numbers of one step; `good` becomes false where one is not sharp.
Scatter scatter(BallMatrix const& theta, BallMatrix const& P, Weighted const& w, bool last, long bits, bool& good) {
    Index const d = P.rows();
    BallMatrix PM(d, d), PG(d, d), Q(d, d), QM(d, d);
    arb_mat_mul(PM, P, leading(w.squared, d), bits);
    arb_mat_mul(PG, P, leading(w.gram, d), bits);
    arb_mat_mul(Q, PG, P, bits);
    arb_mat_neg(Q, Q);
    for (int twice = 0; twice < 2; ++twice) arb_mat_add(Q, Q, P, bits);
    arb_mat_mul(QM, Q, leading(w.squared, d), bits);
    Scatter out{residual_sum(w.gram, theta, bits, good), nan, nan, Vector<double>(d), {}};  // (2)
    Ball freedom, trace, variance, student;
    arb_mat_trace(trace, QM, bits);
    arb_sub(freedom, w.sum, trace, bits);  // (3)
    arb_submul_si(variance, trace_of_product(Q, leading(w.cubed, d), bits), 2, bits);
    arb_add(variance, variance, w.sum_of_squares, bits);
    arb_add(variance, variance, trace_of_product(QM, QM, bits), bits);
    arb_mul(student, freedom, freedom, bits);
    arb_div(student, student, variance, bits);  // (4)
    auto const decided = [](Ball const& x) {
        return mag_cmp_2exp_si(arb_radref(static_cast<arb_srcptr>(x)), -sharp_bits) <= 0;
    };
    good = good && decided(freedom);
    out.freedom = rounded(freedom);
    if (out.freedom > 0x1p-30) {  // none are left: neither has a quantile
        good = good && decided(student);
        out.student = rounded(student);
    }
    Ball entry;
    auto const PMP = [&](Index i, Index j) {
        arb_dot(entry, nullptr, 0, PM(i, 0), 1, P(j, 0), 1, d, bits);
    };  // (1), P is symmetric
    std::vector<Ball> sd(static_cast<size_t>(d));
    for (Index i = 0; i < d; ++i) {
        PMP(i, i);
        arb_sqrtpos(sd[size_t(i)], entry, bits);
        good = good && sharp(sd[size_t(i)]);
        out.sd[i] = rounded(sd[size_t(i)]);
    }
    if (!last) return out;
    out.correlation.resize(d, d);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) {
            PMP(i, j);
            arb_div(entry, entry, sd[size_t(i)], bits);
            arb_div(entry, entry, sd[size_t(j)], bits);
            out.correlation(i, j) = arb_is_finite(entry) ? rounded(entry) : nan;
        }
    return out;
}

}  // namespace

std::vector<Scattered> scattered(Problem<double> const& problem, Records const& data, std::vector<Index> const& steps) {
    constexpr int most_digits = 480;
    Index const d = problem.size;
    std::vector<Scattered> out;
    for (int digits = 30;; digits *= 2) {
        out.clear();
        long bits = 0;
        for (CertifiedSolution& exact : certified(problem, data, steps, digits)) {
            if (exact.enclosure()) bits = std::max(bits, exact.enclosure()->bits);
            out.push_back({std::move(exact), without(d, out.size() + 1 == steps.size())});
        }
        if (bits == 0) return out;
        double const lambda = problem.forgetting;
        WeightedGram gram(data, lambda, steps.back(), 1, bits);
        std::optional<WeightedGram> squared, cubed;  // where lambda = 1 they are gram
        if (lambda != 1)
            squared.emplace(data, lambda, steps.back(), 2, bits), cubed.emplace(data, lambda, steps.back(), 3, bits);
        bool all = true;
        for (Scattered& s : out) {
            if (!s.exact.enclosure()) continue;
            Index const k = s.exact.step();
            bool good = true;
            BallMatrix const G = gram.at(k);
            BallMatrix const M = squared ? squared->at(k) : BallMatrix(), C = cubed ? cubed->at(k) : BallMatrix();
            bool const last = &s == &out.back();
            Weighted const weighted{G, squared ? M : G, cubed ? C : G, weight(lambda, 1, k, bits),
                                    weight(lambda, 2, k, bits)};
            s.scatter =
                scatter(s.exact.enclosure()->theta, s.exact.enclosure()->covariance, weighted, last, bits, good);
            if (!good) s.scatter = without(d, last), all = false;
        }
        if (all || digits >= most_digits) return out;
    }
}

}  // namespace rlslab
