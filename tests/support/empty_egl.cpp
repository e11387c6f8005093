// Replaces libEGL.so.1 in one test: a library that loads and has none of EGL's functions.
extern "C" int corda_test_of_no_use() {
    return 0;
}
