#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <random>

#include "corda/core/basics.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/defs.hpp"
#include "support/cancel.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::media {
namespace {

std::string big_endian(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(number >> shift));
    return bytes;
}

/// The CRC of the PNG specification, third edition, 5.5.
std::uint32_t crc_of(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

/// A PNG with one more chunk, before its end.
std::string with_chunk(const std::string& png, std::string_view type, std::string_view data) {
    constexpr std::size_t kBytesOfEnd = 12;  // of the last chunk
    const std::string checked = std::string(type) + std::string(data);
    const std::string added =
        big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(crc_of(checked));
    return std::string(png).insert(png.size() - kBytesOfEnd, added);
}

namespace fs = std::filesystem;
using testing::HasSubstr;

class Png : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    test::ScratchFolder folder_;
};

Image random_image(int width, int height, bool opaque) {
    std::mt19937 random(11);
    Image image(width, height);
    for (std::size_t i = 0; i < image.size_bytes(); ++i) {
        image.data()[i] =
            opaque && i % 4 == 3 ? std::uint8_t{255} : static_cast<std::uint8_t>(random() & 0xffU);
    }
    return image;
}

ExitCode code_of_reading(const std::string& path) {
    const test::Failure failure = test::failure_of([&] { (void)read_png(path); });
    if (failure.code != ExitCode::kOk) {
        EXPECT_THAT(failure.message, HasSubstr(path));
    }
    return failure.code;
}

TEST_F(Png, RoundTripKeepsEveryPixel) {
    for (const bool opaque : {true, false}) {
        const Image image = random_image(37, 23, opaque);
        write_png(file("a.png"), image, {}, {.force = true});
        EXPECT_TRUE(read_png(file("a.png")) == image) << opaque;
        EXPECT_EQ(test::read_file(file("a.png"))[25], opaque ? 2 : 6);  // IHDR colour type: RGB or RGBA
        EXPECT_THAT(folder_.files(), testing::ElementsAre("a.png"));
    }
}

TEST_F(Png, HasItsChunksAndNoDate) {
    write_png(file("a.png"), random_image(4, 4, true),
              {{{"Software", "corda"}, {"Title", "Pendule à corde"}}, 144.0});
    const std::string bytes = test::read_file(file("a.png"));
    EXPECT_THAT(bytes, HasSubstr(std::string("sRGB\0", 5)));  // 0: perceptual
    EXPECT_THAT(bytes, HasSubstr("pHYs"));
    EXPECT_THAT(bytes, HasSubstr("tEXtSoftware"));
    EXPECT_THAT(bytes, HasSubstr("Pendule \xe0 corde"));  // Latin-1
    EXPECT_THAT(bytes, testing::Not(HasSubstr("tIME")));
    EXPECT_THAT(bytes, testing::Not(HasSubstr("iTXt")));
}

TEST_F(Png, TextComesBackInOrderAsUtf8) {
    PngInfo info;
    info.text = {{"Title", "Pendule à corde"}, {"Comment", "θ₀ = 90°"}, {"Empty", ""}, {"Title", "again"}};
    info.pixels_per_inch = 300.0;
    write_png(file("a.png"), random_image(4, 4, true), info);
    EXPECT_THAT(test::read_file(file("a.png")), HasSubstr("iTXtComment"));
    const PngInfo back = read_png_info(file("a.png"));
    EXPECT_EQ(back.text, info.text);
    EXPECT_NEAR(back.pixels_per_inch, 300.0, 0.013);  // whole pixels per metre
}

TEST_F(Png, SameBytesTwice) {
    const Image image = random_image(64, 64, false);
    write_png(file("a.png"), image, {{{"k", "v"}}, 96.0});
    write_png(file("b.png"), image, {{{"k", "v"}}, 96.0});
    EXPECT_EQ(test::read_file(file("a.png")), test::read_file(file("b.png")));
}

TEST_F(Png, BadFilesAreIoErrors) {
    write_png(file("a.png"), random_image(40, 40, true));
    const std::string whole = test::read_file(file("a.png"));
    EXPECT_EQ(code_of_reading(file("missing.png")), ExitCode::kIo);
    EXPECT_EQ(code_of_reading(folder_.path()), ExitCode::kIo);
    test::write_file(file("b.png"), "");
    EXPECT_EQ(code_of_reading(file("b.png")), ExitCode::kIo);
    test::write_file(file("b.png"), "this is no picture");
    EXPECT_EQ(code_of_reading(file("b.png")), ExitCode::kIo);
    for (std::size_t length = 1; length < whole.size(); length += 7) {
        test::write_file(file("b.png"), whole.substr(0, length));
        ASSERT_EQ(code_of_reading(file("b.png")), ExitCode::kIo) << length;
    }
    for (const std::size_t at : {std::size_t{18}, std::size_t{30}, whole.size() / 2}) {
        std::string broken = whole;
        broken[at] = static_cast<char>(broken[at] ^ 0x55);
        test::write_file(file("b.png"), broken);
        EXPECT_EQ(code_of_reading(file("b.png")), ExitCode::kIo) << at;
    }
}

