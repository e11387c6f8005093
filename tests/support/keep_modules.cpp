// Under LeakSanitizer only: drivers that EGL would unload stay loaded, so that a leak of theirs is reported
// with their name and tests/support/lsan.supp can tell it from one of ours.

extern "C" int dlclose(void*) {
    return 0;
}
