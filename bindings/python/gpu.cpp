// Fleets on a GPU behind C functions, for rlslab/_cuda.py of Python: a library of its own, which no Python's version
// matters to. Each function returns 0, or writes one sentence to `words` (256 characters) and returns 1, or 2.
#include <rlslab/gpu/fleet.hpp>
#include <rlslab/gpu/kernels.hpp>
#include <rlslab/state/state.hpp>

#include <memory>

namespace rlslab::gpu {
namespace {

struct AnyFleet {
    virtual ~AnyFleet() = default;
    /// strides: of psi's filters and parameters and of y's filters, in numbers, of rows on the GPU; null: the host's.
    virtual void update(void const* psi, void const* y, std::int64_t const* strides) = 0;
    /// What is not null.
    virtual void read(double* thetas, unsigned char* healths, std::int64_t* missing) const = 0;
    virtual std::vector<std::byte> state() const = 0;
    virtual StateFault load(std::span<std::byte const> from) = 0;
};
template <class F>
struct FleetOf : AnyFleet {
    using T = typename F::scalar;
    Fleet<F> fleet;
    FleetOf(Index filters, Problem<double> const& problem)
        : fleet(filters, problem.mapped<T>([](double x) { return T(x); })) {}
    void update(void const* psi, void const* y, std::int64_t const* strides) override {
        T const *const P = static_cast<T const*>(psi), *const v = static_cast<T const*>(y);
        Index const M = fleet.filters(), d = fleet.parameters();
        if (!strides) return fleet.update(Eigen::Map<Matrix<T> const>(P, M, d), Eigen::Map<Vector<T> const>(v, M));
        driver::expect_here(P), driver::expect_here(v);
        driver::wait();  // for whoever makes the rows, on any stream
        fleet.update(RowsThere<T>{P, v, 1, Index(strides[0]), Index(strides[1]), 0, Index(strides[2]), 0});
        driver::wait();
    }
    void read(double* thetas, unsigned char* healths, std::int64_t* missing) const override {
        if (thetas)
            Eigen::Map<Matrix<double>>(thetas, fleet.filters(), fleet.parameters()) =
                fleet.thetas().template cast<double>();
        if (healths)
            for (Health const health : fleet.healths()) *healths++ = static_cast<unsigned char>(health);
        if (missing) *missing = fleet.counts().missing;
    }
    std::vector<std::byte> state() const override { return state_of(fleet); }
    StateFault load(std::span<std::byte const> from) override { return rlslab::load(fleet, from); }
};
std::unique_ptr<AnyFleet> made(std::string_view form, bool is_double, Index filters, Problem<double> const& problem) {
    std::unique_ptr<AnyFleet> out;
    auto const make = [&]<class F>(std::type_identity<F>) { out = std::make_unique<FleetOf<F>>(filters, problem); };
    if (is_double ? of_form<double>(form, make) : of_form<float>(form, make)) return out;
    std::string others;
    for (std::string_view const other : forms) others += (others.empty() ? "" : ", ") + std::string(other);
    throw std::invalid_argument("no fleet of " + std::string(form) + " on a GPU; there are " + others);
}
template <class Work>
int told(char* words, Work const& work) {
    try {
        work();
        return 0;
    } catch (std::exception const& failure) {
        std::strncpy(words, failure.what(), 255);
        return dynamic_cast<std::invalid_argument const*>(&failure) ? 2 : 1;
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
        rlslab::expects(variance != 0 || covariance || !theta, "a prior variance or covariance beside a prior theta");
        if (variance != 0 || covariance) {
            problem.prior = rlslab::Prior<double>{};
            if (variance != 0) problem.prior->variance = variance;
            if (theta) problem.prior->theta = Eigen::Map<rlslab::Vector<double> const>(theta, size);
            if (covariance)
                problem.prior->covariance = Eigen::Map<rlslab::Matrix<double> const>(covariance, size, size);
        }
        *out = rlslab::gpu::made(form, is_double != 0, filters, problem).release();
    });
}
EXPORTED void rlslab_gpu_drop(AnyFleet* fleet) { delete fleet; }
EXPORTED int rlslab_gpu_update(AnyFleet* fleet, void const* psi, void const* y, std::int64_t const* strides,
                               char* words) {
    return told(words, [&] { fleet->update(psi, y, strides); });
}
EXPORTED int rlslab_gpu_read(AnyFleet* fleet, double* thetas, unsigned char* healths, std::int64_t* missing,
                             char* words) {
    return told(words, [&] { fleet->read(thetas, healths, missing); });
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
