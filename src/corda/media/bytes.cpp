#include "corda/media/bytes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

Sha256::Sha256() : sum_(av_sha_alloc()) {
    constexpr int kBits = 256;
    if (sum_ == nullptr || av_sha_init(sum_, kBits) != 0)
        throw Error(ExitCode::kTemporary, "out of memory for a checksum");
}

Sha256::~Sha256() {
    av_free(sum_);
}

void Sha256::add(std::string_view bytes) {
    av_sha_update(sum_, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string Sha256::text() {
    std::array<std::uint8_t, 32> digest{};
    av_sha_final(sum_, digest.data());
    return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string sha256_of_file(const std::string& path) {
    Sha256 sum;
    const FileHandle file = open_for_reading(path);
    std::vector<char> block(std::size_t{1} << 20U);
    while (const std::size_t count = read_bytes(file, path, block.data(), block.size())) {
        check_cancelled();
        sum.add({block.data(), count});
    }
    return sum.text();
}

std::string big_endian(std::uint64_t value, std::size_t bytes) {
    std::string text(bytes, '\0');
    for (std::size_t i = bytes; i-- > 0; value >>= 8) text[i] = static_cast<char>(value & 0xff);
    return text;
}

}  // namespace corda::media
