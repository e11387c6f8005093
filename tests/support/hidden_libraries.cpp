// For LD_PRELOAD: hides the libraries that CORDA_TEST_HIDES lists, separated by spaces, from dlopen(), as on
// a system without them.
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
    // dlerror() then gives the reason of a missing file.
    return real(is_hidden ? "libcorda-hidden.so.0" : file, mode);
}
