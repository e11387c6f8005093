#include "corda/film/npz.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"

namespace corda {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are little endian");

// The parts of a zip file (APPNOTE.TXT of PKWARE), and of an .npy (NEP 1).
constexpr std::size_t kZipEnd = 22;
constexpr std::size_t kZipComment = 65535;
constexpr std::size_t kZipEntry = 46;
constexpr std::size_t kZipHeader = 30;
constexpr std::size_t kNpyStart = 10;  // with the length of the header, of version 1
constexpr std::size_t kNpyHeader = 65535;

template <std::size_t Bytes>
std::size_t little_endian(std::string_view bytes, std::size_t at) {
    std::size_t value = 0;
    for (std::size_t i = Bytes; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

/// The text after "'key': " in the header of an array; empty if it has none.
std::string_view npy_value(std::string_view header, std::string_view key) {
    const std::size_t at = header.find(fmt::format("'{}': ", key));
    return at == std::string_view::npos ? std::string_view() : header.substr(at + key.size() + 4);
}

}  // namespace

void NpyArray::copy_to(void* numbers) const {
    const char* from = bytes.data() + first;
    auto* to = static_cast<char*>(numbers);
    if (number_bytes == sizeof(double)) {
        std::copy(from, bytes.data() + bytes.size(), to);
        return;
    }
    for (const char* const end = bytes.data() + bytes.size(); from < end; from += sizeof(float)) {
        float single = 0.0F;
        std::memcpy(&single, from, sizeof single);
        const double number = single;
        std::memcpy(to, &number, sizeof number);
        to += sizeof number;
    }
}

Npz::Npz(const FileHandle& file, const std::string& path, std::size_t most)
    : file_(file), path_(path), most_(most) {
    seek(0, SEEK_END);
    const auto size = static_cast<std::size_t>(std::ftell(file_.get()));
    const std::size_t tail = std::min(size, kZipEnd + kZipComment);
    const std::string end = bytes_at(size - tail, tail);
    const std::size_t at = end.rfind("PK\5\6");
    if (at == std::string::npos || at + kZipEnd > end.size()) fail_damaged("it has no list of its arrays");
    const std::size_t list_size = little_endian<4>(end, at + 12);
    const std::size_t list_at = little_endian<4>(end, at + 16);
    if (list_size > size || list_at > size - list_size) fail_damaged("its list of arrays is beyond its end");
    list_ = bytes_at(list_at, list_size);
}

void Npz::fail(const std::string& what, const std::string& remedy, const std::string& name) const {
    throw Error(ExitCode::kUsage, Problem{{.source = path_, .key = name}, what, remedy});
}

void Npz::fail_damaged(const std::string& reason) const {
    fail("the .npz is damaged: " + reason, "save it again");
}

void Npz::seek(std::size_t at, int from) const {
    if (std::fseek(file_.get(), static_cast<long>(at), from) != 0) fail_file("read", path_, errno);
}

std::string Npz::bytes_at(std::size_t at, std::size_t count) const {
    seek(at, SEEK_SET);
    std::string bytes(count, '\0');
    if (read_bytes(file_, path_, bytes.data(), count) < count) fail_damaged("it ends too early");
    return bytes;
}

std::string Npz::file_of(const std::string& name) const {
    for (std::size_t at = 0; at + kZipEntry <= list_.size() && list_.compare(at, 4, "PK\1\2") == 0;) {
        const std::size_t length = little_endian<2>(list_, at + 28);
        if (list_.substr(at + kZipEntry, length) == name + ".npy") return unpacked(at, name);
        at += kZipEntry + length + little_endian<2>(list_, at + 30) + little_endian<2>(list_, at + 32);
    }
    fail(fmt::format("there is no array \"{}\"", name),
         "save it by numpy.savez(FILE, times=times, positions=positions)");
}

/// The file whose entry in the list is at `entry`.
std::string Npz::unpacked(std::size_t entry, const std::string& name) const {
    const std::size_t method = little_endian<2>(list_, entry + 10);
    const std::size_t packed = little_endian<4>(list_, entry + 20);
    const std::size_t size = little_endian<4>(list_, entry + 24);
    const std::size_t at = little_endian<4>(list_, entry + 42);
    if (method != 0 && method != Z_DEFLATED)
        fail_damaged(fmt::format("{} is packed by method {}", name, method));
    if (size > most_ + kNpyStart + kNpyHeader)
        fail(fmt::format("{} takes more than {} MiB", name, most_ >> 20U), "give fewer times");
    const std::string header = bytes_at(at, kZipHeader);
    if (!header.starts_with("PK\3\4")) fail_damaged(name + " is not where the list says");
    seek(at + kZipHeader + little_endian<2>(header, 26) + little_endian<2>(header, 28), SEEK_SET);
    std::string bytes = inflated(packed, size, method == Z_DEFLATED, name);
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (sum != little_endian<4>(list_, entry + 16)) fail_damaged("the checksum of " + name + " is wrong");
    return bytes;
}

/// The next `packed` bytes of the file, inflated to `size`. Memory grows as they come.
std::string Npz::inflated(std::size_t packed, std::size_t size, bool is_deflated,
                          const std::string& name) const {
    std::array<char, 65536> in{};
    std::array<char, 65536> out{};
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, int (*)(z_streamp)> owner(&stream, inflateEnd);
    std::string bytes;
    int status = Z_OK;
    while (packed > 0 && status == Z_OK) {
        check_cancelled();
        const std::size_t count = read_bytes(file_, path_, in.data(), std::min(packed, in.size()));
        if (count == 0) fail_damaged("it ends too early");
        packed -= count;
        stream.next_in = reinterpret_cast<Bytef*>(in.data());
        stream.avail_in = static_cast<uInt>(count);
        if (!is_deflated) bytes.append(in.data(), count);
        while (is_deflated && status == Z_OK) {
            stream.next_out = reinterpret_cast<Bytef*>(out.data());
            stream.avail_out = static_cast<uInt>(out.size());
            status = inflate(&stream, Z_NO_FLUSH);
            bytes.append(out.data(), out.size() - stream.avail_out);
            if (status == Z_BUF_ERROR) status = Z_OK;  // there is no more to come
            if (stream.avail_out > 0) break;
        }
        if (bytes.size() > size) fail_damaged(name + " is longer than the list says");
    }
    if (status != Z_OK && status != Z_STREAM_END) fail_damaged(name + " cannot be inflated");
    if (bytes.size() != size) fail_damaged(name + " is not as long as the list says");
    return bytes;
}

/// The lengths in "(601, 21, 2), ...".
std::vector<std::size_t> Npz::shape_of(std::string_view header, const std::string& name) const {
    std::string_view text = npy_value(header, "shape");
    const std::size_t end = text.find(')');
    if (!text.starts_with('(') || end == std::string_view::npos) fail_damaged(name + " has a bad header");
    std::vector<std::size_t> shape;
    for (text = text.substr(1, end - 1); !text.empty();) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const auto length = whole_number<std::size_t>(text.substr(0, comma));
        if (!length || *length > most_) fail_damaged(name + " has a shape that it cannot have");
        shape.push_back(*length);
        text.remove_prefix(std::min(comma + 2, text.size()));  // ", "
    }
    return shape;
}

NpyArray Npz::read(const std::string& name) const {
    NpyArray array{{}, file_of(name), 0, sizeof(double)};
    if (array.bytes.size() < kNpyStart || !array.bytes.starts_with("\x93NUMPY\1"))
        fail_damaged(name + " is no array of format 1.0");
    array.first = kNpyStart + little_endian<2>(array.bytes, 8);
    if (array.first > array.bytes.size()) fail_damaged(name + " ends in its header");
    const std::string_view header = std::string_view(array.bytes).substr(kNpyStart, array.first - kNpyStart);
    const std::string_view type = npy_value(header, "descr");
    if (type.starts_with("'<f4'"))
        array.number_bytes = sizeof(float);
    else if (!type.starts_with("'<f8'"))
        fail(fmt::format("numbers of type {}, not '<f8' or '<f4'",
                         printable(type.substr(0, type.find(", 'fortran")))),
             fmt::format("save {}.astype('<f8')", name), name);
    if (!npy_value(header, "fortran_order").starts_with("False"))
        fail("its first index is the fastest (Fortran order)",
             fmt::format("save numpy.ascontiguousarray({})", name), name);
    array.shape = shape_of(header, name);
    auto bytes = static_cast<double>(array.number_bytes);  // a product of integers could overflow
    for (const std::size_t length : array.shape) bytes *= static_cast<double>(length);
    if (static_cast<double>(array.bytes.size() - array.first) != bytes)
        fail_damaged(name + " is not as long as its shape");
    return array;
}

}  // namespace corda
