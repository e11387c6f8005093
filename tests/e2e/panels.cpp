// `--panels` and `corda join`: several scenes in one film or picture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::read_file;
using test::run_corda;
using testing::HasSubstr;
using testing::Not;

class SeveralScenes : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    /// A scene of 64x48 pixels at 10 frames per second, whose chunks are a second.
    [[nodiscard]] std::string scene(const std::string& name, const std::string& duration,
                                    const std::string& more = "") const {
        return folder_.write(name + ".toml",
                             "schema = 1\nworld = { duration = " + duration +
                                 " }\n[[rope]]\nhang = { links = 6, length = 1.0, angle_deg = 30 }\n"
                                 "[video]\nsize = [64, 48]\nfps = 10\n" +
                                 more);
    }

    static void run(const std::vector<std::string>& arguments) {
        const auto result = run_corda(arguments);
        ASSERT_EQ(result.exit_code, 0) << result.err;
    }

    static void expect_failure(const std::vector<std::string>& arguments, int exit_code,
                               const std::string& words) {
        const auto result = run_corda(arguments);
        EXPECT_EQ(result.exit_code, exit_code) << result.err;
        EXPECT_THAT(result.err, HasSubstr(words));
    }

    void expect_same(const std::string& a, const std::string& b) const {
        EXPECT_TRUE(!read_file(file(a)).empty() && read_file(file(a)) == read_file(file(b)))
            << a << " and " << b;
    }

    /// Makes the parts a.mp4 and b.mp4 of joined videos.
    void render_parts(const std::string& ending = ".mp4") const {
        run({"render", scene("a", "1.3"), "-o", file("a" + ending)});
        run({"render", scene("b", "0.4"), "--frames", "1:4", "-o", file("b" + ending)});
    }

    test::ScratchFolder folder_;
};

TEST_F(SeveralScenes, InPanelsAreOneFilm) {
    const std::string a = scene("a", "4.5");
    const std::string b = scene("b", "2", "shutter = 0.5\n");
    const auto result = run_corda({"render", a, b, "--panels", "2x1", "--size", "100x48", "--jobs", "1",
                                   "--json", "-o", file("c.mp4")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["frames"], 45);
    EXPECT_EQ(report["width"], 100);
    ASSERT_EQ(report["panels"].size(), 2U);
    EXPECT_EQ(report["panels"][1]["scene"], "b");
    run({"verify", file("c.mp4")});
    run({"render", "--from", file("c.mp4"), "-o", file("again.mp4")});
    expect_same("again.mp4", "c.mp4");
    const std::vector<std::string> command{"render", a,        b,    "--panels",   "2x1",
                                           "--size", "100x48", "-o", file("d.mp4")};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), command.begin(), command.end());
        return more;
    };
    run(with({"--dry-run"}));
    run(with({"--shard", "1/2"}));
    EXPECT_THAT(run_corda({"recover", file("d.mp4.parts")}).err, HasSubstr("chunk 0"));
    expect_failure({"render", b, a, "--panels", "2x1", "--size", "100x48", "--resume", "-o", file("d.mp4")},
                   2, "panel 1: ");
    run(with({"--resume"}));
    expect_same("d.mp4", "c.mp4");
}

TEST_F(SeveralScenes, InPanelsAreAllCarriedByTheVideo) {
    std::vector<std::string> command{"render", "--panels", "8x8", "--size", "256x192", "-o", file("a.mp4")};
    for (int i = 0; i < 64; ++i)
        command.push_back(scene("scene" + std::to_string(i), "0.2", "speed = \"1/2\"\n"));
    for (const std::vector<std::string>& how :
         std::vector<std::vector<std::string>>{{"--shard", "0/2"}, {"--resume"}}) {
        std::vector<std::string> words = command;
        words.insert(words.end(), how.begin(), how.end());
        const auto result = run_corda(words);
        ASSERT_EQ(result.exit_code, 0) << result.err;
        EXPECT_THAT(result.err, Not(HasSubstr("warning")));
    }
    run({"render", "--from", file("a.mp4"), "-o", file("b.mp4")});
    expect_same("a.mp4", "b.mp4");
    EXPECT_THAT(run_corda({"verify", file("a.mp4")}).out, HasSubstr(", at speed 1/2"));
}

TEST_F(SeveralScenes, InPanelsMayHaveLongNames) {
    const std::string a = scene(std::string(240, 'a'), "0.2");
    const std::string b = scene(std::string(240, 'b'), "0.2");
    run({"render", a, b, "--panels", "2x1", "-o", file("a.mp4")});
    run({"render", "--from", file("a.mp4"), "-o", file("b.mp4")});
    expect_same("a.mp4", "b.mp4");
}

