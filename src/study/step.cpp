#include "corda/study/step.hpp"

#include <utility>

namespace corda::study {
namespace {

thread_local const OnStep* heard_by = nullptr;

}  // namespace

CancelScope::CancelScope(const OnStep& on_step) : outer_(std::exchange(heard_by, &on_step)) {}

CancelScope::~CancelScope() {
    heard_by = outer_;
}

bool check_cancelled() {
    if (heard_by != nullptr && *heard_by) (*heard_by)();
    return true;
}

}  // namespace corda::study
