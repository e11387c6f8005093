// `corda golden`: suites that pass, fail for each cause, lack pictures or have stale ones.
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "e2e/golden_suite.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

using test::GoldenSuite;
using test::kGoldenScene;
using test::kMiddle;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(GoldenSuite, PassesWithItsOwnPictures) {
    const auto result = run({"--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("\"passed\": 3"), HasSubstr("\"failed\": 0"),
                                  HasSubstr("\"missing\": 0"), HasSubstr("\"stale\": 0")));
}

TEST_F(GoldenSuite, ReportsAllPicturesOfAMissingFolder) {
    std::filesystem::remove_all(folder_.file("ref"));
    const auto result = run();
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.out, HasSubstr("0 failed, 3 missing"));
    EXPECT_THAT(result.err, HasSubstr("--update"));
    EXPECT_FALSE(std::filesystem::exists(folder_.file("ref")));
}

TEST_F(GoldenSuite, PassesWithTheMethodOverlay) {
    EXPECT_EQ(run({"--update", "--set", "overlay.method=true"}).exit_code, 0);
    EXPECT_EQ(run({"--set", "overlay.method=true"}).exit_code, 0);
}

TEST_F(GoldenSuite, NamesTheKeysThatChangedBeforeWhatWasChosen) {
    const std::pair<const char*, const char*> cases[] = {
        {"world.drag=0.001", "; world.drag is 0.001 and was 0 (by --set)"},
        {"camera.height=5", "; camera.height is 5 and was not given (by --set)"},
        {"style.rope_width_px=9", "; style.rope_width_px is 9 and was not given (by --set)"},
        {"video.fps=1000", "; video.fps is 1000 and was 60 (by --set)"},
        // The camera is fitted to another motion.
        {"world.duration=5", "; world.duration is 5 and was 2 (by --set); another choice: camera."},
        {"golden.size=[64,36]", "different; 320x180 pixels, now 64x36"},
    };
    for (const auto& [setting, cause] : cases) {
        const auto result = run({"--set", setting});
        EXPECT_EQ(result.exit_code, 7) << setting;
        EXPECT_THAT(result.out, HasSubstr(cause));
    }
}

TEST_F(GoldenSuite, AllowsDifferencesByAnyFigure) {
    for (const auto& [limit, code] : std::vector<std::pair<std::string, int>>{
             {"mean=20", 0}, {"mean=0", 7}, {"share=0.9", 0}, {"share=1e-9", 7}}) {
        EXPECT_EQ(run({"--set", "world.drag=0.3", "--set", "golden." + limit}).exit_code, code) << limit;
    }
}

TEST_F(GoldenSuite, ReportsAnotherVersionAndAnotherOpenGl) {
    const auto recolor = [](Image& image) { image.pixel(5, 5)[0] ^= 1U; };
    change_provenance(kMiddle, [&](Image& image, auto& json) {
        recolor(image);
        json["corda"] = "0.0.7";
    });
    EXPECT_THAT(run().out, HasSubstr("max 1, mean 4.34028e-06, share 1.73611e-05; same scene, "
                                     "drawn by another version of Corda: 0.0.7, now"));
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    change_provenance(kMiddle, [&](Image& image, auto& json) {
        recolor(image);
        json["golden"]["renderer"] = "Voodoo";
    });
    EXPECT_THAT(run().out, HasSubstr("drawn by another OpenGL: Voodoo, now"));
}