TEST_F(SeveralScenes, InPanelsHaveTheSizeOfTheFirstEach) {
    run({"render", scene("a", "0.2"), scene("b", "0.2", "pix = \"444\"\n"), "--panels", "1x2", "-o",
         file("c.mp4")});
    EXPECT_THAT(run_corda({"verify", file("c.mp4")}).out, HasSubstr("64x96, 2 frames at 10 per second"));
}

TEST_F(SeveralScenes, WithoutAGridOrOneClockAreRefused) {
    const std::string a = scene("a", "1");
    const std::string out = file("c.mp4");
    expect_failure({"render", a, a, "-o", out}, 2,
                   "2 scenes need a grid COLUMNSxROWS; give e.g. --panels 2x1");
    expect_failure({"render", a, a, a, "--panels", "2x1", "-o", out}, 2,
                   "--panels 2x1: is no grid COLUMNSxROWS of 3 scenes; give e.g. --panels 3x1");
    for (const char* const panels : {"2", "2x", "0x1", "2x1x1", "-2x-1", "x", "99999999x1"})
        EXPECT_EQ(run_corda({"render", a, a, std::string("--panels=") + panels, "-o", out}).exit_code, 2)
            << panels;
    const std::string other = folder_.write("b.toml",
                                            "schema = 1\n[[rope]]\nhang = { links = 3, length = 1.0 }\n"
                                            "[video]\nsize = [64, 48]\nfps = 20\n");
    expect_failure({"render", a, other, "--panels", "2x1", "-o", out}, 2,
                   "give all scenes the same video.fps (--fps)");
    for (const std::string command : {"still", "strobe", "sheet"}) {
        expect_failure({command, a, other, "--at", "0", "--panels", "2x1", "-o", file("a.png")}, 2,
                       "give all scenes the same video.fps (--fps)");
        expect_failure({command, a, a, "--at", "0", "-o", file("a.png")}, 2, "2 scenes need a grid");
        expect_failure({command, a, a, "--at", "0", "--panels", "1x2", "--size", "2x2", "-o", file("a.png")},
                       2, "1x2 panels (--panels) have no room in 2x2 pixels (--size)");
    }
    run({"render", a, other, "--panels", "2x1", "--fps", "20", "--duration", "0.1", "-o", out});
}

/// A part of a picture that is as wide as it.
Image rows_of(const Image& whole, int y0, int height) {
    Image part(whole.width(), height);
    std::copy_n(whole.pixel(0, y0), part.size_bytes(), part.data());
    return part;
}

TEST_F(SeveralScenes, InPanelsOfPicturesLookAsByThemselves) {
    const std::string a = scene("a", "1", "speed = \"1/2\"\n");
    const std::string b = scene("b", "0.5", "[style]\ntheme = \"paper\"\ntrail_s = 0.2\n");
    const std::string both = file("both.png");
    const auto expect_panels = [&](const std::string& command, const std::string& times,
                                   const std::string& times_of_b, const std::string& size) {
        const std::string option = times.find('.') == std::string::npos ? "--frame" : "--at";
        run({command, a, b, option, times, "--panels", "1x2", "--size", "160x360", "--force", "-o", both});
        run({command, a, option, times, "--size", size, "--force", "-o", file("a.png")});
        run({command, b, option, times_of_b, "--size", size, "--force", "-o", file("b.png")});
        const Image whole = read_png(both);
        ASSERT_EQ(whole.height(), 360);
        EXPECT_TRUE(test::equal_images(rows_of(whole, 0, 180), read_png(file("a.png")))) << command;
        EXPECT_TRUE(test::equal_images(rows_of(whole, 180, 180), read_png(file("b.png")))) << command;
        run({command, "--from", both, "--force", "-o", file("again.png")});
        expect_same("again.png", "both.png");
    };
    expect_panels("still", "0.25", "0.25", "160x180");
    expect_panels("still", "0.75", "0.5", "160x180");  // after the end of b
    expect_panels("still", "7", "4", "160x180");
    expect_panels("strobe", "0.1,0.3,0.8,0.9", "0.1,0.3,0.5", "160x180");
    expect_panels("sheet", "0.1,0.3", "0.1,0.3", "160x180");
}

TEST_F(SeveralScenes, InPanelsOfStillsAreTheFramesOfTheFilm) {
    const std::string a = scene("a", "0.6", "shutter = 0.5\n");
    const std::string b = scene("b", "0.4", "shutter = 0.25\nspeed = 2\n");
    run({"render", a, b, "--panels", "2x1", "--frames", "4:5", "-o", file("frame_%d.png")});
    run({"still", "--from", file("frame_4.png"), "-o", file("again.png")});
    expect_same("again.png", "frame_4.png");
    run({"render", a, b, "--panels", "2x1", "-o", file("c.mkv")});
    run({"still", "--from", file("c.mkv"), "--frame", "0,4", "-o", file("stills")});
    run({"still", a, b, "--panels", "2x1", "--frame", "4", "-o", file("sharp.png")});
    expect_same("stills/a_2x1_f000004.png", "sharp.png");
}

