// Machines on which OpenGL is missing, broken, out of memory or without threads.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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
                                  HasSubstr("GALLIUM_NOOP=1\n")));
    EXPECT_FALSE(std::ifstream(folder_.file("a.png")).good());
    const auto doctor = run_corda({"doctor"}, "GALLIUM_NOOP=1");
    EXPECT_EQ(doctor.exit_code, 4);
    EXPECT_THAT(doctor.out, AllOf(HasSubstr("no   EGL device 0"), HasSubstr("the driver draws wrongly"),
                                  HasSubstr("This machine cannot draw, for the reason above.")));
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
        EXPECT_THAT(result.err,
                    AllOf(HasSubstr("Unset what chooses or changes the driver: " + std::string(variable)),
                          Not(HasSubstr("apt-get"))));
    }
    EXPECT_EQ(still("").exit_code, 0);
}

// Mesa does not check the values of its variables: each of these crashed it (Mesa 22.3).
TEST_F(Drivers, CrashedByVariablesAreProbedInAChild) {
    for (const char* const variable : {"MESA_EXTENSION_OVERRIDE=-GL_ARB_texture_float",
                                       "MESA_EXTENSION_OVERRIDE=-GL_ARB_framebuffer_object"}) {
        for (const auto& [command, words] :
             {std::pair(std::vector<std::string>{"still", scene_, "--at", "0.1", "-o", folder_.file("a.png")},
                        &test::CommandResult::err),
              std::pair(std::vector<std::string>{"render", scene_, "-o", folder_.file("a.mp4")},
                        &test::CommandResult::err),
              std::pair(std::vector<std::string>{"doctor"}, &test::CommandResult::out)}) {
            const auto result = run_corda(command, variable);
            EXPECT_EQ(result.exit_code, 4) << variable << command.front() << result.err;
            EXPECT_THAT(result.*words,
                        HasSubstr("Unset what chooses or changes the driver: " + std::string(variable)));
        }
    }
}

// Without a shader cache, because llvmpipe (Mesa 22.3) would take shaders of another width from it.
TEST_F(Drivers, DrawWithAnyVectorWidth) {
    ASSERT_EQ(still("").exit_code, 0);
    const std::string picture = test::read_file(folder_.file("a.png"));
    for (const char* const width : {"0", "1", "3", "64", "128", "256", "512", "1024", "wide"}) {
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

TEST_F(Drivers, ThatAreInvalidAreNamedByTheirFile) {
    const auto result = still("LD_LIBRARY_PATH=" EMPTY_EGL_FOLDER);
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.err, HasSubstr(EMPTY_EGL_FOLDER "/libEGL.so.1 has no function eglBindAPI"));
}

#ifndef CORDA_SANITIZE  // which reserves more memory than any limit
TEST_F(Drivers, WithoutMemoryEndWithExitCode75) {
    for (const int mib : {100, 200, 300, 340}) {
        const auto result = still("ulimit -v " + std::to_string(mib << 10) + ";");
        EXPECT_EQ(result.exit_code, 75) << mib << result.err;
        EXPECT_THAT(result.err, HasSubstr("address space"));
    }
    for (const int mib : {50, 70, 90}) {
        const auto result = still("ulimit -d " + std::to_string(mib << 10) + ";");
        EXPECT_EQ(result.exit_code, 75) << mib << result.err;
        EXPECT_THAT(result.err, HasSubstr("ulimit -d"));
    }
    EXPECT_EQ(still("ulimit -d " + std::to_string(200 << 10) + ";").exit_code, 0);
}
#endif

}  // namespace
}  // namespace corda
