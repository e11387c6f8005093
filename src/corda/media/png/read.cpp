#include <fmt/format.h>
#include <png.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/format/file_kind.hpp"

namespace corda {
namespace {

// Deflate shrinks by at most 1032 to 1, so a file that promises more is not whole.
constexpr double kMaxRatio = 1032.0;

// Limits of texts: libpng leaves out larger ones, and those behind the last.
constexpr png_uint_32 kMaxTexts = 32;
constexpr png_alloc_size_t kMaxTextBytes = png_alloc_size_t{64} << 10;

/// The parts of a file that a reader asks for.
enum class Wanted { kPixels, kTexts };

/// Data of libpng's callbacks. It lives outside the functions that longjmp returns to.
struct ReadJob : NonCopyable {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::FILE* file = nullptr;
    Wanted wanted;
    std::int64_t done = 0;  ///< rows
    std::int64_t total = 0;
    std::size_t unasked_bytes = 0;    ///< read since check_cancelled()
    std::exception_ptr interruption;  ///< what check_cancelled() threw
    int read_errno = 0;               ///< of the file; 0: it is not to blame
    char message[160] = "out of memory";

    explicit ReadJob(Wanted what) : wanted(what) {}
    ~ReadJob() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_read_error(png_structp png, png_const_charp message) {
    auto* job = static_cast<ReadJob*>(png_get_error_ptr(png));
    std::strncpy(job->message, message, sizeof job->message - 1);
    png_longjmp(png, 1);
}

void on_read_warning(png_structp, png_const_charp) {}

/// False if cancelled. Never throws: libpng's functions are in between.
bool goes_on(ReadJob& job) noexcept {
    try {
        check_cancelled();
        return true;
    } catch (...) {
        job.interruption = std::current_exception();
        return false;
    }
}

/// Reads for libpng, and can be cancelled now and then: chunks that are skipped may be long, too.
void on_read(png_structp png, png_bytep bytes, std::size_t count) {
    constexpr std::size_t kAskEveryBytes = std::size_t{1} << 18;
    auto* job = static_cast<ReadJob*>(png_get_io_ptr(png));
    job->unasked_bytes += count;
    if (job->unasked_bytes >= kAskEveryBytes) {
        job->unasked_bytes = 0;
        if (!goes_on(*job)) png_error(png, "interrupted");
    }
    errno = 0;
    if (std::fread(bytes, 1, count, job->file) == count) return;
    if (std::ferror(job->file) != 0) job->read_errno = errno;
    png_error(png, "the file breaks off before its end");
}

// libpng may leave the next functions by longjmp, so no object with a destructor lives in them.

/// Skips chunks that the reader does not ask for. Colours are not converted, so chunks that describe them are
/// among it.
void skip_chunks(ReadJob& job) {
    static constexpr png_byte kOthers[] = "cHRM\0gAMA\0iCCP\0sBIT\0sPLT\0hIST\0bKGD\0eXIf\0tIME";
    static constexpr png_byte kTexts[] = "tEXt\0zTXt\0iTXt";
    png_set_keep_unknown_chunks(job.png, PNG_HANDLE_CHUNK_NEVER, kOthers, sizeof kOthers / 5);
    if (job.wanted == Wanted::kPixels)
        png_set_keep_unknown_chunks(job.png, PNG_HANDLE_CHUNK_NEVER, kTexts, sizeof kTexts / 5);
}

bool read_header(ReadJob& job) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    png_set_read_fn(job.png, &job, on_read);
    png_set_user_limits(job.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_png_size has better words
    png_set_chunk_cache_max(job.png, kMaxTexts);
    png_set_chunk_malloc_max(job.png, kMaxTextBytes);
    png_set_benign_errors(job.png, 1);  // a text that is too long is left out
    skip_chunks(job);
    png_read_info(job.png, job.info);
    return true;
}

/// Turns every format (palette, grey, 1 to 16 bits, tRNS) into RGBA, of 16 bits if the file has as many, else
/// of 8. Colours are not converted (gAMA, iCCP), because a comparison wants the numbers in the file.
bool request_rgba(ReadJob& job) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    png_set_expand(job.png);
    png_set_gray_to_rgb(job.png);
    png_set_add_alpha(job.png, 0xffff, PNG_FILLER_AFTER);
    if (std::endian::native == std::endian::little) png_set_swap(job.png);
    png_set_interlace_handling(job.png);
    png_read_update_info(job.png, job.info);
    return true;
}

/// Reads the rows to `pixels`, which has room for them.
bool read_rows(ReadJob& job, png_bytep pixels) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    const std::size_t row_bytes = png_get_rowbytes(job.png, job.info);
    const auto height = static_cast<std::int64_t>(png_get_image_height(job.png, job.info));
    job.total = std::int64_t{png_set_interlace_handling(job.png)} * height;
    for (; job.done < job.total; ++job.done) {
        if (!goes_on(job)) return false;
        png_read_row(job.png, pixels + row_bytes * static_cast<std::size_t>(job.done % height), nullptr);
    }
    png_read_end(job.png, job.info);
    return true;
}

/// Rounded to the nearest, in one way: half a step does not occur, as 257 is odd.
Image rounded(const DeepImage& deep) {
    Image image(deep.width(), deep.height());
    std::transform(deep.data(), deep.data() + image.size_bytes(), image.data(),
                   [](std::uint16_t sample) { return static_cast<std::uint8_t>((sample + 128) / 257); });
    return image;
}

[[noreturn]] void fail_png(const std::string& path, std::string_view reason) {
    throw_error(ExitCode::kIo, "cannot read PNG '{}': {}; write the file again, or give another one", path,
                reason);
}

/// Message for a failure of libpng.
[[noreturn]] void fail_png(const std::string& path, const ReadJob& job) {
    if (job.interruption) std::rethrow_exception(job.interruption);
    if (job.read_errno != 0) fail_file("read", path, job.read_errno);
    fail_png(path, std::string_view(job.message));
}

void open_job(ReadJob& job, const std::string& path) {
    png_byte signature[8] = {};
    errno = 0;
    const std::size_t count = std::fread(signature, 1, sizeof signature, job.file);
    if (std::ferror(job.file) != 0) fail_file("read", path, errno);
    if (count < sizeof signature || png_sig_cmp(signature, 0, sizeof signature) != 0) {
        // Judged by the same file: a pipe cannot be opened again.
        std::string head(reinterpret_cast<const char*>(signature), count);
        head.resize(512);
        head.resize(count + std::fread(&head[count], 1, head.size() - count, job.file));
        const media::ForeignKind* const kind = media::foreign_kind(head);
        if (kind == nullptr) fail_png(path, "it does not begin like a PNG");
        throw Error(ExitCode::kIo, Problem{{},
                                           fmt::format("cannot read PNG '{}': it is {}", path, kind->words),
                                           std::string(kind->remedy)});
    }
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_read_error, on_read_warning);
    if (job.png != nullptr) job.info = png_create_info_struct(job.png);
    if (job.info == nullptr) fail_png(path, job);
    png_set_sig_bytes(job.png, sizeof signature);
    if (!read_header(job)) fail_png(path, job);
}

