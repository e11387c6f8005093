#include <png.h>

#include <cmath>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <functional>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/defs.hpp"

namespace corda {
namespace {

constexpr double kInchesPerMetre = 1000.0 / kMmPerInch;
constexpr std::size_t kMaxKeyword = 79;
constexpr std::size_t kMaxPlainText = 1000;  // of longer ones deflate leaves a third
// Measured on 1080p pictures of a few lines on one colour: level 4 without a filter takes 24 ms and half the
// bytes of level 3 (14 ms); level 6 saves 1 % more. Row filters make such pictures larger.
constexpr int kLevel = 4;
constexpr int kFilter = PNG_FILTER_NONE;

/// The text as Latin-1; std::nullopt if it has other characters.
std::optional<std::string> to_latin1(const std::string& utf8) {
    std::string latin1;
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        const auto byte = static_cast<unsigned char>(utf8[i]);
        if (byte < 0x80) {
            latin1.push_back(utf8[i]);
            continue;
        }
        const bool two_bytes = (byte == 0xc2 || byte == 0xc3) && i + 1 < utf8.size();
        const auto next = two_bytes ? static_cast<unsigned char>(utf8[i + 1]) : 0U;
        if (!two_bytes || (next & 0xc0U) != 0x80U) return std::nullopt;
        latin1.push_back(static_cast<char>(((byte & 0x03U) << 6) | (next & 0x3fU)));
        ++i;
    }
    return latin1;
}

bool is_opaque(const Image& image) {
    const std::uint8_t* data = image.data();
    // One AND over all pixels vectorises; an early exit would not.
    std::uint8_t all = 0xff;
    for (std::size_t i = 3; i < image.size_bytes(); i += 4) all &= data[i];
    return all == 0xff;
}

/// Data of libpng's callbacks. It lives outside the function that longjmp returns to.
struct WriteJob : NonCopyable {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::function<void(std::string_view)> sink;
    std::exception_ptr write_error;
    char message[160] = "out of memory";

    ~WriteJob() { png_destroy_write_struct(&png, &info); }
};

void on_write_error(png_structp png, png_const_charp message) {
    auto* job = static_cast<WriteJob*>(png_get_error_ptr(png));
    std::strncpy(job->message, message, sizeof job->message - 1);
    png_longjmp(png, 1);
}

void on_write_warning(png_structp, png_const_charp) {}

/// An exception must not pass through libpng, which is C.
bool write_bytes(WriteJob& job, png_const_bytep bytes, png_size_t count) {
    try {
        job.sink({reinterpret_cast<const char*>(bytes), count});
        return true;
    } catch (...) {
        job.write_error = std::current_exception();
        return false;
    }
}

void on_write(png_structp png, png_bytep bytes, png_size_t count) {
    if (!write_bytes(*static_cast<WriteJob*>(png_get_io_ptr(png)), bytes, count))
        png_error(png, "write error");
}

void on_flush(png_structp) {}

/// Writes the picture; false, and job.message, on failure. No object with a destructor lives here, because
/// libpng leaves by longjmp.
bool write_picture(WriteJob& job, const Image& image, bool opaque, png_uint_32 pixels_per_metre,
                   png_textp text, int text_count) {
    if (setjmp(png_jmpbuf(job.png)) != 0) return false;
    png_set_write_fn(job.png, &job, on_write, on_flush);
    png_set_user_limits(job.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(job.png, job.info, static_cast<png_uint_32>(image.width()),
                 static_cast<png_uint_32>(image.height()), 8,
                 opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job.png, job.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_pHYs(job.png, job.info, pixels_per_metre, pixels_per_metre, PNG_RESOLUTION_METER);
    if (text_count > 0) png_set_text(job.png, job.info, text, text_count);
    png_set_compression_level(job.png, kLevel);
    png_set_filter(job.png, PNG_FILTER_TYPE_BASE, kFilter);
    png_write_info(job.png, job.info);
    if (opaque) png_set_filler(job.png, 0, PNG_FILLER_AFTER);
    for (int y = 0; y < image.height(); ++y) {
        check_cancelled();
        png_write_row(job.png, image.pixel(0, y));
    }
    png_write_end(job.png, nullptr);
    return true;
}

/// The libpng texts of `info`, pointing into `storage`.
std::vector<png_text> libpng_texts(const PngInfo& info, std::vector<std::string>& storage) {
    storage.reserve(info.text.size() * 2);
    std::vector<png_text> texts;
    for (const auto& [keyword, bytes] : info.text) {
        if (keyword.empty() || keyword.size() > kMaxKeyword) {
            throw_usage("PNG text keyword '{}' has {} characters; it must have 1 to {}", keyword,
                        keyword.size(), kMaxKeyword);
        }
        const std::string text = utf8(bytes);
        const auto latin1 = to_latin1(text);
        std::string& key = storage.emplace_back(keyword);
        std::string& value = storage.emplace_back(latin1 ? *latin1 : text);
        png_text entry{};
        const bool is_long = value.size() > kMaxPlainText;
        entry.compression = latin1 ? (is_long ? PNG_TEXT_COMPRESSION_zTXt : PNG_TEXT_COMPRESSION_NONE)
                                   : (is_long ? PNG_ITXT_COMPRESSION_zTXt : PNG_ITXT_COMPRESSION_NONE);
        entry.key = key.data();
        entry.text = value.data();
        if (latin1) {
            entry.text_length = value.size();
        } else {
            entry.itxt_length = value.size();
        }
        texts.push_back(entry);
    }
    return texts;
}

/// Encodes to a sink; `name` is for messages.
void encode(const std::string& name, const Image& image, bool has_alpha, const PngInfo& info,
            std::function<void(std::string_view)> sink) {
    std::vector<std::string> storage;
    std::vector<png_text> texts = libpng_texts(info, storage);
    WriteJob job;
    job.sink = std::move(sink);
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_write_error, on_write_warning);
    if (job.png != nullptr) job.info = png_create_info_struct(job.png);
    const auto pixels_per_metre =
        static_cast<png_uint_32>(std::lround(info.pixels_per_inch * kInchesPerMetre));
    const bool written = job.info != nullptr && write_picture(job, image, !has_alpha, pixels_per_metre,
                                                              texts.data(), static_cast<int>(texts.size()));
    if (job.write_error) std::rethrow_exception(job.write_error);
    if (!written) throw_error(ExitCode::kIo, "cannot write PNG '{}': libpng says: {}", name, job.message);
}

}  // namespace

void write_png(const std::string& path, const Image& image, const PngInfo& info,
               const OutputOptions& options) {
    if (image.width() < 1 || image.height() < 1) throw_usage("cannot write an empty picture to '{}'", path);
    std::vector<std::string> storage;
    static_cast<void>(libpng_texts(info, storage));  // a wrong text is refused before a file is made
    OutputFile file(path, options);
    encode(path, image, !is_opaque(image), info, [&file](std::string_view bytes) { file.write(bytes); });
    file.commit();
}

std::string media::png_bytes(const Image& image, const PngInfo& info, bool keeps_alpha) {
    std::string all;
    encode("frame", image, keeps_alpha || !is_opaque(image), info,
           [&all](std::string_view bytes) { all += bytes; });
    return all;
}

}  // namespace corda