/// Writes a PNG of any format with libpng itself, every row the same.
void write_raw(const std::string& path, int width, int height, int depth, int type,
               const std::vector<png_byte>& row, const std::vector<png_color>& palette = {}) {
    std::FILE* out = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, out);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), depth, type,
                 PNG_INTERLACE_ADAM7, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    png_write_info(png, info);
    const int passes = png_set_interlace_handling(png);
    for (int i = 0; i < passes * height; ++i) png_write_row(png, row.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    std::fclose(out);
}

TEST_F(Png, EveryFormatBecomesRgba8) {
    write_raw(file("grey1.png"), 2, 1, 1, PNG_COLOR_TYPE_GRAY, {0x40});
    const Image grey = read_png(file("grey1.png"));
    EXPECT_EQ(std::vector<int>(grey.data(), grey.data() + 8),
              (std::vector<int>{0, 0, 0, 255, 255, 255, 255, 255}));
    write_raw(file("palette.png"), 2, 2, 8, PNG_COLOR_TYPE_PALETTE, {1, 0}, {{1, 2, 3}, {4, 5, 6}});
    const Image palette = read_png(file("palette.png"));
    EXPECT_EQ(std::vector<int>(palette.data(), palette.data() + 8),
              (std::vector<int>{4, 5, 6, 255, 1, 2, 3, 255}));
    write_raw(file("rgb16.png"), 1, 1, 16, PNG_COLOR_TYPE_RGB, {0xff, 0xff, 0x80, 0x80, 0, 0});
    const Image deep = read_png(file("rgb16.png"));
    EXPECT_EQ(std::vector<int>(deep.data(), deep.data() + 4), (std::vector<int>{255, 128, 0, 255}));
}

/// Writes a PNG that ends after a few bytes of its pixels.
void write_beginning(const std::string& path, int width, int height) {
    std::FILE* out = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, out);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    const std::array<png_byte, 4> data{};
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), data.data(), data.size());
    png_destroy_write_struct(&png, &info);
    std::fclose(out);
}

TEST_F(Png, RefusesAHugePictureInItsOwnWords) {
    for (const auto& [width, height] :
         {std::pair{16384, 16384}, {16384, 4097}, {16385, 1}, {1, 16385}, {2000000000, 2000000000}}) {
        write_beginning(file("huge.png"), width, height);
        const test::Failure failure = test::failure_of([&] { (void)read_png(file("huge.png")); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_EQ(failure.message, "cannot read PNG '" + file("huge.png") + "': it has " +
                                       std::to_string(width) + " x " + std::to_string(height) +
                                       " pixels, and at most 16384 per side and 67108864 in all are read; "
                                       "give a smaller picture");
    }
    write_beginning(file("huge.png"), 16384, 4096);
    const test::Failure failure = test::failure_of([&] { (void)read_png(file("huge.png")); });
    EXPECT_THAT(failure.message, HasSubstr("bytes cannot hold 16384 x 4096 pixels"));
}

TEST_F(Png, RefusesASmallFileOfManyPixelsBeforeTakingMemory) {
    constexpr int kSide = 16384;
    write_raw(file("bomb.png"), kSide, kSide, 1, PNG_COLOR_TYPE_GRAY, std::vector<png_byte>(kSide / 8));
    EXPECT_LT(fs::file_size(file("bomb.png")), 100'000U);  // measured: 33 kB for 1 GiB of RGBA
    const auto read_with_little_memory = [&] {
        const rlimit limit{std::size_t{1} << 29U, std::size_t{1} << 29U};
        ::setrlimit(RLIMIT_DATA, &limit);
        std::_Exit(static_cast<int>(test::code_of([&] { (void)read_png(file("bomb.png")); })));
    };
    EXPECT_EXIT(read_with_little_memory(), testing::ExitedWithCode(6), "");
}

TEST_F(Png, AMissingFolderAndABadKeywordAreErrors) {
    const Image image = random_image(4, 4, true);
    try {
        write_png(file("no/such/folder/a.png"), image);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kIo);
        EXPECT_THAT(error.what(), HasSubstr("No such file"));
    }
    EXPECT_THROW(write_png(file("a.png"), image, {{{"", "no keyword"}}, 96.0}), Error);
    EXPECT_FALSE(fs::exists(file("a.png")));
}

TEST_F(Png, AnExistingFileIsReplacedOnlyWithForce) {
    const Image image = random_image(4, 4, true);
    test::write_file(file("a.png"), "precious");
    EXPECT_THROW(write_png(file("a.png"), image), Error);
    EXPECT_EQ(test::read_file(file("a.png")), "precious");
    write_png(file("a.png"), image, {}, {.force = true});
    EXPECT_TRUE(read_png(file("a.png")) == image);
}

TEST_F(Png, AFullDiskIsReportedInTheWordsOfTheSystem) {
    // More bytes than are buffered, so that the failure comes through libpng.
    try {
        write_png("/dev/full", random_image(200, 200, false));
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kIo);
        EXPECT_THAT(error.what(), HasSubstr("No space left"));
    }
}

TEST_F(Png, CanBeCancelled) {
    const Image image = random_image(5, 4, true);
    write_png(file("a.png"), image);
    for (const std::int64_t last : {0, 3}) {
        const auto code_of = [last](const auto& work) {
            const CancelScope scope = test::cancel_after(last);
            return test::code_of(work);
        };
        EXPECT_EQ(code_of([&] { write_png(file("b.png"), image); }), ExitCode::kInterrupted);
        EXPECT_EQ(code_of([&] { static_cast<void>(read_png(file("a.png"))); }), ExitCode::kInterrupted);
    }
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"a.png"});
}