/// Refuses a picture that takes too much memory, and one that its file cannot hold.
void check_png_size(const ReadJob& job, const std::string& path) {
    const png_uint_32 width = png_get_image_width(job.png, job.info);
    const png_uint_32 height = png_get_image_height(job.png, job.info);
    if (!is_picture_size(width, height)) {
        throw_error(ExitCode::kIo,
                    "cannot read PNG '{}': it has {} x {} pixels, and at most {} per side and {} in all are "
                    "read; give a smaller picture",
                    path, width, height, kMaxSidePx, kMaxPicturePx);
    }
    struct stat status {};
    const bool known_size = ::fstat(::fileno(job.file), &status) == 0 && S_ISREG(status.st_mode);
    const double stored_bytes = static_cast<double>(png_get_rowbytes(job.png, job.info)) * height;
    if (known_size && stored_bytes > kMaxRatio * static_cast<double>(status.st_size)) {
        fail_png(path,
                 fmt::format("a file of {} bytes cannot hold {} x {} pixels", status.st_size, width, height));
    }
}

template <class Sample>
BasicImage<Sample> read_samples(ReadJob& job, const std::string& path) {
    BasicImage<Sample> image(static_cast<int>(png_get_image_width(job.png, job.info)),
                             static_cast<int>(png_get_image_height(job.png, job.info)));
    if (png_get_rowbytes(job.png, job.info) != image.row_bytes()) fail_png(path, "libpng gave no RGBA");
    void* const pixels = image.data();
    if (!read_rows(job, static_cast<png_bytep>(pixels))) fail_png(path, job);
    return image;
}

Picture read_pixels(ReadJob& job, const std::string& path) {
    check_png_size(job, path);
    const bool is_deep = png_get_bit_depth(job.png, job.info) == 16;
    if (!request_rgba(job)) fail_png(path, job);
    if (!is_deep) return {.image = read_samples<std::uint8_t>(job, path)};
    DeepImage deep = read_samples<std::uint16_t>(job, path);
    Image image = rounded(deep);
    return {.image = std::move(image), .deep = std::move(deep)};
}

std::string from_latin1(std::string_view latin1) {
    std::string utf8;
    for (const char character : latin1) {
        const auto byte = static_cast<unsigned char>(character);
        if (byte < 0x80) {
            utf8.push_back(character);
        } else {
            utf8.push_back(static_cast<char>(0xc0U | (byte >> 6)));
            utf8.push_back(static_cast<char>(0x80U | (byte & 0x3fU)));
        }
    }
    return utf8;
}

PngInfo collect_info(const ReadJob& job) {
    PngInfo info;
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(job.png, job.info, &texts, &count);
    for (int i = 0; i < count; ++i) {
        const bool international = texts[i].compression >= PNG_ITXT_COMPRESSION_NONE;
        const std::string_view text(texts[i].text,
                                    international ? texts[i].itxt_length : texts[i].text_length);
        info.text.emplace_back(texts[i].key, international ? std::string(text) : from_latin1(text));
    }
    const png_uint_32 pixels_per_metre = png_get_pixels_per_meter(job.png, job.info);
    if (pixels_per_metre > 0) info.pixels_per_inch = pixels_per_metre * kMmPerInch / 1000.0;
    return info;
}

}  // namespace

Picture read_picture(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ReadJob job(Wanted::kPixels);
    job.file = file.get();
    open_job(job, path);
    return read_pixels(job, path);
}

Image read_png(const std::string& path) {
    return read_picture(path).image;
}

PngInfo read_png_info(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ReadJob job(Wanted::kTexts);
    job.file = file.get();
    open_job(job, path);
    // Text may stand after the pixels, so the whole file is read.
    static_cast<void>(read_pixels(job, path));
    return collect_info(job);
}

}  // namespace corda
