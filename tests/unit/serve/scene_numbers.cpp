#include "corda/serve/scene_numbers.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "support/failure.hpp"

namespace corda::serve {
namespace {

using testing::ElementsAre;

constexpr const char* kManyNumbers = R"(schema = 1
[overlay]
title = "é, 30 °"  # not a number: 5
[world]
gravity = [0.0, -9.81]
duration = 4
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 80.0 }
mass = [1, 2.5, 3, 4]
pinned = [0]
[[rope]]
points = [[0, 0], [1, 0]]
compliance = 1e-3
release = [{ pin = 0, t = 1.5 }]
[video]
fps = 30
)";

std::vector<std::string> keys_of(const char* text) {
    std::vector<std::string> keys;
    for (const SceneNumber& number : numbers_of(text, "a.toml")) keys.push_back(number.key);
    return keys;
}

TEST(SceneNumbers, AreThoseOfMotionAndPictureInOrder) {
    EXPECT_THAT(
        keys_of(kManyNumbers),
        ElementsAre("world.gravity[0]", "world.gravity[1]", "world.duration", "rope[0].hang.links",
                    "rope[0].hang.length", "rope[0].hang.angle_deg", "rope[0].mass[0]", "rope[0].mass[1]",
                    "rope[0].mass[2]", "rope[0].mass[3]", "rope[1].compliance", "rope[1].release[0].t"));
    const SceneNumber links = numbers_of(kManyNumbers, "a.toml")[3];
    EXPECT_EQ(links.value, 3.0);
    EXPECT_TRUE(links.is_integer);
    EXPECT_EQ(links.low, 1.0);
    EXPECT_EQ(links.line, 8U);
    EXPECT_EQ(numbers_of(kManyNumbers, "a.toml")[5].unit, "degrees");
    EXPECT_TRUE(keys_of("schema = 1\n[[rope]]\nmass = [1, 2, 3, 4, 5]\nnonsense = 3\n").empty());
    EXPECT_EQ(test::code_of([] { static_cast<void>(numbers_of("a = ", "a.toml")); }),
              ExitCode::kInvalidScene);
}

TEST(SceneNumbers, ChangesBecomeSettings) {
    const auto numbers = numbers_of(kManyNumbers, "a.toml");
    EXPECT_THAT(
        settings_of({{"rope[0].hang.links", 5.0}, {"world.gravity[1]", -1.62}, {"gone", 1.0}}, numbers),
        ElementsAre("world.gravity[1]=-1.62", "rope[0].hang.links=5"));
}

TEST(SceneNumbers, WritingKeepsAllOtherBytes) {
    std::string expected = kManyNumbers;
    const auto replace = [&](const std::string& old, const std::string& its) {
        expected.replace(expected.find(old), old.size(), its);
    };
    replace("-9.81", "-1.62");
    replace("duration = 4", "duration = 2.5");
    replace("links = 3", "links = 12");
    replace("80.0", "45.0");
    replace("2.5, 3, 4]", "2.5, 3, 7]");
    replace("1e-3", "0.5");
    EXPECT_EQ(with_changes(kManyNumbers, "a.toml",
                           {{"world.gravity[1]", -1.62},
                            {"world.duration", 2.5},
                            {"rope[0].hang.links", 12.0},
                            {"rope[0].hang.angle_deg", 45.0},
                            {"rope[0].mass[3]", 7.0},
                            {"rope[1].compliance", 0.5}}),
              expected);
    EXPECT_EQ(
        with_changes("schema = 1\nworld = { title = \"é°\", drag = 1.0 }", "a.toml", {{"world.drag", 2.0}}),
        "schema = 1\nworld = { title = \"é°\", drag = 2.0 }");
    EXPECT_EQ(test::code_of([] {
                  static_cast<void>(with_changes(kManyNumbers, "a.toml", {{"world.drag", 1.0}}));
              }),
              ExitCode::kUsage);
}

TEST(SceneNumbers, WritingKeepsMarksAndLineEnds) {
    const std::string mark = "\xef\xbb\xbf";
    EXPECT_EQ(with_changes(mark + "world.duration = 1.5\nschema = 1\n", "a.toml", {{"world.duration", 2.0}}),
              mark + "world.duration = 2.0\nschema = 1\n");
    EXPECT_EQ(
        with_changes(mark + "# \u00e9\u20ac\U0001f600\r\n\"world\" . 'duration' = +1_0.5\r\nschema = 1\r\n",
                     "a.toml", {{"world.duration", 2.0}}),
        mark + "# \u00e9\u20ac\U0001f600\r\n\"world\" . 'duration' = 2.0\r\nschema = 1\r\n");
    EXPECT_EQ(
        with_changes("world={title=\"\U0001f600\U0001f600\",drag=1.0}", "a.toml", {{"world.drag", 2.0}}),
        "world={title=\"\U0001f600\U0001f600\",drag=2.0}");
}

}  // namespace
}  // namespace corda::serve
