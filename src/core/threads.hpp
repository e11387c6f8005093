#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace corda {

/// Starts up to `count` threads that do `work`. Returns those that the system started: perhaps fewer, perhaps
/// none. `work` is copied to each.
template <class Work>
[[nodiscard]] std::vector<std::jthread> start_threads(int count, const Work& work) {
    std::vector<std::jthread> threads;
    threads.reserve(static_cast<std::size_t>(std::max(0, count)));
    try {
        for (int i = 0; i < count; ++i) threads.emplace_back(work);
    } catch (const std::system_error&) {  // fewer will do
    }
    return threads;
}

/// Starts and joins `count` threads. Returns false if the system starts fewer at a time.
[[nodiscard]] inline bool can_start_threads(int count) {
    std::mutex mutex;
    std::condition_variable changed;
    bool may_end = false;
    const auto threads = start_threads(count, [&] {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return may_end; });
    });
    const std::lock_guard lock(mutex);
    may_end = true;
    changed.notify_all();
    return static_cast<int>(threads.size()) == count;
}

}  // namespace corda
