// A few threads that share the rows of one large update.
#pragma once

#include <rlslab/linalg/next_row.hpp>

#include <atomic>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace rlslab {

/// Threads for `update_block(psi, y, crew)`: this one and up to threads - 1 more, fewer where the system gives no more. While an update
/// runs they wait for one another without sleeping, each on a core of its own; half a millisecond after it they sleep. One crew may serve
/// many filters, one after another, not two at the same time. The bits are those of one thread: each row is computed by one of them, in
/// the same order of operations. Throws std::invalid_argument for less than one thread.
class Crew final : public Helpers {
    std::atomic<unsigned> started_{0};  // pieces of work so far
    std::atomic<unsigned> busy_{0};     // threads that have not finished the last one
    std::atomic<bool> leaving_{false};
    Work const* work_ = nullptr;
    std::vector<std::thread> threads_;

    /// Waits until `value` is no longer `old`: without sleeping for as long as an update may take, then asleep.
    static void wait(std::atomic<unsigned> const& value, unsigned old) {
        for (int turn = 0; turn < 50000; ++turn) {
            if (value.load(std::memory_order_acquire) != old) return;
            if (turn % 64 == 63) std::this_thread::yield();  // there may be fewer cores than threads
        }
        value.wait(old, std::memory_order_acquire);
    }
    void help(Index part) {
        for (unsigned seen = 0;;) {
            wait(started_, seen);
            ++seen;
            if (leaving_.load(std::memory_order_relaxed)) return;
            (*work_)(part, parts());
            busy_.fetch_sub(1, std::memory_order_acq_rel);
        }
    }

    void start(Index threads) {
        for (Index part = 1; part < threads; ++part) threads_.emplace_back(&Crew::help, this, part);
    }

public:
    explicit Crew(Index threads) {
        expects(threads >= 1, "at least one thread");
#ifdef __cpp_exceptions
        try {
            start(threads);
        } catch (std::system_error const&) {  // no more of them
        } catch (std::bad_alloc const&) {}
#else
        start(threads);
#endif
    }
    Crew(Crew const&) = delete;
    Crew& operator=(Crew const&) = delete;
    ~Crew() {
        leaving_ = true;
        ++started_;
        started_.notify_all();
        for (std::thread& t : threads_) t.join();
    }

    Index parts() const { return Index(threads_.size()) + 1; }
    void run(Work const& work) override {
        work_ = &work;
        busy_.store(unsigned(threads_.size()), std::memory_order_relaxed);
        started_.fetch_add(1, std::memory_order_acq_rel);
        started_.notify_all();
        work(0, parts());
        for (int turn = 1; busy_.load(std::memory_order_acquire) != 0; ++turn)
            if (turn % 64 == 0) std::this_thread::yield();
    }
};

}  // namespace rlslab