TEST_F(GoldenSuite, ReportsUnreadableFiles) {
    test::write_file(reference(kMiddle), "no picture");
    const auto damaged = run({"--json"});
    EXPECT_EQ(damaged.exit_code, 7);
    const auto told = nlohmann::json::parse(damaged.out);
    EXPECT_EQ(told["passed"], 2);
    EXPECT_THAT(told["pictures"][1]["cause"].get<std::string>(), HasSubstr(kMiddle));
    EXPECT_EQ(run({"--update"}).exit_code, 7);
    EXPECT_EQ(test::read_file(reference(kMiddle)), "no picture");
    EXPECT_EQ(run({"--update", "--force"}).exit_code, 0);
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, SurvivesAnyTextInAReference) {
    change_provenance("swing_t0000_000000.png",
                      [](Image&, auto& json) { json["scene"] = "schema = 1\n[world]\nduration = 1e9"; });
    change_provenance(kMiddle, [](Image&, auto& json) { json["golden"]["chosen"] = 3; });
    const auto result = run({"-v"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(run({"--set", "style.rope_width_px=9"}).exit_code, 7);
}

TEST_F(GoldenSuite, UpdatesOnlyDifferingPictures) {
    const std::string first = test::read_file(reference("swing_t0000_000000.png"));
    const std::vector<std::string> change{"--set", "overlay.texts=[{text=\"late\",from=0.4}]"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), change.begin(), change.end());
        return run(more);
    };
    const auto shown = with({"--update", "--dry-run"});
    EXPECT_EQ(shown.exit_code, 0);
    EXPECT_THAT(shown.out, AllOf(HasSubstr("swing_t0000_500000.png: would be written: different: max"),
                                 HasSubstr("2 would be written or removed")));
    EXPECT_EQ(run().exit_code, 0);
    const auto result = with({"--update"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, HasSubstr(", 2 written or removed"));
    EXPECT_EQ(test::read_file(reference("swing_t0000_000000.png")), first);
    EXPECT_EQ(with({}).exit_code, 0);
}

TEST_F(GoldenSuite, ChecksTheOtherScenesDespiteAnInvalidOne) {
    test::write_file(folder_.file("scenes/typo.toml"), "schema = 1\n[[rop]]\n");
    test::write_file(folder_.file("scenes/typo2.toml"), "schema = 1\n[worl]\n");
    const auto result = run({"--junit", folder_.file("j.xml"), "--set", "style.rope_width_px=9"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, AllOf(HasSubstr("typo.toml:2:"), HasSubstr("typo2.toml:2:")));
    EXPECT_THAT(result.out, AllOf(HasSubstr("3 failed"), HasSubstr("0 stale; 2 scenes invalid")));
    const std::string junit = test::read_file(folder_.file("j.xml"));
    EXPECT_THAT(junit, AllOf(HasSubstr("<testcase classname=\"typo\""), HasSubstr("style.rope_width_px is 9"),
                             HasSubstr("<error type=\"invalid\"")));
    const auto told = nlohmann::json::parse(run({"--json"}).out);
    const auto& problem = told["pictures"].back()["problems"].back();
    EXPECT_EQ(problem["line"], 2);
    EXPECT_EQ(problem["key"], "worl");
    EXPECT_EQ(run({"--update"}).exit_code, 3);
}

TEST_F(GoldenSuite, FindsScenesInNestedFolders) {
    std::filesystem::create_directories(folder_.file("scenes/deep/in"));
    test::write_file(folder_.file("scenes/deep/in/other.toml"), std::string(kGoldenScene));
    EXPECT_THAT(run().out, HasSubstr("other_t0000_500000.png: missing"));
}

TEST_F(GoldenSuite, ChangesNothingIfAnUpdateFails) {
    test::write_file(folder_.file("scenes/late.toml"),
                     std::string(kGoldenScene) + "[camera]\nheight = 2\n[style]\ntheme = \"none\"\n");
    const std::string kept = test::read_file(reference(kMiddle));
    EXPECT_EQ(run({"--update", "--set", "world.drag=0.3"}).exit_code, 3);
    EXPECT_EQ(test::read_file(reference(kMiddle)), kept);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.file("ref")), {}), 3);
}

TEST_F(GoldenSuite, CompletesAnUpdateThatWasCutOff) {
    EXPECT_EQ(run({"--update", "--set", "world.drag=0.3"}).exit_code, 0);
    const std::string kept = test::read_file(reference(kMiddle));
    test::write_file(reference(kMiddle), "half a picture");
    std::filesystem::remove(reference("swing_t0000_000000.png"));
    EXPECT_EQ(run({"--update", "--force", "--set", "world.drag=0.3"}).exit_code, 0);
    EXPECT_EQ(test::read_file(reference(kMiddle)), kept);
    EXPECT_EQ(run({"--set", "world.drag=0.3"}).exit_code, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.file("ref")), {}), 3);
}

TEST_F(GoldenSuite, KeepsPicturesThatItDidNotMake) {
    write_png(reference("swing_at_9.png"), Image(4, 4));
    EXPECT_EQ(run().exit_code, 0);
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(reference("swing_at_9.png")));
}

TEST_F(GoldenSuite, NamesPicturesThatLostTheirRecord) {
    std::filesystem::copy(reference(kMiddle), reference("gone_t0000_500000.png"));
    for (const char* const name : {kMiddle, "gone_t0000_500000.png"})
        change_reference(name, [](Image&, PngInfo& info) { info.text.clear(); });
    const auto result = run();
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.err, AllOf(HasSubstr("1 picture has no record"), HasSubstr(kMiddle)));
    EXPECT_THAT(result.out, HasSubstr("gone_t0000_500000.png: stale"));
    EXPECT_EQ(run({"--update"}).exit_code, 7);
    EXPECT_TRUE(std::filesystem::exists(reference("gone_t0000_500000.png")));
    EXPECT_EQ(run({"--update", "--force"}).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(reference("gone_t0000_500000.png")));
    const auto again = run();
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.err, Not(HasSubstr("no record")));
}

