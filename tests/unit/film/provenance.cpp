#include "corda/film/provenance.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "corda/film/film.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kScene = "schema = 1  # a rope\n[[rope]]\nhang = { links = 3, length = 1.0 }\n";

Provenance read(const std::string& text) {
    return provenance_in({.text = {{kProvenanceKeyword, text}}});
}

TEST(Provenances, HaveTheTextAndTheSettingsOfTheScene) {
    const Scene scene = parse_scene(kScene, "a.toml", {"video.jobs=3", "world.drag=0.5"});
    const Provenance made = read(provenance_text(provenance_of(scene)));
    EXPECT_EQ(made.scene, kScene);
    EXPECT_THAT(made.settings, ElementsAre("world.drag=0.5"));
    EXPECT_EQ(scene_of(made, "a.png").world.drag_1_s, 0.5);
    EXPECT_EQ(scene_of(made, "a.png", {"world.drag=0.25"}).world.drag_1_s, 0.25);
}

TEST(Provenances, OfScenesThatCodeChangesSayWhatIsDrawn) {
    Scene scene = parse_scene(kScene, "a.toml", {"world.drag=0.5"});
    scene.video.width_px = 64;
    const Provenance made = provenance_of(scene);
    EXPECT_THAT(made.scene, HasSubstr("size = [64, 1080]"));
    EXPECT_TRUE(made.settings.empty());
    EXPECT_EQ(scene_of(made, "a.png").world.drag_1_s, 0.5);
    scene.text.clear();
    EXPECT_EQ(provenance_of(scene).scene, made.scene);
}

TEST(Provenances, OfScenesWithoutANameOfAFileCanBeReadBack) {
    Scene scene = parse_scene(kScene, "a.toml");
    for (const std::string name : {"", "a/b", ".."}) {
        scene.name = name;
        EXPECT_EQ(read(provenance_text(provenance_of(scene))).name, "scene");
        EXPECT_EQ(left_out_of(provenance_text(provenance_of(scene))), "");
    }
}

/// A text of random characters, which cannot be compressed to less than half.
std::string random_text(std::size_t bytes) {
    std::mt19937 random(1);
    std::string text;
    while (text.size() < bytes) text += fmt::format("#{:08x}", random());
    return text;
}

TEST(Provenances, AreCompressedIfTheyAreLong) {
    const Provenance film{.corda = "0.1.0", .name = "a", .scene = random_text(40'000)};
    const std::string text = provenance_text(film);
    EXPECT_LE(text.size(), Provenance::kMaxBytes);
    EXPECT_EQ(left_out_of(text), "");
    EXPECT_EQ(read(text).scene, film.scene);
}

TEST(Provenances, SayWhyTheyHaveNoScene) {
    for (const std::size_t bytes : {std::size_t{100'000}, std::size_t{2} << 20}) {
        const std::string text =
            provenance_text({.corda = "0.1.0", .name = "a", .scene = random_text(bytes)});
        EXPECT_LE(text.size(), Provenance::kMaxBytes);
        EXPECT_THAT(left_out_of(text), HasSubstr("the scene takes "));
        EXPECT_THAT(test::failure_of([&] { static_cast<void>(scene_of(read(text), "a.mp4")); }).message,
                    HasSubstr("'a.mp4' does not carry its scene, because the scene takes "));
    }
}

TEST(Provenances, HaveSoundNames) {
    Scene scene = parse_scene(kScene, "a.toml");
    for (const std::string& letter : {std::string("a"), std::string("\u00e4")}) {
        scene.name.clear();
        while (scene.name.size() < 300) scene.name += letter;
        const Provenance one = read(provenance_text(provenance_of(scene)));
        EXPECT_TRUE(one.name.ends_with(letter + "..."));
        EXPECT_LE(one.name.size(), 255U);
    }
}

}  // namespace
}  // namespace corda
