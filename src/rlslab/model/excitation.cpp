// Eigenvalues are those of the exact matrices (reference/windows.hpp); everything else is sums in order.
#include <rlslab/model/excitation.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/reference/windows.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rlslab {
namespace {

double power_of_ten(int n) {
    double power = 1;
    for (int i = 0; i < std::abs(n); ++i) power *= 10;
    return n < 0 ? 1 / power : power;
}

constexpr int most_decimals = 12;

/// Decimals of the shortest text that is v to 2^-50; more than most_decimals where none is.
int decimals_of(double v) {
    double scale = 1;
    int decimals = 0;
    for (; decimals <= most_decimals; ++decimals, scale *= 10)
        if (std::abs(v * scale - std::nearbyint(v * scale)) <= 0x1p-50 * std::abs(v * scale)) break;
    return decimals;
}

/// The smallest distance between two numbers, if nearly all are multiples of it from the least; otherwise 0.
double step_of(Signal const& sorted) {
    double unit = INFINITY;
    for (size_t k = 1; k < sorted.size(); ++k) {
        double const gap = sorted[k] - sorted[k - 1];
        // Decimals are stored with a rounding error: a gap of that size is no gap.
        if (gap > 1e-12 * std::max(std::abs(sorted[k]), std::abs(sorted[k - 1]))) unit = std::min(unit, gap);
    }
    size_t multiples = 0;
    for (double const v : sorted) {
        double const quotient = (v - sorted.front()) / unit;
        multiples += std::abs(quotient - std::nearbyint(quotient)) < 1e-3;
    }
    return std::isfinite(unit) && double(multiples) >= 0.99 * double(sorted.size()) ? unit : 0;
}

/// The most decimals that at least half of the numbers have which were counted by their decimals.
int decimals_of_half(std::map<int, size_t> const& counts) {
    size_t all = 0, with = 0;
    for (auto const& [decimals, count] : counts) all += count;
    auto at = counts.rbegin();
    while (2 * (with += at->second) < all) ++at;
    return at->first;
}

}  // namespace

double resolution_of(Signal const& x, double least) {
    struct Value {
        size_t times;
        int decade, decimals;
    };
    Signal sorted = x;
    std::ranges::sort(sorted);
    double const rounding = least * std::max(std::abs(sorted.front()), std::abs(sorted.back()));
    std::vector<Value> values;
    std::map<int, size_t> all;
    std::map<int, std::map<int, size_t>> decades;
    size_t zeros = 0;
    for (auto at = sorted.begin(), next = at; at != sorted.end(); at = next) {
        next = std::upper_bound(at, sorted.end(), *at);
        if (*at == 0) {
            zeros = size_t(next - at);
            continue;
        }
        Value value{size_t(next - at), int(std::floor(correctly::log10(std::abs(*at)))), decimals_of(*at)};
        for (double unit = 10; value.decimals <= 0 && std::fmod(*at, unit) == 0; unit *= 10)
            --value.decimals;  // "1200" has -2
        ++all[value.decimals], ++decades[value.decade][value.decimals];
        values.push_back(value);
    }
    constexpr size_t few_levels = 20, few_in_decade = 10;
    if (values.size() + (zeros > 0) <= few_levels) return rounding;
    int const of_all = decimals_of_half(all);
    if (of_all > most_decimals) return std::max(step_of(sorted), rounding);
    std::map<int, int> of_decade;
    for (auto const& [decade, counts] : decades) {
        size_t seen = 0;
        for (auto const& [decimals, count] : counts) seen += count;
        of_decade[decade] = seen < few_in_decade ? of_all : decimals_of_half(counts);
    }
    auto const square_of = [&](int decimals) {
        double const unit = std::max(power_of_ten(-decimals), rounding);
        return unit * unit;
    };
    double squares = double(zeros) * square_of(of_all);
    for (Value const& v : values) squares += double(v.times) * square_of(std::max(v.decimals, of_decade[v.decade]));
    return std::sqrt(squares / double(x.size()));
}

namespace {

/// How many rows carry z'v_k, v_k less their mean if `centred`: 1 where it is 0 but in one row, all where its size is
/// the same in all.
double rows_that_carry(Signal const& x, Vector<double> const& z, bool centred) {
    Index const n = z.size(), rows = Index(x.size()) - n + 1;
    double largest = 0;
    for (double const v : x) largest = std::max(largest, std::abs(v));
    int const scale = -std::ilogb(largest);
    Signal w(static_cast<size_t>(rows), 0.0);
    double mean = 0, square = 0, fourth = 0;
    for (Index k = 0; k < rows; ++k) {
        double& out = w[size_t(k)];
        for (Index i = 0; i < n; ++i) out += z[i] * std::scalbn(x[size_t(k + n - 1 - i)], scale);
        mean += out / double(rows);
    }
    double most = 0;
    for (double& v : w) most = std::max(most, std::abs(v -= centred ? mean : 0));
    if (most == 0) return 0;
    for (double const v : w) square += v / most * (v / most), fourth += v / most * (v / most) * (v / most) * (v / most);
    return square * square / fourth;
}

}  // namespace

Signal correlation(Signal const& x, Signal const& y, Index most) {
    Index const N = Index(x.size());
    expects(x.size() == y.size() && 0 <= most && most < N,
            "two signals of equal length, and lags shorter than they are");
    Signal out(size_t(most + 1), 0.0);
    for (Index lag = 0; lag <= most; ++lag) {
        double sum = 0;
        for (Index k = lag; k < N; ++k) sum += x[size_t(k)] * y[size_t(k - lag)];
        out[size_t(lag)] = sum / double(N);
    }
    return out;
}

Matrix<double> correlation_matrix(Signal const& x, Index n) {
    expects(1 <= n && n <= Index(x.size()), "an order between 1 and the number of samples");
    Index const rows = Index(x.size()) - n + 1;
    Matrix<double> R = Matrix<double>::Zero(n, n);
    for (Index k = n - 1; k < Index(x.size()); ++k)
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i) R(i, j) += x[size_t(k - i)] * x[size_t(k - j)];
    for (double& r : R.reshaped()) r /= double(rows);
    return R;
}

Excitation excitation(Signal const& u, Index most, ExcitationOptions const& options) {
    expects(!u.empty() && most >= 1, "a record, and an order of at least 1");
    Excitation out;
    out.resolution = resolution_of(u);
    while (out.constant_at_start < Index(u.size()) && u[size_t(out.constant_at_start)] == u[0]) ++out.constant_at_start;
    if (out.constant_at_start == 1) out.constant_at_start = 0;
    for (size_t k = 1; k < u.size(); ++k) out.changes += u[k] != u[k - 1];
    double const noise = out.resolution * std::sqrt(4.0 / 12);  // roots are compared: squares may underflow
    window_spectra(u, most, options.constant, [&](Index n, WindowSpectrum const& of) {
        ExcitationOrder at{n, of.definite, of.condition, of.root * of.root, of.root > noise, 0};
        if (at.definite) {
            at.carried = rows_that_carry(u, of.direction, options.constant);
            out.exact_order = n;
            if (at.resolved && out.order == n - 1) out.order = n;
            double const rows = double(Index(u.size()) - n + 1);
            if (out.order == n && out.persistent == n - 1 && at.carried >= std::min(2 * double(n), rows / 8))
                out.persistent = n;
        }
        out.orders.push_back(at);
        if (options.progress && n < most) options.progress(double(n) / double(most) * (double(n) / double(most)));
        return at.definite;
    });
    if (options.progress) options.progress(1);
    return out;
}

}  // namespace rlslab
