#include "corda/serve/watch.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cstdint>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "corda/serve/smaller.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda::serve {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kScene = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 80.0 }
[video]
fps = 30
size = [1280, 720]
)";

std::string replaced(std::string text, const std::string& old, const std::string& its) {
    return text.replace(text.find(old), old.size(), its);
}

/// The next state that is not busy and has another version than `version`, which becomes its own.
Json next_state(Watch& watch, std::int64_t& version) {
    while (true) {
        const Response response = watch.answer({false, "state", {{"after", std::to_string(version)}}, ""});
        if (response.status == 204) {  // unchanged
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            continue;
        }
        Json state = Json::parse(response.body);
        version = state["version"];
        if (!state["busy"]) return state;
    }
}

class WatchTest : public testing::Test {
  protected:
    Response get(const std::string& path, std::int64_t film = 0) {
        return watch_.answer({false, path, {{"film", std::to_string(film)}}, ""});
    }
    Response post(const std::string& path, const Json& body) {
        return watch_.answer({true, path, {}, body.dump()});
    }

    Json state() { return next_state(watch_, version_); }

    Json save(const std::string& text) {
        test::write_file(path_, text);
        watch_.reload();
        return state();
    }

    [[nodiscard]] Image picture(std::int64_t k, std::int64_t film) {
        const Response response = get("frame/" + std::to_string(k) + ".png", film);
        EXPECT_EQ(response.status, 200U) << response.body;
        return read_png(folder_.write("picture.png", response.body));
    }

    const test::ScratchFolder folder_;
    const std::string path_ = folder_.write("scene.toml", kScene);
    std::int64_t version_ = 0;
    Watch watch_{{.path = path_, .settings = {}, .longest_side_px = 320, .film = {}}};
};

TEST_F(WatchTest, ShowsTheFramesOfTheFilm) {
    const Json film = state()["film"];
    EXPECT_EQ(film["frames"], 30);
    EXPECT_EQ(film["width"], 320);
    EXPECT_EQ(film["height"], 180);
    EXPECT_EQ(film["fps"], 30.0);
    EXPECT_THAT(film["plan"].dump(), HasSubstr("error estimate"));
    const Film whole(parse_scene(kScene, "scene.toml"));
    for (const std::int64_t k : {17, 0, 29})
        EXPECT_EQ(picture(k, film["number"]), made_smaller(whole.frame(k), 320, 180)) << k;
    for (const char* const path : {"frame/30.png", "frame/-1.png", "frame/3.gif", "frame/", "other"})
        EXPECT_GE(get(path, film["number"]).status, 400U) << path;
    EXPECT_EQ(get("frame/3.png", 99).status, 410U);
}

TEST_F(WatchTest, GivesAngleAndEnergy) {
    const Json curves = Json::parse(get("curves", state()["film"]["number"]).body);
    ASSERT_EQ(curves["t"].size(), 30U);
    EXPECT_NEAR(curves["angle_deg"][0].get<double>(), 80.0, 1e-9);
    EXPECT_NEAR(curves["kinetic_j"][20].get<double>() + curves["potential_j"][20].get<double>(), 0.0,
                1e-3);  // measured 2e-5
}

TEST_F(WatchTest, KeepsTheLastGoodFilmBesideAnError) {
    const Json good = state();
    const Json bad = save(replaced(kScene, "length = 1.0", "lenght = 1.0"));
    EXPECT_EQ(bad["film"], good["film"]);
    ASSERT_EQ(bad["problems"].size(), 1U);
    EXPECT_EQ(bad["problems"][0]["line"], 5);
    EXPECT_EQ(bad["problems"][0]["column"], 21);
    EXPECT_THAT(bad["problems"][0]["key"].get<std::string>(), testing::StartsWith("rope[0]"));
    EXPECT_THAT(bad["problems"][0]["text"], HasSubstr("did you mean \"length\"?"));
    EXPECT_EQ(picture(3, good["film"]["number"]).width(), 320);
    const Json again = save(kScene);
    EXPECT_TRUE(again["problems"].empty());
    EXPECT_GT(again["film"]["number"], good["film"]["number"]);
}

