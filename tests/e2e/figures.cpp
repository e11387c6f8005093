// Pictures for reports: vector graphics, sizes in print, several poses and contact sheets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "corda/golden/compare.hpp"
#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using nlohmann::json;
using test::run_corda;
using test::ScratchFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Ropes that cross, a ball, a ring, a see-through colour and a cloth.
const char* const kSceneOfFigures = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 60.0 }
payload = 10.0
[[rope]]
hang = { links = 9, length = 0.8, angle_deg = -70.0, from = [0.2, 0.0] }
color = "#e08000a0"
[[rope]]
hang = { links = 2, length = 0.7, angle_deg = 150.0, from = [0.5, -0.1] }
[[net]]
grid = { columns = 5, rows = 4, spacing = 0.15, from = [-0.9, 0.0], diagonals = true }
[solver]
method = "relaxation"
step = 0.005
reach = 1
sweeps = 30
[video]
size = [800, 450]
fps = 30
)";

/// The picture on white paper.
Image on_white(Image image) {
    for (std::uint8_t* p = image.data(); p < image.data() + image.size_bytes(); p += 4) {
        for (int c = 0; c < 3; ++c)
            p[c] = static_cast<std::uint8_t>((p[c] * p[3] + 255 * (255 - p[3]) + 127) / 255);
        p[3] = 255;
    }
    return image;
}

/// Averages of kFiner x kFiner pixels, because other programs draw edges and lines below one pixel coarsely.
constexpr int kFiner = 4;
Image averaged(const Image& fine) {
    Image image(fine.width() / kFiner, fine.height() / kFiner);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 4; ++c) {
                int sum = 0;
                for (int i = 0; i < kFiner * kFiner; ++i)
                    sum += fine.pixel(kFiner * x + i % kFiner, kFiner * y + i / kFiner)[c];
                image.pixel(x, y)[c] =
                    static_cast<std::uint8_t>((sum + kFiner * kFiner / 2) / (kFiner * kFiner));
            }
        }
    }
    return image;
}

/// Maximum distance, in levels, of a pixel of `other` from the range of the same pixel of `image` and its
/// eight neighbours.
int largest_excess(const Image& image, const Image& other) {
    int largest = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                int low = 255;
                int high = 0;
                for (int v = std::max(0, y - 1); v <= std::min(image.height() - 1, y + 1); ++v) {
                    for (int u = std::max(0, x - 1); u <= std::min(image.width() - 1, x + 1); ++u) {
                        low = std::min<int>(low, image.pixel(u, v)[c]);
                        high = std::max<int>(high, image.pixel(u, v)[c]);
                    }
                }
                const int value = other.pixel(x, y)[c];
                largest = std::max({largest, low - value, value - high});
            }
        }
    }
    return largest;
}

class Figures : public testing::Test {
  protected:
    /// Runs `command` for a .png, a .svg and a .pdf, and expects the same picture to within a pixel at edges
    /// and the given number of levels.
    void expect_same_pictures(const std::vector<std::string>& command, int excess) const {
        for (const char* const name : {"a.png", "a.svg", "a.pdf"}) {
            auto words = command;
            words.insert(words.begin() + 1, scene_);
            words.insert(words.end(), {"-o", folder_.file(name), "--force"});
            const auto result = run_corda(words);
            ASSERT_EQ(result.exit_code, 0) << result.err;
        }
        const Image image = read_png(folder_.file("a.png"));
        const auto drawn = [&](const std::string& program) {
            const auto result = test::run_shell(program);
            EXPECT_EQ(result.exit_code, 0) << result.err;
            return averaged(on_white(read_png(folder_.file("b.png"))));
        };
        const std::string svg = test::quoted(folder_.file("a.svg"));
        const std::string pdf = test::quoted(folder_.file("a.pdf"));
        const std::string b = test::quoted(folder_.file("b"));
        EXPECT_EQ(test::run_shell("pdfimages -list " + pdf + " | tail -n +3").out, "");  // lines, not pixels
        const Image of_svg = drawn(fmt::format("rsvg-convert -w {} -h {} {} -o {}.png",
                                               kFiner * image.width(), kFiner * image.height(), svg, b));
        const Image of_pdf =
            drawn(fmt::format("pdftoppm -png -singlefile -scale-to-x {} -scale-to-y {} {} {}",
                              kFiner * image.width(), kFiner * image.height(), pdf, b));
        const Image paper = on_white(image);
        EXPECT_LE(largest_excess(paper, of_svg), excess);
        EXPECT_LE(largest_excess(paper, of_pdf), excess);
        EXPECT_LT(compare(paper, of_svg).mean, 0.25);  // measured 0.21
        EXPECT_LT(compare(paper, of_pdf).mean, 0.25);  // measured 0.21
    }

    ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfFigures);
};

