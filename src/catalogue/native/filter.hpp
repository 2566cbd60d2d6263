// A filter of any dense variant in float or double, alone or composed, by name, behind an interface of plain numbers.
// Needs headers and Eigen where it is compiled, and neither where it is used.
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace rlslab::native {

using Index = std::ptrdiff_t;

/// What one row did, rlslab::Step with numbers in binary64. `health` is an rlslab::Health (0 sound, 1 undetermined,
/// 2 indefinite, 3 nonfinite); `signal` an rlslab::GuardSignal (0 none, 1 unusable, 2 breakdown, 3 change, 4 outlier,
/// 5 windup), none without a guard.
struct Step {
    double innovation, residual, gamma;
    std::int32_t health, signal;
    bool sound() const { return health == 0; }
};
static_assert(sizeof(Step) == 32);

std::string_view name_of_health(std::int32_t health);
std::string_view name_of_signal(std::int32_t signal);

/// A member that is left at its value here has the library's default.
struct Options {
    Index size = 0;                                ///< d >= 1
    double forgetting = 1;                         ///< lambda, 0 < lambda <= 1
    double prior_variance = 16384;                 ///< c^2 of P0 = c^2 I; 0: no prior
    double const* prior_theta = nullptr;           ///< theta0, d numbers; null: 0
    double const* prior_covariance = nullptr;      ///< P0, d x d, symmetric; null: c^2 I
    Index window = 0;                              ///< rows; 0: none
    std::string_view guard = {};                   ///< a policy's name (guards()); empty: none
    std::string_view control = {};                 ///< the name of a rule of forgetting (controls()); empty: constant
    std::span<double const> control_numbers = {};  ///< the rule's, in its order; NaN or missing: its default, if any

    // Of the guard (GuardOptions): NaN, or 0 rows, is the default.
    static constexpr double unset = std::numeric_limits<double>::quiet_NaN();
    double largest_variance = unset, innovation = unset, least_noise = unset, asymmetry = unset;
    Index noise_memory = 0, rebuild_rows = 0;

    Index certify = 0;  ///< probes of a certificate (rlslab::Certified), up to 6; 0: none. 3 where in doubt
    Index digits = 0;   ///< of P that the guard asks of the probes: their bound above 10^-digits at a 100th row is a
                        ///< breakdown; 0: none. Not in a state
};

/// What the probes of a filter show, rlslab::Certificate: `bound` is above the error ||Phat P^-1 - I||_F of P but with
/// probability 0.08^probes, `theta` above that of theta where it is.
struct Certificate {
    double estimate, bound, theta;
    bool definite;
};

/// What happened so far. Counts of what is not part of the filter stay 0.
struct Counts {
    std::int64_t rows = 0;  ///< offered since it was made, reset or loaded
    std::int64_t unusable = 0, outliers = 0, changes = 0, windups = 0, breakdowns = 0;  ///< as the guard counts them
    std::int64_t refactored = 0;  ///< times that the window's rows were factored anew
    std::int64_t since = 0;       ///< rows since then, or since the start
};

/// What the removal of a row did, as rlslab::Removal: alpha^2 = 1 - w psi'P psi, of the P before, and the error of the
/// removal in units of u / alpha^2.
struct Removal {
    double remaining, noise;
    bool refused() const { return !(0 < remaining); }
};
struct Excitation {
    double deviation, ratio;
};

/// One filter. Of several threads one at a time may use it, also to read. Where an argument is refused
/// std::invalid_argument is thrown, in one line, and the filter is as it was.
class Filter {
public:
    struct Inside;  ///< what a Filter is
    virtual ~Filter() = default;
    Index size() const;                   ///< d
    std::string_view variant() const;     ///< "ud"
    std::string_view arithmetic() const;  ///< "float" or "double"

    /// One row, psi of d numbers. Numbers of the other arithmetic are rounded once. Allocates nothing.
    Step update(double const* psi, double y);
    Step update(float const* psi, float y);
    /// Many rows, the oldest first, each of d contiguous numbers, `stride` >= d numbers apart (0: d). `steps` has room
    /// for all, or is null: then rows are processed as `rlslab::process` does, the fast way where the variant has one,
    /// with the same bits; qr_block, which takes blocks, reports NaN and its health then. Returns the last row's step.
    Step update_many(double const* psi, Index rows, Index stride, double const* y, Step* steps);
    Step update_many(float const* psi, Index rows, Index stride, float const* y, Step* steps);
    /// Rows with weights: sum_i lambda^(k-i) w_i (y_i - psi_i'theta)^2 is minimised, w = 1/v where a row's noise has v
    /// times the variance of the others (Weighted of <rlslab/adapt/weighted.hpp>, around the filter as it is). The
    /// filter takes the row (sqrt(w) psi, sqrt(w) y), and its state is that of the filter inside; the step and the gain
    /// are in y's unit. w = 1: the bits of a row without one. w = 0, a missing output: as pass_time, whatever psi and
    /// y are, but innovation and residual are NaN. w < 0, infinite or NaN: nothing changes, health is nonfinite, signal
    /// none. w is rounded once.
    Step update(double const* psi, double y, double weight);
    Step update(float const* psi, float y, float weight);
    /// As update_many, with as many weights as rows; null: all 1.
    Step update_many(double const* psi, Index rows, Index stride, double const* y, double const* weights, Step* steps);
    Step update_many(float const* psi, Index rows, Index stride, float const* y, float const* weights, Step* steps);
    /// Time without a row: P / lambda.
    Step pass_time();
    /// Takes a row of weight w back that the filter holds (rlslab::remove): w = lambda^n for a row n steps old, times
    /// its own weight. The last row's step stays, and a gain that is stored. w = 0 changes nothing. Refused, and no bit
    /// of the state has changed: where nothing would remain, w < 0, or a number is not finite. Throws where downdates()
    /// is false.
    Removal remove(double const* psi, double y, double weight = 1);
    bool downdates() const;  ///< a plain variant, or one with probes, but kalman, extended_qr and qr_block
    /// Appends the rows of `newer`, made without a prior: as if this one had taken them, but for rounding. health() is
    /// then of all rows. Throws unless both are qr_block of one arithmetic, size and forgetting.
    void merge(Filter const& newer);

    void theta(double* out) const;  ///< d numbers
    /// d numbers, of the last row: theta(k) = theta(k-1) + gain innovation. After a load, of the row as the filter took
    /// it: 1/sqrt(w) of it where that had a weight.
    void gain(double* out) const;
    /// Whether covariance() is reported; else information() is.
    bool reports_covariance() const;
    /// P, or P^-1: d x d, by columns. By rows it is the same, except that a P in full storage (conventional) may have
    /// lost its symmetry.
    void covariance(double* out) const;
    void information(double* out) const;
    /// psi'P psi of each row, in the numbers of the form, P not formed: the variance of psi'theta in units of the
    /// noise's. Psi as of update_many; out: a number a row. NaN while the rows do not determine theta. Throws of kalman
    /// alone, extended_qr and qr_block.
    void variance(double const* Psi, Index rows, Index stride, double* out) const;
    /// F, d x d, by columns, F F' = P or P^-1, whichever is reported: of the variants that store a root (of qr and
    /// qr_block F = R').
    void factor(double* out) const;
    /// n draws of theta + scale S z, S S' = P, n x d by rows (rlslab::sample): the same of every language and machine,
    /// draw k whatever n is. NaN where the rows do not determine theta or P is not definite. Throws where P or P^-1 is
    /// stored itself, and no factor, for n < 0, and for a scale < 0, infinite or NaN.
    void sample(std::uint64_t seed, Index n, double scale, double* out) const;
    bool stores_a_root() const;  ///< of P or P^-1; `ud` and `gentleman` of a D too, which has roots
    /// Where the filter's rows say least (rlslab::least_excited): the direction, d numbers, its standard deviation in
    /// units of the noise's, and the ratio of its variance to the average, from 1 to d, in units of each parameter's
    /// deviation. NaN and throws as sample.
    Excitation least_excited(double* direction) const;

    /// The state, as rlslab::save writes it of the C++ type. `to`: state_size() bytes, or more.
    std::size_t state_size() const;
    void save(std::span<std::byte> to) const;
    /// Into a filter of the same variant, arithmetic, size and composition; forgetting and prior may be others.
    void load(std::span<std::byte const> from);

    /// Of the last row; of `load`: undetermined where theta is NaN or was not determined.
    std::int32_t health() const;
    std::int32_t signal() const;  ///< of the last row
    Counts counts() const;
    Index probes() const;  ///< 0: none
    /// What they show now; the filter stays as it is. Throws std::invalid_argument where there are none.
    Certificate certificate() const;
    void reset();  ///< as it was made
    std::unique_ptr<Filter> clone() const;
};

/// Throws std::invalid_argument for a name that is none, options that no filter has, and a composition that the variant
/// cannot carry, with its reason.
std::unique_ptr<Filter> make(std::string_view variant, std::string_view arithmetic, Options const& options);

/// What `make` is given for a filter that can go on from a state, as far as the state says it by name: variant,
/// arithmetic, size, window, guard and control with those of their options that are not the default. Forgetting, prior
/// and a guard's largest_variance are among the state's numbers. Throws std::invalid_argument, in one line, for bytes
/// that are no state, damaged, or of something that has no name here.
struct Saved {
    std::string_view variant, arithmetic;
    Options options = {};  ///< but control_numbers
    std::vector<double> control_numbers = {};
    Index outputs = 0;  ///< of several (native/outputs.hpp); 0: the state is of a filter
};
Saved saved(std::span<std::byte const> state);
/// A filter made so, gone on from the state: as the one that was saved, bit for bit, until `reset`, which starts with
/// the default forgetting and prior. Throws as `saved`, `make` and `load`.
std::unique_ptr<Filter> from_state(std::span<std::byte const> state);

/// The names that `make` takes, in the order of the library's lists: 18 variants, "float" and "double", the policies of
/// guards, the rules of forgetting.
std::span<std::string_view const> variants();
std::span<std::string_view const> arithmetics();
std::span<std::string_view const> guards();
std::span<std::string_view const> controls();

/// M filters of one variant and one problem, of m outputs each, of real or complex numbers (a number is then two, its
/// real part first), which take a row each at a time: in lockstep (rlslab::Fleet; several outputs and complex numbers:
/// rlslab::OutputFleet), or, where they are guarded, windowed, ruled or followed by probes, one after another.
class Fleet {
protected:
    struct Shape {
        Index size, filters, outputs;
        bool is_complex;
        std::string_view variant, arithmetic;
    };
    explicit Fleet(Shape const& shape) : shape_(shape) {}

public:
    virtual ~Fleet() = default;
    Index size() const { return shape_.size; }                         ///< d
    Index filters() const { return shape_.filters; }                   ///< M
    Index outputs() const { return shape_.outputs; }                   ///< m
    bool is_complex() const { return shape_.is_complex; }              ///< else real
    std::string_view variant() const { return shape_.variant; }        ///< "ud"
    std::string_view arithmetic() const { return shape_.arithmetic; }  ///< "float" or "double", of each part
    using Numbers = std::variant<double const*, float const*>;
    /// A Step of complex numbers.
    struct ComplexStep {
        std::complex<double> innovation, residual;
        double gamma;
        std::int32_t health, signal;
    };
    using Steps = std::variant<Step*, ComplexStep*>;
    /// Rows for each filter, the oldest first, without gaps: psi is count x M x d, y count x M x m, weights count x M
    /// real numbers, or null: all 1. Numbers of the other arithmetic are rounded once; all are of one. A row with a
    /// number that is not finite, or sqrt(w) times which is not, is missing: its filter stays as it was. w as of
    /// Filter::update. steps: room for count x M x m of the fleet's kind, or null; NaN and nonfinite where the row was
    /// missing. Returns how many were missing.
    struct Rows {
        Index count;
        Numbers psi, y, weights = static_cast<double const*>(nullptr);
        Steps steps = static_cast<Step*>(nullptr);
        bool weighs() const {
            return std::visit([](auto* w) { return w != nullptr; }, weights);
        }
    };
    virtual Index update(Rows const& rows) = 0;
    /// One row for each.
    Index update(Numbers psi, Numbers y, Step* steps = nullptr) {
        return update({.count = 1, .psi = psi, .y = y, .steps = steps});
    }
    void theta(Index filter, double* out) const { health(filter, out); }  ///< d x m numbers, by rows
    /// undetermined, then the worst of its steps, of guarded filters the last step whose row was usable; and its theta
    /// where asked.
    virtual std::int32_t health(Index filter, double* theta = nullptr) const = 0;
    /// P of a filter, or P^-1, d x d numbers by columns as Filter's, or null: which one of the two is answered.
    virtual bool matrix(Index filter, double* out) const = 0;
    virtual void reset(Index filter) = 0;
    std::size_t state_size() const { return save({}); }
    /// Returns state_size(); into an empty span it writes nothing.
    virtual std::size_t save(std::span<std::byte> to) const = 0;
    /// Of the same variant, arithmetic, composition, size, and number of filters and outputs.
    virtual void load(std::span<std::byte const> from) = 0;
    virtual std::unique_ptr<Fleet> clone() const = 0;

private:
    Shape shape_;
};

/// As `make`; qr_block has no fleet but a composed one. Several outputs are of plain variants that report P.
std::unique_ptr<Fleet> make_fleet(std::string_view variant, std::string_view arithmetic, Index filters,
                                  Options const& options, Index outputs = 1);
/// The same of complex numbers: plain variants, theta0 = 0 and P0 = c^2 I. psi' is the conjugate transpose.
std::unique_ptr<Fleet> make_complex(std::string_view variant, std::string_view arithmetic, Index filters, Index outputs,
                                    Options const& options);

}  // namespace rlslab::native
