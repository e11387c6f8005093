// Slow motion and time lapse: video.speed.
#include <gtest/gtest.h>

#include <string>

#include "corda/film/film.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

Film film_at_speed(const std::string& speed, const std::string& solver, const std::string& more = "") {
    return Film(
        parse_scene("schema = 1\n[world]\nduration = 0.5\n"
                    "[[rope]]\nhang = { links = 6, length = 1.0, angle_deg = 50.0 }\n"
                    "[video]\nsize = [96, 64]\nfps = 30\nspeed = " +
                        speed + "\n" + more + "[solver]\nmethod = \"" + solver + "\"\n",
                    "film.toml"));
}

TEST(FilmSpeed, SlowMotionShowsTheSameMotionAtFinerTimes) {
    for (const char* const solver : {"exact", "rattle", "relaxation"}) {
        Film film = film_at_speed("1", solver);
        Film slow = film_at_speed("\"1/4\"", solver);
        EXPECT_EQ(slow.frame_count(), 4 * film.frame_count());
        EXPECT_EQ(slow.time_s(1), 1.0 / 120.0);
        for (const std::int64_t k : {0, 1, 7, 14}) {
            const State state = film.state(k);
            EXPECT_EQ(slow.state(4 * k).x_m, state.x_m) << solver << k;
            EXPECT_EQ(slow.state(4 * k).time_s, state.time_s);
        }
        EXPECT_TRUE(test::equal_images(slow.frame(28), film.frame(7))) << solver;
    }
}

TEST(FilmSpeed, TheShutterIsOpenForAShareOfTheSceneTimeOfAFrame) {
    // Exact powers of two, so that the sub-frames have the same times.
    Film slow = film_at_speed("0.25", "exact", "shutter = 0.5\n");
    Film film = film_at_speed("1", "exact");
    EXPECT_TRUE(test::equal_images(slow.frame(28), film.still(slow.time_s(28), 0.125)));
}

TEST(FilmSpeed, TimeLapseHasFewerFrames) {
    Film film = film_at_speed("3", "exact");
    EXPECT_EQ(film.frame_count(), 5);
    EXPECT_EQ(film.time_s(2), 0.2);
}

}  // namespace
}  // namespace corda
