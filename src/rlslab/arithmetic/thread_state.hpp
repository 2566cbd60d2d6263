// The state of a thread on which an arithmetic's results depend: set for a while, and passed from the calling thread to
// other threads that do parts of its work.
#pragma once

#include <cstdint>

namespace rlslab {

namespace detail {
/// Sets a value for this thread until this object is destroyed. Then the previous one applies again.
template <class Value>
class [[nodiscard]] ThreadScope {
    static inline constinit thread_local Value current_{};
    Value previous_;

protected:
    static Value const& now() { return current_; }

public:
    explicit ThreadScope(Value const& value) : previous_(current_) { current_ = value; }
    ~ThreadScope() { current_ = previous_; }
    ThreadScope(ThreadScope const&) = delete;
    ThreadScope& operator=(ThreadScope const&) = delete;
};
}  // namespace detail

/// Make a ThreadState<T> in the calling thread before the other threads start; it must outlive them. A thread makes a
/// ThreadState<T>::Part with the number of the part that it is about to compute, and destroys it when the part is
/// finished. Meanwhile T computes there with the calling thread's state. The results depend on the number of the part,
/// not on the thread. Most arithmetics have no such state. An arithmetic with a length, a random stream or a tally
/// specialises ThreadState beside its definition.
template <class T>
struct ThreadState {
    struct Part {
        Part(ThreadState const&, std::uint64_t) {}
    };
};

}  // namespace rlslab
