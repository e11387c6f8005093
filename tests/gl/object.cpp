#include "corda/gl/object.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "corda/gl/context.hpp"
#include "support/failure.hpp"

namespace corda::gl {
namespace {

/// A frame of one pixel that is cleared to a value and read.
class OnePixel {
  public:
    OnePixel() {
        glBindTexture(GL_TEXTURE_2D, texture_.id());
        glTexStorage2D(GL_TEXTURE_2D, 1, GL_RG8, 1, 1);
        glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.id(), 0);
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
    }
    static void read(std::uint8_t value, std::size_t offset) {
        glClearColor(static_cast<float>(value) / 255.0F, 0.0F, 0.0F, 0.0F);
        glClear(GL_COLOR_BUFFER_BIT);
        glReadPixels(0, 0, 1, 1, GL_RG, GL_UNSIGNED_BYTE, buffer_offset(offset));
    }

  private:
    Texture texture_;
    Framebuffer target_;
};

int byte_at(const std::byte* bytes, std::size_t offset) {
    return std::to_integer<int>(bytes[offset]);
}

TEST(PixelBuffers, StoreEachReadAtItsOffset) {
    const Context context;
    const OnePixel pixel;
    std::array<PixelBuffer, 2> ring;
    // It grows, and is used again for less.
    for (const std::size_t bytes : {10U, 5000U, 100U}) {
        for (PixelBuffer& buffer : ring) {
            buffer.begin(bytes);
            OnePixel::read(7, 0);
            OnePixel::read(200, bytes - 2);
            buffer.end();
        }
        for (PixelBuffer& buffer : ring) {
            const std::byte* const read = buffer.wait();
            EXPECT_EQ(byte_at(read, 0), 7);
            EXPECT_EQ(byte_at(read, bytes - 2), 200);
        }
    }
    // Behind the end, memory is read into again.
    std::array<std::uint8_t, 2> memory{};
    glReadPixels(0, 0, 1, 1, GL_RG, GL_UNSIGNED_BYTE, memory.data());
    EXPECT_EQ(memory[0], 200);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(PixelBuffers, CanBeUsedAfterAnAllocationFails) {
    const Context context;
    const OnePixel pixel;
    PixelBuffer buffer;
    const test::Failure failure = test::failure_of([&] { buffer.begin(std::size_t{1} << 46U); });
    EXPECT_EQ(failure.code, ExitCode::kTemporary);
    EXPECT_THAT(failure.message, testing::HasSubstr("has no 70368744177664 bytes"));
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    buffer.begin(2);
    OnePixel::read(9, 0);
    buffer.end();
    EXPECT_EQ(byte_at(buffer.wait(), 0), 9);
}

}  // namespace
}  // namespace corda::gl
