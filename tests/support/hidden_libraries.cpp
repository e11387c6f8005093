// Preloaded by a test: hides the libraries that CORDA_TEST_HIDES names, separated by spaces, from dlopen(),
// as on a system that has not installed them.
#include <dlfcn.h>

#include <cstdlib>
#include <string>

extern "C" void* dlopen(const char* file, int mode) {
    using Open = void* (*)(const char*, int);
    static const auto real = reinterpret_cast<Open>(dlsym(RTLD_NEXT, "dlopen"));
    const char* const hidden = std::getenv("CORDA_TEST_HIDES");
    const bool is_hidden =
        file != nullptr && hidden != nullptr &&
        (" " + std::string(hidden) + " ").find(" " + std::string(file) + " ") != std::string::npos;
    // The reason that dlerror() then gives is that of a file that is missing.
    return real(is_hidden ? "libcorda-hidden.so.0" : file, mode);
}
