// The exact solution in balls at rising precision; see certified.hpp for what is proven.
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rlslab {

using namespace balls;

namespace {

/// The prior's part of M and b, at row 0: the upper triangle of [M b], (d+1) x (d+1).
BallMatrix prior_part(Problem<double> const& problem, long bits) {
    Index const d = problem.size;
    BallMatrix part(d + 1, d + 1);
    if (!problem.prior) return part;
    auto const& prior = *problem.prior;
    BallMatrix inverse(d, d), theta(d, 1), rhs(d, 1);
    if (prior.covariance) {
        // If the precision is not sufficient, the balls are the whole real line, which certifies nothing.
        if (!arb_mat_spd_inv(inverse, exact(*prior.covariance), bits)) arb_mat_indeterminate(inverse);
    } else {
        for (Index i = 0; i < d; ++i) {
            arb_set_d(inverse(i, i), prior.variance);
            arb_inv(inverse(i, i), inverse(i, i), bits);
        }
    }
    if (prior.theta) theta = exact(*prior.theta);
    arb_mat_mul(rhs, inverse, theta, bits);
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i <= j; ++i) arb_set(part(i, j), inverse(i, j));
        arb_set(part(j, d), rhs(j, 0));
    }
    return part;
}

/// (1), (2) from the upper triangle of [M b]. False: M was not shown to be positive definite at this precision.
bool solve(CertifiedSolution::Enclosure& to, BallMatrix const& normal) {
    Index const d = normal.rows() - 1;
    BallMatrix M(d, d), L(d, d), b(d, 1);
    for (Index j = 0; j < d; ++j) {
        for (Index i = 0; i <= j; ++i) {
            arb_set(M(i, j), normal(i, j));
            arb_set(M(j, i), normal(i, j));
        }
        arb_set(b(j, 0), normal(j, d));
    }
    if (!arb_mat_ldl(L, M, to.bits)) return false;
    to.theta = BallMatrix(d, 1);
    to.covariance = BallMatrix(d, d);
    arb_mat_solve_ldl_precomp(to.theta, L, b, to.bits);
    arb_mat_inv_ldl_precomp(to.covariance, L, to.bits);
    return true;
}

/// More precision cannot make the relative radius of zero small: whether theta is zero is decided exactly.
bool theta_is_zero(CertifiedSolution::Enclosure const& x, Problem<double> const& problem, Records const& data,
                   Index k) {
    for (Index i = 0; i < x.theta.rows(); ++i)
        if (!arb_contains_zero(x.theta(i, 0))) return false;
    return surely_vanishes(problem, data, k);
}

bool defined(Problem<double> const& problem) {
    if (!problem.prior) return true;
    auto const& prior = *problem.prior;
    if (prior.theta && !prior.theta->allFinite()) return false;
    if (!prior.covariance) return std::isfinite(prior.variance);
    Stored<double> const P0{Stored<double>::Quantity::covariance, Stored<double>::Form::plain, *prior.covariance};
    return definiteness(P0.mapped<Reference>([](double x) { return widen(x); })) == Health::sound;
}

/// The number of leading rows without an infinity or a NaN.
Index finite_rows(Records const& data) {
    Index k = 0;
    while (k < data.rows() && std::isfinite(data.y(k)) && data.psi.col(k).allFinite()) ++k;
    return k;
}

void check(Problem<double> const& problem, Records const& data, std::vector<Index> const& steps, int digits) {
    checked(problem);
    expects(!problem.prior || !problem.prior->stored, "a prior given as P0, not as a filter stores it");
    expects(data.parameters() == problem.size && data.y.size() == data.rows(), "data of the problem's size");
    expects(digits >= 1, "digits >= 1");
    expects(std::is_sorted(steps.begin(), steps.end()) &&
                (steps.empty() || (steps.front() >= 1 && steps.back() <= data.rows())),
            "ascending steps between 1 and the number of rows");
    expects(!problem.prior || !problem.prior->covariance || !problem.prior->covariance->allFinite() ||
                *problem.prior->covariance == problem.prior->covariance->transpose(),
            "a symmetric prior covariance, as (P + P')/2 is");
}

/// The upper triangle of [M b], prior included, at any working precision; the prior's part is computed once for each
/// precision.
class Normal {
    Problem<double> const& problem_;
    Records const& data_;
    std::map<long, BallMatrix> prior_;

    BallMatrix const& prior(long bits) {
        auto const [at, fresh] = prior_.try_emplace(bits);
        if (fresh) at->second = prior_part(problem_, bits);
        return at->second;
    }

public:
    Normal(Problem<double> const& problem, Records const& data) : problem_(problem), data_(data) {}

