#pragma once

#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Whether an encoder for an ending works on this machine, and why not.
struct EncoderProbe {
    std::string ending;  ///< ".mp4"
    std::string name;    ///< of the encoder
    bool usable = false;
    bool is_temporary = false;  ///< it hangs, or fails for want of memory or threads
    std::string reason;         ///< empty if it is usable
};

/// Encodes a small picture for every ending with every encoder that it takes, the default first: an encoder
/// that libav lists need not work. Each is tried in a child process that may take 5 s, unless this process
/// has other threads: call it before OpenGL is touched.
[[nodiscard]] std::vector<EncoderProbe> probe_encoders();

/// Encodes a picture in a child process that may take 5 s: some encoders wait for ever, or crash, if they
/// lack threads or memory. If this process has other threads, which rule that out, checks that the system
/// starts threads for the encoder. Throws corda::Error: kEncoder if it fails; kTemporary if it hangs or lacks
/// memory or threads; kInterrupted if cancelled.
void check_encoder_starts(const Format& format, const VideoDef& def);

}  // namespace corda::media
