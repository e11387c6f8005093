#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"

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

/// A queue of tasks for several threads; a task may add further ones.
class TaskQueue {
  public:
    using Task = std::function<void()>;

    /// Adds a task at the end.
    void push_back(Task task);
    /// Adds a task before all that wait.
    void push_front(Task task);
    /// Runs all tasks on `threads` threads, or on the calling one if the system starts none. Throws the
    /// exception of the first task that failed; those that wait by then are dropped.
    void run(int threads);

  private:
    void help();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Task> waiting_;
    unsigned busy_ = 0;
    std::exception_ptr error_;
};

/// Several threads make numbered things, each thread with a state of its own, and the caller takes them in
/// order. A thread that is too far ahead waits. For tasks without an order, see TaskQueue.
template <class Thing>
class OrderedWorkers : NonCopyable {
  public:
    /// Makes the thing of a number, on the thread that made the maker, until `all` is stopped.
    using Make = std::function<Thing(std::int64_t number, const OrderedWorkers& all)>;

    /// Begins to make things first <= i < end. A thread calls `new_maker` before the first thing that it
    /// makes, and again before the next one if `new_maker` threw. If the system starts no thread, none is
    /// made: see has_threads().
    OrderedWorkers(std::int64_t first, std::int64_t end, int threads, std::function<Make()> new_maker)
        : new_maker_(std::move(new_maker)),
          end_(end),
          ahead_(std::int64_t{2} * threads),
          next_(first),
          taken_(first) {
        threads_ = start_threads(threads, [this] { work(); });
    }
    ~OrderedWorkers() {
        stop();
        threads_.clear();
    }

    /// False if the system starts no thread: then nothing is made.
    [[nodiscard]] bool has_threads() const { return !threads_.empty(); }

    /// The next thing in order; std::nullopt if it is not there after a moment. Throws the exception that
    /// making it threw.
    std::optional<Thing> wait() {
        constexpr std::chrono::milliseconds kMoment{50};
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kMoment, [this] { return is_ready(); });
        if (!is_ready()) return std::nullopt;
        if (const auto failed = failures_.find(taken_); failed != failures_.end())
            std::rethrow_exception(failed->second);
        auto node = made_.extract(taken_++);
        changed_.notify_all();
        return std::move(node.mapped());
    }

    /// Makes the threads end.
    void stop() {
        const std::lock_guard lock(mutex_);
        is_stopped_ = true;
        changed_.notify_all();
    }
    [[nodiscard]] bool is_stopped() const { return is_stopped_; }
    /// The number of the next thing to be taken.
    [[nodiscard]] std::int64_t taken() const { return taken_; }

    /// After stop(): the next thing in order, perhaps incomplete; std::nullopt if there is none.
    std::optional<Thing> rest() {
        threads_.clear();  // joins them
        auto node = made_.extract(taken_++);
        return node.empty() ? std::nullopt : std::optional(std::move(node.mapped()));
    }

  private:
    [[nodiscard]] bool is_ready() const { return made_.contains(taken_) || failures_.contains(taken_); }

    /// The number of the next thing to make, once it is not too far ahead; std::nullopt at the end.
    std::optional<std::int64_t> take_number() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_stopped_ || next_ < taken_ + ahead_; });
        if (is_stopped_ || next_ >= end_) return std::nullopt;
        return next_++;
    }

    void work() {
        Make make;
        while (const auto number = take_number()) {
            std::optional<Thing> thing;
            std::exception_ptr failure;
            try {
                if (!make) make = new_maker_();
                thing.emplace(make(*number, *this));
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard lock(mutex_);
            if (failure)
                failures_.emplace(*number, failure);
            else
                made_.emplace(*number, std::move(*thing));
            changed_.notify_all();
        }
    }

    std::function<Make()> new_maker_;
    std::int64_t end_;
    std::int64_t ahead_;  ///< how many may be made or waiting at a time
    std::mutex mutex_;    ///< for the members below
    std::condition_variable changed_;
    std::int64_t next_;                ///< to be made
    std::atomic<std::int64_t> taken_;  ///< all before this one
    std::map<std::int64_t, Thing> made_;
    std::map<std::int64_t, std::exception_ptr> failures_;
    std::atomic<bool> is_stopped_ = false;
    std::vector<std::jthread> threads_;
};

}  // namespace corda
