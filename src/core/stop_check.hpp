#pragma once

#include <cstdint>

#include "corda/core/basics.hpp"

namespace corda {

/// Lets long work be broken off: the work says what it has done, and now and then a callback is asked whether
/// to go on.
class StopCheck {
  public:
    /// The callback is asked when this much has been done since it was last asked: about a millisecond.
    static constexpr std::uint64_t kUpdates = 10'000;

    /// Nobody is asked.
    StopCheck() = default;
    /// Asks `goes_on`, which may be empty and must outlive this.
    explicit StopCheck(const GoesOn& goes_on) : goes_on_(goes_on ? &goes_on : nullptr) {}
    explicit StopCheck(const GoesOn&& goes_on) = delete;
    StopCheck(const StopCheck&) = delete;
    StopCheck& operator=(const StopCheck&) = delete;
    ~StopCheck() = default;

    /// Counts work that has been done, in updates of one particle: some 100 ns each. Throws corda::Error
    /// (kInterrupted) if the callback says that the work is to end, and what the callback throws.
    void spend(std::uint64_t updates) {
        spent_ += updates;
        if (spent_ >= kUpdates) ask();
    }

  private:
    void ask() {
        spent_ = 0;
        if (goes_on_ != nullptr) require_going_on((*goes_on_)());
    }

    const GoesOn* goes_on_ = nullptr;
    std::uint64_t spent_ = 0;
};

}  // namespace corda
