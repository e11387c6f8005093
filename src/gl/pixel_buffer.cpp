#include "corda/gl/pixel_buffer.hpp"

#include <bit>
#include <limits>

#include <fmt/format.h>

#include "corda/core/basics.hpp"

namespace corda::gl {

PixelBuffer::~PixelBuffer() {
    forget_fence();
}

void PixelBuffer::begin(std::size_t bytes) {
    forget_fence();
    if (bytes <= bytes_) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
        return;
    }
    bytes_ = 0;
    buffer_.reset();
    buffer_.emplace();
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_->id());
    constexpr GLbitfield kFlags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const auto size = static_cast<GLsizeiptr>(bytes);
    glBufferStorage(GL_PIXEL_PACK_BUFFER, size, nullptr, kFlags);
    mapped_ = static_cast<const std::byte*>(glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, size, kFlags));
    if (mapped_ == nullptr) {
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        throw Error(ExitCode::kNoGl,
                    fmt::format("OpenGL has no {} bytes to read pixels into; see: corda doctor", bytes));
    }
    bytes_ = bytes;
}

void PixelBuffer::end() {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

const std::byte* PixelBuffer::wait() {
    const GLenum status =
        glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, std::numeric_limits<GLuint64>::max());
    if (status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED) return mapped_;
    throw Error(ExitCode::kNoGl, "OpenGL failed to read pixels; see: corda doctor");
}

void PixelBuffer::forget_fence() {
    glDeleteSync(fence_);  // of null it is nothing
    fence_ = nullptr;
}

void* buffer_offset(std::size_t bytes) {
    return std::bit_cast<void*>(bytes);
}

}  // namespace corda::gl
