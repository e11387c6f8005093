#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include <cerrno>

#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace {

bool threads_are_scarce = false;
bool processes_are_scarce = false;

template <typename Function>
Function* next(const char* name) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): dlsym knows no types
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// Found before those of the C library, also by libav.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) {
    if (threads_are_scarce) return EAGAIN;
    return next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create")(
        thread, attributes, start, argument);
}

extern "C" pid_t fork() {
    if (!processes_are_scarce) return next<pid_t()>("fork")();
    errno = EAGAIN;
    return -1;
}

namespace corda::media {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class VerifyChild : public Video {
  protected:
    ~VerifyChild() override { threads_are_scarce = processes_are_scarce = false; }
};

TEST_F(VerifyChild, FindsWhatThisProcessFinds) {
    make_video(file("a.mp4"), small_video({24000, 1001}), 30);
    const std::string whole = test::read_file(file("a.mp4"));
    test::write_file(file("b.mp4"), whole.substr(0, whole.size() - 200));
    test::write_file(file("c.mp4"), "no video \xff");
    for (const char* const name : {"a.mp4", "b.mp4", "c.mp4"}) {
        const VerifyReport report = verify_in_child(file(name));
        EXPECT_TRUE(report == verify(file(name))) << name;
        EXPECT_EQ(report.ok(), name == std::string("a.mp4"));
    }
    const auto verify_missing = [&] { (void)verify_in_child(file("missing.mp4")); };
    const test::Failure failure = test::failure_of(verify_missing);
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("missing.mp4"));
}

TEST_F(VerifyChild, NeedsNoThread) {
    make_video(file("a.mp4"), small_video(), 30);
    threads_are_scarce = true;
    EXPECT_THAT(all_problems(verify_in_child(file("a.mp4"))), IsEmpty());
    processes_are_scarce = true;
    const VerifyReport report = verify_in_child(file("a.mp4"));
    EXPECT_THAT(all_problems(report), IsEmpty());
    EXPECT_EQ(report.frames, 30);
    const CancelScope stop = test::cancel_after(0);
    EXPECT_EQ(test::code_of([&] { static_cast<void>(verify_in_child(file("a.mp4"))); }),
              ExitCode::kInterrupted);
}

}  // namespace
}  // namespace corda::media
