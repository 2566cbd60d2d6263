// Sums in integers; then the inverse in balls at rising precision, and its largest eigenvalue.
#include <rlslab/reference/windows.hpp>

#include <rlslab/reference/enclosure.hpp>
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <limits>

namespace rlslab {
namespace {

using namespace balls;

/// The samples as integers, in the unit 2^unit.
struct Samples {
    std::vector<Integer> m;
    long unit = std::numeric_limits<int>::max();

    explicit Samples(std::vector<double> const& x) : m(x.size()) {
        for (double const v : x)
            if (v != 0) unit = std::min(unit, long(dyadic(v).exponent));
        for (size_t k = 0; k < x.size(); ++k) {
            if (x[k] == 0) continue;
            auto const [mantissa, exponent] = dyadic(x[k]);
            fmpz_set_si(m[k], mantissa);
            fmpz_mul_2exp(m[k], m[k], ulong(exponent - unit));
        }
    }
};

/// G = rows R in the unit 2^(2 unit), from the lags' sums over k = n-1 ... N-1; if centred, rows^2 R.
void set_gram(IntegerMatrix& G, Samples const& x, std::vector<Integer> const& lags, Integer const& sum, bool centred) {
    Index const n = G.rows(), N = Index(x.m.size());
    auto const at = [&](Index k) -> fmpz const* { return x.m[size_t(k)]; };
    for (Index j = 0; j < n; ++j) fmpz_set(G(0, j), lags[size_t(j)]);
    for (Index i = 1; i < n; ++i)  // one row later at both ends
        for (Index j = i; j < n; ++j) {
            fmpz_set(G(i, j), G(i - 1, j - 1));
            fmpz_addmul(G(i, j), at(n - 1 - i), at(n - 1 - j));
            fmpz_submul(G(i, j), at(N - i), at(N - j));
        }
    if (centred) {
        std::vector<Integer> sums(size_t(n), sum);
        for (Index i = 1; i < n; ++i) {
            fmpz_add(sums[size_t(i)], sums[size_t(i - 1)], at(n - 1 - i));
            fmpz_sub(sums[size_t(i)], sums[size_t(i)], at(N - i));
        }
        for (Index i = 0; i < n; ++i)
            for (Index j = i; j < n; ++j) {
                fmpz_mul_si(G(i, j), G(i, j), N - n + 1);
                fmpz_submul(G(i, j), sums[size_t(i)], sums[size_t(j)]);
            }
    }
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < i; ++j) fmpz_set(G(i, j), G(j, i));
}

WindowSpectrum spectrum_of(IntegerMatrix const& G, long unit, double divisor) {
    if (!nonsingular(G)) return {.condition = std::numeric_limits<double>::infinity()};
    Index const n = G.rows();
    Integer const exponent(2 * unit);
    CertifiedSolution::Enclosure inverse{
        {}, BallMatrix(n, n), 0, 20};  // more than doubles, in which the eigenvalues are found, can hold
    BallMatrix M(n, n), L(n, n);
    for (long bits = 192;; bits *= 2) {
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) arb_set_round_fmpz_2exp(M(i, j), G(i, j), exponent, bits);
        if (!arb_mat_ldl(L, M, bits)) continue;
        arb_mat_inv_ldl_precomp(inverse.covariance, L, bits);
        if (covariance_is_accurate(inverse)) break;
    }
    Dominant least = dominant(inverse.covariance);
    return {.definite = true,
            .condition = correctly::exp2((dominant(M).log2_value + least.log2_value) / 2),
            .root = correctly::exp2(-least.log2_value / 2) / std::sqrt(divisor),
            .direction = std::move(least.vector)};
}

}  // namespace

void window_spectra(std::vector<double> const& x, Index most, bool centred,
                    std::function<bool(Index, WindowSpectrum const&)> const& each) {
    Index const N = Index(x.size());
    Samples const samples(x);
    most = std::min(most, (N + !centred) / 2);  // N - n + 1 >= n, or n + 1
    std::vector<Integer> lags;
    Integer sum;
    for (auto const& m : samples.m) fmpz_add(sum, sum, m);
    for (Index n = 1; n <= most; ++n) {
        // The sums begin at k = n-1, where the new lag has its first product.
        for (Index lag = 0; lag < n - 1; ++lag)
            fmpz_submul(lags[size_t(lag)], samples.m[size_t(n - 2)], samples.m[size_t(n - 2 - lag)]);
        if (n > 1) fmpz_sub(sum, sum, samples.m[size_t(n - 2)]);
        Integer& newest = lags.emplace_back();
        for (Index k = n - 1; k < N; ++k) fmpz_addmul(newest, samples.m[size_t(k)], samples.m[size_t(k - n + 1)]);
        double const rows = double(N - n + 1);
        IntegerMatrix G(n, n);
        set_gram(G, samples, lags, sum, centred);
        if (!each(n, spectrum_of(G, samples.unit, centred ? rows * rows : rows))) return;
    }
}

}  // namespace rlslab
