#pragma once

#include <atomic>

namespace corda {

/// Exists while results are saved under their names. A signal lets this be completed: flushing to a slow disk
/// may take seconds. Safe to ask for in a signal handler.
class Saving {
  public:
    Saving() noexcept { ++count_; }
    Saving(const Saving&) = delete;
    Saving& operator=(const Saving&) = delete;
    ~Saving() { --count_; }

    [[nodiscard]] static bool is_active() noexcept { return count_ > 0; }

  private:
    inline static std::atomic<int> count_{0};
    static_assert(std::atomic<int>::is_always_lock_free);
};

}  // namespace corda
