#include "corda/film/film.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::code_of;
using test::equal_images;
using testing::HasSubstr;

const std::string kRope = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[video]
size = [96, 64]
fps = 30
)";

Film film_of(const std::string& toml, const FilmDef& def = {}) {
    return Film(parse_scene(toml, "film.toml"), def);
}

Film film_by(const std::string& solver) {
    return film_of(kRope + "[solver]\n" + solver);
}

void expect_same_bits(const State& a, const State& b) {
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.y_m, b.y_m);
}

TEST(FilmPasses, AreTwoIfTheFirstTrialOfAutoHolds) {
    Film film = film_of(kRope);
    ASSERT_EQ(film.plan().bodies.front().trials.size(), 1U);
    EXPECT_EQ(film.plan().simulation_passes, 2);
}

TEST(FilmPasses, AreOneForANamedMethod) {
    for (const char* solver : {"method = \"exact\"", "method = \"rattle\"", "method = \"relaxation\""}) {
        EXPECT_EQ(film_by(solver).plan().simulation_passes, 1) << solver;
    }
}

TEST(FilmPasses, IncludeFailedTrials) {
    // A motion that outgrows the first tolerance: a chain that magnifies every error.
    Film film = film_of(
        "schema = 1\n[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 170.0 }\n"
        "[world]\nduration = 6.0\n[video]\nsize = [96, 64]\nfps = 10\n[solver]\ntolerance_px = 0.001\n");
    ASSERT_GT(film.plan().bodies.front().trials.size(), 1U);
    // Two of each trial, and four of the tightest, which has three checks.
    EXPECT_EQ(film.plan().simulation_passes,
              2 * static_cast<int>(film.plan().bodies.front().trials.size()) + 2);
}

TEST(FilmMotion, IsTheCheckedRun) {
    Film film = film_of(kRope);
    Simulation again(film.system(), film.scene().world, film.plan().bodies.front().method);
    for (const std::int64_t k : {0, 11, 30}) {
        ASSERT_EQ(again.advance_to(film.time_s(k)), Status::kOk);
        expect_same_bits(film.state(k), again.state());
    }
}

TEST(FilmMotion, HasTheSameBitsAtUnannouncedTimes) {
    FilmDef def;
    def.stills_s = {0.123, 0.777, 0.5};
    Film announced = film_of(kRope, def);
    Film other = film_of(kRope);
    for (const double time_s : {0.777, 0.123, 0.5}) {
        expect_same_bits(announced.state_at(time_s), other.state_at(time_s));
        EXPECT_TRUE(equal_images(announced.still(time_s), other.still(time_s)));
    }
}

TEST(FilmMotion, RefusesTimesAndFramesOutsideOfTheScene) {
    Film film = film_of(kRope);
    EXPECT_EQ(film.frame_count(), 30);
    EXPECT_EQ(film.last_frame(), 30);
    for (const double time_s : {-1e-9, 1.1, std::nan("")})
        EXPECT_EQ(code_of([&] { static_cast<void>(film.state_at(time_s)); }), ExitCode::kUsage) << time_s;
    for (const std::int64_t k : {-1, 31})
        EXPECT_EQ(code_of([&] { static_cast<void>(film.frame(k)); }), ExitCode::kUsage) << k;
}

TEST(FilmMotion, IsShownUpToItsDivergence) {
    Film film = film_by("method = \"relaxation\"\nforce = [1e300, 0.0]");
    static_cast<void>(film.frame(1));
    EXPECT_EQ(code_of([&] { static_cast<void>(film.frame(20)); }), ExitCode::kDiverged);
    static_cast<void>(film.frame(0));
}

TEST(FilmFrames, AreTheSameInAnyOrder) {
    Film film = film_by("method = \"exact\"");
    std::vector<Image> backwards(30);
    for (std::int64_t k = 29; k >= 0; --k) backwards[static_cast<std::size_t>(k)] = film.frame(k);
    for (std::int64_t k = 0; k < 30; ++k)
        EXPECT_TRUE(equal_images(film.frame(k), backwards[static_cast<std::size_t>(k)])) << k;
}

