#pragma once

#include <functional>

namespace corda::study {

/// Called many times a second by whatever a study computes. What it throws ends the study.
using OnStep = std::function<void()>;

/// For as long as it lives, check_cancelled() on this thread calls `on_step`, which must outlive it. The runs
/// of a study are far below its chapters: a parameter would pass through all of them.
class CancelScope {
  public:
    explicit CancelScope(const OnStep& on_step);
    CancelScope(const CancelScope&) = delete;
    CancelScope& operator=(const CancelScope&) = delete;
    ~CancelScope();

  private:
    const OnStep* outer_;
};

/// Tells whoever hears the steps of this thread, if anyone. Returns true, so that it is a GoesOn.
bool check_cancelled();

}  // namespace corda::study
