#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "corda/pipeline/film_renderer.hpp"
#include "corda/sweep/labels.hpp"
#include "corda/sweep/summary.hpp"
#include "corda/sweep/sweep_file.hpp"

namespace corda::sweep {

/// A file of a sample: its ending, with the dot, and its bytes.
struct SampleFile {
    std::string ending;
    std::string bytes;
};

/// Why there is no sample of a number.
struct SampleFailure {
    ExitCode code = ExitCode::kInvalidScene;
    std::string message;
};

/// Whether an error says that a scene is not one that Corda makes: it fails a sample, not the sweep.
[[nodiscard]] bool is_refusal(ExitCode code);

/// One sample of a sweep. A sample whose scene is refused, or whose motion diverges, has only a failure
/// beside its number, its key, its split and its parameters.
struct Sample {
    std::int64_t number = 0;
    std::string key;  ///< its number with at least 6 digits: names of its files begin with it
    std::string split;
    Parameters parameters;
    std::optional<SampleFailure> failure;
    Summary summary;
    Json info;  ///< its .json: see README.md
    std::vector<Array> arrays;
    std::vector<SampleFile> pictures;  ///< one .mp4, or a .NUMBER.png per frame; empty for kNpz and kNone
};

/// "000012": at least 6 digits, more from sample 1 000 000 on.
[[nodiscard]] std::string key_of(std::int64_t sample);

/// Makes samples, one at a time, on the thread that made the first. It keeps OpenGL open between them.
class SampleMaker {
  public:
    /// `sweep` must outlive it. `film` says how to reach OpenGL.
    explicit SampleMaker(const SweepDef& sweep, FilmDef film = {}) : sweep_(&sweep), film_(std::move(film)) {}

    /// Throws corda::Error for what may be wrong with more than this sample, which the message names: kNoGl,
    /// kEncoder, kTemporary; kInterrupted if cancelled.
    [[nodiscard]] Sample make(std::int64_t number);

  private:
    void make_of(const Scene& scene, Sample& sample);
    void draw(Film& film, Sample& sample);

    const SweepDef* sweep_;
    FilmDef film_;
    pipeline::OwnedCanvas canvas_;
};

}  // namespace corda::sweep
