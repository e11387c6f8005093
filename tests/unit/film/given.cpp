// Films of motions that are given, and the files that give them.
#include "corda/film/given.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "corda/film/film.hpp"
#include "corda/film/provenance.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kGivenScene = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 5, length = 1.0, angle_deg = 70.0, from = [0.1, 3.0] }
[[net]]
grid = { columns = 3, rows = 3, spacing = 0.1 }
[video]
size = [96, 64]
fps = 30
)";

/// The positions of a film at its frames.
GivenMotion motion_of(const Film& film) {
    std::vector<double> times_s;
    std::vector<Vec2> positions_m;
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        const State state = film.state(k);
        times_s.push_back(state.time_s);
        for (std::size_t i = 0; i < state.x_m.size(); ++i)
            positions_m.push_back(film.system().origin_m + Vec2{state.x_m[i], state.y_m[i]});
    }
    return {times_s, positions_m};
}

TEST(GivenFilm, OfTheFilmsOwnPositionsHasTheSameFrames) {
    for (const std::string more :
         {"", "[style]\nmarkers = \"all\"\nbars = \"all\"\n", "[style]\ncolor_by = \"strain\"\n",
          "[overlay]\nplots = [\"tip\"]\n[camera]\nfollow = \"tip\"\n",
          "[[rope]]\npoints = [[0, 0], [0.2, -0.3], [0.4, 0]]\npinned = [0, -1]\n"
          "moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 1.0 }] }]\n"
          "release = [{ pin = -1, t = 0.5 }]\ncut = [{ link = 0, t = 0.8 }]\n"}) {
        SCOPED_TRACE(more);
        const Scene scene = parse_scene(kGivenScene + more, "swing.toml");
        const Film film(scene);
        const Film given(scene, motion_of(film));
        ASSERT_EQ(given.frame_count(), film.frame_count());
        for (const std::int64_t k : {0, 7, 16, 25, 29})
            EXPECT_TRUE(test::equal_images(given.frame(k), film.frame(k))) << k;
    }
}

TEST(GivenFilm, HasThePlanOfNoMethodAndNoEstimate) {
    const Film film(parse_scene(kGivenScene, "swing.toml"));
    FilmDef def;
    def.readings.velocities = true;
    const Film given(film.scene(), motion_of(film), def);
    ASSERT_EQ(given.plan().bodies.size(), 2U);
    EXPECT_EQ(given.plan().bodies[0].reason, PlanReason::kGiven);
    EXPECT_EQ(given.plan().error_estimate_m, std::nullopt);
    EXPECT_EQ(given.plan().simulation_passes, 0);
    // Frozen, it keeps the solver that it does not use.
    EXPECT_TRUE(std::holds_alternative<AutoDef>(frozen_scene(given).solver));
    // Between frames and after: velocities of differences; 1/30 s makes them err by 2 %.
    const State state = film.state_at(0.55);
    const State same = given.state_at(0.55);
    EXPECT_NEAR(same.x_m[5], film.system().origin_m.x + state.x_m[5], 1e-4);  // measured 2.1e-5
    EXPECT_NEAR(given.energy_of(given.state(0)).potential_j(), 0.0, 1e-12);
    EXPECT_EQ(given.figures_at(0.55).energy_error, std::nullopt);
    EXPECT_EQ(given.figures_at(0.55).loads, std::nullopt);
}

