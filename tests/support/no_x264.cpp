// Stands before libavcodec in one test: one that was built without libx264.

#include <dlfcn.h>

#include <cstring>

struct AVCodec;

extern "C" const AVCodec* avcodec_find_encoder_by_name(const char* name) {
    using Find = const AVCodec* (*)(const char*);
    static const auto find = reinterpret_cast<Find>(dlsym(RTLD_NEXT, "avcodec_find_encoder_by_name"));
    return std::strcmp(name, "libx264") == 0 ? nullptr : find(name);
}
