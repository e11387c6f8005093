#pragma once

// The only header that includes libav, private to src/corda/media: headers that other folders include must
// not include this one.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/buffer.h>
#include <libavutil/crc.h>
#include <libavutil/dict.h>
#include <libavutil/error.h>
#include <libavutil/frame.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/mathematics.h>
#include <libavutil/pixdesc.h>
}

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"

namespace corda::media {

/// Deleter for libav's `void free(T**)`.
template <auto kFree>
struct PointerPointerDeleter {
    template <typename T>
    void operator()(T* object) const noexcept {
        (*kFree)(&object);
    }
};

/// Deleter for libav's `void free(T*)`.
template <auto kFree>
struct PointerDeleter {
    template <typename T>
    void operator()(T* object) const noexcept {
        (*kFree)(object);
    }
};

/// Frees a context of avio_alloc_context and its buffer.
inline void free_io(AVIOContext** context) {
    if (*context != nullptr) av_freep(&(*context)->buffer);
    avio_context_free(context);
}

using CodecContext = std::unique_ptr<AVCodecContext, PointerPointerDeleter<&avcodec_free_context>>;
using Packet = std::unique_ptr<AVPacket, PointerPointerDeleter<&av_packet_free>>;
using Frame = std::unique_ptr<AVFrame, PointerPointerDeleter<&av_frame_free>>;
using BufferPool = std::unique_ptr<AVBufferPool, PointerPointerDeleter<&av_buffer_pool_uninit>>;
using InputFormat = std::unique_ptr<AVFormatContext, PointerPointerDeleter<&avformat_close_input>>;
using CodecParameters = std::unique_ptr<AVCodecParameters, PointerPointerDeleter<&avcodec_parameters_free>>;
using IoContext = std::unique_ptr<AVIOContext, PointerPointerDeleter<&free_io>>;
using OutputFormat = std::unique_ptr<AVFormatContext, PointerDeleter<&avformat_free_context>>;

/// Sets how long a frame lasts, in its time base. FFmpeg 6.0 renames the field, a template names either.
template <typename F>
void set_duration(F& frame, std::int64_t duration) {
    if constexpr (requires { frame.duration; }) {
        frame.duration = duration;
    } else {
        frame.pkt_duration = duration;
    }
}

/// Options for an open call, given by name.
class Options : NonCopyable {
  public:
    ~Options() { av_dict_free(&dictionary_); }

    Options& set(const char* name, const std::string& value);
    [[nodiscard]] AVDictionary** get() { return &dictionary_; }
    /// The name of an option that the open call did not take; empty if it took all.
    [[nodiscard]] std::string left_over() const;

  private:
    AVDictionary* dictionary_ = nullptr;
};

/// libav's own text for a negative return value.
[[nodiscard]] std::string libav_text(int status);

/// Throws corda::Error: "WHAT: <libav's text> (<its log lines>); HINT". A full disk and similar errors
/// get their own hint and kIo, a lack of memory or of files that may be open kTemporary.
[[noreturn]] void fail_libav(ExitCode code, const std::string& what, int status, std::string_view hint = {});

/// Throws like fail_libav if `status` is negative; returns it otherwise.
int check_libav(int status, ExitCode code, const std::string& what, std::string_view hint = {});

/// Returns `handle` or throws corda::Error (kTemporary) if libav had no memory for `what`.
template <typename Handle>
Handle check_allocated(Handle handle, const char* what) {
    if (!handle) fail_libav(ExitCode::kTemporary, std::string("cannot make ") + what, AVERROR(ENOMEM));
    return handle;
}

/// While one lives, libav prints nothing: for what holds objects of libav, which log on threads of their own
/// and when they are freed.
///
/// The first one takes over the log callback, which libav has one of per process and does not tell: one that
/// the host application had set is lost. While none lives, messages go to av_log_default_callback.
class QuietLog : NonCopyable {
  public:
    QuietLog();
    ~QuietLog();
};

/// A QuietLog that also collects, for messages, the errors that libav reports on this thread during the
/// object's life. Objects may nest.
class LogCapture : NonCopyable {
  public:
    LogCapture();
    ~LogCapture();

    /// The lines so far, joined by "; "; at most a few hundred characters.
    [[nodiscard]] const std::string& text() const { return text_; }
    void clear() { text_.clear(); }
    void add(std::string_view line);

  private:
    QuietLog quiet_;
    LogCapture* outer_;
    std::string text_;
};

/// The text that the innermost LogCapture of this thread holds; empty without one.
[[nodiscard]] std::string captured_log();

/// The path as a URL of libav's file protocol, so that "a:b.mp4" or "-" are files too.
[[nodiscard]] inline std::string file_url(const std::string& path) {
    return "file:" + path;
}

[[nodiscard]] inline AVRational to_libav(Rational value) {
    return {static_cast<int>(value.num), static_cast<int>(value.den)};
}

/// The duration of one frame: the time base in which frame n has the stamp n.
[[nodiscard]] inline AVRational frame_time_base(Rational fps) {
    return {static_cast<int>(fps.den), static_cast<int>(fps.num)};
}

}  // namespace corda::media
