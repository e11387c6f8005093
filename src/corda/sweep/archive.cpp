#include "corda/sweep/archive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <initializer_list>

#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"

namespace corda::sweep {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kTarBlockBytes = 512;

/// The head of an array in NumPy's format 1.0; its length is a multiple of 64.
std::string npy_head(const Array& array) {
    std::string shape;
    for (const std::int64_t count : array.shape) shape += fmt::format("{}, ", count);
    if (array.shape.size() > 1) shape.erase(shape.size() - 2);
    if (array.shape.size() == 1) shape.pop_back();
    std::string words = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
                                    array.is_bytes ? "|u1" : "<f8", shape);
    constexpr std::size_t kMagicBytes = 10;
    words.resize((kMagicBytes + words.size()) / 64 * 64 + 63 - kMagicBytes, ' ');
    words += '\n';
    const auto length = static_cast<unsigned>(words.size());
    return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(length & 0xFFU) +
           static_cast<char>(length >> 8U) + words;
}

std::string little_endian(std::uint64_t value, std::size_t bytes) {
    std::string text = media::big_endian(value, bytes);
    std::ranges::reverse(text);
    return text;
}

std::string zeros(std::size_t bytes) {
    return std::string(bytes, '\0');
}

/// The text and zeros up to a multiple of `bytes`.
std::string padded(std::string text, std::size_t bytes) {
    text.resize((text.size() + bytes - 1) / bytes * bytes);
    return text;
}

void append(std::string& text, std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts) text += part;
}

void check_zip_bytes(std::uint64_t bytes, std::string_view remedy) {
    if (bytes > 0xffffffffU) throw_usage("the arrays of an .npz file are over 4 GiB; {}", remedy);
}

/// Compressed bytes without the head and the checksum of a zlib stream.
std::string deflated(std::string_view bytes) {
    constexpr std::size_t kHeadBytes = 2;
    constexpr std::size_t kChecksumBytes = 4;
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    if (compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 bytes.size()) != Z_OK)
        throw Error(ExitCode::kTemporary, "out of memory for an archive");
    return packed.substr(kHeadBytes, size - kHeadBytes - kChecksumBytes);
}

}  // namespace

std::string tar_entry(const std::string& name, std::string_view bytes) {
    // Fields of fixed length; numbers are octal. The checksum sums the bytes of the head, itself as spaces.
    constexpr std::string_view kNoChecksum = "        ";
    std::string head;
    append(head, {padded(name, 100), "000644 \0"sv, "000000 \0"sv, "000000 \0"sv,
                  fmt::format("{:011o} ", bytes.size()), "00000000000 ", kNoChecksum, "0", zeros(100),
                  "ustar\0"sv, "00", zeros(64), "000000 \0"sv, "000000 \0"sv});
    unsigned sum = 0;
    for (const char c : head) sum += static_cast<unsigned char>(c);
    head.replace(148, 7, fmt::format("{:06o}", sum) + '\0');
    return padded(head, kTarBlockBytes) + padded(std::string(bytes), kTarBlockBytes);
}

std::string tar_end() {
    return zeros(2 * kTarBlockBytes);
}

std::string npz_bytes(const std::vector<Array>& arrays, std::string_view remedy) {
    // ZIP without its 64-bit extensions (PKWARE, APPNOTE.TXT 6.3.10, section 4.3). A library's heads would
    // change with its version.
    const std::string version = little_endian(20, 2);
    const std::string date = little_endian(1U << 5U | 1U, 2);  // 1 January 1980
    std::string files;
    std::string directory;
    for (const Array& array : arrays) {
        const std::string name = array.name + ".npy";
        std::string content = npy_head(array) + array.data;
        const std::size_t size = content.size();
        check_zip_bytes(size, remedy);
        const auto checksum =
            crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(size));
        if (array.is_bytes) content = deflated(content);
        std::string head;
        append(head, {version, zeros(2), little_endian(array.is_bytes ? Z_DEFLATED : 0, 2), zeros(2), date,
                      little_endian(checksum, 4), little_endian(content.size(), 4), little_endian(size, 4),
                      little_endian(name.size(), 2), zeros(2)});
        append(directory, {"PK\1\2", version, head, zeros(10), little_endian(files.size(), 4), name});
        append(files, {"PK\3\4", head, name, content});
        check_zip_bytes(files.size() + directory.size(), remedy);
    }
    const std::string count = little_endian(arrays.size(), 2);
    append(directory, {"PK\5\6", zeros(4), count, count, little_endian(directory.size(), 4),
                       little_endian(files.size(), 4), zeros(2)});
    files += directory;
    return files;
}

}  // namespace corda::sweep
