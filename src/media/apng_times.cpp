#include "corda/media/apng_times.hpp"

#include <array>
#include <string_view>

#include "corda/core/file.hpp"

namespace corda::media {
namespace {

constexpr std::int64_t kSignatureBytes = 8;
constexpr std::int64_t kChunkBytes = 12;  // length, name and checksum

std::uint32_t big_endian(const unsigned char* bytes, int count) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
    return value;
}

}  // namespace

ApngTimes read_apng_times(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ApngTimes times;
    std::int64_t frames = 0;
    // The head of a chunk, and of an fcTL what is up to the delay's denominator, where 0 means 100.
    std::array<unsigned char, 32> head{};
    std::int64_t offset = kSignatureBytes;
    while (::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) == 0 &&
           std::fread(head.data(), 1, head.size(), file.get()) == head.size()) {
        if (std::string_view(reinterpret_cast<const char*>(head.data()) + 4, 4) == "fcTL") {
            const std::uint32_t den = big_endian(head.data() + 30, 2);
            const Rational delay = Rational::reduced(big_endian(head.data() + 28, 2), den == 0 ? 100 : den);
            if (frames == 0) times.delay_s = delay;
            if (delay != times.delay_s && times.uneven_at < 0) times.uneven_at = frames;
            ++frames;
        }
        offset += kChunkBytes + big_endian(head.data(), 4);
    }
    return times;
}

}  // namespace corda::media