TEST_F(GoldenSuite, SkipsTomlFilesOfOtherPrograms) {
    test::write_file(folder_.file("scenes/pyproject.toml"), "[project]\nname = \"x\"\n");
    test::write_file(folder_.file("scenes/address.toml"), "schema = \"https://example.org/a.json\"\n");
    test::write_file(folder_.file("scenes/nested.toml"), "[tool.a]\nschema = 1\n");
    test::write_file(folder_.file("scenes/table.toml"), "schema = { a = 1 }\n[packages]\nrope = \"^1\"\n");
    std::filesystem::create_directory(folder_.file("scenes/folder.toml"));
    const auto result = run({"-v"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* const name : {"pyproject", "address", "nested", "table"})
        EXPECT_THAT(result.err, HasSubstr(name + std::string(".toml: passed over")));
    EXPECT_EQ(test::run_corda({"golden", folder_.file("scenes/pyproject.toml"), "--dir", folder_.file("ref")})
                  .exit_code,
              3);
}

TEST_F(GoldenSuite, WarnsIfPicturesAreStaleForALostSchema) {
    test::write_file(folder_.file("scenes/other.toml"), kGoldenScene);
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    test::write_file(folder_.file("scenes/other.toml"), std::string(kGoldenScene).substr(11));
    const auto result = run();
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.err,
                HasSubstr("other.toml: passed over, and its pictures are stale: it has no schema = 1; add"));
}

TEST_F(GoldenSuite, NamesADanglingLinkAndChecksTheOthers) {
    std::filesystem::create_symlink("nothing", folder_.file("scenes/link.toml"));
    const auto result = run({"--json"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.out, HasSubstr("link.toml: a link to nothing"));
    EXPECT_GT(nlohmann::json::parse(result.out)["passed"], 0);
    EXPECT_EQ(run({"--update"}).exit_code, 3);  // otherwise the pictures of that scene would be removed
}

TEST_F(GoldenSuite, NamesAFolderInPlaceOfAPicture) {
    std::filesystem::remove(reference(kMiddle));
    std::filesystem::create_directory(reference(kMiddle));
    for (const auto& options : {std::vector<std::string>{}, {"--update"}}) {
        const auto result = run(options);
        EXPECT_EQ(result.exit_code, 6);
        EXPECT_THAT(result.err,
                    AllOf(HasSubstr(kMiddle), HasSubstr("is a folder"), HasSubstr("move it away")));
    }
    std::filesystem::remove(reference(kMiddle));
    ASSERT_EQ(mkfifo(reference(kMiddle).c_str(), 0600), 0);  // reading it would block
    EXPECT_EQ(run().exit_code, 6);
    std::filesystem::remove(reference(kMiddle));
    EXPECT_EQ(run({"--update"}).exit_code, 0);
}

TEST_F(GoldenSuite, DrawsOneSceneOnSeveralThreads) {
    std::string times = "golden.at=[0";
    for (int i = 1; i < 40; ++i) times += "," + std::to_string(i / 20.0);
    EXPECT_EQ(run({"--update", "--set", times + "]"}).exit_code, 0);
    const auto result = run({"--json", "--set", times + "]"});
    EXPECT_EQ(nlohmann::json::parse(result.out)["passed"], 40);
    EXPECT_EQ(run({"--json"}).exit_code, 7);  // the others are stale
}

TEST_F(GoldenSuite, FailsForAnEmptyPictureEvenInAnUpdate) {
    for (const char* const option : {"--json", "--update"}) {
        const auto result = run({option, "--set", "camera={center=[100,100],height=1.0}"});
        EXPECT_EQ(result.exit_code, 7);
        EXPECT_THAT(result.out, HasSubstr("empty"));
    }
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, AddsMissingPicturesAndRemovesStaleOnes) {
    std::filesystem::rename(reference("swing_t0001_000000.png"), reference("swing_t0003_000000.png"));
    const auto result = run({"--junit", folder_.file("junit.xml")});
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.out, AllOf(HasSubstr("swing_t0001_000000.png: missing"),
                                  HasSubstr("swing_t0003_000000.png: stale")));
    EXPECT_EQ(test::run_shell("xmllint --noout " + test::quoted(folder_.file("junit.xml"))).exit_code, 0);
    EXPECT_THAT(test::read_file(folder_.file("junit.xml")),
                AllOf(HasSubstr("<testsuite name=\"swing\" tests=\"3\" failures=\"1\" errors=\"0\" time="),
                      HasSubstr("<testsuite name=\"stale\" tests=\"1\" failures=\"1\" errors=\"0\" time=")));
    EXPECT_THAT(run({"--update", "--dry-run"}).out, HasSubstr("would be removed"));
    EXPECT_TRUE(std::filesystem::exists(reference("swing_t0003_000000.png")));
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(reference("swing_t0003_000000.png")));
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, AcceptsAVariantNamedByItsCause) {
    std::filesystem::rename(reference("swing_t0001_000000.png"), reference("swing_t0001_000000.old.png"));
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, RefusesInvalidSuites) {
    const std::string plain =
        folder_.write("plain.toml", "schema = 1\n[[rope]]\nhang = { links = 2, length = 1 }\n");
    const auto result = test::run_corda({"golden", plain, "--dir", folder_.file("ref")});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("has no table [golden]"));
    EXPECT_EQ(run({"--dry-run"}).exit_code, 2);
    const auto late = run({"--set", "golden.at=[9]"});
    EXPECT_EQ(late.exit_code, 3);
    EXPECT_THAT(late.err, HasSubstr("after the end of the motion"));
}

