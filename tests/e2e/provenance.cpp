// Pictures and videos contain their scene, and `--from` reproduces them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/probe.hpp"

namespace corda {
namespace {

using test::read_file;
using test::run_corda;
using testing::HasSubstr;

class ProvenanceOfFiles : public testing::Test {
  private:
    test::ScratchFolder folder_;

  protected:
    std::string scene_ =
        folder_.write("scene.toml",
                      "schema = 1\nworld = { duration = 0.5 }\n[[rope]]\n"
                      "hang = { links = 6, length = 1.0, angle_deg = 30, from = [100.1, 3] }\n"
                      "[video]\nsize = [64, 48]\nfps = 30\n");
    test::ScratchFolder& folder() { return folder_; }

    /// Runs a command that must succeed.
    static void run(const std::vector<std::string>& arguments) {
        const auto result = run_corda(arguments);
        ASSERT_EQ(result.exit_code, 0) << result.err;
    }

    void expect_same(const std::string& a, const std::string& b) {
        EXPECT_EQ(read_file(folder_.file(a)) == read_file(folder_.file(b)), true) << a << " and " << b;
    }
};

TEST_F(ProvenanceOfFiles, StillsAreReproducedByteForByte) {
    std::filesystem::create_directory(folder().file("new"));
    run({"still", scene_, "--at", "0.1,0.123456789,0.5", "--set", "style.theme=paper", "--size", "80x60",
         "-o", folder().file("old")});
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder().file("old"))) {
        const std::string name = entry.path().filename().string();
        run({"still", "--from", entry.path().string(), "-o", folder().file("new/" + name)});
        expect_same("old/" + name, "new/" + name);
        ++count;
    }
    EXPECT_EQ(count, 3);
}

TEST_F(ProvenanceOfFiles, FiguresAreReproducedByteForByte) {
    run({"still", scene_, "--frame", "7", "--shutter", "0.5", "--ppi", "150", "-o", folder().file("a.png")});
    run({"still", "--from", folder().file("a.png"), "-o", folder().file("b.png")});
    expect_same("a.png", "b.png");
    run({"strobe", scene_, "--at", "0,0.21,0.4", "--width-mm", "20", "-o", folder().file("c.png")});
    run({"strobe", "--from", folder().file("c.png"), "-o", folder().file("d.png")});
    expect_same("c.png", "d.png");
    run({"sheet", scene_, "--frame", "0:4", "--width-mm", "40", "--font-pt", "5", "-o",
         folder().file("h.png")});
    run({"sheet", "--from", folder().file("h.png"), "-o", folder().file("i.png")});
    expect_same("h.png", "i.png");
    run({"sheet", scene_, "--frame", "0:4", "--size", "300x100", "-o", folder().file("e.png")});
    run({"sheet", "--from", folder().file("e.png"), "-o", folder().file("f.png")});
    expect_same("e.png", "f.png");
    const auto other = run_corda({"still", "--from", folder().file("e.png"), "-o", folder().file("g.png")});
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.err, HasSubstr("was made by `corda sheet`"));
}

TEST_F(ProvenanceOfFiles, AuthoredVideosAreReproducedByteForByte) {
    const std::string authored = folder().write(
        "authored.toml",
        "schema = 1\nworld = { duration = 0.2 }\n"
        "[[rope]]\nhang = { particles = 4, length = 1.0, angle_deg = 30 }\nlabel = \"8 kg\"\n"
        "copies = { count = 3, angle_deg = 5.0 }\n[camera]\npath = [{ t = 0.0 }, { t = 0.2, height = 1.0 }]\n"
        "[overlay]\ntexts = [{ text = \"released\", to = 0.1 }]\n"
        "[video]\nsize = [64, 48]\nfps = 30\nspeed = \"1/2\"\nhold = 0.2\n");
    run({"render", authored, "--frames", "2:9", "-o", folder().file("a.mp4")});
    run({"render", "--from", folder().file("a.mp4"), "-o", folder().file("b.mp4")});
    expect_same("a.mp4", "b.mp4");
    EXPECT_EQ(test::probe(folder().file("a.mp4")).frames, 7);
    const auto portrait =
        run_corda({"render", authored, "--size", "portrait", "-o", folder().file("c.mp4"), "--dry-run"});
    EXPECT_THAT(portrait.err, HasSubstr("18 frames of 1080x1920 at 30 per second, at speed 1/2"));
    const auto unknown = run_corda({"render", authored, "--size", "wide", "-o", folder().file("c.mp4")});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("4k, 1080p, square or portrait"));
}

