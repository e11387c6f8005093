// Thousands of broken scenes, the same on every run: each gives a scene or a corda::Error.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/scene/scene.hpp"
#include "corda/scene/schema.hpp"
#include "fuzz/text_mutator.hpp"

namespace corda::scene {
namespace {

using test::kTokens;
using test::TextMutator;

constexpr std::array<std::string_view, 5> kScenes{
    R"(schema = 1
[world]
gravity = 9.81
duration = 2.0
drag = 0.01
[[rope]]
line = { particles = 12, from = [0.0, 50.0], step = [0.1, -1.0] }
mass = 1.0
payload = 2.0
velocity = [0.0, 1.0]
pinned = [0, -1]
color = "#e8c07d"
[solver]
method = "relaxation"
step = 0.002
reach = 7
sweeps = 1
delta = 0.001
force = [0.0, -9.8]
[video]
size = [640, 360]
fps = "30000/1001"
)",
    R"(schema = 1
world = { gravity = [0.0, -9.81], duration = 1e1 }
[[rope]]
hang = { links = 20, length = 1.0, angle_deg = 45.0, from = [0.0, 0.0] }
pinned = []
[[rope]]
points = [[0.0, 0.0], [0.1, -1.0], [0.3, -1.5]]
origin = [2.0, -1.0]
mass = [1, 2.5, 3]
velocity = [[0, 0], [1, 2], [3.0, -4.0]]
width_px = 3.5
[camera]
center = [0.0, 1.0]
height = 5.0
margin = 0.1
)",
    R"(schema = 1 # comment
rope = [{ line = { particles = 2, step = [1, 0] } }]
[style]
theme = "paper"
background = ["#101010", "#202020"]
payload = false
supports = true
halo = true
trail_s = 0.5
color_by = "speed"
net_width_px = 2.5
palette = ["#ff0000", '#00ff00']
rope_width_px = 4
markers = "all"
marker_radius_px = 6.0
pinned_color = """#ff5d5d"""
bars = "real"
bar_width_px = 1.0
imaginary_bar_color = "#54d6c270"
[overlay]
time = true
title = "t"
text_px = 20.0
[video]
fps = 25
codec = "libx264"
preset = "medium"
crf = 18
threads = 2
shutter = 0.5
subframes = 4
)",
    R"(schema = 1
[[net]]
grid = { columns = 4, rows = 3, from = [0.0, 1.5], spacing = [0.1, 0.2], diagonals = true }
mass = 0.02
velocity = [-6.0, 5.0]
pinned = [[0, 0], [-1, 0], 5]
compliance = 1e-3
string = true
width_px = 1.5
[[net]]
points = [[0, 0], [1, 0], [1, 1], [0.5, 2.5]]
bars = [[0, 1], [1, 2], [-1, 0]]
mass = [1, 2, 3, 4]
pinned = [0, -1]
color = "#ffffff80"
[[net]]
grid = { columns = 2, rows = 2, spacing = 1, diagonals = false }
[solver]
method = "relaxation"
)",
    R"(schema = 1
[[rope]]
points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
closed = true
bending = 0.25
compliance = 1e-4
link_length = [1.0, 1.5, 0.5, 2]
[[rope]]
line = { particles = 3, step = [0, -1] }
string = true
link_length = 1.25
[[rope]]
hang = { links = 2, length = 1 }
closed = false
string = false
bending = 1e3
[solver]
method = "rattle"
order = 6
step = 1e-3
[[solver.bodies]]
ropes = [1, -1]
nets = []
method = "relaxation"
reach = 2
)"};

TEST(SceneMutations, GiveASceneOrAnError) {
    constexpr std::uint32_t kRuns = 8000;
    int scenes = 0;
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
        const std::string text = TextMutator(seed).broken(kScenes);
        try {
            static_cast<void>(parse_scene(text, "mutation.toml"));
            ++scenes;
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ExitCode::kInvalidScene) << text;
            const std::string_view message = error.what();
            ASSERT_NE(message, "") << text;
            ASSERT_LE(std::count(message.begin(), message.end(), '\n'), 20) << text;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what() << "\n" << text;
        }
    }
    // Some mutations change only a comment or a number. If all were errors, the scenes themselves would be
    // broken.
    EXPECT_GT(scenes, 100);
}

TEST(SceneMutations, SettingsGiveASceneOrAnError) {
    constexpr std::uint32_t kRuns = 3000;
    constexpr std::array<std::string_view, 13> kKeys{
        "rope[0].mass",          "world",          "video.size[1]",       "rope[1].line",
        "solver.step",           "a.b[0].c",       "net[0].grid.rows",    "net[1].bars",
        "net[0].pinned[1]",      "rope[0].string", "rope[0].link_length", "solver.bodies",
        "solver.bodies[0].ropes"};
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
        std::mt19937 random(seed);
        std::string setting(kKeys[random() % kKeys.size()]);
        setting += '=';
        for (std::uint32_t i = 0; i <= seed % 3; ++i) setting += kTokens[random() % kTokens.size()];
        if (seed % 5 == 0) setting[random() % setting.size()] = static_cast<char>(random() % 256);
        try {
            static_cast<void>(parse_scene(kScenes[seed % kScenes.size()], "mutation.toml", {setting}));
        } catch (const Error& error) {
            ASSERT_TRUE(error.code() == ExitCode::kInvalidScene || error.code() == ExitCode::kUsage)
                << setting;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what() << "\n" << setting;
        }
    }
}

/// Values at the limits of a key, beyond them, and of other types.
std::vector<std::string> values_of(const Key& key) {
    const Range& range = key.type.range;
    std::vector<std::string> values(kTokens.begin(), kTokens.begin() + 13);
    for (const double bound : {range.low, range.high, range.low - 1.0, 2.0 * range.high}) {
        const std::string number = number_text(bound);
        values.insert(values.end(), {number, "[" + number + "]", "[" + number + ", " + number + "]",
                                     "[[" + number + ", 1], [0, " + number + "]]"});
    }
    for (const std::string_view word : key.type.choices) values.emplace_back(word);
    if (!key.binding.initial.toml.empty()) values.push_back(key.binding.initial.toml);
    values.insert(values.end(),
                  {"true", "\"red\"", "[\"red\", \"#00000000\"]", "\"\"", "[]", "{}", "1e-5", "3"});
    return values;
}

TEST(SceneMutations, OfEveryKeyGiveASceneOrAnError) {
    int scenes = 0;
    for (const Key& key : all_keys()) {
        std::string path = path_of(key);
        while (path.find("[]") != std::string::npos) path.replace(path.find("[]"), 2, "[0]");
        for (const std::string& value : values_of(key)) {
            const Setting setting = path + "=" + value;
            for (const std::string_view scene : kScenes) {
                try {
                    static_cast<void>(parse_scene(scene, "mutation.toml", {setting}));
                    ++scenes;
                } catch (const Error& error) {
                    ASSERT_EQ(error.code(), ExitCode::kInvalidScene) << setting;
                } catch (const std::exception& error) {
                    FAIL() << error.what() << "\n" << setting;
                }
            }
        }
    }
    EXPECT_GT(scenes, 1000);
}

}  // namespace
}  // namespace corda::scene
