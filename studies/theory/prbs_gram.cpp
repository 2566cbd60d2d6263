// Pseudo-random binary sequences as an input: the conditioning they give, in integers.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/rationals.hpp>

#include <rlslab/variants/variants.hpp>

#include <stdexcept>

namespace rlslab::studies {
namespace {

using namespace rationals;

/// One period of +-1 from a shift register of m bits, fed back from taps of a primitive polynomial.
std::vector<int> prbs(int m) {
    static std::vector<std::vector<int>> const taps{{3, 2}, {4, 3},       {5, 3}, {6, 5},
                                                    {7, 6}, {8, 6, 5, 4}, {9, 5}, {10, 7}};
    std::vector<int> out;
    if (m < 3 || m > 10) throw std::invalid_argument("expected a register of 3 to 10 bits");
    for (unsigned state = 1, n = 0; n < (1u << m) - 1; ++n) {
        out.push_back(state & 1u << (m - 1) ? 1 : -1);
        unsigned bit = 0;
        for (int tap : taps[size_t(m - 3)]) bit ^= state >> (tap - 1);
        state = (state << 1 | (bit & 1)) & ((1u << m) - 1);
    }
    return out;
}

/// The Gram matrix of n delays over one period, circular: entry (i, j) is R(i - j).
void measure(Trial const& trial, TrialOutput& out) {
    int const m = int(trial.number("m"));
    std::vector<int> const x = prbs(m);
    size_t const period = x.size();
    std::vector<long> R(period);
    bool two_levels = true;  // R(0) = M, R(tau) = -1 else
    for (size_t tau = 0; tau < period; ++tau) {
        for (size_t k = 0; k < period; ++k) R[tau] += x[k] * x[(k + tau) % period];
        two_levels = two_levels && R[tau] == (tau == 0 ? long(period) : -1);
    }
    double const M1 = double(period) + 1;
    for (size_t n : {size_t(2), size_t(3), size_t(4), size_t(6), period}) {
        if (n > period) continue;
        // n eigenvectors that span the space: 1 and e_0 - e_j, tested by multiplication.
        auto const entry = [&](size_t i, size_t j) { return R[(period + i - j) % period]; };
        bool spectrum = true;
        for (size_t i = 0; i < n; ++i) {
            long on_ones = 0;
            for (size_t j = 0; j < n; ++j) on_ones += entry(i, j);
            spectrum = spectrum && on_ones == long(period + 1 - n);
            for (size_t j = 1; j < n; ++j)
                spectrum = spectrum && entry(i, 0) - entry(i, j) == long(period + 1) * (long(i == 0) - long(i == j));
        }
        std::string filters = "not asked";
        if (n <= 4) {  // fed one period of the delay line with P0 = I: P^-1 is the Gram matrix and I
            M const I = M::Identity(Index(n), Index(n)), ones = M::Ones(Index(n), Index(n));
            M const P = (I + ones / Q(long(period + 2 - n))) / Q(long(period + 2));
            filters = "exact";
            for_each(Variants<Q>{}, [&]<class F>() {
                F filter({.size = Index(n), .prior = Prior<Q>{.variance = 1}});
                V psi{Index(n)};
                for (size_t k = 0; k < period; ++k) {
                    for (size_t i = 0; i < n; ++i) psi[Index(i)] = x[(k + period - i) % period];
                    filter.update(psi, Q(0));
                }
                if (covariance(filter.stored()) != P) filters = "different";
            });
        }
        out({double(period), double(n), two_levels ? "exact" : "different", spectrum ? "exact" : "different", filters,
             M1 / (M1 - double(n))});
    }
}

}  // namespace

extern Study const prbs_gram;
Study const prbs_gram{
    .name = "prbs_gram",
    .question = "How well does a pseudo-random binary sequence excite?",
    .source =
        "derived (docs/theory.md 4, 53; docs/literature.md 2); maximum-length sequences: Golomb 1967 (cited, not read)",
    .formula = R"tex(\Psi^\top \Psi = (M + 1) I - \mathbf{1}\mathbf{1}^\top, \quad M = 2^m - 1: \quad
\text{eigenvalues } M + 1\ (n - 1 \text{ times}),\ M + 1 - n, \quad
\kappa_P = \frac{M + 1}{M + 1 - n})tex",
    .interpretation =
        "One full period of a two-level sequence, n delays of it, circular: everything is an integer and equal to the "
        "formula with ==. The condition number of P stays close to 1 until the number of delays comes near the period; "
        "with all M delays the smallest eigenvalue is still 1, so the sequence is persistently exciting of order M, "
        "its mean of 1/M included. Every variant that exists in rationals, fed the same period from P0 = I, holds "
        "exactly the inverse of I + Gram matrix.",
    .data = "maximum-length sequences of 3 to 10 bits",
    .factors =
        [](Budget) {
            return std::vector<Factor>{{"m", {3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0}}};
        },
    .measures = {"period", "delays", "autocorrelation", "eigenvalues", "filters", "kappa_P"},
    .measure = measure,
    .plots = {{.title = "Condition number of P after one period",
               .x = "period",
               .y = "kappa_P",
               .series = "delays",
               .x_label = "period M",
               .y_label = "κ₂ of P",
               .where = {{"delays", {"2", "3", "4", "6"}}}}},
    .claims =
        {
            {"R(0) = M and R(tau) = -1 for every other tau, m = 3 ... 10, as integers",
             [](Table const& t) { return everywhere(t, "autocorrelation", "exact"); },
             verification("docs/theory.md 53")},
            {"the Gram matrix of n = 2, 3, 4, 6 and M delays has the eigenvalue M + 1 n - 1 times and M + 1 - n once, "
             "as integers",
             [](Table const& t) { return everywhere(t, "eigenvalues", "exact"); }, verification("docs/theory.md 53")},
            {"with all M delays the condition number is M + 1: the smallest eigenvalue is 1",
             [](Table const& t) {
                 return within(
                     t, {"m"}, [](Table const& rows) { return greatest("kappa_P")(rows) - rows.numbers("period")[0]; },
                     1, 1);
             },
             verification("docs/theory.md 53")},
            {"every variant in rationals, from P0 = I, holds exactly the inverse of I + Gram matrix (n = 2, 3, 4)",
             [](Table const& t) {
                 return everywhere(t.where("filters", {"exact", "different"}), "filters", "exact");
             },
             verification("docs/theory.md 53")},
        },
};

}  // namespace rlslab::studies