TEST_F(ProvenanceOfFiles, VideosAreReproducedByteForByte) {
    for (const std::string ending : {".mp4", ".mov", ".mkv", ".webm"}) {
        SCOPED_TRACE(ending);
        run({"render", scene_, "--frames", "2:11", "--jobs", "2", "-o", folder().file("a" + ending)});
        run({"render", "--from", folder().file("a" + ending), "--jobs", "1", "-o",
             folder().file("b" + ending)});
        expect_same("a" + ending, "b" + ending);
    }
}

TEST_F(ProvenanceOfFiles, FramesAreReproducedTogetherOrAlone) {
    run({"render", scene_, "--frames", "3:6", "--set", "video.shutter=0.5", "-o",
         folder().file("old/%03d.png")});
    run({"render", "--from", folder().file("old/004.png"), "-o", folder().file("new/%03d.png")});
    for (const std::string name : {"003.png", "004.png", "005.png"})
        expect_same("old/" + name, "new/" + name);
    run({"still", "--from", folder().file("old/004.png"), "-o", folder().file("one.png")});
    run({"compare", folder().file("old/004.png"), folder().file("one.png")});
}

TEST_F(ProvenanceOfFiles, CommandLineOverridesTheStoredScene) {
    run({"render", scene_, "--frames", "2:11", "-o", folder().file("a.mp4")});
    run({"still", "--from", folder().file("a.mp4"), "--frame", "5", "--size", "96x32", "-o",
         folder().file("a.png")});
    EXPECT_EQ(read_png(folder().file("a.png")).width(), 96);
    const auto made = run_corda({"render", "--from", folder().file("a.mp4"), "--duration", "0.1", "-o",
                                 folder().file("b.mp4"), "--json"});
    EXPECT_THAT(made.out, HasSubstr("\"frames\": 3,"));
}

TEST_F(ProvenanceOfFiles, ContainsNoFolder) {
    run({"still", scene_, "--frame", "1", "-o", folder().file("a.png")});
    run({"render", scene_, "--frames", "0:2", "-o", folder().file("a.mp4")});
    const std::string path = std::filesystem::path(scene_).parent_path().string();
    EXPECT_EQ(read_file(folder().file("a.mp4")).find(path), std::string::npos);
    for (const auto& [keyword, text] : read_png_info(folder().file("a.png")).text)
        EXPECT_EQ(text.find(path), std::string::npos) << keyword;
}

TEST_F(ProvenanceOfFiles, FilesWithoutItAreRefused) {
    write_png(folder().file("plain.png"), Image(8, 8));
    for (const std::string file : {"plain.png", "scene.toml", "none.mp4"}) {
        SCOPED_TRACE(file);
        const auto result =
            run_corda({"render", "--from", folder().file(file), "-o", folder().file("x.mp4")});
        EXPECT_THAT(result.exit_code, testing::AnyOf(2, 6));
        EXPECT_THAT(result.err, HasSubstr(file));
        EXPECT_FALSE(std::filesystem::exists(folder().file("x.mp4")));
    }
    const auto none = run_corda({"render", "-o", folder().file("x.mp4")});
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_THAT(none.err, HasSubstr("--from"));
    EXPECT_EQ(
        run_corda({"render", scene_, "--from", folder().file("plain.png"), "-o", folder().file("x.mp4")})
            .exit_code,
        2);
}

TEST_F(ProvenanceOfFiles, GifsHaveNone) {
    const std::string gif = folder().file("a.gif");
    run({"render", scene_, "--duration", "0.1", "--fps", "25", "-o", gif});
    const auto result = run_corda({"render", "--from", gif, "-o", folder().file("x.mp4")});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("is a GIF"));
}

