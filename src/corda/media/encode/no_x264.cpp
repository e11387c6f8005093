// In place of x264_encoder.cpp in a build without libx264.

#include "corda/core/basics.hpp"
#include "corda/media/encode/encoder.hpp"

namespace corda::media {

std::string x264_version() {
    return {};
}

std::unique_ptr<Encoder> make_x264_encoder(const Format& /*format*/, const VideoDef& /*def*/) {
    throw Error(ExitCode::kEncoder, "this Corda was built without libx264");
}

}  // namespace corda::media
