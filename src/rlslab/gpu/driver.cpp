// NVIDIA's driver by dlopen, and the library's PTX as data.
#include <rlslab/gpu/driver.hpp>

#include <dlfcn.h>

#include <map>
#include <mutex>
#include <stdexcept>

asm(".section .rodata\n.global rlslab_ptx_first\nrlslab_ptx_first: .incbin \"" RLSLAB_PTX
    "\"\n.global rlslab_ptx_last\nrlslab_ptx_last: .byte 0\n.previous\n");
extern "C" char const rlslab_ptx_first[], rlslab_ptx_last[];

namespace rlslab::gpu::driver {
namespace {

using Address = unsigned long long;  // CUdeviceptr
using Result = int;                  // CUresult: 0 is success

/// The functions of libcuda that are called, and what they take.
// clang-format off
#define RLSLAB_FUNCTIONS(F)                                                                                         \
    F(cuInit, unsigned) F(cuGetErrorString, Result, char const**) F(cuDeviceGet, int*, int) F(cuCtxSynchronize)     \
    F(cuDeviceGetName, char*, int, int) F(cuDeviceGetAttribute, int*, int, int)                                     \
    F(cuDevicePrimaryCtxRetain, void**, int) F(cuCtxPushCurrent_v2, void*) F(cuCtxPopCurrent_v2, void**)            \
    F(cuPointerGetAttribute, void*, int, Address) F(cuModuleLoadData, void**, void const*)                          \
    F(cuModuleGetFunction, void**, void*, char const*) F(cuMemAlloc_v2, Address*, std::size_t)                      \
    F(cuMemFree_v2, Address)                                                                                        \
    F(cuMemcpyHtoD_v2, Address, void const*, std::size_t) F(cuMemcpyDtoH_v2, void*, Address, std::size_t)           \
    F(cuLaunchKernel, void*, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, void*, void**, \
      void**)
// clang-format on
struct Functions {
#define RLSLAB_MEMBER(NAME, ...) Result (*NAME)(__VA_ARGS__);
    RLSLAB_FUNCTIONS(RLSLAB_MEMBER)
};

class Driver {
    std::map<std::string, void*> kernels_;
    std::mutex mutex_;  // guards kernels_

public:
    Functions call{};
    int device = 0;
    void* context = nullptr;

    Driver() {
        void* const library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
        if (!library) throw std::runtime_error("no GPU: libcuda.so.1, NVIDIA's driver, is not installed");
#define RLSLAB_FIND(NAME, ...)                                                           \
    if (!(call.NAME = reinterpret_cast<Result (*)(__VA_ARGS__)>(dlsym(library, #NAME)))) \
        throw std::runtime_error("no GPU: libcuda.so.1 has no " #NAME);
        RLSLAB_FUNCTIONS(RLSLAB_FIND)
        check(call.cuInit(0), "no GPU");
        check(call.cuDeviceGet(&device, 0), "no GPU");
        int major = 0;
        check(call.cuDeviceGetAttribute(&major, 75, device), "no GPU");  // 75: of the compute capability
        if (major < 7) throw std::runtime_error("no GPU: one of compute capability 7.0 (Volta) or newer is needed");
        check(call.cuDevicePrimaryCtxRetain(&context, device), "no context on the GPU");
    }
    void check(Result result, std::string const& what) const {
        if (result == 0) return;
        char const* words = nullptr;
        call.cuGetErrorString(result, &words);
        throw std::runtime_error(what + ": " + (words ? words : "error " + std::to_string(result)));
    }
    void* kernel(std::string const& name) {
        std::lock_guard const lock(mutex_);
        void*& out = kernels_[name];
        if (out) return out;
        void* module = nullptr;
        check(call.cuModuleLoadData(&module, with_one_entry(name).c_str()), "the driver does not compile " + name);
        check(call.cuModuleGetFunction(&out, module, name.c_str()), "no kernel " + name);
        return out;
    }
    /// This kernel's PTX alone, compiled in a moment. The parts of kernels.cu follow each other, each from .version on.
    static std::string with_one_entry(std::string const& name) {
        std::string_view const all = ptx(), start = ".visible .entry ";
        std::size_t const at = all.find(std::string(start) + name + "(");
        if (at == all.npos) throw std::runtime_error("no kernel " + name);
        std::size_t const first = all.rfind("\n.version", at) + 1, behind = all.find("\n.version", at);
        std::string_view part = all.substr(first, behind == all.npos ? all.npos : behind - first);
        std::string out;
        while (!part.empty()) {
            std::size_t const entry = std::min(part.find(start), part.size());
            out += part.substr(0, entry);
            part.remove_prefix(entry);
            std::size_t const end = part.empty() ? 0 : part.find("\n}\n") + 3;
            if (part.substr(0, end).starts_with(std::string(start) + name + "(")) out += part.substr(0, end);
            part.remove_prefix(end);
        }
        return out;
    }
};
/// The driver, in the GPU's context until this ends: then the thread has the context that it had.
struct InContext {
    Driver& of;
    explicit InContext(Driver& d) : of(d) { d.check(d.call.cuCtxPushCurrent_v2(d.context), "no context on the GPU"); }
    InContext(InContext const&) = delete;
    ~InContext() {
        void* was;
        of.call.cuCtxPopCurrent_v2(&was);
    }
    Driver* operator->() const { return &of; }
};
InContext driver() {
    static Driver the_first;
    return InContext(the_first);
}

}  // namespace

void start() { driver(); }
std::string device_name() {
    char name[256] = {};
    driver()->check(driver()->call.cuDeviceGetName(name, sizeof name - 1, driver()->device), "no name of the GPU");
    return name;
}
void wait() { driver()->check(driver()->call.cuCtxSynchronize(), "the GPU failed"); }
void* kernel(std::string const& name) { return driver()->kernel(name); }
void launch(void* kernel, std::size_t blocks, unsigned threads, std::size_t shared, void const* argument) {
    InContext const d = driver();
    void* arguments[] = {const_cast<void*>(argument)};
    d->check(d->call.cuLaunchKernel(kernel, unsigned(blocks), 1, 1, threads, 1, 1, unsigned(shared), nullptr, arguments,
                                    nullptr),
             "the GPU does not start");
}
std::string_view ptx() { return {rlslab_ptx_first, std::size_t(rlslab_ptx_last - rlslab_ptx_first)}; }
std::uint64_t allocate(std::size_t bytes) {
    Address at = 0;
    if (bytes > 0)
        driver()->check(driver()->call.cuMemAlloc_v2(&at, bytes), std::to_string(bytes) + " bytes on the GPU");
    return at;
}
void release(std::uint64_t at) noexcept {
    try {
        driver()->call.cuMemFree_v2(at);
    } catch (std::exception const&) {}  // its context is gone, and the memory with it
}
void expect_here(void const* at) {
    int on = -1;
    InContext const d = driver();
    d->check(d->call.cuPointerGetAttribute(&on, 9, Address(at)), "rows that are not on the GPU");  // 9: the device
    if (on != d->device) throw std::invalid_argument("rows on GPU " + std::to_string(on) + ", expected the first");
}
void to_device(std::uint64_t to, void const* from, std::size_t bytes) {
    if (bytes > 0) driver()->check(driver()->call.cuMemcpyHtoD_v2(to, from, bytes), "no copy to the GPU");
}
void from_device(void* to, std::uint64_t from, std::size_t bytes) {
    if (bytes > 0) driver()->check(driver()->call.cuMemcpyDtoH_v2(to, from, bytes), "no copy from the GPU");
}

}  // namespace rlslab::gpu::driver
