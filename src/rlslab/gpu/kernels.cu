// The kernels of fleets: the library's variants as they are, a filter a lane, and teams of lanes for larger ones.
// Compiled by clang alone, without a CUDA toolkit (cmake/gpu.cmake), once for each of these parts:
//   RLSLAB_PART 1, 2   sizes 1 to 8      3, 4, 5   9 to 32 of the forms that have no team      6   teams
#define EIGEN_NO_CUDA
#define EIGEN_DONT_VECTORIZE
#include <rlslab/gpu/device.hpp>
#pragma clang force_cuda_host_device begin
#include <Eigen/Core>
#include <rlslab/gpu/kernels.hpp>
#include <rlslab/gpu/team.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>
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
/// The lanes of a warp, 16 or 32 of them, that have one filter.
struct DeviceTeam {
    int lane;
    unsigned mask;
    template <class Work>
    __device__ void each(Work const& work) const {
        int here = lane;
        asm volatile("" : "+r"(here));  // so that no comparison with it is kept from row to row in a register
        work(here);
        __nvvm_bar_warp_sync(mask);
    }
    template <class Test>
    __device__ bool all(Test const& test) const {
        return __nvvm_vote_all_sync(mask, test(lane));
    }
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
        extern __attribute__((shared)) TwoNumbers<double> room[];                                              \
        int const thread = __nvvm_read_ptx_sreg_tid_x(), team = thread / LANES;                                \
        Index const together = __nvvm_read_ptx_sreg_ntid_x() / LANES;                                          \
        Index const filter = Index(__nvvm_read_ptx_sreg_ctaid_x()) * together + team;                          \
        if (filter >= in.filters) return;                                                                      \
        DeviceTeam const lanes{thread % LANES, LANES == 32 ? ~0u : 0xffffu << thread / 16 % 2 * 16};           \
        T* const own = reinterpret_cast<T*>(room) + team * team_room<LANES>(in.words);                      \
        team_##NAME<T, LANES, N>(lanes, in, filter, own);                                                      \
    }

#if RLSLAB_PART == 1
RLSLAB_WITH_TEAMS(1) RLSLAB_WITH_TEAMS(2) RLSLAB_WITH_TEAMS(3) RLSLAB_WITH_TEAMS(4)
RLSLAB_WITH_TEAMS(5) RLSLAB_WITH_TEAMS(6) RLSLAB_WITH_TEAMS(7) RLSLAB_WITH_TEAMS(8)
#elif RLSLAB_PART == 2
RLSLAB_WITHOUT_TEAMS(1) RLSLAB_WITHOUT_TEAMS(2) RLSLAB_WITHOUT_TEAMS(3) RLSLAB_WITHOUT_TEAMS(4)
RLSLAB_WITHOUT_TEAMS(5) RLSLAB_WITHOUT_TEAMS(6) RLSLAB_WITHOUT_TEAMS(7) RLSLAB_WITHOUT_TEAMS(8)
#elif RLSLAB_PART == 3
RLSLAB_WITHOUT_TEAMS(9) RLSLAB_WITHOUT_TEAMS(10) RLSLAB_WITHOUT_TEAMS(11) RLSLAB_WITHOUT_TEAMS(12)
RLSLAB_WITHOUT_TEAMS(13) RLSLAB_WITHOUT_TEAMS(14) RLSLAB_WITHOUT_TEAMS(15) RLSLAB_WITHOUT_TEAMS(16)
#elif RLSLAB_PART == 4
RLSLAB_WITHOUT_TEAMS(17) RLSLAB_WITHOUT_TEAMS(18) RLSLAB_WITHOUT_TEAMS(19) RLSLAB_WITHOUT_TEAMS(20)
RLSLAB_WITHOUT_TEAMS(21) RLSLAB_WITHOUT_TEAMS(22) RLSLAB_WITHOUT_TEAMS(23) RLSLAB_WITHOUT_TEAMS(24)
#elif RLSLAB_PART == 5
RLSLAB_WITHOUT_TEAMS(25) RLSLAB_WITHOUT_TEAMS(26) RLSLAB_WITHOUT_TEAMS(27) RLSLAB_WITHOUT_TEAMS(28)
RLSLAB_WITHOUT_TEAMS(29) RLSLAB_WITHOUT_TEAMS(30) RLSLAB_WITHOUT_TEAMS(31) RLSLAB_WITHOUT_TEAMS(32)
#else
RLSLAB_TEAMS(ud) RLSLAB_TEAMS(ud_delta) RLSLAB_TEAMS(conventional)
#endif
