#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace corda::test {

/// During its lifetime, an x86 CPU that computes with a number below 2.2e-308, which takes a hundred times as
/// long, raises SIGFPE, which ends the test program. Other CPUs do not slow down there.
class DenormalTrap {
  public:
    DenormalTrap(const DenormalTrap&) = delete;
    DenormalTrap& operator=(const DenormalTrap&) = delete;
#if defined(__SSE2__)
    DenormalTrap() : control_(_mm_getcsr()) {
        constexpr unsigned kStatus = 0x003F;
        _mm_setcsr(control_ & ~(kStatus | static_cast<unsigned>(_MM_MASK_DENORM)));
    }
    ~DenormalTrap() {
        _mm_setcsr(control_);
    }

  private:
    unsigned control_;
#else
    DenormalTrap() = default;
    ~DenormalTrap() = default;
#endif
};

}  // namespace corda::test
