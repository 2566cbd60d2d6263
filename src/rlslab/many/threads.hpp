// Work divided among threads.
#pragma once

#include <rlslab/core/concept.hpp>

#include <system_error>
#include <thread>
#include <vector>

namespace rlslab::detail {

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

}  // namespace rlslab::detail