TEST_F(Figures, LookTheSameAsPixelsAndAsVectors) {
    // Measured 8 levels as SVG and 11 as PDF.
    const std::string no_text = "overlay={time=false,scale_bar=false}";
    expect_same_pictures({"still", "--at", "0.4", "--set", no_text}, 14);
    expect_same_pictures({"strobe", "--at", "0,0.1,0.2,0.3", "--set", "style.theme=paper", "--set",
                          "style.background=#ffeedd", "--set", no_text},
                         14);
    // Measured 47: other programs place and smooth glyphs differently.
    expect_same_pictures({"still", "--at", "0.4"}, 60);
    // Measured 33: the hatch of small supports has overlapping edges, whose coverages Corda does not add.
    expect_same_pictures({"sheet", "--at", "0,0.1,0.2,0.3", "--columns", "3"}, 70);
}

TEST_F(Figures, LookTheSameWhereFadedLinesAreVerticalOrLevel) {
    expect_same_pictures({"strobe", "--at", "0,0.2", "--set", "overlay={time=false,scale_bar=false}", "--set",
                          "rope=[{hang={lengths=[1.0],angles_deg=[0.0],rates_deg_s=[180.0]}},"
                          "{line={particles=2,from=[0.5,0.5],step=[1,0]},pinned=[0,1]}]"},
                         14);
}

TEST_F(Figures, LookTheSameOnTransparentGrounds) {
    // A halo in a PDF removes everything below it, even the halo of a translucent rope.
    const std::vector<std::string> clear{"--set", "style.background=transparent", "--set",
                                         "rope[1].color=#e08000"};
    std::vector<std::string> command{"still", "--at", "0.4"};
    command.insert(command.end(), clear.begin(), clear.end());
    expect_same_pictures(command, 14);
}

TEST_F(Figures, LookTheSameInLinkColours) {
    const std::string no_text = "overlay={time=false,scale_bar=false,legend=false}";
    // Measured 10 levels as SVG and 12 as PDF.
    const std::string two = "rope[0].color=[\"#e69f00\",\"#56b4e9\"]";
    expect_same_pictures({"still", "--at", "0.4", "--set", no_text, "--set", "style.color_by=strain"}, 14);
    expect_same_pictures(
        {"still", "--at", "0.4", "--set", no_text, "--set", "style.color_by=link", "--set", two}, 14);
    expect_same_pictures({"strobe", "--at", "0,0.2,0.4", "--set", no_text, "--set", "style.color_by=speed",
                          "--set", "style.theme=paper"},
                         14);
    // A legend and its words: measured 41 and 50.
    expect_same_pictures({"still", "--at", "0.4", "--set", "overlay={time=false,scale_bar=false,legend=true}",
                          "--set", "style.color_by=speed"},
                         60);
}

TEST_F(Figures, HaveTextAsTextInAPdf) {
    const auto text_of = [&](const std::string& times) {
        const auto result = run_corda({"sheet", scene_, "--at", times, "-o", folder_.file("a.pdf"), "--force",
                                       "--set", "overlay.scale_bar=false"});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return test::run_shell("pdftotext " + test::quoted(folder_.file("a.pdf")) +
                               " - | tr -d '\\f' | grep . || true")
            .out;
    };
    EXPECT_EQ(text_of("0,0.3,0.6"), "t = 0.0 s\nt = 0.3 s\nt = 0.6 s\n");
    EXPECT_EQ(text_of("0,0.125,0.6"), "t = 0.000 s\nt = 0.125 s\nt = 0.600 s\n");
    EXPECT_EQ(text_of("0,0.3333333333"), "t = 0.000 s\nt = 0.333 s\n");
    EXPECT_EQ(text_of("0.5,0.50001"), "t = 0.50000 s\nt = 0.50001 s\n");
    const auto fonts = test::run_shell("pdffonts " + test::quoted(folder_.file("a.pdf")));
    EXPECT_THAT(fonts.out, HasSubstr("+DejaVuSans"));  // embedded
}

TEST_F(Figures, HaveTheFontOfTheScene) {
    std::filesystem::copy("/usr/share/fonts/truetype/dejavu/DejaVuSerif.ttf", folder_.file("serif.ttf"));
    expect_same_pictures({"still", "--at", "0.4", "--set", "overlay={title=\"Pendel\",font=\"serif.ttf\"}"},
                         60);
    const auto fonts = test::run_shell("pdffonts " + test::quoted(folder_.file("a.pdf")));
    EXPECT_THAT(fonts.out, AllOf(HasSubstr("+DejaVuSerif"), HasSubstr("+DejaVuSans")));  // and the numbers
    const std::vector<std::string> again{
        "still", "--from", folder_.file("a.png"), "-o", folder_.file("b.png"), "--force"};
    ASSERT_EQ(run_corda(again).exit_code, 0);
    EXPECT_EQ(test::read_file(folder_.file("a.png")) == test::read_file(folder_.file("b.png")), true);
    std::filesystem::remove(folder_.file("serif.ttf"));
    const auto refused = run_corda(again);
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.err, HasSubstr("serif.ttf' cannot be opened; give the path of a font"));
}