TEST(FilmFrames, AreTheSameNextToAnotherFilmInOneThreadAndInTwo) {
    const auto sized = [](int width_px, int height_px) {
        Scene scene = parse_scene(kRope, "film.toml");
        scene.video.width_px = width_px;
        scene.video.height_px = height_px;
        return Film(scene);
    };
    const Image small_alone = sized(64, 48).frame(12);
    const Image large_alone = sized(640, 360).frame(12);
    Film a = sized(64, 48);
    Film b = sized(640, 360);
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(equal_images(a.frame(12), small_alone));
        EXPECT_TRUE(equal_images(b.frame(12), large_alone));
    }
    Image small_in_thread;
    Image large_in_thread;
    std::thread one([&] { small_in_thread = a.frame(12); });
    std::thread two([&] { large_in_thread = b.frame(12); });
    one.join();
    two.join();
    EXPECT_TRUE(equal_images(small_in_thread, small_alone));
    EXPECT_TRUE(equal_images(large_in_thread, large_alone));
}

TEST(FilmPlan, CannotBeFrozenIfRopesDifferInReach) {
    Scene scene = parse_scene(
        kRope +
            "[[rope]]\nhang = { links = 3, length = 1.0 }\n[solver]\nmethod = \"relaxation\"\nreach = 2\n",
        "two.toml");
    Film film(scene);
    EXPECT_THAT(frozen_toml(film), HasSubstr("reach = 2\n"));
    scene.ropes[0].reach = 1;
    Film mixed(scene);
    EXPECT_EQ(code_of([&] { static_cast<void>(frozen_toml(mixed)); }), ExitCode::kUsage);
}

TEST(FilmPlan, GivesTheSameBytesWhenFrozen) {
    for (const char* solver : {"method = \"auto\"", "method = \"rattle\"\norder = 6",
                               "method = \"relaxation\"\nreach = 3\nsweeps = 2\ndelta = 0.01"}) {
        Film chosen = film_by(solver);
        Film frozen = film_of(kRope + frozen_toml(chosen));
        EXPECT_FALSE(std::holds_alternative<AutoDef>(frozen.scene().solver));
        for (const std::int64_t k : {0, 13, 30}) {
            expect_same_bits(chosen.state(k), frozen.state(k));
            EXPECT_TRUE(equal_images(chosen.frame(k), frozen.frame(k))) << solver << frozen_toml(chosen);
        }
        EXPECT_EQ(frozen_toml(frozen), frozen_toml(chosen));
    }
}

TEST(FilmPlan, OfSeveralMethodsGivesTheSameBytesWhenFrozen) {
    const std::string bodies = kRope +
                               "[[rope]]\npoints = [[0.5, 0], [0.25, 0.45], [-0.25, 0.45], [-0.5, 0]]\n"
                               "closed = true\nbending = 0.01\n[[rope]]\nhang = { links = 4, length = 1.0 }\n"
                               "[[rope]]\npoints = [[0, 0], [0.3, 0.1]]\nstring = true\nlink_length = 0.5\n";
    Film chosen = film_of(bodies);
    const std::string toml = frozen_toml(chosen);
    EXPECT_THAT(toml, HasSubstr("[[solver.bodies]]\nropes = [1]\nmethod = \"rattle\""));
    Film frozen = film_of(bodies + toml);
    EXPECT_EQ(frozen.plan().simulation_passes, 1);
    for (const std::int64_t k : {0, 13, 30}) {
        expect_same_bits(chosen.state(k), frozen.state(k));
        EXPECT_TRUE(equal_images(chosen.frame(k), frozen.frame(k))) << toml;
    }
    EXPECT_EQ(frozen_toml(frozen), toml);
}

TEST(FilmPlan, KeepsTheDisplayedErrorWithinTheTolerance) {
    Film film = film_by("tolerance_px = 0.01");
    ASSERT_TRUE(film.error_estimate_px().has_value());
    EXPECT_LE(*film.error_estimate_px(), 0.01);
    EXPECT_FALSE(film_by("method = \"exact\"").error_estimate_px().has_value());
}

TEST(FilmProgress, CanStopTheSimulation) {
    FilmDef def;
    def.on_progress = [](std::int64_t done, std::int64_t) { return done < 5; };
    EXPECT_EQ(code_of([&] { static_cast<void>(film_of(kRope, def)); }), ExitCode::kInterrupted);
}

TEST(FilmProgress, MayUseTheFilmThatIsDrawn) {
    const Film film = film_of(kRope);
    const Film other = film_of(kRope);
    const Image alone = film.frame(3);
    int calls = 0;
    {
        const CancelScope drawing([&] {
            EXPECT_TRUE(equal_images(film.frame(3), alone));
            EXPECT_TRUE(equal_images(draw_figure(other, {.times_s = {0.1}}), other.still(0.1)));
            return ++calls > 0;
        });
        EXPECT_TRUE(equal_images(film.still(0.1, 0.5), other.still(0.1, 0.5)));
    }
    EXPECT_GT(calls, 0);
}

