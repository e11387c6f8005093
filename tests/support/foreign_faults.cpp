// For LD_PRELOAD: faults of a full host, chosen by environment variables.
//   THREADS_TO_START=N      the system starts N more threads, then none
//   FSYNC_TAKES_MS=N        flushing a file to disk takes N ms, despite signals
//   FSYNC_BLOCKS_AFTER=NAME flushing a file to disk blocks once there is a file of this name (see glob(3), with braces)
//   FSYNC_BLOCKS_UNTIL=FILE the file that ends this

#include <dlfcn.h>
#include <glob.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

int number_in(const char* variable, int otherwise) {
    const char* const text = std::getenv(variable);
    return text == nullptr ? otherwise : std::atoi(text);
}

bool is_there(const char* pattern) {
    glob_t found{};
    const int status = glob(pattern, GLOB_BRACE | GLOB_NOSORT, nullptr, &found);
    globfree(&found);
    return status == 0;
}

template <class Function>
Function* next(Function* /*this_one*/, const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
                   void* argument) {
    static std::atomic<int> left = number_in("THREADS_TO_START", 1 << 30);
    if (left-- <= 0) return EAGAIN;
    return next(&pthread_create, "pthread_create")(thread, attributes, work, argument);
}

int fsync(int descriptor) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t end_ms =
        now.tv_sec * std::int64_t{1000} + now.tv_nsec / 1'000'000 + number_in("FSYNC_TAKES_MS", 0);
    while (now.tv_sec * std::int64_t{1000} + now.tv_nsec / 1'000'000 < end_ms) {
        usleep(10'000);
        clock_gettime(CLOCK_MONOTONIC, &now);
    }
    const char* const name = std::getenv("FSYNC_BLOCKS_AFTER");
    const char* const end = std::getenv("FSYNC_BLOCKS_UNTIL");
    while (name != nullptr && end != nullptr && is_there(name) && access(end, F_OK) != 0) usleep(10'000);
    return next(&fsync, "fsync")(descriptor);
}
}