TEST_F(Figures, HaveTheSameBytesOnEveryRun) {
    for (const char* const ending : {"svg", "pdf"}) {
        std::vector<std::string> bytes;
        for (const char* const name : {"a.", "b."}) {
            ASSERT_EQ(
                run_corda({"still", scene_, "--at", "0.4", "-o", folder_.file(name) + ending}).exit_code, 0);
            bytes.push_back(test::read_file(folder_.file(name) + ending));
            EXPECT_EQ(test::run_shell("sleep 1.1").exit_code, 0);  // a date would differ
        }
        EXPECT_EQ(bytes[0], bytes[1]);
        EXPECT_GT(bytes[0].size(), 1000U);
        EXPECT_LT(bytes[0].size(), 30'000U);  // measured 8296 and 10941
    }
}

TEST_F(Figures, NeedNoOpenGlAsVectors) {
    const std::string none = "CORDA_BACKEND=device:63";
    EXPECT_EQ(run_corda({"still", scene_, "--at", "0", "-o", folder_.file("a.png")}, none).exit_code, 4);
    for (const char* const name : {"a.svg", "a.pdf"}) {
        for (const char* const command : {"still", "strobe", "sheet"}) {
            const auto result =
                run_corda({command, scene_, "--at", "0", "-o", folder_.file(name), "--force"}, none);
            EXPECT_EQ(result.exit_code, 0) << result.err;
        }
    }
}

TEST_F(Figures, HaveTheirSizeInPrint) {
    const std::string png = folder_.file("a.png");
    const std::vector<std::string> print{"--at", "0", "--width-mm", "85", "--ppi", "200", "--force"};
    for (const char* const command : {"still", "strobe", "sheet"}) {
        for (const char* const name : {"a.png", "a.svg", "a.pdf"}) {
            std::vector<std::string> words{command, scene_, "-o", folder_.file(name), "--json"};
            words.insert(words.end(), print.begin(), print.end());
            const auto result = run_corda(words);
            ASSERT_EQ(result.exit_code, 0) << result.err;
            EXPECT_EQ(json::parse(result.out)["width"], 669);  // 85 / 25.4 * 200
            EXPECT_EQ(json::parse(result.out)["height"], 376);
        }
        EXPECT_EQ(read_png(png).width(), 669);
        EXPECT_NEAR(read_png_info(png).pixels_per_inch, 200.0, 0.1);
        const std::string svg = test::read_file(folder_.file("a.svg"));
        EXPECT_THAT(svg, HasSubstr(R"(width="85mm" height="47.7727)"));
        const auto info = test::run_shell("pdfinfo " + test::quoted(folder_.file("a.pdf")));
        EXPECT_THAT(info.out, HasSubstr("Page size:       240.945 x 135.419 pts")) << info.out;
        EXPECT_THAT(info.out, HasSubstr("Title:           scene"));
    }
    const auto size_of_letters = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"still",
                                       scene_,
                                       "--at",
                                       "0",
                                       "--width-mm",
                                       "85",
                                       "--force",
                                       "-o",
                                       folder_.file("a.svg"),
                                       "--set",
                                       "overlay.time=true"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_corda(words).exit_code, 0);
        return test::read_file(folder_.file("a.svg"));
    };
    const std::string by_default = size_of_letters({});
    EXPECT_EQ(size_of_letters({"--font-pt", "8"}), by_default);
    EXPECT_EQ(size_of_letters({"--set", "overlay.text_px=40"}), size_of_letters({"--font-pt", "9.6"}));
    EXPECT_NE(size_of_letters({"--font-pt", "9.6"}), by_default);
    const auto too_large =
        run_corda({"still", scene_, "--at", "0", "-o", png, "--font-pt", "90", "--ppi", "600"});
    EXPECT_EQ(too_large.exit_code, 2);
    EXPECT_THAT(too_large.err,
                HasSubstr("--font-pt 90: is 750 pixels at 600 per inch, not 4 .. 400; choose another --ppi"));
    const auto both =
        run_corda({"still", scene_, "--at", "0", "-o", png, "--width-mm", "85", "--size", "64x64"});
    EXPECT_EQ(both.exit_code, 2);
    const auto huge =
        run_corda({"still", scene_, "--at", "0", "-o", png, "--width-mm", "9999", "--ppi", "600"});
    EXPECT_EQ(huge.exit_code, 2);
    EXPECT_THAT(huge.err, HasSubstr("choose another width or --ppi"));
}

