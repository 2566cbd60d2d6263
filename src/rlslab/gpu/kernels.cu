// The kernels of fleets: the library's variants as they are, a filter a lane, and teams of lanes for larger ones.
// Compiled by clang alone, without a CUDA toolkit (src/cmake/gpu.cmake), once for each of these parts:
//   RLSLAB_PART 1, 2   sizes 1 to 8      3, 4, 5   9 to 32 of the forms that have no team      6   teams
#define EIGEN_NO_CUDA
#define EIGEN_DONT_VECTORIZE
#include <rlslab/gpu/device.hpp>
#pragma clang force_cuda_host_device begin
#include <Eigen/Core>
#include <rlslab/gpu/kernels.hpp>
namespace rlslab {
void on_misuse(char const*) { __builtin_trap(); }  // which a program without exceptions may define
}  // namespace rlslab
#pragma clang force_cuda_host_device end

namespace {
using namespace rlslab;
using namespace rlslab::detail;

__device__ inline Index thread_of_grid(int threads) {
    return Index(__nvvm_read_ptx_sreg_ctaid_x()) * threads + __nvvm_read_ptx_sreg_tid_x();
}
/// The lanes of a warp, 16 or 32 of them, that have one filter. Both teams of a warp take each step together.
struct DeviceTeam {
    int lane, lanes;
    unsigned mask;
    template <class X>
    struct Own {
        X own;
        __device__ X& operator[](int) { return own; }
    };
    __device__ void alone(auto const& work) const {
        int here = lane;
        asm volatile("" : "+r"(here));  // so that no comparison or address is kept from row to row in a register
        work(here);
    }
    __device__ void meet() const { __nvvm_bar_warp_sync(~0u); }
    __device__ void each(auto const& work) const {
        alone(work);
        meet();
    }
    /// x is computed here, not where it is used.
    __device__ static void settle(float& x) { asm volatile("" : "+f"(x)); }
    __device__ static void settle(double& x) { asm volatile("" : "+d"(x)); }
    /// To each lane the number of the lane below.
    __device__ void up(auto& x) const {
        int words[sizeof x.own / 4];
        __builtin_memcpy(words, &x.own, sizeof words);
        for (int& word : words) word = __nvvm_shfl_sync_up_i32(~0u, word, 1, (32 - lanes) << 8);
        __builtin_memcpy(&x.own, words, sizeof words);
    }
    __device__ bool all(auto const& test) const {
        return (__nvvm_vote_ballot_sync(~0u, test(lane)) & mask) == mask;
    }
    __device__ bool any_team(bool of_this) const { return __nvvm_vote_any_sync(~0u, of_this); }
    __device__ bool every_team(bool of_this) const { return __nvvm_vote_all_sync(~0u, of_this); }
};
}  // namespace

#define RLSLAB_LANES(NAME, F, T, D)                                                                            \
    extern "C" __attribute__((global)) void __attribute__((launch_bounds(128)))                                \
        rlslab_##NAME##_##T##_##D(LaneRows<T> const in) {                                                      \
        Index const i = thread_of_grid(128);                                                                   \
        if (i < in.filters) take_rows<F<T, D>, D>(in, i);                                                      \
    }
#define RLSLAB_TEAM(NAME, T, LANES, N)                                                                         \
    extern "C" __attribute__((global)) void __attribute__((launch_bounds(512)))                                \
        rlslab_##NAME##_##T##_team_##LANES##_##N(LaneRows<T> const in) {                                       \
        extern __attribute__((shared, aligned(16))) double room[];                                               \
        int const thread = __nvvm_read_ptx_sreg_tid_x(), team = thread / LANES;                                \
        Index const together = __nvvm_read_ptx_sreg_ntid_x() / LANES;                                          \
        Index const filter = Index(__nvvm_read_ptx_sreg_ctaid_x()) * together + team;                          \
        if (filter >= in.filters) return;                                                                      \
        DeviceTeam const lanes{thread % LANES, LANES, LANES == 32 ? ~0u : 0xffffu << thread / 16 % 2 * 16};           \
        T* const own = reinterpret_cast<T*>(room) + team * in.room;                                         \
        team_##NAME<T, LANES, N>(lanes, in, filter, own);                                                      \
    }

#define RLSLAB_EIGHT(KERNELS, A, B, C, D, E, F, G, H) \
    KERNELS(A) KERNELS(B) KERNELS(C) KERNELS(D) KERNELS(E) KERNELS(F) KERNELS(G) KERNELS(H)
#if RLSLAB_PART == 1
RLSLAB_EIGHT(RLSLAB_WITH_TEAMS, 1, 2, 3, 4, 5, 6, 7, 8)
#elif RLSLAB_PART == 2
RLSLAB_EIGHT(RLSLAB_WITHOUT_TEAMS, 1, 2, 3, 4, 5, 6, 7, 8)
#elif RLSLAB_PART == 3
RLSLAB_EIGHT(RLSLAB_WITHOUT_TEAMS, 9, 10, 11, 12, 13, 14, 15, 16)
#elif RLSLAB_PART == 4
RLSLAB_EIGHT(RLSLAB_WITHOUT_TEAMS, 17, 18, 19, 20, 21, 22, 23, 24)
#elif RLSLAB_PART == 5
RLSLAB_EIGHT(RLSLAB_WITHOUT_TEAMS, 25, 26, 27, 28, 29, 30, 31, 32)
#else
RLSLAB_TEAMS(ud) RLSLAB_TEAMS(ud_delta) RLSLAB_TEAMS(conventional)
#endif