TEST(FilmRefusal, NamesFileProblemAndRemedy) {
    try {
        static_cast<void>(
            film_of("schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [2, 0]]\npinned = [0, 2]\n"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInvalidScene);
        EXPECT_THAT(error.what(), testing::StartsWith("film.toml: "));
        EXPECT_THAT(error.what(), HasSubstr("two pins"));
        EXPECT_THAT(error.what(), HasSubstr("let the rope sag between its pins"));
    }
}

TEST(FilmRefusal, AlwaysNamesTheFile) {
    const Scene sound = parse_scene("schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [2, 0]]\n", "film.toml");
    Scene coinciding = sound;
    coinciding.ropes[0].points_m[1] = coinciding.ropes[0].points_m[0];
    Scene dragged = sound;
    dragged.world.drag_1_s = -1.0;
    Scene outside = sound;
    outside.ropes[0].pinned = {3};
    for (const Scene& scene : {coinciding, dragged, outside}) {
        try {
            static_cast<void>(Film(scene));
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kInvalidScene);
            EXPECT_THAT(error.what(), testing::StartsWith("film.toml: "));
            EXPECT_THAT(error.what(), HasSubstr("; "));  // and the remedy
        }
    }
    try {
        static_cast<void>(Renderer(outside));
        ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::StartsWith("film.toml: "));
    }
}

TEST(FilmOfABuiltScene, NeedsOnlyPoints) {
    Scene scene;
    scene.ropes.resize(1);
    scene.ropes[0].points_m = {{0.0, 0.0}, {0.5, -0.5}, {1.0, -1.0}};
    scene.world.duration_s = 0.5;
    scene.video.width_px = 64;
    scene.video.height_px = 64;
    Film film(scene);
    EXPECT_EQ(film.frame(3).width(), 64);
    EXPECT_TRUE(film.error_estimate_px().has_value());
}

TEST(FilmOfABuiltScene, RefusesFieldsOutsideOfTheirDeclaredRange) {
    Scene sound;
    sound.ropes.resize(1);
    sound.ropes[0].points_m = {{0.0, 0.0}, {0.5, -0.5}, {1.0, -1.0}};
    const std::vector<std::pair<std::function<void(Scene&)>, const char*>> faults{
        {[](Scene& s) { s.ropes.clear(); }, "neither a rope nor a net"},
        {[](Scene& s) { s.ropes[0].points_m.resize(1); }, "fewer than 2 points"},
        {[](Scene& s) { s.ropes[0].points_m[1] = s.ropes[0].points_m[0]; },
         "particles 0 and 1, which a bar joins, coincide"},
        {[](Scene& s) { s.ropes[0].points_m[1].x = std::nan(""); }, "not finite"},
        {[](Scene& s) {
             s.ropes[0].mass_kg = {1.0, 1.0};
         },
         "one value per particle"},
        {[](Scene& s) {
             s.ropes[0].mass_kg = {1.0, 0.0, 1.0};
         },
         "not > 0"},
        {[](Scene& s) { s.ropes[0].pinned = {3}; }, "particle 3 of 3"},
        {[](Scene& s) { s.ropes[0].reach = 0; }, "reach"},
        {[](Scene& s) { s.ropes[0].rest_m = {1.0}; }, "one value per link"},
        {[](Scene& s) { s.world.duration_s = 0.0; }, "world.duration"},
        {[](Scene& s) { s.world.drag_1_s = -1.0; }, "world.drag"},
        {[](Scene& s) { s.solver = RattleDef{3}; }, "order"},
        {[](Scene& s) {
             s.solver = RattleDef{4, 0.01, 0.0};
         },
         "guard"},
        {[](Scene& s) { s.solver = ExactDef{0.0}; }, "tolerance"},
        {[](Scene& s) { s.solver = RelaxationDef{.step_s = 0.0}; }, "solver.step"},
        {[](Scene& s) { s.video.width_px = 0; }, "video.size"},
        {[](Scene& s) { s.video.width_px = s.video.height_px = 16384; }, "video.size"},
        {[](Scene& s) { s.style.net_width_px = 0.0; }, "net_width_px"},
        {[](Scene& s) { s.world.duration_s = std::nan(""); }, "world.duration"},
        {[](Scene& s) { s.world.duration_s = -1.0; }, "world.duration"},
        {[](Scene& s) { s.world.duration_s = 1e300; }, "world.duration"},
        {[](Scene& s) { s.world.duration_s = 1e-300; }, "world.duration"},
        {[](Scene& s) { s.world.gravity_m_s2.x = std::nan(""); }, "world.gravity"},
        {[](Scene& s) {
             s.video.fps = FrameRate(Rational{1, 0});
         },
         "video.fps: 1/0"},
        {[](Scene& s) {
             s.video.fps = FrameRate(Rational{0, 1});
         },
         "video.fps: 0/1"},
        {[](Scene& s) {
             s.video.fps = FrameRate(Rational{-30, 1});
         },
         "video.fps: -30/1"},
        {[](Scene& s) {
             s.video.fps = FrameRate(Rational{1, std::int64_t{1} << 62});
         },
         "video.fps: 1/4611"},
        {[](Scene& s) {
             s.video.fps = FrameRate(Rational{1'000'000'000, 1});
         },
         "video.fps: 1000000000 is out of range"},
        {[](Scene& s) { s.solver = AutoDef{0.0}; }, "tolerance_px"},
        {[](Scene& s) { s.solver = AutoDef{std::nan("")}; }, "tolerance_px"},
        {[](Scene& s) { s.solver = AutoDef{std::numeric_limits<double>::infinity()}; }, "tolerance_px"},
        {[](Scene& s) { s.camera.height_m = 0.0; }, "camera.height"},
        {[](Scene& s) { s.camera.margin = 2.0; }, "camera.margin"},
        {[](Scene& s) { s.style.rope_width_px = std::nan(""); }, "rope_width_px"},
    };
    for (const auto& [spoil, words] : faults) {
        Scene scene = sound;
        spoil(scene);
        try {
            static_cast<void>(Film(scene).state(0));
            ADD_FAILURE() << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kInvalidScene) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(words));
        }
    }
}

