// (1) to (5) of prior_law.hpp, letter by letter: P, theta, s and W have 257 bits, the squares double's. Then the
// costs for the arithmetics and the prior of a comparison, in numbers and in a sentence.
#include "src/lab/compare/prior_law.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

using Vec = Vector<Reference>;
using Mat = Matrix<Reference>;
using Numbers = std::vector<double>;

constexpr double of_a_rounding = 0.4247;  // rms of a rounding in units of u: docs/theory.md 68
constexpr Index most_parameters = 32;

double as_double(Reference const& x) { return static_cast<double>(x); }
double square(double x) { return x * x; }
double square(Reference const& x) { return square(as_double(x)); }

double squares(Vec const& x) {
    double sum = 0;
    for (Index i = 0; i < x.size(); ++i) sum += square(x[i]);
    return sum;
}

/// P of one row more, of variance v: f = P psi, K = f / (v + psi'f).
void take(Mat& P, Vec const& f, Vec const& K) { P -= K.lazyProduct(f.transpose()); }

/// The sums of (3), (4) and (5) as they grow row by row.
class Recursion {
    Index d_;
    Mat P_, P_N_, W_;
    Vec theta_, theta_N_, s_;

public:
    double stored = 0, products = 0, corrected = 0, steady = 0;  // in squares of 0.425 u

    Recursion(double c2, Mat const& P_free, Vec const& theta_free)
        : d_(theta_free.size()), P_(Mat::Zero(d_, d_)), P_N_(P_free), W_(d_, d_), theta_(Vec::Zero(d_)) {
        Reference const by_c2 = Reference(1) / c2;
        for (Index i = 0; i < d_; ++i) {  // the prior as d rows e_i of noise variance c^2
            Vec const f = P_N_.col(i);
            take(P_N_, f, f / Reference(c2 + f[i]));
            P_(i, i) = c2;
        }
        theta_N_ = P_N_.lazyProduct(theta_free), s_ = Vec(d_);
        for (Index i = 0; i < d_; ++i) {
            theta_N_[i] = theta_free[i] - by_c2 * theta_N_[i];  // (1)
            s_[i] = -by_c2 * theta_N_[i];
            for (Index j = 0; j < d_; ++j) W_(i, j) = by_c2 * P_N_(i, j);
        }
    }
    double bias(Vec const& theta_free) const { return std::sqrt(squares(Vec(theta_N_ - theta_free))); }

    void row(Vec const& psi, Reference const& y) {
        Vec const f = P_.lazyProduct(psi);
        Reference const s = Reference(1) + psi.dot(f), e = y - psi.dot(theta_), r = y - psi.dot(theta_N_);
        Vec const P_N_psi = P_N_.lazyProduct(psi), gain = f / s;
        Numbers q2(size_t(d_), 0.0), K(size_t(d_), 0.0), w2(size_t(d_), 0.0), before(size_t(d_ * d_), 0.0);
        for (Index j = 0; j < d_; ++j)
            for (Index i = 0; i < d_; ++i) {
                before[size_t(i + d_ * j)] = square(P_(i, j));
                q2[size_t(i)] += 2 * before[size_t(i + d_ * j)] * square(psi[j]);
            }
        for (Index i = 0; i < d_; ++i) {
            K[size_t(i)] = as_double(gain[i]);
            s_[i] += psi[i] * r;
            theta_[i] += gain[i] * e;
        }
        take(P_, f, gain);
        for (Index j = 0; j < d_; ++j)
            for (Index i = 0; i < d_; ++i) {
                W_(i, j) += P_N_psi[i] * psi[j];
                w2[size_t(j)] += square(W_(i, j));
            }
        Reference const Ks = gain.dot(s_);
        double const p2 = squares(P_N_psi), r2 = square(r), e2 = square(e), step2 = square(Reference(e / s));
        Numbers after(size_t(d_), 0.0);  // sum_i P_j,ai^2 psi_i^2
        for (Index i = 0; i < d_; ++i)
            for (Index a = 0; a < d_; ++a) after[size_t(a)] += square(P_(a, i)) * square(psi[i]);
        for (Index a = 0; a < d_; ++a) {
            double const w = w2[size_t(a)], K_a = K[size_t(a)], q = q2[size_t(a)];
            double const common = w * (square(theta_[a]) + square(K_a) * e2) + p2 * square(psi[a]) * square(theta_[a]);
            corrected += w * square(theta_[a]), steady += w * square(theta_N_[a]);
            stored += common + (w * r2 + p2 * square(s_[a])) * q;
            products += common + w * q * step2;
            for (Index b = 0; b < d_; ++b) {
                double const s2 = square(s_[b]), K_b = K[size_t(b)], now = square(P_(a, b)),
                             keep_a = 1 - 2 * K_a * as_double(psi[a]), keep_b = 1 - 2 * K_b * as_double(psi[b]);
                double const BP = std::abs(before[size_t(a + d_ * b)] * keep_a + square(K_a) * q2[size_t(b)] / 2),
                             PB = std::abs(now * keep_b + square(K_b) * after[size_t(a)]);
                stored += w * s2 * (now + square(K_a) * square(f[b]));
                products += 2 * w * (BP * square(Reference(s_[b] - psi[b] * Ks)) + PB * s2);
            }
        }
    }
    /// Rows that are not looked at: theta is rounded in each.
    void rest(Index rows) {
        double const more = double(rows) * squares(theta_N_);
        stored += more, products += more, corrected += more, steady += more;
    }
};

