#pragma once

#include <string>
#include <vector>

namespace corda::media {

/// Whether an encoder for an ending works on this machine, and why not.
struct EncoderProbe {
    std::string ending;  ///< ".mp4"
    std::string name;    ///< of the encoder
    bool usable = false;
    std::string reason;  ///< empty if it is usable
};

/// Encodes a small picture for every ending with every encoder that it takes, the default first: an encoder
/// that libav lists need not work.
[[nodiscard]] std::vector<EncoderProbe> probe_encoders();

}  // namespace corda::media
