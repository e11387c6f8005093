#include "corda/sweep/archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"

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

}  // namespace

ArchiveWriter::ArchiveWriter(Kind kind, WriteBytes write)
    : write_(std::move(write)), archive_(archive_write_new()) {
    if (archive_ == nullptr) throw Error(ExitCode::kTemporary, "out of memory for an archive");
    check(kind == Kind::kTar ? archive_write_set_format_ustar(archive_)
                             : archive_write_set_format_zip(archive_));
    if (kind == Kind::kZip) set_compression(false);
    check(archive_write_set_bytes_per_block(archive_, 0));  // no padding after the end
    check(archive_write_open(archive_, this, nullptr, &ArchiveWriter::write, nullptr));
}

ArchiveWriter::~ArchiveWriter() {
    if (failure_ == nullptr) archive_write_fail(archive_);  // writes nothing more
    archive_write_free(archive_);
}

std::ptrdiff_t ArchiveWriter::write(archive* its, void* writer, const void* bytes, std::size_t count) {
    auto& self = *static_cast<ArchiveWriter*>(writer);
    try {
        self.write_({static_cast<const char*>(bytes), count});
        return static_cast<std::ptrdiff_t>(count);
    } catch (...) {  // libarchive is between here and the caller
        self.failure_ = std::current_exception();
        archive_set_error(its, ARCHIVE_FAILED, "the output takes no more");
        return -1;
    }
}

void ArchiveWriter::check(int status) {
    if (failure_) std::rethrow_exception(failure_);
    if (status == ARCHIVE_OK) return;
    const char* const reason = archive_error_string(archive_);
    throw Error(ExitCode::kIo, fmt::format("cannot write an archive: {}", reason == nullptr ? "" : reason));
}

void ArchiveWriter::set_compression(bool is_compressed) {
    check(is_compressed ? archive_write_zip_set_compression_deflate(archive_)
                        : archive_write_zip_set_compression_store(archive_));
}

void ArchiveWriter::add(const std::string& name, std::string_view bytes) {
    const std::unique_ptr<archive_entry, FreeEntry> entry(archive_entry_new());
    if (!entry) throw Error(ExitCode::kTemporary, "out of memory for an archive");
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), kFileMode);
    archive_entry_set_size(entry.get(), static_cast<std::int64_t>(bytes.size()));
    archive_entry_set_mtime(entry.get(), 0, 0);
    check(archive_write_header(archive_, entry.get()));
    const auto written = archive_write_data(archive_, bytes.data(), bytes.size());
    check(written == static_cast<std::ptrdiff_t>(bytes.size()) ? ARCHIVE_OK : ARCHIVE_FATAL);
    check(archive_write_finish_entry(archive_));
}

void ArchiveWriter::finish() {
    check(archive_write_close(archive_));
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
    std::string bytes;
    ArchiveWriter zip(ArchiveWriter::Kind::kZip, [&bytes](std::string_view part) { bytes += part; });
    for (const Array& array : arrays) {
        zip.set_compression(array.is_bytes);
        zip.add(array.name + ".npy", npy_head(array) + array.data);
    }
    zip.finish();
    return bytes;
}

}  // namespace corda::sweep