TEST_F(WatchTest, TellsWhatIsWrongWithAFileUntilItIsThere) {
    const std::string path = folder_.path() + "/later.toml";
    std::vector<std::string> told;
    Watch watch({.path = path,
                 .settings = {},
                 .longest_side_px = 160,
                 .film = {},
                 .on_problems = [&](const std::vector<Problem>& problems) {
                     for (const Problem& problem : problems) told.push_back(problem.text());
                     if (problems.empty()) told.emplace_back("shown");
                 }});
    std::int64_t version = 0;
    EXPECT_THAT(next_state(watch, version)["problems"].dump(),
                AllOf(HasSubstr("cannot read the scene file"), Not(HasSubstr(path))));
    test::write_file(path, kScene);
    watch.reload();
    EXPECT_EQ(next_state(watch, version)["film"]["frames"], 30);
    EXPECT_THAT(told, testing::ElementsAre(AllOf(testing::StartsWith(path + ": cannot read the scene file"),
                                                 HasSubstr("give the path of a TOML file")),
                                           "shown"));
}

TEST_F(WatchTest, ASaveInterruptsTheWork) {
    static_cast<void>(state());
    // Hours of simulation, which end at once.
    test::write_file(
        path_, replaced(replaced(kScene, "links = 3", "links = 3000"), "duration = 1.0", "duration = 60.0"));
    watch_.reload();
    while (!Json::parse(watch_.answer({false, "state", {{"after", "0"}}, ""}).body)["busy"]) continue;
    EXPECT_EQ(save(kScene)["film"]["frames"], 30);
}

TEST_F(WatchTest, NumbersChangeTheFilmAndTheFileOnlyWhenAsked) {
    const std::int64_t film = state()["film"]["number"];
    const Image before = picture(10, film);
    EXPECT_EQ(post("number", {{"key", "rope[0].hang.angle_deg"}, {"value", 45}}).status, 200U);
    const Json changed = state();
    EXPECT_EQ(changed["changes"], 1);
    EXPECT_NE(picture(10, changed["film"]["number"]), before);
    EXPECT_EQ(test::read_file(path_), kScene);
    EXPECT_EQ(post("number", {{"key", "rope[0].mass"}, {"value", 45}}).status, 400U);

    test::write_file(path_, std::string(kScene) + "# more\n");
    EXPECT_EQ(post("write", Json::object()).status, 409U);  // by another program, meanwhile
    watch_.reload();
    EXPECT_EQ(state()["changes"], 1);
    EXPECT_EQ(post("write", Json::object()).status, 200U);
    EXPECT_EQ(test::read_file(path_), replaced(kScene, "80.0", "45.0") + "# more\n");
    EXPECT_EQ(state()["changes"], 0);
    EXPECT_EQ(post("number", {{"key", "rope[0].hang.angle_deg"}, {"value", nullptr}}).status, 200U);

    const std::string file_before = test::read_file(path_);
    EXPECT_EQ(post("number", {{"key", "world.duration"}, {"value", -2}}).status, 200U);
    EXPECT_FALSE(state()["problems"].empty());
    EXPECT_EQ(post("write", Json::object()).status, 409U);  // of a number that the scene refuses
    EXPECT_EQ(test::read_file(path_), file_before);
    EXPECT_EQ(save(replaced(file_before, "duration = 1.0", ""))["changes"], 0);  // of a number that is gone
}