TEST_F(Png, AFailedReadIsNoEndOfTheFile) {
    const char* const kFails = "/proc/self/mem";  // an ordinary file whose first bytes cannot be read
    const test::Failure failure = test::failure_of([&] { static_cast<void>(read_png(kFails)); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("Input/output error"));
}

TEST_F(Png, LongAndManyTextsAreLeftOut) {
    const Image image = random_image(8, 8, true);
    write_png(file("a.png"), image, {{{"First", "kept"}}, 96.0});
    std::string png = test::read_file(file("a.png"));
    png = with_chunk(png, "tEXt", std::string("Long") + '\0' + std::string(200'000, 'a'));
    for (int i = 0; i < 100; ++i)
        png = with_chunk(png, "tEXt", std::string("Many") + '\0' + std::string(60'000, 'b'));
    test::write_file(file("b.png"), png);
    EXPECT_TRUE(read_png(file("b.png")) == image);
    const PngInfo info = read_png_info(file("b.png"));
    EXPECT_EQ(info.text.front().second, "kept");
    EXPECT_LT(info.text.size(), 33U);
    std::size_t bytes = 0;
    for (const auto& [keyword, text] : info.text) bytes += text.size();
    EXPECT_LT(bytes, std::size_t{2} << 20);
}

TEST_F(Png, CanBeCancelledWithinItsTexts) {
    write_png(file("a.png"), random_image(8, 8, true));
    std::string png = test::read_file(file("a.png"));
    for (int i = 0; i < 4; ++i)
        png = with_chunk(png, "tEXt", std::string("Long") + '\0' + std::string(1'000'000, 'a'));
    test::write_file(file("b.png"), png);
    int asked = 0;
    const CancelScope stop([&] { return ++asked < 3; });
    EXPECT_EQ(test::code_of([&] { static_cast<void>(read_png_info(file("b.png"))); }),
              ExitCode::kInterrupted);
    EXPECT_EQ(asked, 3);
}

TEST_F(Png, OtherFilesAreNamedForWhatTheyAre) {
    const std::vector<std::array<std::string, 2>> others{
        {"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 5\n",
         "a Git LFS pointer; run: git lfs pull"},
        {"\n<!DOCTYPE HTML><title>404</title>", "an HTML page"},
        {"<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"/>", "an SVG"},
        {"\xff\xd8\xff\xe0..JFIF", "a JPEG"},
        {"\x89PNG\n\x1a\n....", "line endings were changed"},
        {"", "empty"},
        {"plain words", "does not begin like a PNG"}};
    for (const auto& [bytes, words] : others) {
        test::write_file(file("a.png"), bytes);
        const test::Failure failure = test::failure_of([&] { static_cast<void>(read_png(file("a.png"))); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr(words));
        EXPECT_THAT(test::failure_of([&] { static_cast<void>(read_png_info(file("a.png"))); }).message,
                    HasSubstr(words));
    }
}

TEST_F(Png, TextsAreUtf8) {
    PngInfo info;
    info.text = {{"Title", "caf\xe9"}, {"Author", "\xe2\x88\x9e\xff"}};
    write_png(file("a.png"), random_image(2, 2, true), info);
    EXPECT_EQ(read_png_info(file("a.png")).text[0].second, "caf\\xe9");
    EXPECT_EQ(read_png_info(file("a.png")).text[1].second, "\xe2\x88\x9e\\xff");
}

}  // namespace
}  // namespace corda::media
