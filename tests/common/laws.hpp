// The laws of recursive least squares as predicates over an entry of the catalogue, so that each can be shown to fail.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace rlslab::laws {

/// Equality that knows NaN: breakdown repeats, too.
inline bool identical(Reference const& a, Reference const& b) { return a == b || (isnan(a) && isnan(b)); }
template <class A, class B>
bool identical(A const& a, B const& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
    for (Index j = 0; j < a.cols(); ++j)
        for (Index i = 0; i < a.rows(); ++i)
            if (!identical(Reference(a(i, j)), Reference(b(i, j)))) return false;
    return true;
}
inline bool identical(Stored<Reference> const& a, Stored<Reference> const& b) {
    return identical(a.F, b.F) && identical(a.D, b.D);
}

/// As a part of a test's name.
inline std::string title(CatalogueEntry const& entry) {
    std::string name = std::string(entry.variant) + "_" + std::string(entry.arithmetic->name);
    std::ranges::replace(name, '-', '_');
    return name;
}

/// Rows of bell-shaped noise in psi, and y = psi' (1, -2, 3, ...) + noise; exact in binary64, rounded by who takes
/// them.
inline Records noise_records(Index size, Index rows, Seed seed) {
    Records out{.psi = Eigen::MatrixXd(size, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        double y = seed.bell() / 8;
        for (Index i = 0; i < size; ++i) {
            out.psi(i, k) = seed.bell();
            y += out.psi(i, k) * double(i % 2 ? -(i + 1) : i + 1);
        }
        out.y[k] = y;
    }
    return out;
}

inline void process_rows(AnyFilter& f, Records const& records, double scale = 1) {
    for (Index k = 0; k < records.rows(); ++k) f.update(records.sample(k), scale * records.y[k]);
}

/// P0 = I keeps c^2 |psi|^2 below 1/u even in bfloat16: beyond that P - K f' has no correct bit left at the first step.
inline Problem<double> problem(Index size, double forgetting = 1, double variance = 1) {
    return {.size = size, .forgetting = forgetting, .prior = Prior<double>{.variance = variance}};
}

// --- laws without a tolerance ---------------------------------------------------------------------------------------

/// psi = 0 moves neither theta nor what is stored (lambda = 1), whatever y says. Where solving for theta draws random
/// numbers, theta is left to `stored`.
inline bool a_zero_regressor_teaches_nothing(CatalogueEntry const& entry) {
    auto const f = entry.make(problem(3), Seed{1});
    process_rows(*f, as_stored(noise_records(3, 20, Seed{17}), *entry.arithmetic));
    auto const theta = f->theta();
    auto const stored = f->stored();
    f->update(Vector<double>(Vector<double>::Zero(3)), 5);
    return identical(f->stored(), stored) && (entry.arithmetic->stochastic || identical(f->theta(), theta));
}

/// Short of overflow and underflow a factor of two commutes with rounding.
inline bool scaling_the_output_by_two_scales_theta_exactly(CatalogueEntry const& entry) {
    auto const f = entry.make(problem(3, 31.0 / 32), Seed{1}), g = entry.make(problem(3, 31.0 / 32), Seed{1});
    Records records = noise_records(3, 40, Seed{11});
    records.y *= 64;  // keeps binary16 clear of its subnormal numbers
    records = as_stored(records, *entry.arithmetic);
    process_rows(*f, records);
    process_rows(*g, records, 2);
    Vector<Reference> twice = f->theta();
    for (Reference& x : twice) x *= 2;
    return identical(g->theta(), twice);
}

/// Rows taken without a report leave what they leave with one, and the next report is the same. In blocks, or with
/// rounding at random, nothing is promised. Three nearly dependent columns without a prior: a short word breaks down on
/// the way.
inline bool rows_without_report_leave_the_same_bits(CatalogueEntry const& entry) {
    if (entry.block > 1 || entry.arithmetic->stochastic) return true;
    Problem<double> p = problem(3, 0.96875);
    if (entry.starts_without_prior) p.prior.reset();
    Records records = noise_records(3, 30, Seed{7});
    for (Index k = 0; k < records.rows(); ++k)
        for (Index i = 0; i < 3; ++i) records.psi(i, k) = 1 + std::pow(records.psi(0, k), double(i)) / 64;
    records = as_stored(records, *entry.arithmetic);
    auto const reported = entry.make(p, Seed{1});
    for (Index k = 0; k < records.rows(); ++k) {
        auto const f = entry.make(p, Seed{1});
        Step<double> const a = f->update_block(records, 0, k + 1),
                           b = reported->update(records.sample(k), records.y[k]);  // all but the last unreported
        if (a.health != b.health || !identical(Reference(a.innovation), Reference(b.innovation)) ||
            !identical(f->stored(), reported->stored()) || !identical(f->theta(), reported->theta()) ||
            !identical(f->gain(), reported->gain()))
            return false;
    }
    return true;
}

/// A copy goes on as the original does, and the original as if it had not been copied.
inline bool a_clone_continues_bit_for_bit(CatalogueEntry const& entry) {
    Records const records = as_stored(noise_records(4, 60, Seed{5}), *entry.arithmetic);
    auto const f = entry.make(problem(4, 0.96875), Seed{1}), undisturbed = entry.make(problem(4, 0.96875), Seed{1});
    process_rows(*undisturbed, records);
    std::unique_ptr<AnyFilter> clone;
    for (Index k = 0; k < records.rows(); ++k) {
        if (k == 30) clone = f->clone();
        f->update(records.sample(k), records.y[k]);
        if (clone) clone->update(records.sample(k), records.y[k]);
    }
    return identical(f->stored(), clone->stored()) && identical(f->theta(), clone->theta()) &&
           identical(f->stored(), undisturbed->stored()) && identical(f->theta(), undisturbed->theta());
}

/// The same data and seed give the same bits; asking for reports on the way changes nothing.
inline bool same_seed_same_bits_whoever_looks(CatalogueEntry const& entry) {
    Records const records = as_stored(noise_records(4, 60, Seed{6}), *entry.arithmetic);
    auto const f = entry.make(problem(4, 0.96875), Seed{3}), looked_at = entry.make(problem(4, 0.96875), Seed{3});
    for (Index k = 0; k < records.rows(); ++k) {
        f->update(records.sample(k), records.y[k]);
        looked_at->update(records.sample(k), records.y[k]);
        looked_at->theta();
        looked_at->gain();
        looked_at->stored();
    }
    return identical(f->stored(), looked_at->stored()) && identical(f->theta(), looked_at->theta());
}

/// On well-conditioned data every step is sound and gamma lies in (0, 1].
inline bool healthy_data_are_reported_sound(CatalogueEntry const& entry) {
    Records const records = as_stored(noise_records(3, 60, Seed{8}), *entry.arithmetic);
    auto const f = entry.make(problem(3, 0.96875), Seed{1});
    for (Index k = 0; k < records.rows(); ++k) {
        Step<double> const step = f->update(records.sample(k), records.y[k]);
        if (step.health != Health::sound || !(0 < step.gamma && step.gamma <= 1)) return false;
    }
    return true;
}

/// A NaN in the data is reported at once.
inline bool a_nan_is_reported(CatalogueEntry const& entry) {
    auto const f = entry.make(problem(3), Seed{1});
    process_rows(*f, as_stored(noise_records(3, 10, Seed{8}), *entry.arithmetic));
    Vector<double> const psi = Vector<double>::Constant(3, std::numeric_limits<double>::quiet_NaN());
    return f->update(psi, 1).health == Health::nonfinite;
}

// --- laws with a budget, in units of the arithmetic's epsilon --------------------------------------------------------

inline double norm(Vector<Reference> const& x) {
    Reference sum = 0;
    for (Reference const& v : x) sum += v * v;
    return static_cast<double>(sqrt(sum));
}

/// The worst |residual - (y - psi'theta)| over |y| + |psi||theta|, in epsilons: theta as reported after the step.
inline double residual_error(CatalogueEntry const& entry) {
    Records const records = as_stored(noise_records(3, 40, Seed{21}), *entry.arithmetic);
    double const epsilon = 2 * entry.arithmetic->unit_roundoff();
    auto const f = entry.make(problem(3, 0.96875), Seed{1});
    double worst = 0;
    for (Index k = 0; k < records.rows(); ++k) {
        Step<double> const step = f->update(records.sample(k), records.y[k]);
        Vector<Reference> const theta = f->theta();
        Reference after = records.y[k], size = abs(after);
        for (Index i = 0; i < 3; ++i) {
            after -= records.psi(i, k) * theta[i];
            size += abs(Reference(records.psi(i, k) * theta[i]));
        }
        // A step is reported in binary64: its rounding is not the filter's.
        double const unit = std::max(epsilon, 0x1p-52);
        worst = std::max(worst, static_cast<double>(abs(Reference(after - step.residual)) / size) / unit);
    }
    return worst;
}

/// The worst |K - P psi| over |K|, in epsilons, P exactly as stored; covariance forms.
inline double gain_error(CatalogueEntry const& entry) {
    Records const records = as_stored(noise_records(3, 40, Seed{22}), *entry.arithmetic);
    auto const f = entry.make(problem(3, 0.96875), Seed{1});
    double worst = 0;
    for (Index k = 0; k < records.rows(); ++k) {
        f->update(records.sample(k), records.y[k]);
        if (k < 8) continue;  // the large prior is gone by then
        Stored<Reference> const stored = f->stored();
        Vector<Reference> const psi = records.psi.col(k).cast<Reference>(), K = f->gain();
        bool const of_P = stored.quantity == Stored<Reference>::Quantity::covariance;  // else P^-1 K - psi, over |psi|
        Vector<Reference> const &from = of_P ? psi : K, &to = of_P ? K : psi;
        double const off = norm(Vector<Reference>(multiplied_out(stored).lazyProduct(from) - to));
        worst = std::max(worst, off / norm(to) / (2 * entry.arithmetic->unit_roundoff()));
    }
    return worst;
}

/// |theta - exact| / |exact| and the same for P, in epsilons, against the certified solution of the rounded problem.
struct Errors {
    double theta, covariance;
};
inline Errors errors(CatalogueEntry const& entry, Problem<double> const& given, Records const& records) {
    Problem<double> const p = as_stored(given, *entry.arithmetic);
    Records const data = as_stored(records, *entry.arithmetic);
    auto const f = entry.make(p, Seed{1});
    if (entry.block == 1) process_rows(*f, data);
    else f->update_block(data, 0, data.rows());
    int const digits = int(entry.arithmetic->decimal_digits()) + 20;
    CertifiedSolution const exact = std::move(certified(p, data, {data.rows()}, digits).front());
    auto const in_epsilons = [&](double digits_kept) {
        return std::pow(10, -digits_kept + (entry.arithmetic->digits - 1) * 0.30102999566398120);
    };
    return {in_epsilons(exact.theta_digits(f->theta())), in_epsilons(exact.covariance_digits(f->stored()))};
}

}  // namespace rlslab::laws