double between(double x, double x0, double x1, double y0, double y1) {
    if (!(y0 > 0 && y1 > 0)) return std::max(y0, y1);
    double const l0 = correctly::log10(y0), l1 = correctly::log10(y1);
    return correctly::pow(10, l0 + (x - x0) / (x1 - x0) * (l1 - l0));
}

constexpr int most_bits = 53;  // the law's priors end at 2^53 / tr M
constexpr std::pair<char const*, PriorForm> forms[] = {{"symmetric", PriorForm::stored},
                                                       {"joseph", PriorForm::products}};

/// A relative error of 1 or more has no digits.
double digits_of_error(double error) { return std::max(0.0, -correctly::log10(error)); }
bool is_a_loss(double digits) { return std::round(10 * digits) >= 10 * least_prior_loss; }

double c2_of(Comparison const& c) { return c.scaled_prior ? c.scaled_prior->c * c.scaled_prior->c : *c.options.p0; }
Vector<double> units_of(Comparison const& c) { return c.scaled_prior ? c.scaled_prior->s : Vector<double>(); }

/// Arithmetics that round to nearest, have at most 53 bits and hold data and prior.
std::vector<Arithmetic const*> words_of(Comparison const& c) {
    std::vector<Arithmetic const*> out;
    for (Result const& r : c.results) {
        Arithmetic const& word = *r.entry->arithmetic;
        auto const stored = std::ranges::find(c.rounding, word.name, &RoundingEffect::arithmetic);
        if (word.digits <= most_bits && !word.stochastic && std::ranges::find(out, &word) == out.end() &&
            (stored == c.rounding.end() || (stored->in_range && stored->data_in_range)))
            out.push_back(&word);
    }
    return out;
}

/// The records in these units, where there is a law for them.
class Units {
    Mat P_;
    Vec theta_;
    Matrix<double> psi_;
    Vector<double> const& y_;
    double length_ = 0;

public:
    double trace = 0;

    Units(Records const& records, CertifiedSolution const& least_squares, Vector<double> const& units) : y_(records.y) {
        Index const d = records.parameters();
        if (least_squares.status() != Status::certified || d > most_parameters) return;
        P_ = least_squares.covariance(), theta_ = least_squares.theta(), psi_ = records.psi;
        for (Index i = 0; i < units.size(); ++i) {
            theta_[i] *= units[i], P_.row(i) *= Reference(units[i]), P_.col(i) *= Reference(units[i]);
            psi_.row(i) /= units[i];
        }
        length_ = std::sqrt(squares(theta_));
        for (double const x : psi_.reshaped()) trace += square(x);
    }
    bool is_empty() const { return !(length_ > 0) || !std::isfinite(length_) || !(trace > 0) || !std::isfinite(trace); }
    std::optional<PriorPoint> at(double c2) const {
        Index const d = psi_.rows(), N = psi_.cols(), seen = std::min(N, std::max(4 * d, 40000 / (d * d)));
        Recursion sums(c2, P_, theta_);
        Vec row(d);
        for (Index j = 0; j < seen; ++j) {
            for (Index i = 0; i < d; ++i) row[i] = psi_(i, j);
            sums.row(row, y_[j]);
        }
        sums.rest(N - seen);
        auto const size = [&](double squares) { return of_a_rounding * std::sqrt(squares) / length_; };
        PriorPoint const out{c2,
                             sums.bias(theta_) / length_,
                             size(sums.stored),
                             size(sums.products),
                             size(sums.corrected),
                             size(sums.steady)};
        if (!std::isfinite(out.bias + out.stored + out.products)) return {};
        return out;
    }
};

}  // namespace

PriorPoint PriorLaw::at(double c2) const {
    size_t i = 1;
    while (i + 1 < points.size() && points[i].c2 < c2) ++i;
    PriorPoint const &a = points[i - 1], &b = points[i];
    double const x = correctly::log10(c2), x0 = correctly::log10(a.c2), x1 = correctly::log10(b.c2);
    auto const on_the_line = [&](double PriorPoint::*of) { return between(x, x0, x1, a.*of, b.*of); };
    return {c2,
            std::min(1.0, on_the_line(&PriorPoint::bias)),
            on_the_line(&PriorPoint::stored),
            on_the_line(&PriorPoint::products),
            on_the_line(&PriorPoint::corrected),
            on_the_line(&PriorPoint::steady)};
}

