#include "corda/media/format/file_kind.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "corda/core/file.hpp"

namespace corda::media {
namespace {

/// A kind of file by the bytes at a place in it.
struct Signature {
    std::size_t offset;
    std::string_view bytes;
    ForeignKind kind;
};

constexpr std::array kSignatures{
    Signature{0, "version https://git-lfs.github.com/", {"a Git LFS pointer", "run: git lfs pull"}},
    Signature{0, "/annex/objects/", {"a git-annex pointer", "run: git annex get"}},
    Signature{0, "../.git/annex/", {"a git-annex pointer", "run: git annex get"}},
    Signature{0, "\x89PNG\n", {"a PNG whose line endings were changed", "copy it in binary mode"}},
    Signature{0, "\x89PNG\r\r\n", {"a PNG whose line endings were changed", "copy it in binary mode"}},
    Signature{0, "\xff\xd8\xff", {"a JPEG", kConvertToPng}},
    Signature{0, "GIF8", {"a GIF", kConvertToPng}},
    Signature{8, "WEBP", {"a WebP", kConvertToPng}},
    Signature{0, "BM", {"a BMP", kConvertToPng}},
    Signature{0, {"II*\0", 4}, {"a TIFF", kConvertToPng}},
    Signature{0, {"MM\0*", 4}, {"a TIFF", kConvertToPng}},
    Signature{4, "ftypavif", {"an AVIF", kConvertToPng}},
    Signature{4, "ftyphei", {"a HEIC", kConvertToPng}},
    Signature{0, "\xff\x0a", {"a JPEG XL", kConvertToPng}},
    Signature{4, "ftyp", {"an MP4 or QuickTime file", "give a picture of it"}},
    Signature{0, "\x1a\x45\xdf\xa3", {"a Matroska or WebM video", "give a picture of it"}},
    Signature{0, "%PDF-", {"a PDF", kConvertToPng}},
    Signature{0, "\x1f\x8b", {"compressed by gzip", "run gunzip on it"}},
    Signature{0, "PK\x03\x04", {"a ZIP archive", "unpack it"}},
};

constexpr ForeignKind kEmpty{"empty", "write or copy it again"};
constexpr ForeignKind kHtml{"an HTML page", "download the file itself: a server answered with a page"};
constexpr ForeignKind kSvg{"an SVG", kConvertToPng};

bool has_at(std::string_view head, std::size_t offset, std::string_view bytes) {
    return head.size() >= offset && head.substr(offset).starts_with(bytes);
}

}  // namespace

const ForeignKind* foreign_kind(std::string_view head) {
    if (head.empty()) return &kEmpty;
    for (const Signature& signature : kSignatures)
        if (has_at(head, signature.offset, signature.bytes)) return &signature.kind;
    std::string text(head);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const std::size_t begin = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (begin == std::string::npos || text[begin] != '<') return nullptr;
    // A page may hold an SVG.
    const bool is_html =
        text.find("<html") != std::string::npos || text.find("<!doctype html") != std::string::npos;
    if (is_html) return &kHtml;
    return text.find("<svg") != std::string::npos ? &kSvg : nullptr;
}

const ForeignKind* foreign_kind_of(const std::string& path) {
    constexpr std::size_t kHeadBytes = 512;
    return foreign_kind(first_bytes(path, kHeadBytes));
}

bool is_png(const std::string& path) {
    return first_bytes(path, kPngSignature.size()) == kPngSignature;
}

std::string file_kind(const std::string& path) {
    const std::string head = first_bytes(path, 4096);
    const auto at = [&head](std::size_t offset, std::string_view bytes) {
        return has_at(head, offset, bytes);
    };
    if (at(4, "ftyp")) return "mov";
    if (at(0, "\x1a\x45\xdf\xa3")) return "matroska";
    if (at(0, "GIF8")) return "gif";
    if (at(0, "YUV4MPEG2 ")) return "yuv4mpegpipe";
    return {};
}

}  // namespace corda::media