TEST(GivenFilm, EndsWithItsTimesUnlessTheSceneSaysWhen) {
    Scene scene = parse_scene("schema = 1\n[[rope]]\nhang = { links = 1, length = 1.0 }\n", "a");
    const auto still = [](double end_s) {
        return GivenMotion({0.0, end_s}, {{0, 0}, {0, -1}, {0, 0}, {0.1, -1}}, "m.csv");
    };
    EXPECT_EQ(Film(scene, still(0.5)).frame_count(), 30);
    give_motion(scene, still(3.0));
    EXPECT_EQ(scene.world.duration_s, 3.0);
    Scene shorter =
        parse_scene("schema = 1\nworld.duration = 0.25\n[[rope]]\nhang = { links = 1, length = 1.0 }\n", "a");
    EXPECT_EQ(Film(shorter, still(0.5)).frame_count(), 15);
    // The last frame is before the end.
    EXPECT_EQ(Film(shorter, still(14.0 / 60.0)).frame_count(), 15);
    const auto failure = test::failure_of([&] { Film(shorter, still(0.2)); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_EQ(
        failure.message,
        "m.csv: the positions end at 0.2 s, before the last frame at 0.233333 s of a film of 0.25 s; give "
        "world.duration = 0.2 (--duration 0.2), or positions up to there");
}

TEST(GivenFilm, RefusesOtherParticlesAndTensions) {
    const std::string rope = "schema = 1\n[[rope]]\nhang = { links = 1, length = 1.0 }\n";
    const GivenMotion motion({0.0, 1.0}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}, "m.csv");
    EXPECT_EQ(
        test::failure_of([&] { Film(parse_scene(rope, "a"), motion); }).message,
        "m.csv: positions of 3 particles, and the scene has 2; give one position per particle, ropes before "
        "nets, or change the ropes of the scene");
    const GivenMotion two({0.0, 1.0}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}, "m.csv");
    const auto colors = test::failure_of(
        [&] { Film(parse_scene(rope + "[style]\ncolor_by = \"tension\"\n", "a.toml"), two); });
    EXPECT_EQ(colors.code, ExitCode::kInvalidScene);
    EXPECT_EQ(
        colors.message,
        "a.toml:5:12: style.color_by: tensions are not known where positions are given; give \"speed\" or "
        "\"strain\"");
    EXPECT_THAT(
        test::failure_of([&] {
            Film(parse_scene(rope + "[style]\narrows = \"tension\"\n", "a"), two);
        }).message,
        HasSubstr(
            "a:5:10: style.arrows: tensions are not known where positions are given; give \"velocity\" or"));
}

TEST(GivenFilm, IsNoFilmThatItsSceneCouldRepeat) {
    Scene scene = parse_scene(kGivenScene, "swing.toml");
    give_motion(scene, motion_of(Film(scene)));
    const Provenance made = provenance_of(scene);
    EXPECT_EQ(made.scene, "");
    EXPECT_THAT(made.left_out, HasSubstr("positions were given and not simulated (hash of scene"));
    const auto left_out_with = [&](const std::string& setting) {
        Scene other = parse_scene(kGivenScene, "swing.toml", {setting});
        other.given = scene.given;
        return provenance_of(other).left_out;
    };
    // The hash is that of what changes pictures.
    EXPECT_EQ(left_out_with("video.jobs=2"), made.left_out);
    EXPECT_EQ(left_out_with("video.threads=2"), made.left_out);
    EXPECT_NE(left_out_with("style.theme=paper"), made.left_out);
    EXPECT_NE(left_out_with("rope[0].color=#123456"), made.left_out);
    Scene same = scene;
    give_motion(same, GivenMotion({0.0, 1.0}, std::vector<Vec2>(30)));
    EXPECT_NE(provenance_of(same).left_out, made.left_out);
}

// Files.

GivenMotion positions_in(const std::string& bytes) {
    const test::ScratchFolder folder;
    return read_positions(folder.write("m.csv", bytes));
}

TEST(ReadPositions, FindsTheColumnsByTheirNames) {
    for (const std::string text : {
             "t,x0,y0,x1,y1\n0,1,2,3,4\n0.5,5,6,7,8e0\n",
             "t,x0,y0,x1,y1\r\n0,1,2,3,4\r\n\r\n0.5,5,6,7,8",
             "\xef\xbb\xbft;x0;y0;x1;y1;vx0_m_s\n0;1;2;3;4;nan\n0,5;5;6;7;8;\n",
             "energy,t,y1,x1,\"a,x1_y0\",8 kg_x0,tension0_n\n,0,4,3,2,1,\n9, 0.5 ,8,7,6,+5,9\n",
             "t,x0,y0,x1,y1\n0,1,2,3,4, \n0.5,5,6,7,8,\n",
             "t\tx0\ty0\tx1\ty1\n0\t1\t2\t3\t4\n\"0.5\"\t5\t6\t7\t8\n",
         }) {
        SCOPED_TRACE(text);
        const GivenMotion motion = positions_in(text);
        EXPECT_EQ(motion.particle_count(), 2U);
        EXPECT_EQ(motion.end_s(), 0.5);
        EXPECT_THAT(motion.at(0.0).x_m, ElementsAre(1, 3));
        EXPECT_THAT(motion.at(0.5).x_m, ElementsAre(5, 7));
        EXPECT_THAT(motion.at(0.5).y_m, ElementsAre(6, 8));
    }
}

