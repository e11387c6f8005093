#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/rational.hpp"
#include "corda/core/workers.hpp"
#include "corda/media/chunks/chunk_folder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/read/decoder.hpp"

namespace corda::media {

/// Pictures of which an animation is made.
struct AnimationDef {
    std::vector<ChunkFile> chunks;  ///< one after the other; they are exact
    std::int64_t frames = 0;        ///< in all
    Rational fps;
    int loop = 0;     ///< how often it plays; 0: for ever
    int threads = 1;  ///< change the time that it takes, and no byte
};

/// Refuses an animation of one frame that would be a picture. Throws corda::Error (kUsage).
void check_animation_frames(const Ending& ending, std::int64_t frames);

/// Makes an animation of an ending. A few pictures per thread are in memory at a time, and all encoded frames
/// of a .webp. Throws corda::Error: kIo, kEncoder, kInterrupted if cancelled.
void write_animation(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                     OutputFile& output);

// As write_animation, of one format: Codec::write.

/// One palette for all frames; each frame holds the pixels that changed.
void write_gif(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
               OutputFile& output);
/// Lossless, with all levels of transparency; each frame is the rectangle that has changed. (libavcodec's
/// encoder tries all ways to lay a frame over the last one, in four times the time for more bytes.)
void write_apng(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output);
/// The same.
void write_webp(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output);

/// Changes of an animation frame.
struct PictureChange {
    /// Where the frame differs from the last one, from even columns and rows on; one pixel if it does not.
    PixelRect part;
    /// That part of the frame. If it is to be blended over the last frame, pixels that stay as they are have
    /// no colour and are transparent, which takes fewer bytes.
    Image picture;
    bool is_blended = false;
};

/// The exact pictures of chunks, one after the other, and what each of them changes.
class LosslessFrames {
  public:
    explicit LosslessFrames(std::vector<ChunkFile> chunks) : chunks_(std::move(chunks)) {}

    /// Goes on to picture `k`, which must come after the current one. Throws corda::Error (kIo).
    void go_to(std::int64_t k);
    [[nodiscard]] const Image& picture() const { return picture_; }
    /// The change since the picture before; of picture 0, all of it. Opaque pictures are blended.
    [[nodiscard]] PictureChange change() const;

  private:
    /// Opens the chunk of picture `k`, unless it is open.
    void enter(std::int64_t k);
    void read(Image& picture);
    void decode();

    std::vector<ChunkFile> chunks_;
    QuietLog quiet_;
    std::optional<Decoder> decoder_;  ///< of the chunk before chunk_
    std::size_t chunk_ = 0;           ///< the next one to open
    std::int64_t end_ = 0;            ///< of the open one
    std::int64_t next_ = 0;
    Image picture_;
    Image last_;  ///< the picture before
};

/// Makes something of the frames first <= k < end. If `all` is stopped, the result is dropped.
template <class Section>
using MakeSection =
    std::function<Section(std::int64_t first, std::int64_t end, const OrderedWorkers<Section>& all)>;

/// Makes something of sections of the frames on the threads of `def`, and takes it in order on this one.
/// `new_maker` is called as OrderedWorkers does. Throws what they throw, and corda::Error (kInterrupted).
template <class Section>
void for_each_section(const AnimationDef& def, const OnProgress& on_progress,
                      const std::function<MakeSection<Section>()>& new_maker,
                      const std::function<void(Section)>& take) {
    constexpr std::int64_t kFrames = 12;
    const std::int64_t sections = (def.frames + kFrames - 1) / kFrames;
    const auto threads = static_cast<int>(std::min<std::int64_t>(def.threads, sections));
    OrderedWorkers<Section> all(0, sections, threads, [&] {
        return [&def, make = new_maker()](std::int64_t section, const OrderedWorkers<Section>& every) {
            return make(section * kFrames, std::min(def.frames, (section + 1) * kFrames), every);
        };
    });
    for (std::int64_t taken = 0; taken < sections;) {
        report_progress(on_progress, taken * kFrames, def.frames);
        auto section = all.wait();
        if (!section) continue;
        take(std::move(*section));
        ++taken;
    }
}

/// Makes something of each frame, and takes it in order.
template <class Frame>
void for_each_frame(const AnimationDef& def, const OnProgress& on_progress,
                    const std::function<Frame(const LosslessFrames&)>& make,
                    const std::function<void(const Frame&)>& take) {
    using Section = std::vector<Frame>;
    const auto new_maker = [&] {
        const auto pictures = std::make_shared<LosslessFrames>(def.chunks);
        return [pictures, &make](std::int64_t first, std::int64_t end, const OrderedWorkers<Section>& all) {
            Section section;
            for (std::int64_t k = first; k < end && !all.is_stopped(); ++k) {
                pictures->go_to(k);
                section.push_back(make(*pictures));
            }
            return section;
        };
    };
    for_each_section<Section>(def, on_progress, new_maker, [&take](const Section& section) {
        for (const Frame& frame : section) take(frame);
    });
}

}  // namespace corda::media
