// Rows that an application must outlive, what a filter is after them, and the command line of programs that show it.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/reference/definiteness.hpp>
#include <rlslab/variants/ud.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

namespace rlslab::long_run {

inline constexpr double lambda = 0.98;                      // a memory of 50 rows
inline constexpr int d = 5, recovery = 5 * 50, good = 400;  // rows from a disturbance to the comparison; between two
inline constexpr std::array names{"burst",          "silence",         "collinear",    "outlier of 1e6", "not finite",
                                  "constant input", "1 outlier in 20", "out of scale", "true change"};

/// The disturbances in turn, each after a stretch of good rows: psi white, y = psi'theta + noise of deviation 0.1,
/// theta = (1, -2, 3, -4, 5) until the next true change, which negates it.
///   burst             20 rows times 1000               outlier of 1e6     one
///   silence           3000 rows, psi = 0               not finite         7 rows with NaN, infinities
///   collinear         2000 rows, all of psi alike      1 outlier in 20    300 rows, of deviation 10
///   constant input    1000 rows, psi = (1, 1, ...)     out of scale       2 rows with an entry times 3e37 or 1e6
class Abuse {
    enum Kind { burst, silence, collinear, outlier, not_finite, constant, one_in_twenty, scale, change, kinds };
    static constexpr int lengths[kinds] = {20, 3000, 2000, 1, 7, 1000, 300, 2, 1};
    Seed seed_;
    int left_ = good, since_ = 0;
    Kind kind_ = Kind(kinds - 1);  // the first to come is the burst
    bool good_ = true, begun_ = false;
    double sign_ = 1;

public:
    explicit Abuse(Seed seed) : seed_(seed) {}

    bool begun() const { return begun_; }  ///< a disturbance has come
    bool is_good() const { return good_; }
    int since() const { return since_; }  ///< good rows so far in this stretch
    int kind() const { return kind_; }    ///< of the disturbance before this stretch, or that is now
    double theta(int i) const { return sign_ * (i % 2 ? -(i + 1) : i + 1); }

    float next(float (&psi)[d]) {
        if (left_-- == 0) {
            good_ = !good_;
            begun_ = true;
            since_ = 0;
            if (!good_) kind_ = Kind((kind_ + 1) % kinds);
            left_ = (good_ ? good : lengths[kind_]) - 1;
            if (!good_ && kind_ == change) sign_ = -sign_;
        }
        for (float& x : psi) x = float(seed_.bell());
        if (good_) ++since_;
        else disturb(psi);
        double y = 0.1 * seed_.bell();
        for (int i = 0; i < d; ++i) y += double(psi[i]) * theta(i);
        if (good_) return float(y);
        if (kind_ == outlier) y += 1e6;
        if (kind_ == not_finite && left_ % 3 == 0) y = -INFINITY;
        if (kind_ == one_in_twenty && seed_.uniform() < 0.05) y += 10 * seed_.bell();
        return float(y);
    }

private:
    void disturb(float (&psi)[d]) {
        for (float& x : psi) {
            if (kind_ == burst) x *= 1000;
            if (kind_ == silence) x = 0;
            if (kind_ == collinear) x = psi[0];
            if (kind_ == constant) x = 1;
        }
        if (kind_ == not_finite) psi[left_ % d] = left_ % 2 ? NAN : INFINITY;
        if (kind_ == scale) psi[left_ % d] *= left_ % 2 ? 1e6f : 3e37f;
    }
};

struct Survived {
    std::array<Index, names.size()> compared{}, worse{};  ///< worse: an error of more than twice the fresh filter's
    std::array<double, names.size()> ratio{};             ///< the largest
    Index not_finite = 0;                                 ///< rows after which a number of the state is not finite
    Index checked = 0, not_definite = 0;

    Index all_compared() const { return sum(compared); }
    Index all_worse() const { return sum(worse); }

private:
    static Index sum(std::array<Index, names.size()> const& counts) {
        Index out = 0;
        for (Index n : counts) out += n;
        return out;
    }
};

/// theta beside that of a Ud<double, 5> that started where the last disturbance ended.
class Beside {
    std::optional<Ud<double, d>> fresh_;

public:
    /// After a filter has taken this row. Whether five memory lengths have passed since the disturbance: then theta(i)
    /// was compared.
    template <class Theta>
    bool compare(Abuse const& abuse, float const (&psi)[d], float y, Theta theta, Survived& out) {
        if (!abuse.is_good() || !abuse.begun()) return false;
        if (abuse.since() == 1)
            fresh_.emplace(Problem<double>{.forgetting = lambda, .prior = Prior<double>{.variance = 100}});
        double const exact[d] = {psi[0], psi[1], psi[2], psi[3], psi[4]};
        fresh_->update(exact, y);
        if (abuse.since() != recovery) return false;
        double ours = 0, free = 0;
        for (int i = 0; i < d; ++i) {
            double const a = double(theta(i)) - abuse.theta(i), b = fresh_->theta()[i] - abuse.theta(i);
            ours += a * a;
            free += b * b;
        }
        size_t const kind = size_t(abuse.kind());
        ++out.compared[kind];
        out.worse[kind] += !(ours <= 4 * free);
        if (!(std::sqrt(ours / free) <= out.ratio[kind])) out.ratio[kind] = std::sqrt(ours / free);
        return true;
    }
};

/// F, a Ud<float, 5> or a type around it, over so many rows. After each row every number of theta, D and U is looked
/// at. Five memory lengths after each disturbance theta is compared, and whether P is positive definite is decided
/// exactly. `told(rows, survived)` every `interval` rows.
template <class F, class Told>
Survived survive(F& f, Index rows, Seed seed, Index interval, Told told) {
    Survived out;
    Abuse abuse(seed);
    Beside beside;
    float psi[d];
    for (Index k = 1; k <= rows; ++k) {
        float const y = abuse.next(psi);
        f.update(psi, y);
        auto const state = f.form();
        float sum = 0;  // NaN if a number is infinite or NaN
        for (int j = 0; j < d; ++j) {
            sum += 0 * state.theta[j] + 0 * state.D[j];
            for (int i = 0; i < j; ++i) sum += 0 * state.U(i, j);
        }
        out.not_finite += !(sum == 0);
        if (k % interval == 0) told(k, out);
        if (!beside.compare(
                abuse, psi, y, [&state](int i) { return state.theta[i]; }, out))
            continue;
        ++out.checked;
        bool const finite = sum == 0;
        out.not_definite +=
            !finite ||
            definiteness(f.stored().template mapped<Reference>([](float x) { return Reference(x); })) != Health::sound;
    }
    return out;
}

struct Length {
    long long rows, seed;
};

/// nullopt, and a line on standard error, for words that are no ROWS [SEED].
inline std::optional<Length> length_of(char const* program, int arguments, char** argument) {
    char* end = nullptr;
    Length const out{arguments > 1 ? std::strtoll(argument[1], &end, 10) : 0,
                     arguments > 2 ? std::strtoll(argument[2], nullptr, 10) : 71};
    if (out.rows >= 1 && out.rows <= 1'000'000'000'000 && !*end && arguments <= 3) return out;
    std::fprintf(stderr, "%s: expected ROWS [SEED], rows from 1 to 1e12\n", program);
    return {};
}

}  // namespace rlslab::long_run
