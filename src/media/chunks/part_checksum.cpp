#include "corda/media/chunks/part_checksum.hpp"

#include <algorithm>
#include <array>

#include "corda/core/file.hpp"
#include "corda/media/big_endian.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

constexpr std::string_view kMark =
    "\xc3"
    "corda checksum\n";  // 16 bytes that no text holds: \xc3 and a letter are no UTF-8
constexpr std::size_t kLengthBytes = 8;
constexpr std::size_t kSumBytes = 4;
constexpr std::size_t kRecordBytes = kMark.size() + kLengthBytes + kSumBytes;

/// What stands before a record: the head of a free box (ISO/IEC 14496-12, 8.1.2), or of a Void element (RFC
/// 8794, 11.3.2).
std::string head_of(std::string_view container) {
    if (container == "mp4" || container == "mov") return big_endian(kRecordBytes + 8, 4) + "free";
    return {static_cast<char>(0xec), static_cast<char>(0x80U | kRecordBytes)};
}

}  // namespace

void PartChecksum::add(std::string_view bytes) {
    crc_ = av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), crc_,
                  reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    bytes_ += bytes.size();
}

std::string PartChecksum::record() const {
    return std::string(kMark) + big_endian(bytes_, kLengthBytes) + big_endian(crc_, kSumBytes);
}

std::string PartChecksum::element(std::string_view container) const {
    PartChecksum with_head = *this;
    const std::string head = head_of(container);
    with_head.add(head);
    return head + with_head.record();
}

SoundBytes sound_bytes_of(const std::string& path, PartExtent extent, const OnProgress& on_progress) {
    const FileHandle file = open_for_reading(path);
    std::array<char, 1 << 16> block{};
    std::string ahead;  // what was read and not counted
    std::uint64_t counted = 0;
    SoundBytes sound;
    PartChecksum checksum;
    const auto count = [&](std::size_t bytes) {
        checksum.add(std::string_view(ahead).substr(0, bytes));
        ahead.erase(0, bytes);
        counted += bytes;
    };
    while (extent == PartExtent::kAll || sound.count == 0) {
        const std::size_t at = ahead.find(kMark);
        if (at != std::string::npos && at + kRecordBytes <= ahead.size()) {
            count(at);
            sound.is_damaged = checksum.record() != ahead.substr(0, kRecordBytes);
            if (sound.is_damaged) break;
            ahead.erase(0, kRecordBytes);
            counted += kRecordBytes;
            sound.count = counted;
            checksum = {};
            continue;
        }
        count(ahead.size() - std::min(ahead.size(), kRecordBytes - 1));  // the rest may begin a record
        report_progress(on_progress, 0, 0);
        const std::size_t read = read_bytes(file, path, block.data(), block.size());
        if (read == 0) break;
        ahead.append(block.data(), read);
    }
    return sound;
}

}  // namespace corda::media
