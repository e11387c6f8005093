#pragma once

#include <cstddef>
#include <optional>

#include "corda/gl/object.hpp"

namespace corda::gl {

/// Memory that OpenGL reads pixels into while the CPU goes on. Its context must be current whenever it is
/// used, and when it is destroyed.
class PixelBuffer {
  public:
    PixelBuffer() = default;
    PixelBuffer(const PixelBuffer&) = delete;
    PixelBuffer& operator=(const PixelBuffer&) = delete;
    ~PixelBuffer();

    /// Makes room for `bytes`; what was read before is lost. Until end(), glReadPixels() takes an offset in
    /// this buffer, by buffer_offset(), for an address. Throws corda::Error (kTemporary) if there is no room.
    void begin(std::size_t bytes);
    void end();

    /// Waits for what was read between begin() and end(). It lies at the returned address until the next
    /// begin(). Throws corda::Error (kNoGl) if the driver fails.
    [[nodiscard]] const std::byte* wait();

  private:
    void forget_fence();

    std::optional<Buffer> buffer_;
    std::size_t bytes_ = 0;
    const std::byte* mapped_ = nullptr;  ///< for as long as the buffer lives
    GLsync fence_ = nullptr;             ///< after the reads
};

/// An offset in a PixelBuffer as glReadPixels() takes it.
[[nodiscard]] void* buffer_offset(std::size_t bytes);

}  // namespace corda::gl
