// Replaces libx264 in one test: an encoder library that loads but fails. It has every symbol that libavcodec
// needs at load time; the first call that can fail does.

extern "C" {

extern const char x264_levels[4096] = {};

int x264_param_default_preset(void*, const char*, const char*) {
    return -1;
}
int x264_param_apply_profile(void*, const char*) {
    return -1;
}
int x264_param_parse(void*, const char*, const char*) {
    return -1;
}
void* x264_encoder_open_164(void*) {
    return nullptr;
}
int x264_encoder_reconfig(void*, void*) {
    return -1;
}
int x264_encoder_headers(void*, void**, int*) {
    return -1;
}
int x264_encoder_encode(void*, void**, int*, void*, void*) {
    return -1;
}
int x264_encoder_delayed_frames(void*) {
    return 0;
}
int x264_encoder_maximum_delayed_frames(void*) {
    return 0;
}
void x264_encoder_close(void*) {}
void x264_param_default(void*) {}
void x264_param_apply_fastfirstpass(void*) {}
void x264_param_cleanup(void*) {}
void x264_picture_init(void*) {}
}
