#include <gmock/gmock.h>

#include <string>

#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

Scene coloured(ColorBy by, const std::string& solver = {}) {
    Scene scene = parse_scene(
        "schema = 1\n[world]\nduration = 1.0\n[[rope]]\nhang = { links = 6, length = 1.0, angle_deg = 70.0 "
        "}\n"
        "payload = 3.0\n[video]\nsize = [160, 120]\nfps = 30\n" +
            solver,
        "coloured.toml");
    scene.style.color_by = by;
    return scene;
}

TEST(Colours, RecordOnlyTheFieldsTheyNeed) {
    EXPECT_TRUE(Film(coloured(ColorBy::kBody)).state(3).vx_m_s.empty());
    EXPECT_TRUE(Film(coloured(ColorBy::kStrain)).state(3).tension_n.empty());
    Film film(coloured(ColorBy::kTension));
    EXPECT_EQ(film.state(3).tension_n.size(), 6U);
    EXPECT_TRUE(film.state(3).vx_m_s.empty());
    EXPECT_EQ(Film(coloured(ColorBy::kSpeed)).state(3).vx_m_s.size(), 7U);
}

TEST(Colours, DoNotChangeTheMotion) {
    Film plain(coloured(ColorBy::kBody));
    Film film(coloured(ColorBy::kTension));
    EXPECT_EQ(film.state(20).x_m, plain.state(20).x_m);
    EXPECT_EQ(film.plan().simulation_passes, plain.plan().simulation_passes);
}

TEST(Colours, OfUnknownTensionsAreRefused) {
    // Imaginary bars that share the load in any way.
    const Scene scene = parse_scene(
        "schema = 1\n[[net]]\ngrid = { columns = 4, rows = 3, spacing = 0.2, diagonals = true "
        "}\n[style]\ncolor_by = "
        "\"tension\"\n",
        "stiff.toml");
    const auto failure = test::failure_of([&] { static_cast<void>(Film(scene)); });
    EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
    EXPECT_NE(failure.message.find("stiff.toml:5:12: style.color_by: "), std::string::npos)
        << failure.message;
    EXPECT_NE(failure.message.find("set style.color_by"), std::string::npos) << failure.message;
}

TEST(Colours, OfAQuantityNeedAMotion) {
    EXPECT_EQ(test::code_of([] { Renderer{coloured(ColorBy::kSpeed)}; }), ExitCode::kInvalidScene);
}

}  // namespace
}  // namespace corda
