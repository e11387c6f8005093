// `corda compare` on pictures made by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using test::run_shell;
using testing::HasSubstr;

class CompareFiles : public testing::Test {
  private:
    test::ScratchFolder folder_;

  protected:
    std::string file(const std::string& name) { return folder_.file(name); }

    /// A rectangle on a grey background, 40x30.
    static Image drawn(int left = 10, int level = 100, int width = 40) {
        Image image(width, 30);
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < width; ++x) {
                std::uint8_t* const rgba = image.pixel(x, y);
                const bool is_inside = x >= left && x < left + 9 && y >= 5 && y < 20;
                std::fill(rgba, rgba + 3, static_cast<std::uint8_t>(is_inside ? 220 : level));
                rgba[3] = 255;
            }
        }
        return image;
    }

    std::string put(const std::string& name, const Image& image) {
        write_png(file(name), image);
        return file(name);
    }

    static int code(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "compare");
        return run_corda(arguments).exit_code;
    }

    static nlohmann::json report(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "compare");
        arguments.emplace_back("--json");
        const auto result = run_corda(arguments);
        EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 7) << result.err;
        return nlohmann::json::parse(result.out, nullptr, false);
    }
};

TEST_F(CompareFiles, OnePixelOffByOne) {
    const std::string a = put("a.png", drawn());
    Image other = drawn();
    other.pixel(3, 4)[2] += 1;
    const std::string b = put("b.png", other);
    EXPECT_EQ(code({a, a}), 0);
    EXPECT_EQ(code({a, b}), 7);
    EXPECT_EQ(code({a, b, "--max", "1"}), 0);
    EXPECT_EQ(code({a, b, "--mean", "0.001"}), 0);
    EXPECT_EQ(code({a, b, "--mean", "0"}), 7);
    EXPECT_EQ(code({a, a, "--max", "0", "--mean", "0", "--share", "0"}), 0);
}

TEST_F(CompareFiles, ShiftedByOne) {
    const auto json = report({put("a.png", drawn(10)), put("b.png", drawn(11))});
    EXPECT_EQ(json["max"], 120);
    EXPECT_EQ(json["share"], 2.0 * 15 / (40 * 30));
}

TEST_F(CompareFiles, AnotherSizeHasADifferencePictureToo) {
    const std::string a = put("a.png", drawn());
    const std::string b = put("b.png", drawn(10, 100, 44));
    EXPECT_EQ(code({a, b, "--max", "255", "--diff", file("d.png")}), 7);
    EXPECT_EQ(read_png(file("d.png")).width(), 44);
    EXPECT_EQ(report({a, b})["max"], nullptr);
}

TEST_F(CompareFiles, SixteenBitsGreyAndAlpha) {
    Image half = drawn();
    half.pixel(0, 0)[3] = 128;
    const std::string a = put("a.png", drawn());
    EXPECT_EQ(report({a, put("half.png", half)})["max"], 127);
    for (const std::string format : {"gray", "rgb48be", "rgba64be", "gray16be", "rgba"}) {
        const std::string other = file(format + ".png");
        const auto made = run_shell("ffmpeg -v error -i " + a + " -pix_fmt " + format + " " + other);
        ASSERT_EQ(made.exit_code, 0) << made.err;
        EXPECT_EQ(code({a, other, "--max", "1"}), 0) << format;  // grey by ffmpeg may be off by 1
    }
}

TEST_F(CompareFiles, SixteenBitFilesDifferInTheirLowerEightBits) {
    const std::string grey = "ffmpeg -v error -y -f rawvideo -pix_fmt rgb48be -s 12x12 -i ";
    for (const char* const name : {"a", "b"}) {
        std::string pixels(12 * 12 * 6, 'd');
        if (name[0] == 'b') pixels[7] = 'e';
        test::write_file(file(name), pixels);
        ASSERT_EQ(run_shell(grey + file(name) + " -pix_fmt rgb48be " + file(name) + ".png").exit_code, 0);
    }
    const std::string a = file("a.png");
    const std::string b = file("b.png");
    EXPECT_EQ(code({a, a}), 0);
    const auto result = run_corda({"compare", a, b, "--diff", file("d.png")});
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.out, HasSubstr("max 0.00389105,"));  // 1/257
    EXPECT_NE(read_png(file("d.png")).pixel(1, 0)[0], read_png(file("d.png")).pixel(2, 0)[0]);
    EXPECT_EQ(code({a, b, "--max", "0.01"}), 0);
    EXPECT_DOUBLE_EQ(report({a, b})["max"].get<double>(), 1.0 / 257.0);
    // 8 bits against 16.
    ASSERT_EQ(run_shell("ffmpeg -v error -y -i " + a + " -pix_fmt rgb24 " + file("c.png")).exit_code, 0);
    EXPECT_EQ(report({a, file("c.png")})["max"], 0);
    EXPECT_EQ(code({b, file("c.png")}), 7);
}

TEST_F(CompareFiles, CorruptPicturesAreErrorsNotMismatches) {
    const std::string a = put("a.png", drawn());
    std::string bytes = test::read_file(a);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    test::write_file(file("flipped.png"), bytes);
    test::write_file(file("cut.png"), bytes.substr(0, 60));
    for (const std::string bad : {"flipped.png", "cut.png"}) {
        EXPECT_EQ(code({a, file(bad)}), 6) << bad;
        EXPECT_EQ(code({file(bad), file(bad)}), 6) << bad;
    }
}

TEST_F(CompareFiles, ImpossibleFileNamesAreNotInternalErrors) {
    const std::string a = put("a.png", drawn());
    EXPECT_EQ(code({a, file(std::string(300, 'n'))}), 6);
    EXPECT_EQ(run_corda({"golden", file(std::string(300, 'n')), "--dir", file("ref")}).exit_code, 6);
}

TEST_F(CompareFiles, NestedFolders) {
    for (const std::string folder : {"a/deep/in", "b/deep/in"})
        std::filesystem::create_directories(file(folder));
    for (const std::string name : {"a/one.png", "b/one.png", "a/deep/in/two.PNG", "b/deep/in/two.PNG"})
        put(name, drawn(10));
    EXPECT_EQ(report({file("a"), file("b")})["files"].size(), 2U);
    std::filesystem::remove(file("b/deep/in/two.PNG"));
    put("b/deep/in/two.PNG", drawn(11));
    // The second run does not compare the difference pictures of the first one.
    for (int i = 0; i < 2; ++i)
        EXPECT_EQ(code({file("a"), file("b"), "--diff", file("a/diff"), "--force"}), 7);
    EXPECT_TRUE(std::filesystem::exists(file("a/diff/deep/in/two.PNG")));
    put("b/deep/three.png", drawn());
    EXPECT_EQ(code({file("a/deep"), file("b/deep")}), 7);
}

TEST_F(CompareFiles, LeavesComparedFoldersAlone) {
    for (const std::string folder : {"a", "b"}) std::filesystem::create_directory(file(folder));
    put("a/one.png", drawn(11));
    put("b/one.png", drawn(10));
    for (const std::string folder : {"a", "b"})
        EXPECT_EQ(code({file("a"), file("b"), "--diff", file("b/../" + folder), "--force"}), 2);
    EXPECT_EQ(read_png(file("b/one.png")), drawn(10));
    EXPECT_EQ(code({file("a"), file("b"), "--diff", file("diff")}), 7);
    EXPECT_TRUE(std::filesystem::exists(file("diff/one.png")));
}

}  // namespace
}  // namespace corda
