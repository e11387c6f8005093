#include "corda/pipeline/provenance.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

Provenance read(const std::string& text) {
    return provenance_in({.text = {{kProvenanceKeyword, text}}});
}

/// Scenes of `bytes` each; random ones cannot be compressed to less than half.
std::vector<Provenance> files_of(std::size_t count, std::size_t bytes, bool is_random) {
    std::mt19937 random(1);
    std::vector<Provenance> files;
    for (std::size_t i = 0; i < count; ++i) {
        Provenance& file = files.emplace_back();
        file.corda = "0.1.0";
        file.name = fmt::format("pendulum {}", i);
        while (file.scene.size() < bytes) file.scene += fmt::format("#{:08x}", is_random ? random() : i);
    }
    return files;
}

TEST(Provenances, OfManyScenesAreCompressed) {
    for (const auto& files : {files_of(64, 2000, false), files_of(12, 3000, true)}) {
        const std::string text = provenance_text(joined(files));
        EXPECT_LE(text.size(), Provenance::kMaxBytes);
        EXPECT_EQ(left_out_of(text), "");
        const Provenance one = read(text);
        ASSERT_EQ(one.parts.size(), files.size());
        for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(one.parts[i].scene, files[i].scene) << i;
    }
}

TEST(Provenances, SayWhyTheyHaveNoScenes) {
    const std::string text = provenance_text(joined(files_of(20, 6000, true)));
    EXPECT_LE(text.size(), Provenance::kMaxBytes);
    EXPECT_THAT(left_out_of(text), HasSubstr("the scenes take "));
    const Provenance one = read(text);
    ASSERT_THAT(one.parts, SizeIs(20));
    EXPECT_THAT(test::failure_of([&] { static_cast<void>(scene_of(one.parts[7], "a.mp4")); }).message,
                HasSubstr("'a.mp4' does not carry its scene, because the scenes take "));
}

TEST(Provenances, OfMoreVideosThanHaveRoomCanBeRead) {
    const std::string text = provenance_text(joined(files_of(1000, 0, false)));
    EXPECT_LE(text.size(), Provenance::kMaxBytes);
    EXPECT_THAT(left_out_of(text), HasSubstr("the names of 1000 scenes take "));
    EXPECT_THAT(read(text).name, HasSubstr("pendulum 0, pendulum 1, "));
}

TEST(Provenances, OfLongNamesAreSound) {
    std::vector<Provenance> files = files_of(2, 20, false);
    for (const std::string& letter : {std::string("a"), std::string("\u00e4")}) {
        for (Provenance& file : files) {
            file.name.clear();
            while (file.name.size() < 240) file.name += letter;
        }
        const Provenance one = read(provenance_text(joined(files)));
        EXPECT_EQ(one.name.substr(0, 240), files[0].name);
        EXPECT_TRUE(one.name.ends_with(letter + "..."));
        EXPECT_LE(one.name.size(), 255U);
    }
}

}  // namespace
}  // namespace corda
