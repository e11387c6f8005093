#include "corda/suite/crew.hpp"

#include <thread>
#include <utility>
#include <vector>

namespace corda::suite {

void Crew::later(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
    changed_.notify_one();
}

void Crew::next(Work work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_front(std::move(work));
    changed_.notify_one();
}

void Crew::run(int threads) {
    {
        std::vector<std::jthread> helpers;
        for (int i = 0; i < threads; ++i) helpers.emplace_back([this] { help(); });
    }
    if (error_) std::rethrow_exception(error_);
}

void Crew::help() {
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

}  // namespace corda::suite
