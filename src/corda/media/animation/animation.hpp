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

/// Makes a GIF with one palette for all frames; each frame holds the pixels that changed. A few pictures per
/// thread are in memory at a time. Throws corda::Error: kIo, kEncoder, kInterrupted if cancelled.
void write_gif(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
               OutputFile& output);

/// The exact pictures of chunks, one after the other.
class LosslessFrames {
  public:
    explicit LosslessFrames(std::vector<ChunkFile> chunks) : chunks_(std::move(chunks)) {}

    /// Goes on to picture `k`, which must come after the current one. Throws corda::Error (kIo).
    void go_to(std::int64_t k);
    [[nodiscard]] const Image& picture() const { return picture_; }

  private:
    /// Decodes picture next_.
    void decode();

    std::vector<ChunkFile> chunks_;
    QuietLog quiet_;
    std::optional<Decoder> decoder_;  ///< of the chunk before chunk_
    std::size_t chunk_ = 0;           ///< the next one to open
    std::int64_t end_ = 0;            ///< of the open one
    std::int64_t next_ = 0;
    Image picture_;
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

}  // namespace corda::media
