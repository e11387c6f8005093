#include "corda/gl/context.hpp"

#include <gmock/gmock.h>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <optional>
#include <thread>

#include "support/failure.hpp"
#include "support/host_context.hpp"

namespace corda::gl {
namespace {

using Backend = ContextDef::Backend;
using test::code_of;
using test::failure_of;

TEST(ContextDefs, AreReadFromText) {
    EXPECT_EQ(ContextDef::parse("auto").backend, Backend::kAuto);
    EXPECT_EQ(ContextDef::parse("surfaceless").backend, Backend::kSurfaceless);
    EXPECT_EQ(ContextDef::parse("default").backend, Backend::kDefault);
    EXPECT_EQ(ContextDef::parse("device").backend, Backend::kDevice);
    EXPECT_EQ(ContextDef::parse("device").device, std::nullopt);
    EXPECT_EQ(ContextDef::parse("device:12").backend, Backend::kDevice);
    EXPECT_EQ(ContextDef::parse("device:12").device, 12);
}

TEST(ContextDefs, RejectAnyOtherText) {
    for (const char* text : {"", "Auto", "auto ", "devices", "device:", "device:-1", "device:1x", "device: 1",
                             "device:99999999999", "surfaceless:0"}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(ContextDef::parse(text)); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << text;
        EXPECT_THAT(failure.message, testing::HasSubstr("device:N"));
    }
}

TEST(Contexts, ReportAMissingDevice) {
    const test::Failure failure = failure_of([] { const Context context(ContextDef::parse("device:63")); });
    EXPECT_EQ(failure.code, ExitCode::kNoGl);
    EXPECT_THAT(failure.message, testing::HasSubstr("no such EGL device"));
}

TEST(Contexts, AreCurrentInOneThreadAtATime) {
    const Context context;
    ExitCode code = ExitCode::kOk;
    std::thread([&] { code = failure_of([&] { context.make_current(); }).code; }).join();
    EXPECT_EQ(code, ExitCode::kNoGl);
}

TEST(Contexts, KeepAnotherContextCurrentWhenDestroyed) {
    const test::HostContext host;
    auto context = std::make_unique<Context>();
    EXPECT_FALSE(host.is_current());
    host.make_current();
    context.reset();
    EXPECT_EQ(eglGetCurrentContext() != EGL_NO_CONTEXT, true);
}

TEST(SavedContexts, AreRestored) {
    const test::HostContext host;
    {
        const SavedContext saved_host;
        const Context outer;
        EXPECT_FALSE(host.is_current());
        EGLContext outer_handle = eglGetCurrentContext();
        {
            const SavedContext saved_outer;
            const Context inner;
            EXPECT_NE(eglGetCurrentContext(), outer_handle);
        }
        EXPECT_EQ(eglGetCurrentContext(), outer_handle);
    }
    EXPECT_TRUE(host.is_current());
    EXPECT_TRUE(host.is_alive());
}

TEST(SavedContexts, RestoreNoContext) {
    const Context context;
    std::thread([] {
        {
            const SavedContext none;
            const Context other;
        }
        EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
    }).join();
}

TEST(Contexts, OfTheParentCannotBeUsedAfterAFork) {
    const Context context;
    const SavedContext saved;
    const pid_t child = fork();
    if (child == 0) {
        // 1: the parent's context could be used; 2: none of its own is possible.
        if (!context.is_inherited() || code_of([&] { context.make_current(); }) != ExitCode::kNoGl) _exit(1);
        _exit(code_of([] { const Context own; }) == ExitCode::kOk ? 0 : 2);
    }
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    EXPECT_FALSE(context.is_inherited());
    EXPECT_EQ(code_of([&] { context.make_current(); }), ExitCode::kOk);
}

TEST(Forks, WaitForTheDriver) {
    std::atomic<bool> stop = false;
    std::thread drawing([&] {
        while (!stop) const Context context;
    });
    for (int i = 0; i < 10; ++i) {
        const pid_t child = fork();
        if (child == 0) _exit(code_of([] { const Context own; }) == ExitCode::kOk ? 0 : 1);
        int status = -1;
        EXPECT_EQ(waitpid(child, &status, 0), child);
        EXPECT_EQ(status, 0);
    }
    stop = true;
    drawing.join();
}

TEST(Probes, KeepTheCurrentContext) {
    const test::HostContext host;
    EXPECT_FALSE(probe_contexts().empty());
    EXPECT_TRUE(host.is_current());
    EXPECT_TRUE(host.is_alive());
}

}  // namespace
}  // namespace corda::gl
