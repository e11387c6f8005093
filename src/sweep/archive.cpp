#include "corda/sweep/archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <exception>
#include <initializer_list>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/media/bytes.hpp"

namespace corda::sweep {
namespace {

constexpr int kFileMode = 0644;

struct FreeEntry {
    void operator()(archive_entry* entry) const { archive_entry_free(entry); }
};
struct FreeReader {
    void operator()(archive* reader) const { archive_read_free(reader); }
};

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
    std::reverse(text.begin(), text.end());
    return text;
}

std::string zeros(std::size_t bytes) {
    return std::string(bytes, '\0');
}

void append(std::string& text, std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts) text += part;
}

void check_zip_bytes(std::uint64_t bytes) {
    if (bytes > 0xffffffffU)
        throw Error(ExitCode::kUsage,
                    "the arrays of a sample are over 4 GiB; leave out some of output.labels, or the frames "
                    "(output.pictures)");
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

TarWriter::TarWriter(WriteBytes write) : write_(std::move(write)), archive_(archive_write_new()) {
    if (!archive_) throw Error(ExitCode::kTemporary, "out of memory for an archive");
    check(archive_write_set_format_ustar(archive_.get()));
    check(archive_write_set_bytes_per_block(archive_.get(), 0));  // no padding after the end
    check(archive_write_open(archive_.get(), this, nullptr, &TarWriter::write, nullptr));
}

TarWriter::~TarWriter() {
    write_ = [](std::string_view) {};  // freeing an unfinished archive writes its end
}

void TarWriter::Free::operator()(archive* its) const {
    archive_write_free(its);
}

std::ptrdiff_t TarWriter::write(archive*, void* writer, const void* bytes, std::size_t count) {
    auto& self = *static_cast<TarWriter*>(writer);
    try {
        if (!self.failure_) self.write_({static_cast<const char*>(bytes), count});
    } catch (...) {  // must not pass through libarchive, which leaks if its output fails
        self.failure_ = std::current_exception();
    }
    return static_cast<std::ptrdiff_t>(count);
}

void TarWriter::check(int status) {
    if (failure_) std::rethrow_exception(failure_);
    if (status == ARCHIVE_OK) return;
    const char* const reason = archive_error_string(archive_.get());
    throw Error(ExitCode::kIo, fmt::format("cannot write an archive: {}", reason == nullptr ? "" : reason));
}

void TarWriter::add(const std::string& name, std::string_view bytes) {
    const std::unique_ptr<archive_entry, FreeEntry> entry(archive_entry_new());
    if (!entry) throw Error(ExitCode::kTemporary, "out of memory for an archive");
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), kFileMode);
    archive_entry_set_size(entry.get(), static_cast<std::int64_t>(bytes.size()));
    archive_entry_set_mtime(entry.get(), 0, 0);
    check(archive_write_header(archive_.get(), entry.get()));
    const auto written = archive_write_data(archive_.get(), bytes.data(), bytes.size());
    check(written == static_cast<std::ptrdiff_t>(bytes.size()) ? ARCHIVE_OK : ARCHIVE_FATAL);
    check(archive_write_finish_entry(archive_.get()));
}

void TarWriter::finish() {
    check(archive_write_close(archive_.get()));
}

void list_tar(const std::string& path, const std::function<void(const std::string&, std::int64_t)>& take) {
    constexpr std::size_t kBlockBytes = 1 << 16;
    const std::unique_ptr<archive, FreeReader> reader(archive_read_new());
    const auto fail = [&] {
        const char* const reason = reader ? archive_error_string(reader.get()) : "out of memory";
        throw Error(ExitCode::kMismatch,
                    fmt::format("'{}' is damaged: {}", path, reason == nullptr ? "" : reason));
    };
    if (!reader || archive_read_support_format_tar(reader.get()) != ARCHIVE_OK ||
        archive_read_open_filename(reader.get(), path.c_str(), kBlockBytes) != ARCHIVE_OK)
        fail();
    archive_entry* entry = nullptr;
    int status = ARCHIVE_OK;
    while ((status = archive_read_next_header(reader.get(), &entry)) == ARCHIVE_OK) {
        check_cancelled();
        take(archive_entry_pathname(entry), archive_entry_size(entry));
    }
    if (status != ARCHIVE_EOF) fail();
}

std::string npz_bytes(const std::vector<Array>& arrays) {
    // ZIP without its 64-bit extensions (PKWARE, APPNOTE.TXT 6.3.10, section 4.3). An archive of libarchive
    // has other heads with each of its versions.
    const std::string version = little_endian(20, 2);
    const std::string date = little_endian(1U << 5U | 1U, 2);  // 1 January 1980
    std::string files;
    std::string directory;
    for (const Array& array : arrays) {
        const std::string name = array.name + ".npy";
        std::string content = npy_head(array) + array.data;
        const std::size_t size = content.size();
        check_zip_bytes(size);
        const auto checksum =
            crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(size));
        if (array.is_bytes) content = deflated(content);
        std::string head;
        append(head, {version, zeros(2), little_endian(array.is_bytes ? Z_DEFLATED : 0, 2), zeros(2), date,
                      little_endian(checksum, 4), little_endian(content.size(), 4), little_endian(size, 4),
                      little_endian(name.size(), 2), zeros(2)});
        append(directory, {"PK\1\2", version, head, zeros(10), little_endian(files.size(), 4), name});
        append(files, {"PK\3\4", head, name, content});
        check_zip_bytes(files.size() + directory.size());
    }
    const std::string count = little_endian(arrays.size(), 2);
    append(directory, {"PK\5\6", zeros(4), count, count, little_endian(directory.size(), 4),
                       little_endian(files.size(), 4), zeros(2)});
    files += directory;
    return files;
}

}  // namespace corda::sweep
