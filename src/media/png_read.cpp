#include <fmt/format.h>
#include <png.h>
#include <sys/stat.h>

#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/media/defs.hpp"

namespace corda {
namespace {

// Deflate shrinks by at most 1032 to 1, so a file that promises more is not whole.
constexpr double kLargestRatio = 1032.0;

// What texts and profiles may take; libpng leaves out what is larger.
constexpr png_uint_32 kMostTexts = 100;
constexpr png_alloc_size_t kLargestChunkBytes = png_alloc_size_t{4} << 20;

/// What libpng's callbacks work with. It lives outside the functions that longjmp returns to.
struct ReadJob {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::FILE* file = nullptr;
    int read_errno = 0;  ///< of the file; 0: it is not to blame
    char message[160] = "out of memory";

    ReadJob() = default;
    ReadJob(const ReadJob&) = delete;
    ReadJob& operator=(const ReadJob&) = delete;
    ~ReadJob() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_read_error(png_structp png, png_const_charp message) {
    auto* job = static_cast<ReadJob*>(png_get_error_ptr(png));
    if (std::ferror(job->file) != 0) job->read_errno = errno;
    std::strncpy(job->message, message, sizeof job->message - 1);
    png_longjmp(png, 1);
}

void on_read_warning(png_structp, png_const_charp) {}

// libpng may leave the next three functions by longjmp, so no object with a destructor lives in them.

bool read_header(ReadJob& job) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    png_init_io(job.png, job.file);
    png_set_user_limits(job.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_png_size has better words
    png_set_chunk_cache_max(job.png, kMostTexts);
    png_set_chunk_malloc_max(job.png, kLargestChunkBytes);
    png_read_info(job.png, job.info);
    return true;
}

/// Turns every format (palette, grey, 1 to 16 bits, tRNS) into 8-bit RGBA. Colours are not converted (gAMA,
/// iCCP), because a comparison wants the numbers in the file.
bool request_rgba8(ReadJob& job) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    png_set_expand(job.png);
    png_set_scale_16(job.png);
    png_set_gray_to_rgb(job.png);
    png_set_add_alpha(job.png, 0xff, PNG_FILLER_AFTER);
    png_set_interlace_handling(job.png);
    png_read_update_info(job.png, job.info);
    return true;
}

bool read_rows(ReadJob& job, Image& image, const OnProgress& on_progress) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    const std::int64_t total = std::int64_t{png_set_interlace_handling(job.png)} * image.height();
    for (std::int64_t done = 0; done < total; ++done) {
        report_progress(on_progress, done, total);
        png_read_row(job.png, image.pixel(0, static_cast<int>(done % image.height())), nullptr);
    }
    png_read_end(job.png, job.info);
    return true;
}

[[noreturn]] void fail_png(const std::string& path, std::string_view reason) {
    throw Error(
        ExitCode::kIo,
        fmt::format("cannot read PNG '{}': {}; write the file again, or give another one", path, reason));
}

/// Of what libpng has ended.
[[noreturn]] void fail_png(const std::string& path, const ReadJob& job) {
    if (job.read_errno != 0) fail_file("read", path, job.read_errno);
    fail_png(path, std::string_view(job.message));
}

void open_job(ReadJob& job, const std::string& path) {
    png_byte signature[8] = {};
    errno = 0;
    const std::size_t count = std::fread(signature, 1, sizeof signature, job.file);
    if (std::ferror(job.file) != 0) fail_file("read", path, errno);
    if (count == 0) fail_png(path, "the file is empty");
    if (count < sizeof signature || png_sig_cmp(signature, 0, sizeof signature) != 0) {
        fail_png(path, "it does not begin like a PNG");
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
        throw Error(ExitCode::kIo,
                    fmt::format("cannot read PNG '{}': it has {} x {} pixels, and at most {} per side and {} "
                                "in all are read; give a smaller picture",
                                path, width, height, kLargestSidePx, kMostPicturePx));
    }
    struct stat status {};
    const bool known_size = ::fstat(::fileno(job.file), &status) == 0 && S_ISREG(status.st_mode);
    const double stored_bytes = static_cast<double>(png_get_rowbytes(job.png, job.info)) * height;
    if (known_size && stored_bytes > kLargestRatio * static_cast<double>(status.st_size)) {
        fail_png(path,
                 fmt::format("a file of {} bytes cannot hold {} x {} pixels", status.st_size, width, height));
    }
}

Image read_pixels(ReadJob& job, const std::string& path, const OnProgress& on_progress) {
    check_png_size(job, path);
    if (!request_rgba8(job)) fail_png(path, job);
    Image image(static_cast<int>(png_get_image_width(job.png, job.info)),
                static_cast<int>(png_get_image_height(job.png, job.info)));
    if (png_get_rowbytes(job.png, job.info) != image.row_bytes()) fail_png(path, "libpng gave no 8-bit RGBA");
    if (!read_rows(job, image, on_progress)) fail_png(path, job);
    return image;
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

Image read_png(const std::string& path, const OnProgress& on_progress) {
    const FileHandle file = open_for_reading(path);
    ReadJob job;
    job.file = file.get();
    open_job(job, path);
    return read_pixels(job, path, on_progress);
}

PngInfo read_png_info(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    ReadJob job;
    job.file = file.get();
    open_job(job, path);
    // Text may stand after the pixels, so the whole file is read.
    (void)read_pixels(job, path, {});
    return collect_info(job);
}

}  // namespace corda
