#include "corda/media/probe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/media/format.hpp"

namespace corda::media {
namespace {

TEST(Probe, TriesTheEncodersOfTheTableAndNoOthers) {
    std::vector<std::string> names;
    for (const EncoderProbe& probe : probe_encoders()) {
        EXPECT_TRUE(probe.usable) << probe.name << ": " << probe.reason;
        EXPECT_EQ(probe.reason, "");
        names.push_back(probe.name);
    }
    EXPECT_THAT(names, testing::ElementsAre("libx264"));
}

}  // namespace
}  // namespace corda::media