PriorPoint PriorLaw::best(PriorForm form, double u) const {
    PriorPoint out = points.front();
    for (double c2 = out.c2; u * c2 * trace <= 1; c2 *= 2)
        if (PriorPoint const one = at(c2); one.total(form, u) < out.total(form, u)) out = one;
    return out;
}

PriorLaw prior_law(Records const& records, CertifiedSolution const& least_squares, Vector<double> const& units) {
    Units const in_units(records, least_squares, units);
    PriorLaw out{.points = {}, .trace = in_units.trace};
    if (in_units.is_empty()) return out;
    double const first = std::ldexp(1.0, -std::ilogb(out.trace));
    for (int k = 0; k <= 53; k += 4) {
        std::optional<PriorPoint> const point = in_units.at(std::ldexp(first, k));
        if (!point) return {};
        out.points.push_back(*point);
    }
    return out;
}

std::optional<PriorPoint> prior_point(Records const& records, CertifiedSolution const& least_squares, double c2,
                                      Vector<double> const& units) {
    Units const in_units(records, least_squares, units);
    return in_units.is_empty() ? std::nullopt : in_units.at(c2);
}

std::vector<PriorCost> prior_costs(Records const& records, Comparison const& c) {
    if (!c.options.composition.empty() || c.options.forgetting != 1) return {};
    PriorLaw const law = prior_law(records, *c.without_prior, units_of(c));
    if (law.empty()) return {};
    double const given = c2_of(c);
    std::vector<PriorCost> out;
    for (Arithmetic const* const word : words_of(c)) {
        double const u = std::ldexp(1.0, -word->digits);
        for (auto const& [name, form] : forms) {
            PriorPoint const best = law.best(form, u);
            double const digits = digits_of_error(best.total(form, u));
            out.push_back({word->name, name, best.c2, digits,
                           std::max(0.0, digits - digits_of_error(law.at(given).total(form, u)))});
        }
    }
    return out;
}

std::vector<StartCost> start_costs(Records const& records, Comparison const& c) {
    if (!c.options.composition.empty() || c.options.forgetting != 1) return {};
    std::optional<PriorPoint> const given = prior_point(records, *c.without_prior, c2_of(c), units_of(c));
    if (!given || !(given->steady > 0)) return {};
    double const loss = std::max(0.0, correctly::log10(given->corrected / given->steady));
    PriorLaw const law = is_a_loss(loss) ? prior_law(records, *c.without_prior, units_of(c)) : PriorLaw{};
    std::vector<StartCost> out;
    for (Arithmetic const* const word : words_of(c)) {
        double const u = std::ldexp(1.0, -word->digits), digits = digits_of_error(u * given->corrected);
        out.push_back({word->name, digits, std::min(loss, digits_of_error(u * given->steady))});
        if (law.empty()) continue;
        if (double const best = law.best(PriorForm::corrected, u).c2; best < c2_of(c)) out.back().best_c2 = best;
    }
    return out;
}

std::string start_cost_text(Comparison const& c) {
    std::string out;
    bool smaller = false;
    for (StartCost const& cost : c.start_costs)
        if (is_a_loss(cost.loss)) {
            smaller = smaller || cost.best_c2;
            out += fmt::format("{}in {} about {:.1f} digits of theta, to {:.1f}{}", out.empty() ? "" : "; ",
                               cost.arithmetic, cost.loss, cost.digits,
                               cost.best_c2 ? fmt::format(" (best c^2 {:.1g})", *cost.best_c2) : "");
        }
    return out.empty()
               ? ""
               : fmt::format(
                     "the first rows excite so little that with this prior theta is far off at first: forms "
                     "that correct theta row by row keep the roundings of that, {}; qr and gentleman do not{}",
                     out,
                     !smaller       ? ""
                     : c.options.p0 ? ". A prior of c^2 says that no parameter exceeds c deviations of the noise"
                                    : ". A prior of c^2 says that no parameter times its regressor's size "
                                      "exceeds c deviations of the noise");
}

std::string prior_cost_text(Comparison const& c) {
    std::string out;
    std::string_view arithmetic;
    for (PriorCost const& cost : c.prior_costs) {
        if (!c.options.p0 || !is_a_loss(cost.loss)) continue;
        bool const more = cost.arithmetic == arithmetic;
        out += fmt::format("{}{} about {:.1f}{} (best c^2 {:.1g})",
                           more          ? ", "
                           : out.empty() ? fmt::format("in {} ", cost.arithmetic)
                                         : fmt::format("; in {} ", cost.arithmetic),
                           cost.form, cost.loss, more ? "" : " digits", cost.best_c2);
        arithmetic = cost.arithmetic;
    }
    return out.empty()
               ? ""
               : fmt::format(
                     "against least squares --p0 {} costs forms that store P, {}; symmetric stands for all that "
                     "update P by a difference",
                     *c.options.p0, out);
}

}  // namespace rlslab::compare
