// Fleets on a GPU behind C functions, for python/rlslab/_cuda.py: a library of its own, which no Python's version
// matters to. Each function returns 0, or writes one sentence to `words` (256 characters) and returns 1.
#include <rlslab/gpu/fleet.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <memory>

namespace rlslab::gpu {
namespace {

struct AnyFleet {
    virtual ~AnyFleet() = default;
    virtual void update(void const* psi, void const* y, std::int64_t const* strides) = 0;
    virtual void update_of_host(void const* psi, void const* y) = 0;
    virtual void thetas(double* to) const = 0;
    virtual void healths(unsigned char* to) const = 0;
    virtual std::int64_t missing() const = 0;
    virtual std::vector<std::byte> state() const = 0;
    virtual StateFault load(std::span<std::byte const> from) = 0;
};
template <class F>
struct FleetOf : AnyFleet {
    using T = typename F::scalar;
    Fleet<F> fleet;
    FleetOf(Index filters, Problem<double> const& problem)
        : fleet(filters, problem.mapped<T>([](double x) { return T(x); })) {}
    /// strides: of psi's filters and parameters and of y's filters, in numbers.
    void update(void const* psi, void const* y, std::int64_t const* strides) override {
        driver::wait();  // for whoever makes the rows, on any stream
        fleet.update(RowsThere<T>{static_cast<T const*>(psi), static_cast<T const*>(y), 1, Index(strides[0]),
                                  Index(strides[1]), 0, Index(strides[2]), 0});
        driver::wait();
    }
    void update_of_host(void const* psi, void const* y) override {
        Index const M = fleet.filters();
        fleet.update(Eigen::Map<Matrix<T> const>(static_cast<T const*>(psi), M, fleet.parameters()),
                     Eigen::Map<Vector<T> const>(static_cast<T const*>(y), M));
    }
    void thetas(double* to) const override {
        Eigen::Map<Matrix<double>>(to, fleet.filters(), fleet.parameters()) = fleet.thetas().template cast<double>();
    }
    void healths(unsigned char* to) const override {
        for (Health const health : fleet.healths()) *to++ = static_cast<unsigned char>(health);
    }
    std::int64_t missing() const override { return fleet.counts().missing; }
    std::vector<std::byte> state() const override { return state_of(fleet); }
    StateFault load(std::span<std::byte const> from) override { return rlslab::load(fleet, from); }
};
template <template <class, int> class... Forms>
std::unique_ptr<AnyFleet> made(std::string_view form, bool is_double, Index filters, Problem<double> const& problem) {
    std::unique_ptr<AnyFleet> out;
    auto const one = [&]<class OfDouble, class OfFloat>(std::type_identity<OfDouble>, std::type_identity<OfFloat>) {
        if (form != OfDouble::name) return;
        if (is_double) out = std::make_unique<FleetOf<OfDouble>>(filters, problem);
        else out = std::make_unique<FleetOf<OfFloat>>(filters, problem);
    };
    (one(std::type_identity<Forms<double, Dynamic>>{}, std::type_identity<Forms<float, Dynamic>>{}), ...);
    if (!out)
        throw std::invalid_argument(
            "no fleet of " + std::string(form) +
            " on a GPU; there are ud, ud_delta, conventional, carlson, gentleman, qr, inverse_qr");
    return out;
}
template <class Work>
int told(char* words, Work const& work) {
    try {
        work();
        return 0;
    } catch (std::exception const& failure) {
        std::strncpy(words, failure.what(), 255);
        return 1;
    }
}

}  // namespace
}  // namespace rlslab::gpu

using rlslab::gpu::AnyFleet, rlslab::gpu::told;
#define EXPORTED extern "C" __attribute__((visibility("default")))

/// variance 0: no prior; theta and covariance may be null.
EXPORTED int rlslab_gpu_make(AnyFleet** out, char const* form, int is_double, std::int64_t filters, std::int64_t size,
                             double forgetting, double variance, double const* theta, double const* covariance,
                             char* words) {
    return told(words, [&] {
        rlslab::Problem<double> problem{.size = size, .forgetting = forgetting, .prior = std::nullopt};
        if (variance != 0 || theta || covariance) {
            problem.prior = rlslab::Prior<double>{};
            if (variance != 0) problem.prior->variance = variance;
            if (theta) problem.prior->theta = Eigen::Map<rlslab::Vector<double> const>(theta, size);
            if (covariance)
                problem.prior->covariance = Eigen::Map<rlslab::Matrix<double> const>(covariance, size, size);
        }
        using namespace rlslab;
        *out = gpu::made<Ud, UdDelta, Conventional, Carlson, Gentleman, Qr, InverseQr>(form, is_double != 0, filters,
                                                                                       problem)
                   .release();
    });
}
EXPORTED void rlslab_gpu_drop(AnyFleet* fleet) { delete fleet; }
EXPORTED int rlslab_gpu_update(AnyFleet* fleet, void const* psi, void const* y, std::int64_t const* strides,
                               char* words) {
    return told(words, [&] {
        if (strides) fleet->update(psi, y, strides);
        else fleet->update_of_host(psi, y);
    });
}
EXPORTED int rlslab_gpu_read(AnyFleet* fleet, double* thetas, unsigned char* healths, std::int64_t* missing,
                             char* words) {
    return told(words, [&] {
        if (thetas) fleet->thetas(thetas);
        if (healths) fleet->healths(healths);
        if (missing) *missing = fleet->missing();
    });
}
/// The bytes of the state, or how many they are where `to` is null.
EXPORTED int rlslab_gpu_state(AnyFleet* fleet, char* to, std::int64_t* bytes, char* words) {
    return told(words, [&] {
        auto const state = fleet->state();
        *bytes = std::int64_t(state.size());
        if (to) std::memcpy(to, state.data(), state.size());
    });
}
EXPORTED int rlslab_gpu_load(AnyFleet* fleet, char const* from, std::int64_t bytes, char* words) {
    return told(words, [&] {
        auto const fault = fleet->load({reinterpret_cast<std::byte const*>(from), size_t(bytes)});
        if (fault != rlslab::StateFault::none)
            throw std::invalid_argument("a state that is " + std::string(name_of(fault)));
    });
}