TEST_F(SeveralScenes, InPanelsOfPicturesAreVectorsToo) {
    const std::string a = scene("a", "1");
    const auto result = run_corda({"still", a, a, a, a, "--panels", "2x2", "--at", "0", "--width-mm", "100",
                                   "--ppi", "254", "--json", "-o", file("a.svg")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["width"], 1000);
    EXPECT_EQ(report["height"], 750);
    EXPECT_EQ(report["panels"].size(), 4U);
    EXPECT_THAT(read_file(file("a.svg")), HasSubstr("viewBox=\"0 0 1000 750\""));
    run({"still", a, a, "--panels", "2x1", "--at", "0", "-o", file("a.pdf")});
}

TEST_F(SeveralScenes, AreJoinedOneAfterTheOther) {
    for (const std::string ending : {".mp4", ".mov", ".mkv"}) {
        render_parts(ending);
        const std::string a = file("a" + ending);
        const std::string b = file("b" + ending);
        const auto result = run_corda({"join", a, b, "-o", file("c" + ending), "--json"});
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const auto report = nlohmann::json::parse(result.out);
        EXPECT_EQ(report["frames"], 16);
        EXPECT_EQ(report["parts"][0]["frames"], 13);
        EXPECT_THAT(run_corda({"verify", file("c" + ending)}).out, HasSubstr("16 frames at 10 per second"));
        run({"join", a, b, "-o", file("d" + ending)});
        expect_same("c" + ending, "d" + ending);
        run({"join", file("c" + ending), a, "-o", file("e" + ending)});
        expect_failure({"render", "--from", file("e" + ending), "-o", file("f.mp4")}, 2,
                       "has several scenes (a, b, a); give one of the videos");
    }
}

TEST_F(SeveralScenes, AreJoinedOnlyIfTheyAgree) {
    render_parts();
    const std::string a = file("a.mp4");
    const std::string out = file("c.mp4");
    const std::string toml = scene("b", "0.4");
    const std::string b = file("other.mp4");
    const auto expect_refused = [&](const std::vector<std::string>& settings, const std::string& words) {
        std::vector<std::string> command{"render", toml, "--force", "-o", b};
        command.insert(command.end(), settings.begin(), settings.end());
        run(command);
        expect_failure({"join", a, b, "-o", out}, 7, words);
    };
    expect_refused({"--size", "80x48"}, "its size (--size) is 80x48 and not 64x48");
    expect_refused({"--fps", "20"}, "its rate (--fps) is 20 and not 10");
    expect_refused({"--pix", "444"}, "its codec (--codec, --pix) is h264 High 4:4:4");
    expect_refused({"--crf", "30"},
                   "its encoder settings (--preset, --crf) differ; render both with the same options");
    run({"render", toml, "-o", file("b.webm")});
    expect_failure({"join", a, file("b.webm"), "-o", out}, 7, "its codec (--codec, --pix) is vp9");
    expect_failure({"join", a, a, "-o", file("c.webm")}, 2, "cannot be made of h264");
    expect_failure({"join", a, a, "-o", file("c.gif")}, 2, "no video that can be joined");
    expect_failure({"join", a, a, "-o", a, "--force"}, 2, "would replace the input");
    expect_failure({"join", a, "-o", out}, 2, "FILES");
    const std::string advice = "give a video that corda render has written";
    expect_failure({"join", a, toml, "-o", out}, 2, "is a scene file; " + advice);
    run({"render", toml, "-o", file("b.gif")});
    expect_failure({"join", a, file("b.gif"), "-o", out}, 2, advice);
    test::write_file(file("text.mp4"), "text");
    expect_failure({"join", a, file("text.mp4"), "-o", out}, 6, advice);
    EXPECT_EQ(read_file(out), "");
}

TEST_F(SeveralScenes, AreNotJoinedOfDamagedFiles) {
    render_parts();
    const std::string a = file("a.mp4");
    const std::string whole = read_file(a);
    const std::string b = file("other.mp4");
    const auto expect_refused = [&](const std::string& bytes, int exit_code) {
        test::write_file(b, bytes);
        const auto result = run_corda({"join", a, b, "-o", file("c.mp4")});
        EXPECT_EQ(result.exit_code, exit_code) << result.err;
        EXPECT_EQ(read_file(file("c.mp4")), "");
    };
    expect_refused("no video", 6);
    expect_refused(whole.substr(0, whole.size() - 100), 7);
    std::string flipped = whole;
    flipped[whole.size() - 40] ^= 0x55;
    expect_refused(flipped, 7);
    expect_failure({"join", a, file("missing.mp4"), "-o", file("c.mp4")}, 6, "missing.mp4");
    test::write_file(file("c.mp4"), "precious");
    expect_failure({"join", a, a, "-o", file("c.mp4")}, 6, "--force");
    run({"join", a, a, "--force", "-o", file("c.mp4")});
}

}  // namespace
}  // namespace corda
