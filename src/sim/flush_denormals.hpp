#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace corda::sim {

/// During its life, numbers below 2.2e-308 (denormal ones) count as 0 on x86 CPUs. A damped rope halves its
/// distance to equilibrium again and again; with denormal numbers every operation would take a hundred times
/// as long. Other CPUs do not slow down.
class FlushDenormals {
  public:
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;
#if defined(__SSE2__)
    FlushDenormals() : control_(_mm_getcsr()) {
        _mm_setcsr(control_ | kFlushToZero | kDenormalsAreZero);
    }
    ~FlushDenormals() {
        _mm_setcsr(control_);
    }

  private:
    static constexpr unsigned kFlushToZero = 0x8000;
    static constexpr unsigned kDenormalsAreZero = 0x0040;
    unsigned control_;
#else
    FlushDenormals() = default;
    ~FlushDenormals() = default;
#endif
};

}  // namespace corda::sim
