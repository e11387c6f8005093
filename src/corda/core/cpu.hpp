#pragma once

// Differences between CPUs, except loops that are written in intrinsics: each of those is in the file of the
// plain loop that gives the same bits.

#include <cstdint>

#include "corda/core/basics.hpp"

#if defined(__x86_64__)
#include <xmmintrin.h>
/// Compiles a function for AVX2 only; the caller asks the CPU first.
#define CORDA_AVX2 [[gnu::target("avx2")]]
#else
#define CORDA_AVX2
#endif
#if defined(__x86_64__) && !defined(CORDA_NO_CLONES)
/// Compiles a function twice, for every x86-64 CPU and for AVX2, and chooses when the program starts. Clang
/// takes no such function that is declared before it is defined. The function must not throw: GCC leaves its
/// calls out of their callers' exception tables, and an exception that passes such a caller ends the program.
#define CORDA_AVX2_CLONES [[gnu::target_clones("avx2", "default")]]
#else
#define CORDA_AVX2_CLONES
#endif
/// Inlines a function into its callers; where one of them is compiled for AVX2, so is the function.
#define CORDA_INLINE [[gnu::always_inline]] inline

/// Before a loop none of whose iterations reads what another writes, for loops over more arrays than a
/// compiler compares.
#if defined(__clang__)
#define CORDA_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define CORDA_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace corda {

/// During its life, this thread takes numbers below 2.2e-308 (denormal ones) as 0. A damped rope halves its
/// distance to equilibrium again and again, and x86 CPUs take a hundred times as long for an operation with
/// denormal numbers. AArch64 does not slow down, but flushes them too, for the same bits.
class FlushDenormals : NonCopyable {
  public:
    FlushDenormals() { set_control(control_ | kFlush); }
    ~FlushDenormals() { set_control(control_); }

  private:
#if defined(__x86_64__)
    using Control = unsigned;
    static constexpr Control kFlush = 0x8040;  // MXCSR: results (bit 15) and operands (bit 6)
    static Control control() {
        return _mm_getcsr();
    }
    static void set_control(Control control) {
        _mm_setcsr(control);
    }
#elif defined(__aarch64__)
    using Control = std::uint64_t;
    static constexpr Control kFlush = std::uint64_t{1} << 24;  // FPCR.FZ: results and operands
    static Control control() {
        Control control = 0;
        asm volatile("mrs %0, fpcr" : "=r"(control));
        return control;
    }
    static void set_control(Control control) {
        asm volatile("msr fpcr, %0" : : "r"(control) : "memory");
    }
#else
#error \
    "Corda runs on x86-64 and AArch64: the same scene must give the same bytes, so denormal numbers are flushed"
#endif

    Control control_ = control();
};

}  // namespace corda
