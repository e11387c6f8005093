#include "corda/media/read/webp_reader.hpp"

#include <webp/decode.h>
#include <webp/demux.h>

#include <algorithm>
#include <cmath>

#include "corda/core/file.hpp"

namespace corda::media {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 31;

bool fits(Rational fps, const std::vector<std::int64_t>& ends, std::int64_t ticks_per_second) {
    std::int64_t k = 0;
    return std::ranges::all_of(ends, [&](std::int64_t end) {
        ++k;
        return (2 * ticks_per_second * k * fps.den + fps.num) / (2 * fps.num) == end;
    });
}

/// The fraction of smallest denominator that fits.
std::optional<Rational> simplest_rate(const std::vector<std::int64_t>& ends, std::int64_t ticks_per_second) {
    constexpr std::int64_t kMaxDenominator = 10'000;
    double low = 0.0;  // that fitting rates are above, and those up to which they are
    double high = 2.0 * static_cast<double>(ticks_per_second);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const double frames = 2.0 * static_cast<double>(ticks_per_second) * static_cast<double>(i + 1);
        const double twice_end = 2.0 * static_cast<double>(ends[i]);
        low = std::max(low, frames / (twice_end + 1.0));
        if (twice_end > 0.0) high = std::min(high, frames / (twice_end - 1.0));
    }
    for (std::int64_t den = 1; den <= kMaxDenominator; ++den) {
        const auto num = static_cast<std::int64_t>(std::floor(high * static_cast<double>(den)));
        if (num > 0 && static_cast<double>(num) > low * static_cast<double>(den) &&
            fits({num, den}, ends, ticks_per_second))
            return Rational{num, den};
    }
    return std::nullopt;
}

}  // namespace

void WebpReader::Free::operator()(WebPAnimDecoder* decoder) const {
    WebPAnimDecoderDelete(decoder);
}

WebpReader::WebpReader(const std::string& path)
    : bytes_(first_bytes(path, std::min(file_size(path), kMaxBytes))) {
    WebPAnimDecoderOptions options{};
    WebPAnimDecoderOptionsInit(&options);
    options.color_mode = MODE_RGBA;
    const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()};
    decoder_.reset(WebPAnimDecoderNew(&data, &options));
    WebPAnimInfo info{};
    const bool is_sound = decoder_ && WebPAnimDecoderGetInfo(decoder_.get(), &info) != 0 &&
                          is_picture_size(info.canvas_width, info.canvas_height);
    if (!is_sound) decoder_.reset();
    width_px_ = static_cast<int>(info.canvas_width);
    height_px_ = static_cast<int>(info.canvas_height);
}

bool WebpReader::has_next() const {
    return is_open() && WebPAnimDecoderHasMoreFrames(decoder_.get()) != 0;
}

bool WebpReader::read(Image& picture) {
    std::uint8_t* rgba = nullptr;
    int end_ms = 0;
    if (!has_next() || WebPAnimDecoderGetNext(decoder_.get(), &rgba, &end_ms) == 0) return false;
    ends_ms_.push_back(end_ms);
    if (picture.width() != width_px_ || picture.height() != height_px_)
        picture = Image(width_px_, height_px_);
    std::copy_n(rgba, picture.size_bytes(), picture.data());
    return true;
}

std::vector<std::int64_t> WebpReader::stated_ends_ms() const {
    std::vector<std::int64_t> ends_ms;
    if (!is_open()) return ends_ms;
    const WebPDemuxer* const demuxer = WebPAnimDecoderGetDemuxer(decoder_.get());
    WebPIterator each{};
    std::int64_t end_ms = 0;
    for (int more = WebPDemuxGetFrame(demuxer, 1, &each); more != 0; more = WebPDemuxNextFrame(&each)) {
        end_ms += each.duration;
        ends_ms.push_back(end_ms);
    }
    WebPDemuxReleaseIterator(&each);
    return ends_ms;
}

std::optional<Rational> rate_of_ends(const std::vector<std::int64_t>& ends, std::optional<Rational> stated,
                                     std::int64_t ticks_per_second) {
    if (ends.empty() || ends.back() <= 0) return std::nullopt;
    if (stated && fits(*stated, ends, ticks_per_second)) return stated;
    for (const Rational usual :
         {Rational{60, 1}, Rational{30, 1}, Rational{25, 1}, Rational{24, 1}, Rational{50, 1},
          Rational{30000, 1001}, Rational{24000, 1001}, Rational{60000, 1001}})
        if (fits(usual, ends, ticks_per_second)) return usual;
    const Rational mean = Rational::reduced(ticks_per_second * std::ssize(ends), ends.back());
    return mean.den == 1 && fits(mean, ends, ticks_per_second) ? mean : simplest_rate(ends, ticks_per_second);
}

}  // namespace corda::media