TEST_F(WatchTest, AFrameStaysUntilItIsTaken) {
    Watch watch({.path = path_, .settings = {}, .longest_side_px = 160, .picture_bytes = 1, .film = {}});
    std::int64_t version = 0;
    const std::string number = next_state(watch, version)["film"]["number"].dump();
    std::vector<std::future<Response>> frames;
    for (int k = 0; k < 30; ++k)
        frames.push_back(std::async(std::launch::async, [&watch, &number, k] {
            Response answer;
            do {  // asks again for a frame that takes long
                answer = watch.answer({false, fmt::format("frame/{}.png", k), {{"film", number}}, ""});
            } while (answer.status == 503U);
            return answer;
        }));
    for (std::future<Response>& frame : frames) EXPECT_EQ(frame.get().status, 200U);
}

TEST_F(WatchTest, TellsADivergenceBeforeItsFrameIsAskedFor) {
    static_cast<void>(state());
    const Json diverged = save(std::string(kScene) +
                               "[camera]\ncenter = [0, 0]\nheight = 3\n[solver]\n"
                               "method = \"relaxation\"\nforce = [1e300, 0.0]\n");
    EXPECT_THAT(diverged["problems"].dump(), HasSubstr("diverge"));
}

TEST_F(WatchTest, NumbersAreThoseOfSettings) {
    Watch watch({.path = path_,
                 .settings = {"rope[0].hang.angle_deg=30", "world.gravity=[0,-2]"},
                 .longest_side_px = 160,
                 .film = {}});
    auto next = [&watch, version = std::int64_t{0}]() mutable { return next_state(watch, version); };
    const auto post = [&watch](const std::string& path, const Json& body) {
        return watch.answer({true, path, {}, body.dump()}).status;
    };
    const auto angle = [](const Json& state) {
        for (const Json& number : state["numbers"])
            if (number["key"] == "rope[0].hang.angle_deg") return number["value"].get<double>();
        return 0.0;
    };
    EXPECT_EQ(angle(next()), 30.0);
    EXPECT_EQ(post("number", {{"key", "world.duration"}, {"value", -2}}), 200U);
    EXPECT_THAT(next()["problems"].dump(),
                AllOf(HasSubstr("slider world.duration=-2: world.duration: "), Not(HasSubstr("--set"))));
    EXPECT_EQ(post("number", {{"key", "world.duration"}, {"value", nullptr}}), 200U);
    static_cast<void>(next());
    EXPECT_EQ(post("number", {{"key", "rope[0].hang.angle_deg"}, {"value", 80}}), 200U);  // that of the file
    const Json changed = next();
    EXPECT_EQ(changed["changes"], 1);
    EXPECT_EQ(angle(changed), 80.0);
    EXPECT_EQ(post("number", {{"key", "rope[0].hang.angle_deg"}, {"value", 45}}), 200U);
    static_cast<void>(next());
    EXPECT_EQ(post("write", Json::object()), 200U);
    EXPECT_EQ(angle(next()), 45.0);
    EXPECT_EQ(test::read_file(path_), replaced(kScene, "80.0", "45.0"));
}

TEST_F(WatchTest, WrittenNumbersCountInPlaceOfSettingsHoweverTheyAreSpelt) {
    const std::string text = replaced(kScene, "duration = 1.0", "duration = 1.0\ngravity = [0.0, -9.0]");
    test::write_file(path_, text);
    Watch watch({.path = path_,
                 .settings = {"world.duration = 2", "world.gravity=[0,-5]", "video.fps=10"},
                 .longest_side_px = 160,
                 .film = {}});
    auto next = [&watch, version = std::int64_t{0}]() mutable { return next_state(watch, version); };
    EXPECT_EQ(next()["film"]["frames"], 20);
    for (const auto& [key, value] : {std::pair("world.duration", 4.0), std::pair("world.gravity[1]", -3.0)}) {
        EXPECT_EQ(watch.answer({true, "number", {}, Json{{"key", key}, {"value", value}}.dump()}).status,
                  200U);
        static_cast<void>(next());
    }
    EXPECT_EQ(watch.answer({true, "write", {}, "{}"}).status, 200U);
    const Json state = next();
    EXPECT_EQ(state["changes"], 0);
    EXPECT_EQ(state["film"]["frames"], 40);
    for (const Json& number : state["numbers"]) {
        if (number["key"] == "world.gravity[1]") {
            EXPECT_EQ(number["value"], -3.0);
        }
    }
}

