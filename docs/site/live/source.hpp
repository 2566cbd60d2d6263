// Where rows come from: made ones of a chosen condition, or a table's; with what is switched on to disturb them.
#pragma once

#include "docs/site/live/settings.hpp"
#include "docs/site/live/table.hpp"

#include <rlslab/core/random.hpp>

namespace rlslab::live {

/// 2^x, x <= 0, by square roots alone: the same bits everywhere, which a library's pow does not have.
inline double power_of_two(double x) {
    double const whole = std::floor(x);
    double out = std::ldexp(1.0, int(whole)), root = std::sqrt(2.0), rest = x - whole;
    for (int i = 0; i < 53; ++i, root = std::sqrt(root)) {
        rest *= 2;
        if (rest >= 1) out *= root, rest -= 1;
    }
    return out;
}

/// Made rows: psi = Q S g, or S g where the condition comes from units; g nearly normal, S_ii = condition^(-i/(d-1)), Q
/// a product of two reflections; y = psi'1 + noise. All rows are rounded to nearest in the format.
/// With N = rows: an outlier at row 0.4 N (100 is added to y), silence from 0.55 N to 0.75 N (psi = 0), and from 0.8 N
/// on a changed system (psi'theta changes sign; of a table, y).
class Source {
    Settings settings_;
    RunTimeFormat format_;
    Rows const& table_;
    Seed seed_;
    int d_;
    long k_ = 0;
    double S_[most_parameters], v_[2][most_parameters];

    double made_row(double* psi) {
        double sum = 0;
        for (int i = 0; i < d_; ++i) psi[i] = S_[i] * seed_.bell();
        if (settings_.units == 0)
            for (auto const& v : v_) {
                double along = 0, square = 0;
                for (int i = 0; i < d_; ++i) along += v[i] * psi[i], square += v[i] * v[i];
                for (int i = 0; i < d_; ++i) psi[i] -= v[i] * (2 * along / square);
            }
        for (int i = 0; i < d_; ++i) sum += psi[i];
        return sum;
    }

public:
    Source(Settings const& now, Rows const& table)
        : settings_(now), format_(format_of(now)), table_(table), seed_{std::uint64_t(now.seed)},
          d_(now.table != 0 ? table.d() : int(now.parameters)) {
        for (int i = 0; i < d_; ++i) {
            S_[i] = d_ < 2 ? 1 : power_of_two(-now.condition * 3.321928094887362 * i / (d_ - 1));
            for (auto& v : v_) v[i] = seed_.bell();
        }
    }
    int d() const { return d_; }
    long rows() const { return settings_.table != 0 ? table_.rows() : long(settings_.rows); }
    /// Whether the row that was last taken is the outlier.
    bool at_outlier() const { return settings_.outlier != 0 && k_ == std::lround(0.4 * double(rows())); }
    /// False after a table's last row; made rows go on.
    bool next(double* psi, double& y) {
        double const at = double(++k_), n = double(rows());
        bool const changed = settings_.change != 0 && at > 0.8 * n;
        if (settings_.table != 0) {
            if (k_ > rows()) return false;
            for (int i = 0; i < d_; ++i) psi[i] = table_.psi[size_t((k_ - 1) * d_ + i)];
            y = table_.y[size_t(k_ - 1)];
            if (changed) y = -y;
        } else {
            double const sum = made_row(psi);
            y = (changed ? -sum : sum) + settings_.noise * seed_.bell();
        }
        if (at_outlier()) y += 100;
        if (settings_.silent != 0 && at > 0.55 * n && at <= 0.75 * n)
            for (int i = 0; i < d_; ++i) psi[i] = 0;
        for (int i = 0; i < d_; ++i) psi[i] = nearest_in(format_, psi[i]);
        y = nearest_in(format_, y);
        return true;
    }
};

}  // namespace rlslab::live