/// A script that uses the page like a reader and checks the visible parts; the page's title is the result.
constexpr const char* kVisitor = R"html(<script>
const pixels = (section, kind) => {
  const image = section.querySelector("." + kind + " img");
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, canvas.width, canvas.height).data;
};
const isSeen = (section, kind) => getComputedStyle(section.querySelector("." + kind)).visibility === "visible";
addEventListener("load", () => {
  const seen = {sections: document.querySelectorAll("section[id]").length, wrong: 0, different: 0, blinks: []};
  const section = document.getElementById("swing_t0000_500000.png");
  const [a, b, d] = ["reference", "drawn", "difference"].map((kind) => pixels(section, kind));
  for (let i = 0; i < a.length; ++i) {
    if (i % 4 === 3) continue;
    seen.wrong += d[i] !== Math.min(255, 16 * Math.abs(a[i] - b[i]));
    seen.different += a[i] !== b[i];
  }
  seen.both = isSeen(section, "reference") && isSeen(section, "drawn");
  section.querySelector("[data-mode=slide]").click();
  const range = section.querySelector("input");
  range.value = 25;
  range.dispatchEvent(new Event("input"));
  seen.cut = getComputedStyle(section.querySelector(".drawn img")).clipPath;
  section.querySelector("[data-mode=blink]").click();
  const overlap = ["reference", "drawn"].map((kind) => section.querySelector("." + kind + " img").getBoundingClientRect());
  seen.onePlace = overlap[0].x === overlap[1].x && overlap[0].y === overlap[1].y;
  let looks = 0;
  const look = () => {
    seen.blinks.push(isSeen(section, "reference") + "/" + isSeen(section, "drawn"));
    if (++looks < 3) setTimeout(look, 500);
    else document.title = "SEEN" + JSON.stringify(seen) + "SEEN";
  };
  look();
});
</script>)html";

TEST_F(GoldenSuite, ShowsFailuresOnOnePage) {
    const auto result = run({"--html", folder_.file("page.html"), "--set", "style.rope_width_px=9"});
    EXPECT_EQ(result.exit_code, 7);
    const std::string page = test::read_file(folder_.file("page.html"));
    EXPECT_THAT(page, AllOf(HasSubstr("style.rope_width_px is 9 and was not given"), Not(HasSubstr("http")),
                            Not(HasSubstr("src=\"/"))));
    const std::string visited = folder_.write("visited.html", page + kVisitor);
    const auto shown =
        test::run_shell("chromium --headless --no-sandbox --disable-gpu --user-data-dir=" +
                        test::quoted(folder_.file("profile")) + " --virtual-time-budget=20000 --dump-dom " +
                        test::quoted("file://" + visited));
    const std::size_t begin = shown.out.find("SEEN{");
    ASSERT_NE(begin, std::string::npos) << shown.out.substr(0, 2000) << shown.err;
    const std::size_t end = shown.out.find("}SEEN", begin);
    const auto seen = nlohmann::json::parse(shown.out.substr(begin + 4, end - begin - 3));
    EXPECT_EQ(seen["sections"], 3);
    EXPECT_EQ(seen["wrong"], 0);
    EXPECT_GT(seen["different"], 1000);
    EXPECT_EQ(seen["both"], true);
    EXPECT_EQ(seen["cut"], "inset(0px 0px 0px 25%)");
    EXPECT_EQ(seen["onePlace"], true);
    EXPECT_NE(seen["blinks"][0], seen["blinks"][1]);
    EXPECT_EQ(seen["blinks"][0], seen["blinks"][2]);
}

}  // namespace
}  // namespace corda