TEST_F(WatchTest, PicturesHaveTheSizeThatIsAskedFor) {
    static_cast<void>(state());
    EXPECT_EQ(post("side", {{"px", 640}}).status, 200U);
    const Json film = state()["film"];
    EXPECT_EQ(film["width"], 640);
    EXPECT_EQ(picture(0, film["number"]).height(), 360);
    EXPECT_EQ(post("side", {{"px", 100000}}).status, 200U);
    const Json whole = state();
    EXPECT_EQ(whole["film"]["width"], 1280);  // that of the scene
    EXPECT_EQ(whole["side"], (Json{{"px", kMaxSidePx}, {"fits", false}}));
    EXPECT_EQ(post("side", {{"px", "big"}}).status, 400U);
}

TEST_F(WatchTest, AnswersAtOnceWhetherTheStateIsNew) {
    const Json now = state();
    EXPECT_EQ(now["side"], (Json{{"px", 320}, {"fits", false}}));
    EXPECT_EQ(watch_.answer({false, "state", {{"after", now["version"].dump()}}, ""}).status, 204U);
    // Those of the next program at the same address are others.
    Watch next({.path = path_, .settings = {}, .longest_side_px = {}, .film = {}});
    std::int64_t version = 0;
    const Json later = next_state(next, version);
    EXPECT_GT(later["film"]["number"], now["film"]["number"]);
    EXPECT_EQ(later["side"]["fits"], true);
}

/// The bytes of the command line's files, with the numbers of the page.
TEST_F(WatchTest, StillsAndVideosAreThoseOfTheProgram) {
    static_cast<void>(state());
    EXPECT_EQ(post("number", {{"key", "rope[0].hang.angle_deg"}, {"value", 45}}).status, 200U);
    const std::int64_t film = state()["film"]["number"];
    const auto made_by = [&](const std::vector<std::string>& command, const std::string& output) {
        const std::string path = folder_.path() + "/" + output;
        std::vector<std::string> words = command;
        words.insert(words.begin() + 1, path_);
        words.insert(words.end(), {"--set", "rope[0].hang.angle_deg=45", "-o", path});
        const test::CommandResult run = test::run_corda(words);
        EXPECT_EQ(run.exit_code, 0) << run.err;
        return test::read_file(path);
    };
    const Response still = get("still/7.png", film);
    EXPECT_EQ(still.status, 200U);
    EXPECT_TRUE(still.body == made_by({"still", "--frame", "7"}, "still.png"));
    EXPECT_EQ(get("still/30.png", film).status, 410U);
    EXPECT_EQ(get("still/7.png", film + 1).status, 410U);

    EXPECT_EQ(post("render", {{"ending", "exe"}}).status, 400U);
    EXPECT_EQ(post("render", {{"ending", "mp4"}}).status, 200U);
    Json render;
    do render = state()["render"];
    while (render["is_running"]);
    EXPECT_EQ(render["text"], "30 frames written");
    EXPECT_EQ(render["progress"], 1.0);
    EXPECT_TRUE(test::read_file(folder_.path() + "/scene.mp4") == made_by({"render"}, "other.mp4"));
    const Response exists = post("render", {{"ending", "mp4"}});
    EXPECT_EQ(exists.status, 409U);
    EXPECT_THAT(exists.body, HasSubstr("scene.mp4"));
    EXPECT_EQ(post("render", {{"ending", "mp4"}, {"force", true}}).status, 200U);
    EXPECT_EQ(post("stop", Json::object()).status, 200U);
    EXPECT_EQ(state()["render"]["is_running"], false);
    EXPECT_TRUE(test::read_file(folder_.path() + "/scene.mp4") ==
                test::read_file(folder_.path() + "/other.mp4"));
}

}  // namespace
}  // namespace corda::serve