TEST(ReadPositions, ReadsLinesThatAreLongerThanItsBlocks) {
    std::string names = "t";
    std::string row;
    for (int i = 0; i < 20'000; ++i) {
        names += ",x" + std::to_string(i) + ",y" + std::to_string(i);
        row += "," + std::to_string(i) + ",-0.25";
    }
    const GivenMotion motion = positions_in(names + "\n0" + row + "\n1" + row + "\n");
    EXPECT_EQ(motion.particle_count(), 20'000U);
    EXPECT_EQ(motion.at(1.0).x_m.back(), 19'999.0);
}

TEST(ReadPositions, NamesThePlaceOfWhatIsWrong) {
    const std::string names = "t,x0,y0\n";
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", ": the file is empty; give CSV, or .npz"},
        {"0,1,2\n1,2,3\n",
         ":1:1: the first line names no column t; name t, x0, y0, x1, y1, ... for all particles"},
        {"t\n0\n1\n", ":1:1: the first line names no column x0"},
        {"t,x0,y0,x1\n", ":1:1: the first line names no column y1"},
        {"t,x0,y0,x999999999999,y1\n", ":1:1: the first line names no column x1"},
        {"t,x0,y0,a_x0\n", ":1:1: two columns are x0; remove or rename one"},
        {names + "0,1,2\n1,1\n",
         ":3:1: 2 of 3 cells; give all columns of the first line, or leave out the row"},
        {"t,x0,y0,x1,y1\n0,0,0,0,0\n1,0,0,0,0,0,5,-0,9\n",
         ":3:11: more cells than columns; give decimal points, or separate cells by semicolons"},
        {"t;x0;y0\n0;1;2\n1;2;3;;\n",
         ":3:7: more cells than columns; name all columns in the first line, or leave out the row"},
        {names + "0,1,2\n1,nan,2\n",
         ":3:3: x0: nan is not a finite number; give a number, or leave out the row"},
        {names + "0,1,2\n1,1e999,2\n", ":3:3: x0: 1e999 is not a finite number"},
        {names + "0,1,2\n1,,2\n", ":3:3: x0: there is no number"},
        {names + "0,1,2\n1,2,3 m\n", ":3:5: y0: 3 m is not a finite number"},
        {names + "0,1,2\n1,2,\x1b[0m\n", ":3:5: y0: \\x1b[0m is not a finite number"},
        {names + "0,1,2\n0,1,2\n", ":3:1: t = 0 s comes after 0 s; give times that increase"},
        {names + "0,1,2\n1e-10,1,2\n", ":3:1: t = 1e-10 s comes after 0 s"},
        {names + "0,1,2\n", ": times: 1 time; give at least two"},
        {names, ": times: 0 times; give at least two"},
        {names + "5,1,2\n6,1,2\n", ": times[0]: the first time is 5 s"},
        {std::string("\x93NUMPY\1\0", 8), ": this is one array; save both by numpy.savez"},
        {"PK\3\4", ": the .npz is damaged: it has no list of its arrays; save it again"},
    };
    const test::ScratchFolder folder;
    for (const auto& [bytes, message] : cases) {
        const std::string path = folder.file("m.csv");
        test::write_file(path, bytes);
        const auto failure = test::failure_of([&] { static_cast<void>(read_positions(path)); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << bytes;
        EXPECT_THAT(failure.message, HasSubstr(path + message));
    }
    EXPECT_EQ(test::code_of([&] { static_cast<void>(read_positions(folder.file("none.csv"))); }),
              ExitCode::kIo);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(read_positions(folder.path())); }), ExitCode::kIo);
}

}  // namespace
}  // namespace corda
