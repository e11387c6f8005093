#include "corda/media/file_kind.hpp"

#include <string_view>

#include "corda/core/file.hpp"

namespace corda::media {

std::string file_kind(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    std::string head(4096, '\0');
    head.resize(read_bytes(file, path, head.data(), head.size()));
    const auto at = [&head](std::size_t offset, std::string_view bytes) {
        return head.size() >= offset + bytes.size() && head.compare(offset, bytes.size(), bytes) == 0;
    };
    if (at(4, "ftyp")) return "mov";
    if (at(0, "\x1a\x45\xdf\xa3")) return "matroska";
    if (at(0, "GIF8")) return "gif";
    // What makes a picture an animation comes before its pixels.
    if (at(0, "\x89PNG\r\n\x1a\n") && head.find("acTL") < head.find("IDAT")) return "apng";
    if (at(0, "RIFF") && at(8, "WEBP")) return "webp";
    if (at(0, "YUV4MPEG2 ")) return "yuv4mpegpipe";
    return {};
}

}  // namespace corda::media
