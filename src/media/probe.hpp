#pragma once

#include <string>
#include <vector>

namespace corda::media {

/// Whether an encoder works on this machine, and why not.
struct EncoderProbe {
    std::string name;
    bool usable = false;
    std::string reason;  ///< empty if it is usable
};

/// Encodes a small picture with every encoder in the table of formats: an encoder that libav lists need not
/// work.
[[nodiscard]] std::vector<EncoderProbe> probe_encoders();

}  // namespace corda::media
