// Filters of complex numbers, of any dense variant in float or double, by name: plain numbers in and out, the real part
// of each, then the imaginary one, as in an array of std::complex.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>

namespace rlslab::native {

/// M filters of m outputs each (rlslab::ComplexFleet): psi' is the conjugate transpose. Of several threads one at a
/// time may use it, also to read. Where an argument is refused std::invalid_argument is thrown, in one line, and it is
/// as it was.
class ComplexFleet {
    Index size_, filters_, outputs_;
    std::string_view variant_, arithmetic_;

protected:
    ComplexFleet(Index size, Index filters, Index outputs, std::string_view variant, std::string_view arithmetic)
        : size_(size), filters_(filters), outputs_(outputs), variant_(variant), arithmetic_(arithmetic) {}

public:
    virtual ~ComplexFleet() = default;
    Index size() const { return size_; }                         ///< d
    Index filters() const { return filters_; }                   ///< M
    Index outputs() const { return outputs_; }                   ///< m
    std::string_view variant() const { return variant_; }        ///< "ud"
    std::string_view arithmetic() const { return arithmetic_; }  ///< "float" or "double", of each part

    using Numbers = Fleet::Numbers;
    /// What the rows did; each array has room, or is null. NaN, and nonfinite, where a row was missing.
    struct Steps {
        double *innovation = nullptr, *residual = nullptr;  ///< rows x M x m complex numbers
        double* gamma = nullptr;                            ///< rows x M
        std::int32_t* health = nullptr;                     ///< rows x M, the worst of a filter's outputs
    };
    /// Rows for each filter, the oldest first: psi is rows x M x d and y rows x M x m complex numbers, without gaps, of
    /// one arithmetic; those of the other are rounded once. A row with a number that is not finite is missing: its
    /// filter stays as it was. Returns how many were missing.
    virtual Index update(Index rows, Numbers psi, Numbers y, Steps const& steps) = 0;
    virtual void theta(double* out) const = 0;  ///< M x d x m complex numbers
    virtual bool reports_covariance() const = 0;
    /// P, or P^-1, whichever is reported, of filter i: d x d complex numbers, by columns. By rows it is its conjugate.
    virtual void matrix(Index filter, double* out) const = 0;
    /// Undetermined until its rows determine theta, then the worst of its steps.
    virtual std::int32_t health(Index filter) const = 0;
    virtual void reset() = 0;  ///< as it was made
    std::size_t state_size() const { return save({}); }
    /// Returns state_size(); into an empty span it writes nothing.
    virtual std::size_t save(std::span<std::byte> to) const = 0;
    /// Of the same variant, arithmetic, size, number of filters and of outputs.
    virtual void load(std::span<std::byte const> from) = 0;
    virtual std::unique_ptr<ComplexFleet> clone() const = 0;
};

/// As `make`; of plain variants, with theta0 = 0 and P0 = c^2 I. Several outputs are of the variants that report P.
std::unique_ptr<ComplexFleet> make_complex(std::string_view variant, std::string_view arithmetic, Index filters,
                                           Index outputs, Options const& options);

}  // namespace rlslab::native
