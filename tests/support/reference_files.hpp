#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"

namespace corda::test {

/// R1 (src/corda/sim/README.md): positions in metres of the bob of the IFToMM benchmark problem A01 (a
/// pendulum) at t = 0.5, 1, ..., 2000 s, with more digits than a double holds.
inline std::vector<Vec2> read_a01() {
    std::ifstream file(CORDA_TEST_DATA "/a01_pendulum.txt");
    std::vector<Vec2> points_m;
    for (Vec2 point; file >> point.x >> point.y;) points_m.push_back(point);
    EXPECT_EQ(points_m.size(), 4000U) << CORDA_TEST_DATA;
    return points_m;
}

/// Positions of all particles of the source report's start at a time.
struct ReportFrame {
    double time_s = 0.0;
    std::vector<Vec2> points_m;
};

/// R11 (src/corda/sim/README.md): the 40 particles at 1, 2, 5 and 10 s.
inline std::vector<ReportFrame> read_report_swing() {
    constexpr std::size_t kParticles = 40;
    std::ifstream file(CORDA_TEST_DATA "/swing40.txt");
    std::vector<ReportFrame> frames;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line.front() == '#') continue;
        std::istringstream numbers(line);
        ReportFrame& frame = frames.emplace_back();
        numbers >> frame.time_s;
        for (Vec2 point; numbers >> point.x >> point.y;) frame.points_m.push_back(point);
        EXPECT_EQ(frame.points_m.size(), kParticles) << frame.time_s;
    }
    EXPECT_EQ(frames.size(), 4U) << CORDA_TEST_DATA;
    return frames;
}

}  // namespace corda::test
