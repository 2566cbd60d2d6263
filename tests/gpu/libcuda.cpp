// A libcuda of the tests' own: its memory is the host's, its kernels are the bodies of a GPU's, lane after lane.
// Compiled as for the device (src/cmake/gpu.cmake), with hidden symbols beside the library's own text for this
// processor.
#include <rlslab/gpu/kernels.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace rlslab::detail {
namespace {

struct HostTeam {
    int lanes;
    template <class X>
    struct Own {
        X of[32];
        X& operator[](int i) { return of[i]; }
    };
    void each(auto const& work) const {
        for (int i = 0; i < lanes; ++i) work(i);
    }
    void alone(auto const& work) const { each(work); }
    void meet() const {}
    static void settle(double) {}
    void up(auto& x) const { std::copy_backward(x.of, x.of + lanes - 1, x.of + lanes); }
    bool all(auto const& test) const {
        bool out = true;
        for (int i = 0; i < lanes; ++i) out = test(i) && out;
        return out;
    }
    bool any_team(bool) const { return true; }  // so that a row that is missing goes and is taken back
    bool every_team(bool present) const { return present; }
};
using Kernel = void (*)(void const*);

template <class F, int d, class T = typename F::scalar>
void as_lanes(void const* argument) {
    auto const& in = *static_cast<LaneRows<T> const*>(argument);
    for (Index i = 0; i < in.filters; ++i) take_rows<F, d>(in, i);
}
/// Saboteurs: one operation of Ud fused, or one of its sums in another order.
template <int d, bool fused>
struct Sabotaged : Ud<double, d> {
    Step<double> update(Regressor<double> psi, double y) {
        auto const form = this->form();
        double sum = 0, before[d];
        for (int j = d - 1; j >= 0; --j) sum += psi[j] * form.theta[j], before[j] = form.theta[j];
        Step<double> const step = Ud<double, d>::update(psi, y);
        if (fused) form.theta[2] = std::fma(step.innovation, form.K[2], before[2]);
        else
            for (int j = 0; j < d; ++j) form.theta[j] = before[j] + (y - sum) * form.K[j];
        return step;
    }
};

std::map<std::string, Kernel> const& kernels() {
    static std::map<std::string, Kernel> const all = [] {
        std::map<std::string, Kernel> out;
#define RLSLAB_LANES(NAME, F, T, D) out["rlslab_" #NAME "_" #T "_" #D] = as_lanes<F<T, D>, D>;
#define RLSLAB_TEAM(NAME, T, LANES, N)                                                                        \
    out["rlslab_" #NAME "_" #T "_team_" #LANES "_" #N] = [](void const* argument) {                           \
        auto const& in = *static_cast<LaneRows<T> const*>(argument);                                          \
        std::vector<T> room(size_t(in.room), T(7));                                                           \
        for (Index i = 0; i < in.filters; ++i) team_##NAME<T, LANES, N>(HostTeam{LANES}, in, i, room.data()); \
    };
        // clang-format off
        RLSLAB_WITH_TEAMS(4) RLSLAB_WITH_TEAMS(8)
        RLSLAB_WITHOUT_TEAMS(4) RLSLAB_WITHOUT_TEAMS(8) RLSLAB_WITHOUT_TEAMS(16)
        RLSLAB_TEAMS(ud) RLSLAB_TEAMS(ud_delta) RLSLAB_TEAMS(conventional)
            // clang-format on
            out["rlslab_ud_double_5"] = as_lanes<Sabotaged<5, true>, 5>;
        out["rlslab_ud_double_6"] = as_lanes<Sabotaged<6, false>, 6>;
        return out;
    }();
    return all;
}

}  // namespace
}  // namespace rlslab::detail

#define CUDA extern "C" __attribute__((visibility("default"))) int
CUDA cuInit(unsigned) { return 0; }
CUDA cuGetErrorString(int, char const** to) { return *to = "refused by the tests' own libcuda", 0; }
CUDA cuDeviceGet(int* to, int) { return *to = 0; }
CUDA cuDeviceGetName(char* to, int room, int) { return std::snprintf(to, size_t(room), "host"), 0; }
CUDA cuDevicePrimaryCtxRetain(void** to, int) { return *to = nullptr, 0; }
CUDA cuDeviceGetAttribute(int* to, int, int) { return *to = 7, 0; }
CUDA cuCtxPushCurrent_v2(void*) { return 0; }
CUDA cuCtxPopCurrent_v2(void**) { return 0; }
CUDA cuPointerGetAttribute(void* to, int, unsigned long long) { return *static_cast<int*>(to) = 0; }
CUDA cuCtxSynchronize() { return 0; }
CUDA cuModuleLoadData(void** to, void const* text) {
    return *to = nullptr, std::string(static_cast<char const*>(text)).find(".entry") == std::string::npos;
}
CUDA cuModuleGetFunction(void** to, void*, char const* name) {
    auto const& all = rlslab::detail::kernels();
    auto const found = all.find(name);
    if (found == all.end()) return 500;  // CUDA_ERROR_NOT_FOUND
    *to = reinterpret_cast<void*>(found->second);
    return 0;
}
CUDA cuMemAlloc_v2(unsigned long long* to, size_t bytes) {
    *to = reinterpret_cast<unsigned long long>(std::aligned_alloc(256, (bytes + 255) & ~size_t(255)));
    return *to == 0;
}
CUDA cuMemFree_v2(unsigned long long at) { return std::free(reinterpret_cast<void*>(at)), 0; }
CUDA cuMemcpyHtoD_v2(unsigned long long to, void const* from, size_t bytes) {
    return std::memcpy(reinterpret_cast<void*>(to), from, bytes), 0;
}
CUDA cuMemcpyDtoH_v2(void* to, unsigned long long from, size_t bytes) {
    return std::memcpy(to, reinterpret_cast<void const*>(from), bytes), 0;
}
CUDA cuLaunchKernel(void* kernel, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, void*,
                    void** arguments, void**) {
    return reinterpret_cast<rlslab::detail::Kernel>(kernel)(arguments[0]), 0;
}
