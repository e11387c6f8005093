#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using test::code_of;

Scene rope() {
    return parse_scene(R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[video]
fps = 30
[solver]
method = "exact"
)",
                       "rope.toml");
}

TEST(FilmEnergy, NeedsVelocities) {
    Film film(rope());
    EXPECT_EQ(code_of([&] { static_cast<void>(film.energy_of(film.state(3))); }), ExitCode::kUsage);
}

TEST(FilmEnergy, OfAnExactRunIsConserved) {
    FilmDef def;
    def.readings.velocities = true;
    const Film film(rope(), def);
    const Energy energy = film.energy_of(film.state(25));
    EXPECT_GT(energy.kinetic_j, 0.9);
    EXPECT_EQ(energy.elastic_j, 0.0);
    EXPECT_NEAR(energy.kinetic_j + energy.potential_j(), 0.0, 1e-12);  // measured 9e-14
}

TEST(FilmMask, RefusesMoreBodiesThanItCanDistinguish) {
    std::string scene = "schema = 1\n[world]\nduration = 0.1\n";
    for (int i = 0; i < 256; ++i) scene += "[[rope]]\nhang = { links = 1, length = 1.0 }\n";
    Film film(parse_scene(scene, "bodies.toml"));
    EXPECT_EQ(code_of([&] { static_cast<void>(film.mask(0)); }), ExitCode::kUsage);
}

}  // namespace
}  // namespace corda
