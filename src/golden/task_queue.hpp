#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>

namespace corda::golden {

/// Pieces of work that a few threads do, and that may add more of them.
class TaskQueue {
  public:
    using Work = std::function<void()>;

    /// Work for when nothing of push_front() is left.
    void push_back(Work work);
    /// Work that is done before all that waits.
    void push_front(Work work);
    /// Does all work on `threads` threads, or on the calling one if the system starts none. Throws what the
    /// first piece that failed threw; what was not begun by then is dropped.
    void run(int threads);

  private:
    void help();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Work> waiting_;
    unsigned busy_ = 0;
    std::exception_ptr error_;
};

}  // namespace corda::golden
