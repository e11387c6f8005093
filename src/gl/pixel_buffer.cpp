#include "corda/gl/pixel_buffer.hpp"

#include <bit>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"

namespace corda::gl {
namespace {

/// So that the next check finds errors of its own. A lost context tells them without end.
void forget_errors() {
    for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) {
    }
}

}  // namespace

PixelBuffer::~PixelBuffer() {
    forget_fence();
}

void PixelBuffer::begin(std::size_t bytes) {
    forget_fence();
    if (buffer_ && bytes <= bytes_) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
        return;
    }
    bytes = std::bit_ceil(bytes);  // of what grows frame by frame, few are made
    buffer_.reset();
    buffer_.emplace();
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
    constexpr GLbitfield kFlags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const auto size = static_cast<GLsizeiptr>(bytes);
    glBufferStorage(GL_PIXEL_PACK_BUFFER, size, nullptr, kFlags);
    mapped_ = static_cast<const std::byte*>(glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, size, kFlags));
    if (mapped_ == nullptr) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        buffer_.reset();
        forget_errors();
        throw Error(
            ExitCode::kTemporary,
            fmt::format("OpenGL has no {} bytes to read pixels into; take a smaller size, or try again with "
                        "more memory",
                        bytes));
    }
    bytes_ = bytes;
}

void PixelBuffer::end() {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();  // or a driver may begin only when it is waited for
}

const std::byte* PixelBuffer::wait() {
    GLenum status = GL_TIMEOUT_EXPIRED;
    while (status == GL_TIMEOUT_EXPIRED)  // a driver may have a longest one
        status = glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, std::numeric_limits<GLuint64>::max());
    if (status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED) return mapped_;
    throw Error(ExitCode::kNoGl, "OpenGL failed to read pixels; see: corda doctor");
}

void PixelBuffer::forget_fence() {
    if (fence_ != nullptr) glDeleteSync(std::exchange(fence_, nullptr));
}

void* buffer_offset(std::size_t bytes) {
    return std::bit_cast<void*>(bytes);
}

}  // namespace corda::gl
