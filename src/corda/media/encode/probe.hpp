#pragma once

#include <string>
#include <vector>

#include "corda/media/format/format.hpp"

namespace corda::media {

/// Whether an encoder for an ending works on this machine, and why not.
struct EncoderProbe {
    std::string ending;         ///< ".mp4"
    std::string name;           ///< of the encoder
    std::string reason;         ///< empty if it is usable
    bool is_temporary = false;  ///< memory or threads are lacking
};

/// Encodes a small picture for every ending with every encoder that it takes, the default first: an encoder
/// that libav lists need not work.
[[nodiscard]] std::vector<EncoderProbe> probe_encoders();

/// Throws corda::Error (kTemporary) if the system does not start as many threads as the encoder starts: some
/// encoders would wait for ever.
void check_threads(const Codec& codec);

}  // namespace corda::media