TEST_F(ProvenanceOfFiles, DamagedProvenanceIsRefused) {
    const std::string sound =
        R"({"corda":"0.1.0","name":"a","scene":"schema = 1\n[[rope]]\nline = { particles = 3, step = [0, -1] }\n","picture":{"command":"still","times":[0]}})";
    const auto code_of = [&](const std::string& text) {
        write_png(folder().file("bad.png"), Image(8, 8), {.text = {{"Provenance", text}}}, {.force = true});
        const auto result = run_corda(
            {"still", "--from", folder().file("bad.png"), "--dry-run", "-o", folder().file("x.png")});
        EXPECT_EQ(result.exit_code == 0, result.err.find("corda: error:") == std::string::npos) << result.err;
        return result.exit_code;
    };
    EXPECT_EQ(code_of(sound), 0);
    for (const std::string& bad : std::vector<std::string>{
             "", "{", "[]", "null", "{}", R"({"corda":1,"name":"a"})", R"({"corda":"0.1.0","name":"a"})",
             R"({"corda":"0.1.0","name":"../a","scene":"schema = 1"})", std::string(100'000, '['),
             std::string(3 << 20, ' ')})
        EXPECT_EQ(code_of(bad), 2) << bad.substr(0, 80);
    for (const auto& [from, to] :
         std::vector<std::pair<std::string, std::string>>{{"still", "paint"},
                                                          {"[0]", "[]"},
                                                          {"[0]", "[1e999]"},
                                                          {"[0]", "[-1]"},
                                                          {"[0]", "[\"0\"]"},
                                                          {"\"times\"", "\"columns\":-1,\"times\""},
                                                          {"\"times\"", "\"shutter\":7,\"times\""}}) {
        std::string bad = sound;
        bad.replace(bad.find(from), from.size(), to);
        EXPECT_EQ(code_of(bad), 2) << bad;
    }
    for (const std::string& parts :
         std::vector<std::string>{R"("packed_scene":"")", R"("packed_scene":1)", R"("settings":1)"}) {
        write_png(folder().file("bad.png"), Image(8, 8),
                  {.text = {{"Provenance", R"({"corda":"0.1.0","name":"a",)" + parts + "}"}}},
                  {.force = true});
        const auto result = run_corda({"render", "--from", folder().file("bad.png"), "--size", "100x100",
                                       "-o", folder().file("x.mp4")});
        EXPECT_EQ(result.exit_code, 2) << parts;
        EXPECT_THAT(result.err, HasSubstr("has damaged provenance")) << parts;
    }
    std::string scene = sound;
    scene.replace(scene.find("particles = 3"), 13, "particles = 1");
    EXPECT_EQ(code_of(scene), 3);
}

TEST_F(ProvenanceOfFiles, ExplainsWhyALargeSceneIsNotStored) {
    const auto scene_of = [&](int particles) {
        std::string points;
        for (int i = 0; i < particles; ++i)
            points +=
                fmt::format("[{}, {}], ", std::to_string(0.1 * i * i / 7.0), std::to_string(std::sin(i)));
        return folder().write(
            "large.toml",
            "schema = 1\nworld = { duration = 0.1 }\n[[rope]]\npoints = [" + points +
                "]\n[video]\nsize = [64, 48]\nfps = 30\n[solver]\nmethod = \"rattle\"\nstep = 0.03\n");
    };
    run({"still", scene_of(1500), "--frame", "0", "-o", folder().file("c.png")});  // 40 KB of text
    run({"still", "--from", folder().file("c.png"), "-o", folder().file("d.png")});
    expect_same("c.png", "d.png");
    const std::string large = scene_of(8000);
    run({"still", large, "--frame", "0", "-o", folder().file("a.png")});
    const auto result = run_corda({"still", "--from", folder().file("a.png"), "-o", folder().file("b.png")});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("does not carry its scene, because the scene takes"));
    const auto film = run_corda({"render", large, "--frames", "0:1", "-o", folder().file("a.mp4")});
    EXPECT_EQ(film.exit_code, 0);
    EXPECT_THAT(film.err, HasSubstr("--from cannot repeat the output, because the scene takes"));
}

}  // namespace
}  // namespace corda
