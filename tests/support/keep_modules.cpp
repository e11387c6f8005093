// For LeakSanitizer only: drivers that EGL would unload stay loaded, so that their leaks are reported with
// their names, and tests/support/lsan.supp can suppress these.

extern "C" int dlclose(void*) {
    return 0;
}
