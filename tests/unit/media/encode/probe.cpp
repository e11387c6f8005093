#include "corda/media/encode/probe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/media/format/format.hpp"

namespace corda::media {
namespace {

TEST(Probe, TriesEveryEncoderOfEveryEndingTheDefaultFirst) {
    std::string last;
    std::string defaults;
    for (const EncoderProbe& probe : probe_encoders()) {
        // The GPU's encoder is listed where there is none.
        EXPECT_TRUE(probe.reason.empty() || probe.name == "h264_nvenc") << probe.name << probe.reason;
        if (probe.ending != last) defaults += probe.ending + " " + probe.name + "; ";
        last = probe.ending;
    }
    EXPECT_EQ(defaults,
              ".mp4 libx264; .webm libvpx-vp9; .mov prores_ks; .mkv ffv1; .gif gif; "
              "%04d.png png; - rawvideo; ");
}

}  // namespace
}  // namespace corda::media
