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

std::uint64_t from_big_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
    return value;
}

ByteReader ByteReader::of_file(const std::string& path) {
    ByteReader reader{std::string_view()};
    reader.path_ = path;
    reader.file_ = open_for_reading(path);
    reader.size_ = file_size(path);
    return reader;
}

std::string ByteReader::take(std::uint64_t count) {
    std::string bytes;
    if (file_) {
        // One byte more than there should be: reading fails in a file of /proc, whose size is 0.
        bytes.resize(static_cast<std::size_t>(std::min(count, left() + 1)));
        bytes.resize(read_bytes(file_, path_, bytes.data(), bytes.size()));
    } else {
        bytes = text_.substr(static_cast<std::size_t>(position_), static_cast<std::size_t>(count));
    }
    position_ += bytes.size();
    size_ = std::max(size_, position_);
    return bytes;
}

std::optional<std::uint64_t> ByteReader::number(std::size_t bytes) {
    const std::string text = take(bytes);
    if (text.size() < bytes) position_ = size_;
    return text.size() == bytes ? std::optional(from_big_endian(text)) : std::nullopt;
}

bool ByteReader::skip(std::uint64_t count) {
    constexpr std::uint64_t kMaxRead = 256;  // a GIF has many short blocks, for which seeking would take long
    if (count > left()) {
        position_ = size_;
        return false;
    }
    if (file_ && count <= kMaxRead) return take(count).size() == count;
    position_ += count;
    return !file_ || ::fseeko(file_.get(), static_cast<off_t>(count), SEEK_CUR) == 0;
}

std::optional<PngChunk> next_png_chunk(ByteReader& bytes) {
    const auto length = bytes.number(4);
    std::string type = bytes.take(4);
    if (!length || type.size() < 4) return std::nullopt;
    return PngChunk{std::move(type), *length};
}

std::optional<Mp4Box> next_mp4_box(ByteReader& bytes) {
    const std::uint64_t begin = bytes.position();
    const std::uint64_t left = bytes.left();
    auto size = bytes.number(4);
    std::string type = bytes.take(4);
    if (size == 1U) size = bytes.number(8);
    if (size == 0U) size = left;
    const std::uint64_t head = bytes.position() - begin;
    if (!size || type.size() < 4 || *size < head) return std::nullopt;
    return Mp4Box{std::move(type), *size - head};
}

std::optional<EbmlNumber> next_ebml_number(ByteReader& bytes) {
    const auto first = bytes.number(1);
    if (!first || *first == 0) return std::nullopt;
    std::size_t more = 0;
    while ((*first & (0x80U >> more)) == 0) ++more;
    const auto rest = bytes.number(more);
    if (!rest) return std::nullopt;
    const std::uint64_t id = *first << (8 * more) | *rest;
    const std::uint64_t marker = std::uint64_t{1} << (7 * (more + 1));
    const std::uint64_t length = id ^ marker;
    return EbmlNumber{id, length, more + 1, length + 1 == marker};
}

}  // namespace corda::media
