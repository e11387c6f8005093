// Machines on which OpenGL is missing or draws nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::AllOf;
using testing::HasSubstr;

const char* const kSceneOfDrivers =
    "schema = 1\n[[rope]]\nhang = { links = 4, length = 1.0, angle_deg = 30.0 }\n"
    "[world]\nduration = 0.1\n[video]\nsize = [64, 64]\nfps = 30\n";

class Drivers : public testing::Test {
  protected:
    test::CommandResult still(const std::string& environment) {
        return run_corda({"still", scene_, "--at", "0.1", "-o", folder_.file("a.png"), "--force"},
                         environment);
    }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfDrivers);
};

TEST_F(Drivers, ThatDrawNothingAreDetected) {
    const auto result = still("GALLIUM_NOOP=1");
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.err, AllOf(HasSubstr("the driver draws wrongly: pixel ("), HasSubstr("Driver: NOOP"),
                                  HasSubstr("unset variables that choose or change a driver")));
    EXPECT_FALSE(std::ifstream(folder_.file("a.png")).good());
    const auto doctor = run_corda({"doctor"}, "GALLIUM_NOOP=1");
    EXPECT_EQ(doctor.exit_code, 4);
    EXPECT_THAT(doctor.out, AllOf(HasSubstr("no   EGL device 0"), HasSubstr("the driver draws wrongly"),
                                  HasSubstr("This machine cannot draw.")));
}

TEST_F(Drivers, AreCertifiedByDoctor) {
    EXPECT_THAT(run_corda({"doctor"}).out,
                HasSubstr("its test picture equals the plain C++ reference in every byte"));
    EXPECT_THAT(run_corda({"doctor", "--json"}).out, HasSubstr("\"equals_reference\":"));
}

TEST_F(Drivers, BrokenByVariablesWorkOnceTheseAreUnset) {
    for (const char* const variable :
         {"__EGL_VENDOR_LIBRARY_DIRS=/nonexistent", "__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent",
          "LIBGL_DRIVERS_PATH=/nonexistent", "GALLIUM_DRIVER=bogus", "GALLIUM_DRIVER=softpipe",
          "MESA_GL_VERSION_OVERRIDE=3.3", "MESA_GLSL_VERSION_OVERRIDE=330"}) {
        const auto result = still(variable);
        // Mesa 25 has its drivers in one library and ignores this folder.
        if (std::string_view(variable).starts_with("LIBGL_DRIVERS_PATH") && result.exit_code == 0) continue;
        EXPECT_EQ(result.exit_code, 4) << variable;
        EXPECT_THAT(result.err, HasSubstr("unset variables that choose or change a driver")) << variable;
    }
    EXPECT_EQ(still("").exit_code, 0);
}

// Without a shader cache, because llvmpipe (Mesa 22.3) would take shaders of another width from it.
TEST_F(Drivers, DrawWithEveryVectorWidth) {
    ASSERT_EQ(still("").exit_code, 0);
    const std::string picture = test::read_file(folder_.file("a.png"));
    for (const char* const width : {"128", "256"}) {
        const auto result = still("MESA_SHADER_CACHE_DISABLE=1 LP_NATIVE_VECTOR_WIDTH=" + std::string(width));
        ASSERT_EQ(result.exit_code, 0) << width << result.err;
        EXPECT_EQ(test::read_file(folder_.file("a.png")), picture) << width;
    }
}

TEST_F(Drivers, WithMissingLibrariesAreNamedWithTheirPackage) {
    const auto hiding = [](const std::string& libraries) {
        return "LD_PRELOAD=" HIDDEN_LIBRARIES " CORDA_TEST_HIDES='" + libraries + "'";
    };
    const auto egl = still(hiding("libEGL.so.1"));
    EXPECT_EQ(egl.exit_code, 4);
    EXPECT_THAT(egl.err,
                AllOf(HasSubstr("libEGL.so.1 cannot be loaded"), HasSubstr("apt-get install libegl1")));
    const auto gl = still(hiding("libOpenGL.so.0 libGL.so.1"));
    EXPECT_EQ(gl.exit_code, 4);
    EXPECT_THAT(gl.err, HasSubstr("apt-get install libopengl0"));
    EXPECT_EQ(still(hiding("libOpenGL.so.0")).exit_code, 0);
    const auto doctor = run_corda({"doctor"}, hiding("libEGL.so.1"));
    EXPECT_EQ(doctor.exit_code, 4);
    EXPECT_THAT(doctor.out, AllOf(HasSubstr("apt-get install libegl1"), HasSubstr("yes  .mkv: ffv1")));
}

}  // namespace
}  // namespace corda