TEST(FilmOfABuiltScene, RefusesStillsOutsideOfItsMotion) {
    Scene scene;
    scene.ropes.resize(1);
    scene.ropes[0].points_m = {{0.0, 0.0}, {0.5, -0.5}};
    scene.solver = ExactDef{};
    for (const double time_s : {std::nan(""), -1.0, 10.1, 1e300}) {
        FilmDef def;
        def.stills_s = {1.0, time_s};
        EXPECT_EQ(code_of([&] { static_cast<void>(Film(scene, def)); }), ExitCode::kUsage) << time_s;
    }
}

TEST(FilmOfABuiltScene, AcceptsTheExtremesOfDeclaredRanges) {
    Scene scene;
    scene.ropes.resize(1);
    scene.ropes[0].points_m = {{0.0, 0.0}, {0.5, -0.5}, {1.0, -1.0}};
    scene.solver = ExactDef{};
    scene.world.duration_s = 0.1;
    scene.video.width_px = 64;
    scene.video.height_px = 64;
    for (const double height_m : {1e-9, 1.0, 4e9}) {
        scene.camera.height_m = height_m;
        for (const double center_m : {0.0, 1e9, -1e9}) {
            scene.camera.center_m = Vec2{center_m, 0.0};
            EXPECT_EQ(Film(scene).frame(3).width(), 64);
        }
    }
}

TEST(Renderer, AcceptsAnyFinitePosition) {
    Film film = film_of(kRope);
    Renderer renderer(film.scene());
    std::vector<Vec2> positions_m(film.system().particle_count());
    for (const double far_m : {1e9, 1e20, 1e300, 1.7e308}) {
        for (std::size_t i = 0; i < positions_m.size(); ++i)
            positions_m[i] = {i % 2 == 0 ? far_m : -far_m, i % 3 == 0 ? far_m : -0.5 * far_m};
        EXPECT_EQ(renderer.draw(positions_m).width(), 96);
    }
    positions_m[7].y = std::nan("");
    try {
        static_cast<void>(renderer.draw(positions_m));
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        EXPECT_STREQ(error.what(), "position 7 is not finite");
    }
    positions_m[7].y = std::numeric_limits<double>::infinity();
    EXPECT_EQ(code_of([&] { static_cast<void>(renderer.draw(positions_m)); }), ExitCode::kUsage);
}

TEST(Renderer, DrawsPositionsLikeAFilm) {
    Film film = film_of(kRope);
    Scene scene = film.scene();
    scene.camera = film.camera();
    Renderer renderer(scene);
    const State state = film.state(20);
    std::vector<Vec2> positions_m;
    for (std::size_t i = 0; i < state.x_m.size(); ++i)
        positions_m.push_back(film.system().origin_m + Vec2{state.x_m[i], state.y_m[i]});
    EXPECT_TRUE(equal_images(renderer.draw(positions_m), film.frame(20)));
    positions_m.pop_back();
    EXPECT_EQ(code_of([&] { static_cast<void>(renderer.draw(positions_m)); }), ExitCode::kUsage);
}

}  // namespace
}  // namespace corda
