#include "corda/golden/task_queue.hpp"

#include <utility>

#include "corda/core/threads.hpp"

namespace corda::golden {

void TaskQueue::push_back(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
    changed_.notify_one();
}

void TaskQueue::push_front(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_front(std::move(work));
    changed_.notify_one();
}

void TaskQueue::run(int threads) {
    {
        const auto helpers = start_threads(threads, [this] { help(); });
        if (helpers.empty()) help();
    }
    if (error_) std::rethrow_exception(error_);
}

void TaskQueue::help() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return !waiting_.empty() || busy_ == 0; });
        if (waiting_.empty()) return;
        Work work = std::move(waiting_.front());
        waiting_.pop_front();
        ++busy_;
        lock.unlock();
        std::exception_ptr error;
        try {
            work();
        } catch (...) {
            error = std::current_exception();
        }
        work = {};  // what it holds may be large, and is not to outlive it
        lock.lock();
        --busy_;
        if (error) waiting_.clear();
        if (error && !error_) error_ = error;
        changed_.notify_all();
    }
}

}  // namespace corda::golden
