#include "corda/media/animation/apng_times.hpp"

#include <array>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/media/big_endian.hpp"

namespace corda::media {
namespace {

constexpr std::int64_t kSignatureBytes = 8;
constexpr std::int64_t kChunkBytes = 12;  // length, name and checksum

}  // namespace

ApngTimes read_apng_times(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ApngTimes times;
    std::int64_t frames = 0;
    // The head of a chunk, and of an fcTL what is up to the delay's denominator, where 0 means 100.
    std::array<char, 32> head{};
    const std::string_view bytes(head.data(), head.size());
    const auto number = [bytes](std::size_t at, std::size_t count) {
        return static_cast<std::int64_t>(from_big_endian(bytes.substr(at, count)));
    };
    std::int64_t offset = kSignatureBytes;
    while (::fseeko(file.get(), static_cast<off_t>(offset), SEEK_SET) == 0 &&
           read_bytes(file, path, head.data(), head.size()) == head.size()) {
        if (bytes.substr(4, 4) == "fcTL") {
            const std::int64_t den = number(30, 2);
            const Rational delay = Rational::reduced(number(28, 2), den == 0 ? 100 : den);
            if (frames == 0) times.delay_s = delay;
            if (delay != times.delay_s && times.uneven_at < 0) times.uneven_at = frames;
            ++frames;
        }
        offset += kChunkBytes + number(0, 4);
    }
    return times;
}

}  // namespace corda::media
