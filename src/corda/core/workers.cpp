#include "corda/core/workers.hpp"

#include <utility>

namespace corda {

void TaskQueue::push_back(Task task) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(task));
    changed_.notify_one();
}

void TaskQueue::push_front(Task task) {
    const std::lock_guard lock(mutex_);
    waiting_.push_front(std::move(task));
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
        Task task = std::move(waiting_.front());
        waiting_.pop_front();
        ++busy_;
        lock.unlock();
        std::exception_ptr error;
        try {
            task();
        } catch (...) {
            error = std::current_exception();
        }
        task = {};  // its data may be large
        lock.lock();
        --busy_;
        if (error) waiting_.clear();
        if (error && !error_) error_ = error;
        changed_.notify_all();
    }
}

}  // namespace corda
