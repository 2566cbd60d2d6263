// NVIDIA's driver, loaded when the first fleet asks for it: no CUDA toolkit to build or to run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace rlslab::gpu {

/// The variants that have kernels (gpu/kernels.hpp).
inline constexpr std::string_view forms[] = {"ud",        "ud_delta", "conventional", "carlson",
                                             "gentleman", "qr",       "inverse_qr"};

/// The GPU that the driver names first, in the context that its other users in this process have (torch, cupy, jax).
/// Work goes to its default stream, in order. All throw std::runtime_error with the driver's words.
namespace driver {
/// Throws std::runtime_error, in one sentence, where no driver or no GPU is.
void start();
std::string device_name();
void wait();  ///< for all work on the GPU, whose ever
/// Throws unless the address is in this GPU's memory.
void expect_here(void const* at);
/// The kernel of that name, which the driver compiles out of the library's PTX at the first call (and keeps on disk).
void* kernel(std::string const& name);
/// One argument; shared: bytes of shared memory a block.
void launch(void* kernel, std::size_t blocks, unsigned threads, std::size_t shared, void const* argument);
std::string_view ptx();  ///< the library's own
std::uint64_t allocate(std::size_t bytes);
void release(std::uint64_t at) noexcept;
void to_device(std::uint64_t to, void const* from, std::size_t bytes);
void from_device(void* to, std::uint64_t from, std::size_t bytes);
}  // namespace driver

/// Numbers in the GPU's memory. data() is an address there.
template <class X>
class Memory {
    std::uint64_t at_ = 0;
    std::size_t count_ = 0;

public:
    Memory() = default;
    explicit Memory(std::size_t count) : at_(driver::allocate(count * sizeof(X))), count_(count) {}
    Memory(Memory&& other) noexcept : at_(std::exchange(other.at_, 0)), count_(std::exchange(other.count_, 0)) {}
    Memory& operator=(Memory&& other) noexcept {
        std::swap(at_, other.at_), std::swap(count_, other.count_);
        return *this;
    }
    ~Memory() {
        if (at_) driver::release(at_);
    }
    std::size_t size() const { return count_; }
    X* data() const { return reinterpret_cast<X*>(at_); }
    void write(std::size_t first, X const* from, std::size_t count) {
        driver::to_device(at_ + first * sizeof(X), from, count * sizeof(X));
    }
    void read(std::size_t first, X* to, std::size_t count) const {
        driver::from_device(to, at_ + first * sizeof(X), count * sizeof(X));
    }
};

}  // namespace rlslab::gpu
