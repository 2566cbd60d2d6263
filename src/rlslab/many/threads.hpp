// Work divided among threads.
#pragma once

#include <rlslab/core/concept.hpp>
#include <rlslab/linalg/team.hpp>

#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace rlslab {
namespace detail {

/// work(0) ... work(n - 1), each in a thread, the first in this one; where the system gives no more threads, this one
/// also does the rest in turn. work must not throw. Returns when all is done.
template <class Work>
void among_threads(Index n, Work const& work) {
    struct Joined {  // not std::jthread, which libc++ 14 does not have
        std::vector<std::thread> threads;
        ~Joined() {
            for (std::thread& t : threads) t.join();
        }
    } others;
    Index started = 1;
    try {
        for (; started < n; ++started) others.threads.emplace_back(work, started);
    } catch (std::system_error const&) {}
    work(Index(0));
    for (; started < n; ++started) work(started);
}

/// Where the threads of a team wait for each other: for some microseconds awake, then other threads may go first.
struct Meeting {
    std::atomic<Index> here{0}, times{0};
    Index count = 0;

    static void until(auto const& come) {
        for (int looks = 0; !come(); ++looks)
            if (looks > 4000) std::this_thread::yield();
    }
    void wait() {
        Index const now = times.load(std::memory_order_relaxed);
        if (here.fetch_add(1, std::memory_order_acq_rel) + 1 == count) {
            here.store(0, std::memory_order_relaxed);
            times.store(now + 1, std::memory_order_release);
        } else {
            until([&] { return times.load(std::memory_order_acquire) != now; });
        }
    }
};
/// work(with, seat) in each thread at the same time, in as many as the system gives.
inline void run_team(Index threads, void (*work)(void*, Seat const&), void* with) {
    Meeting meeting;
    std::atomic<Index> count{0};
    auto const take_seat = [&](Index i) {
        Meeting::until([&] { return count.load(std::memory_order_acquire) != 0; });
        work(with, {i, count.load(std::memory_order_relaxed), &meeting});
    };
    std::vector<std::thread> others;
    others.reserve(size_t(threads));
    try {
        while (Index(others.size()) + 1 < threads) others.emplace_back(take_seat, Index(others.size()) + 1);
    } catch (std::system_error const&) {}
    meeting.count = Index(others.size()) + 1;
    count.store(meeting.count, std::memory_order_release);
    take_seat(0);
    for (std::thread& t : others) t.join();
}

}  // namespace detail

/// From now on n >= 1 threads share the work on each block of rows (update_block) in float and double, in all filters;
/// one at the start. The bits are the same for any n. A block at work stays with the threads that it has. Throws
/// std::invalid_argument for n < 1 or more than 1024.
inline void use_threads(Index n) {
    expects(1 <= n && n <= 1024, "1 to 1024 threads");
    [[maybe_unused]] static bool const there = [] {
        detail::the_team.run = detail::run_team;
        detail::the_team.wait = [](void* meeting) { static_cast<detail::Meeting*>(meeting)->wait(); };
        return true;
    }();
    detail::the_team.threads.store(n, std::memory_order_release);
}

}  // namespace rlslab