    BallMatrix sum(IntegerGram const& gram, long bits) {
        BallMatrix normal(problem_.size + 1, problem_.size + 1);
        for (Index j = 0; j <= problem_.size; ++j)
            for (Index i = 0; i <= j; ++i) gram.entry(normal(i, j), i, j, bits);
        arb_mat_add(normal, normal, prior(bits), bits);
        return normal;
    }
    ForgettingGram recursion(long bits) { return {data_, problem_.forgetting, prior(bits), bits}; }
};

}  // namespace

// 2^-t <= 10^-digits and 2^-133 <= 10^-40; every step rounds in the direction that makes the test stricter.
bool theta_is_accurate(CertifiedSolution::Enclosure const& x) {
    long const t = bits_for(x.digits);
    Magnitude const largest = size_and_radius(x.theta).first;
    for (Index i = 0; i < x.theta.rows(); ++i) {
        Magnitude floor, allowed;
        arb_get_mag_lower(allowed, x.theta(i, 0));
        mag_mul_2exp_si(floor, largest, -133);
        mag_max(allowed, allowed, floor);
        mag_mul_2exp_si(allowed, allowed, -t);
        if (mag_cmp(arb_radref(x.theta(i, 0)), allowed) > 0) return false;
    }
    return true;
}

bool covariance_is_accurate(CertifiedSolution::Enclosure const& x) {
    auto const [size, radius] = size_and_radius(x.covariance);
    Magnitude allowed;
    mag_mul_2exp_si(allowed, size, -bits_for(x.digits));
    return mag_cmp(radius, allowed) <= 0;
}

std::vector<CertifiedSolution> certified(Problem<double> const& problem, Records const& data,
                                         std::vector<Index> const& steps, int digits) {
    return certified(problem, data, steps, digits, {});
}

std::vector<CertifiedSolution> certified(Problem<double> const& problem, Records const& data,
                                         std::vector<Index> const& steps, int digits,
                                         std::function<void()> const& pause) {
    check(problem, data, steps, digits);
    Index const d = problem.size;
    Index const known = defined(problem) ? finite_rows(data) : 0;
    std::vector<Index> defined_steps;
    for (Index const k : steps)
        if (k <= known) defined_steps.push_back(k);
    std::vector<Index> const ranks =
        problem.prior ? std::vector<Index>(defined_steps.size(), d) : proven_ranks(data, defined_steps, pause);

    std::vector<CertifiedSolution> answers;
    std::vector<size_t> pending;
    for (size_t s = 0; s < steps.size(); ++s) {
        bool const regular = s < ranks.size() && ranks[s] == d;
        if (regular) pending.push_back(s);
        answers.emplace_back(steps[s], d, s < ranks.size() ? ranks[s] : 0,
                             regular            ? Status::unresolved
                             : s < ranks.size() ? Status::singular
                                                : Status::undefined);
    }

    // 64 bits more than the digits need are enough for a condition number of the normal equations up to about 10^15.
    long const least = (bits_for(digits) + 64 + 63) / 64 * 64;
    long const most = std::max(1L << 16, 4 * least);
    // Doubled, and the last one is `most` itself; then 0.
    auto const after = [most](long bits) { return bits == most ? 0 : std::min(2 * bits, most); };
    auto decided = [&](size_t s, BallMatrix const& normal, long bits) {
        if (pause) pause();
        auto enclosure =
            std::make_shared<CertifiedSolution::Enclosure>(CertifiedSolution::Enclosure{{}, {}, bits, digits});
        if (!solve(*enclosure, normal) || !covariance_is_accurate(*enclosure)) return false;
        if (!theta_is_accurate(*enclosure)) {
            if (bits < most || !theta_is_zero(*enclosure, problem, data, steps[s])) return false;
            arb_mat_zero(enclosure->theta);
        }
        answers[s] = CertifiedSolution(steps[s], d, std::move(enclosure));
        return true;
    };
    Normal normal(problem, data);
    if (pending.empty()) return answers;
    if (problem.forgetting == 1) {
        IntegerGram gram(data, steps[pending.back()]);
        for (size_t const s : pending) {
            gram.advance(steps[s], pause);
            for (long bits = least; bits > 0 && !decided(s, normal.sum(gram, bits), bits);) bits = after(bits);
        }
    } else {
        for (long bits = least; bits > 0 && !pending.empty(); bits = after(bits)) {
            ForgettingGram gram = normal.recursion(bits);
            std::erase_if(pending, [&](size_t s) {
                gram.advance(steps[s], pause);
                return decided(s, gram.matrix(), bits);
            });
        }
    }
    return answers;
}

}  // namespace rlslab
