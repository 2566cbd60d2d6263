// The products of scatter.hpp in balls, repeated with more digits of P until they are sharp.
#include <rlslab/reference/scatter.hpp>

#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <memory>

namespace rlslab {
namespace {

using namespace balls;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr long sharp_bits = 40;

double rounded(arb_srcptr x) { return arf_get_d(arb_midref(x), ARF_RND_NEAR); }
bool sharp(arb_srcptr x) { return arb_is_zero(x) || arb_rel_accuracy_bits(x) >= sharp_bits; }

/// G_k with w_i^power, both triangles, [psi y] as its columns.
class WeightedGram {
    std::unique_ptr<IntegerGram> exact_;
    std::unique_ptr<ForgettingGram> forgetting_;
    long bits_;

public:
    WeightedGram(Records const& data, double lambda, Index last, unsigned power, long bits) : bits_(bits) {
        Index const m = data.size() + 1;
        if (lambda == 1) exact_ = std::make_unique<IntegerGram>(data, last);
        else forgetting_ = std::make_unique<ForgettingGram>(data, lambda, BallMatrix(m, m), bits, power);
    }
    BallMatrix at(Index k, Index m) {
        BallMatrix out(m, m);
        exact_ ? exact_->advance(k) : forgetting_->advance(k);
        for (Index j = 0; j < m; ++j)
            for (Index i = 0; i <= j; ++i) {
                if (exact_) exact_->entry(out(i, j), i, j, bits_);
                else arb_set(out(i, j), forgetting_->matrix()(i, j));
                arb_set(out(j, i), out(i, j));
            }
        return out;
    }
};

BallMatrix leading(BallMatrix const& A, Index d) {
    BallMatrix out(d, d);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) arb_set(out(i, j), A(i, j));
    return out;
}

/// sum_i w_i = (1 - lambda^k) / (1 - lambda).
Ball weight(double lambda, Index k, long bits) {
    if (lambda == 1) return Ball(double(k));
    Ball const one(1.0), l(lambda);
    Ball power, below;
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
    return {nan, nan, Vector<double>::Constant(d, nan), last ? Matrix<double>(Matrix<double>::Constant(d, d, nan)) : Matrix<double>()};
}

/// The numbers of one step; `good` becomes false where one is not sharp.
Scatter scatter(BallMatrix const& theta, BallMatrix const& P, BallMatrix const& gram, BallMatrix const& squared, Ball const& weights, bool last, long bits, bool& good) {
    Index const d = P.rows();
    bool const same = &gram == &squared;
    BallMatrix PM(d, d), other;
    arb_mat_mul(PM, P, leading(squared, d), bits);
    if (!same) {
        other = BallMatrix(d, d);
        arb_mat_mul(other, P, leading(gram, d), bits);
    }
    BallMatrix const& PG = same ? PM : other;
    Scatter out{residual_sum(gram, theta, bits, good), nan, Vector<double>(d), {}};                      // (2)
    Ball freedom(weights), trace;
    arb_mat_trace(trace, PM, bits);
    arb_submul_si(freedom, trace, 2, bits);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) arb_addmul(freedom, PG(i, j), PM(j, i), bits);                     // (3)
    good = good && mag_cmp_2exp_si(arb_radref(static_cast<arb_srcptr>(freedom)), -sharp_bits) <= 0;
    out.freedom = rounded(freedom);
    Ball entry;
    auto const PMP = [&](Index i, Index j) { arb_dot(entry, nullptr, 0, PM(i, 0), 1, P(j, 0), 1, d, bits); };    // (1), P is symmetric
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
        for (Exact& exact : certified(problem, data, steps, digits)) {
            if (exact.enclosure()) bits = std::max(bits, exact.enclosure()->bits);
            out.push_back({std::move(exact), without(d, out.size() + 1 == steps.size())});
        }
        if (bits == 0) return out;
        WeightedGram gram(data, problem.forgetting, steps.back(), 1, bits), squared(data, problem.forgetting, steps.back(), 2, bits);
        bool all = true;
        for (Scattered& s : out) {
            if (!s.exact.enclosure()) continue;
            Index const k = s.exact.step();
            bool good = true;
            BallMatrix const G = gram.at(k, d + 1);
            BallMatrix const M = problem.forgetting == 1 ? BallMatrix() : squared.at(k, d + 1);
            bool const last = &s == &out.back();
            s.scatter = scatter(s.exact.enclosure()->theta, s.exact.enclosure()->covariance, G, problem.forgetting == 1 ? G : M,
                                weight(problem.forgetting, k, bits), last, bits, good);
            if (!good) s.scatter = without(d, last), all = false;
        }
        if (all || digits >= most_digits) return out;
    }
}

}  // namespace rlslab