TEST_F(Figures, PrintTheSameReportAsStills) {
    const auto result =
        run_corda({"strobe", scene_, "--frame", "0:10,20", "-o", folder_.file("a.svg"), "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(report["schema"], 1);
    EXPECT_EQ(report["outputs"].size(), 1U);
    EXPECT_EQ(report["outputs"][0]["path"], folder_.file("a.svg"));
    EXPECT_EQ(report["outputs"][0]["times_s"].size(), 11U);
    EXPECT_EQ(report["simulation_passes"], 1);
    const std::string once = folder_.file("once.png");
    const std::string twice = folder_.file("twice.png");
    ASSERT_EQ(run_corda({"strobe", scene_, "--at", "0,1", "-o", once}).exit_code, 0);
    ASSERT_EQ(run_corda({"strobe", scene_, "--at", "1,0,1", "-o", twice}).exit_code, 0);
    EXPECT_EQ(test::read_file(once), test::read_file(twice));  // one pose, one label
    const auto words = run_corda({"sheet", scene_, "--at", "0,1", "-o", folder_.file("b.svg")});
    EXPECT_EQ(words.out, folder_.file("b.svg") + "\n");
    const auto dry = run_corda({"sheet", scene_, "--at", "0,1", "-o", folder_.file("c.svg"), "--dry-run"});
    EXPECT_EQ(dry.exit_code, 0);
    EXPECT_EQ(test::read_file(folder_.file("c.svg")), "");
}

TEST_F(Figures, WithOnePoseEqualStills) {
    for (const char* const ending : {"svg", "pdf", "png"}) {
        const std::string still = folder_.file("a.") + ending;
        const std::string strobe = folder_.file("b.") + ending;
        ASSERT_EQ(run_corda({"still", scene_, "--at", "0.5", "-o", still}).exit_code, 0);
        ASSERT_EQ(run_corda({"strobe", scene_, "--at", "0.5", "-o", strobe}).exit_code, 0);
        if (std::string_view(ending) == "png") {  // its text records the command
            EXPECT_TRUE(read_png(still) == read_png(strobe));
        } else {
            EXPECT_TRUE(test::read_file(still) == test::read_file(strobe)) << ending;
        }
    }
}

TEST_F(Figures, AreRefusedWithARemedy) {
    struct Case {
        std::vector<std::string> words;
        int code;
        const char* says;
    };
    const std::string out = folder_.file("a.png");
    const std::vector<Case> cases{
        {{"strobe", scene_, "-o", out}, 2, "--at or --frame"},
        {{"strobe", scene_, "--at", "0,9", "-o", out}, 2, "--at 9: is not within 0 .. 1 s"},
        {{"strobe", scene_, "--at", "0", "-o", folder_.path()}, 2, ".png, .svg or .pdf"},
        {{"sheet", scene_, "--at", "0", "-o", folder_.file("a.jpg")}, 2, ".png, .svg or .pdf"},
        {{"sheet", scene_, "--at", "0", "-o", out, "--columns", "0"}, 2, "--columns"},
        {{"sheet", scene_, "--frame", ":30", "--size", "64x64", "-o", out},
         2,
         "fewer times or a larger size"},
        {{"sheet", scene_, "--at", "0", "--columns", "99", "-o", out}, 2, "99 columns"},
        {{"still", scene_, "--at", "0,1", "-o", out}, 2, "corda strobe"},
        {{"strobe", folder_.file("none.toml"), "--at", "0", "-o", out}, 6, "none.toml"},
        {{"strobe", scene_, "--at", "0", "-o", folder_.file("none/a.svg")}, 6, "does not exist"},
    };
    for (const Case& wrong : cases) {
        const auto result = run_corda(wrong.words);
        EXPECT_EQ(result.exit_code, wrong.code) << wrong.says << result.err;
        EXPECT_THAT(result.err, HasSubstr(wrong.says));
    }
    test::write_file(folder_.file("there.svg"), "mine");
    EXPECT_EQ(run_corda({"strobe", scene_, "--at", "0", "-o", folder_.file("there.svg")}).exit_code, 6);
    EXPECT_EQ(test::read_file(folder_.file("there.svg")), "mine");
    const std::vector<std::string> away{"--set", "camera.center=[99,0]", "--set", "camera.height=2",
                                        "--fail-empty"};
    for (const char* const command : {"still", "strobe", "sheet"}) {
        std::vector<std::string> words{command,  scene_, "--at", "0", "-o", folder_.file("away.svg"),
                                       "--force"};
        words.insert(words.end(), away.begin(), away.end());
        EXPECT_EQ(run_corda(words).exit_code, 7) << command;
    }
}

}  // namespace
}  // namespace corda
