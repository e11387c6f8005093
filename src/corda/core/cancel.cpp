#include "corda/core/cancel.hpp"

#include <cassert>
#include <utility>

namespace corda {
namespace {

thread_local const CancelScope* innermost = nullptr;

void require(bool goes_on) {
    if (!goes_on) throw Error(ExitCode::kInterrupted, "stopped by the caller");
}

/// While a callback runs, no scope around it is asked.
class Callback : NonCopyable {
  public:
    Callback() = default;
    ~Callback() { innermost = asked_; }

    [[nodiscard]] const CancelScope* asked() const { return asked_; }

  private:
    const CancelScope* asked_ = std::exchange(innermost, nullptr);
};

}  // namespace

CancelScope::CancelScope(std::function<bool()> goes_on, Outer outer)
    : goes_on_(std::move(goes_on)),
      outer_(std::exchange(innermost, this)),
      ignores_outer_(outer == Outer::kIgnored) {}

CancelScope::~CancelScope() {
    assert(innermost == this);
    innermost = outer_;
}

void CancelScope::ask(const CancelScope* scope) {
    if (scope == nullptr) return;
    if (!scope->ignores_outer_) ask(scope->outer_);
    if (scope->goes_on_) require(scope->goes_on_());
}

void check_cancelled() {
    detail::work_before_check += std::exchange(detail::work_since_check, 0);
    if (innermost == nullptr) return;
    const Callback callback;
    CancelScope::ask(callback.asked());
}

void report_progress(const OnProgress& on_progress, std::int64_t done, std::int64_t total) {
    if (on_progress) {
        const Callback callback;
        require(on_progress(done, total));
    }
    check_cancelled();
}

}  // namespace corda
