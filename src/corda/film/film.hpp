#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/defs.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// How a Film is made.
struct FilmDef {
    /// Times in seconds, 0 .. world.duration_s, between frames at which stills or states will be needed.
    /// Other times are possible, but cost another simulation.
    std::vector<double> stills_s;
    double stills_shutter = 0.0;  ///< exposure of these stills, 0 .. 1; see Film::still()
    /// How to reach OpenGL: "auto", "device", "device:N", "surfaceless" or "default".
    std::string backend = "auto";
    bool require_gpu = false;  ///< refuse OpenGL on the CPU
    StateFields readings;      ///< fields of states in addition to positions
    /// Called while the film is made, with the number of times that the simulation has reached, in every
    /// pass. Returning false ends it with kInterrupted.
    OnProgress on_progress;
    std::function<double()> clock_s;  ///< seconds of a clock, by which stepping_s() is measured
};

/// OpenGL driver information.
struct GlInfo {
    std::string renderer;  ///< GL_RENDERER
    std::string vendor;
    std::string version;
    std::string platform;  ///< how the context was reached, e.g. "EGL device 0"
};

namespace gl {
struct ContextDef;
}
namespace film {
struct Look;
struct Motion;
}  // namespace film

/// Gives a scene its motion in place of a simulated one: positions that another simulation or a measurement
/// has found. A film of it then draws them, with the bodies, the style and the camera of the scene; forces,
/// velocities, `moves` and methods of the scene change nothing, pins let go lose their supports, and cut
/// links are gone. Unless something else gives world.duration, the film ends at the last time.
void give_motion(Scene& scene, GivenMotion motion);

/// Reads positions: CSV as `corda simulate` writes it, from standard input for "-", or an .npz of NumPy with
/// the arrays `times` (n) and `positions` (n, particles, 2) of float64. Throws corda::Error: kIo if the file
/// cannot be read, kUsage with its place for what it lacks.
[[nodiscard]] GivenMotion read_positions(const std::string& path);

/// A scene as pictures: plans a method, simulates the motion, fits the camera to it, and draws frames in any
/// order. The same scene gives the same bytes.
///
/// All is made by the constructor and never changes: any number of threads may use a film at once, and copies
/// share it. A CancelScope of the calling thread can end any call. Each thread that draws has an OpenGL
/// context, which it keeps for all films.
class Film {
  public:
    /// Plans and simulates the scene. A motion that exceeds 1 GiB is kept in a temporary file (TMPDIR, or
    /// /var/tmp). Throws corda::Error: kInvalidScene if no method can run the scene or provide its tensions,
    /// or if a field is outside of its declared range, kUsage for an unknown backend or a still outside of
    /// the scene, kIo if a large motion does not fit on the disk, kInterrupted if cancelled or if on_progress
    /// returns false.
    explicit Film(const Scene& scene, const FilmDef& def = {});
    /// The film of a scene whose motion is given: see give_motion().
    Film(Scene scene, GivenMotion motion, const FilmDef& def = {});

    [[nodiscard]] const Scene& scene() const;
    [[nodiscard]] const System& system() const;

    /// Number of frames of the scene's video: those that start before its end.
    [[nodiscard]] std::int64_t frame_count() const;
    /// The index of the last frame whose time is not after the scene's end; states exist up to it, unless the
    /// motion diverges.
    [[nodiscard]] std::int64_t last_frame() const;
    /// The time of frame `k`: exactly k / fps, rounded once.
    [[nodiscard]] double time_s(std::int64_t k) const;

    /// The method and the estimate of its error.
    [[nodiscard]] const Plan& plan() const;
    /// Estimate of the displayed position error in pixels; std::nullopt if the plan has none.
    [[nodiscard]] std::optional<double> error_estimate_px() const;
    /// The camera with center and height filled in (for one that moves, those without its path); a scene with
    /// this camera gives the same bytes.
    [[nodiscard]] const CameraDef& camera() const;
    /// The same with the center and the height at a time, of a camera that moves too.
    [[nodiscard]] CameraDef camera_at(double time_s) const;

    /// Positions at frame `k`, 0 .. last_frame(), or at a time in 0 .. world.duration_s. Throws corda::Error:
    /// kUsage out of range, kDiverged if the motion ends before, kInterrupted if cancelled.
    [[nodiscard]] State state(std::int64_t k) const;
    [[nodiscard]] State state_at(double time_s) const;
    /// Figures of the state at a time. Throws as state_at().
    [[nodiscard]] Figures figures_at(double time_s) const;
    /// Energy of a state of this film, for which FilmDef::readings must include velocities; that of the
    /// weight is 0 at the start. Throws corda::Error (kUsage) without velocities.
    [[nodiscard]] Energy energy_of(const State& state) const;
    /// Figures of the whole run, or up to where it diverges.
    [[nodiscard]] const Diagnostics& diagnostics() const;
    /// Seconds spent in stepping; 0 without FilmDef::clock_s.
    [[nodiscard]] double stepping_s() const;

    /// Draws frame `k`, 0 .. last_frame(), as in the video, blurred by video.shutter; or the picture at a
    /// time in 0 .. world.duration_s, sharp unless `shutter` (0 .. 1, see VideoDef) is more than 0. RGBA8,
    /// row 0 on top. Calls check_cancelled() repeatedly if the picture is large or blurred. Throws as
    /// state(), and kNoGl.
    [[nodiscard]] Image frame(std::int64_t k) const;
    [[nodiscard]] Image still(double time_s, double shutter = 0.0) const;
    /// True if that picture would show only the ground. Needs no OpenGL. Throws as state().
    [[nodiscard]] bool is_empty(double time_s, double shutter = 0.0) const;
    /// The body at each pixel of frame `k` without motion blur, row 0 on top: 0 for none, or 1 + its index
    /// (ropes before nets). A pixel shows the last body that covers at least half of it; bars between other
    /// particles, supports and annotations are left out. Needs no OpenGL. Throws as state(), and kUsage for
    /// more than 255 bodies.
    [[nodiscard]] std::vector<std::uint8_t> mask(std::int64_t k) const;
    /// Positions in m in world coordinates as pixels, y down; the centre of the top left pixel is at (0.5,
    /// 0.5). A camera that moves is where it is at `time_s`.
    [[nodiscard]] std::vector<Vec2> to_pixels(std::span<const Vec2> positions_m, double time_s = 0.0) const;
    /// Plots, and names of their curves, that are left out of the pictures for lack of room: sentences with a
    /// remedy.
    [[nodiscard]] std::vector<std::string> left_out() const;
    /// The OpenGL driver. Throws kNoGl.
    [[nodiscard]] GlInfo gl() const;

    /// The same motion in pictures of another size, style or overlay, without another simulation. `scene` has
    /// the bodies and the world of the film's scene. Throws corda::Error (kInternal) for another colouring,
    /// other arrows, a longer trail, or an energy or a plot that the film's scene does not have.
    [[nodiscard]] Film with_look(const Scene& scene) const;

    // The values that a film consists of; for this library's own use.
    [[nodiscard]] const film::Motion& motion() const;
    [[nodiscard]] const film::Look& look() const;
    [[nodiscard]] const gl::ContextDef& context_def() const;
    /// A time in the form of time_within(). Throws corda::Error (kUsage) if there is no motion at that time.
    [[nodiscard]] double checked_s(double time_s) const;

  private:
    struct Impl;
    explicit Film(std::shared_ptr<const Impl> impl);

    std::shared_ptr<const Impl> impl_;
};

/// The scene of a film with the methods and the camera that were chosen: it gives the same frames, byte for
/// byte.
[[nodiscard]] Scene frozen_scene(const Film& film);

/// The tables [solver], [[solver.bodies]] and [camera] of frozen_scene(), for pasting into a scene file.
/// Throws corda::Error (kUsage) if method `relaxation` moves ropes that differ in reach (only code can make
/// such).
[[nodiscard]] std::string frozen_toml(const Film& film);

/// Draws given positions: from another simulation, or measured ones.
class Renderer {
  public:
    /// `scene` gives bodies, style and picture size. A camera without center and height is fitted to its
    /// points. Throws corda::Error: kInvalidScene for a field outside of its declared range, kUsage for an
    /// unknown backend (see FilmDef).
    explicit Renderer(const Scene& scene, const std::string& backend = "auto");

    /// The camera with center and height filled in.
    [[nodiscard]] const CameraDef& camera() const;
    /// Draws the particles at these positions in m, in world coordinates, one per particle, ropes before
    /// nets. Throws corda::Error: kUsage for another number of positions or one that is not finite, kNoGl.
    [[nodiscard]] Image draw(std::span<const Vec2> positions_m) const;

  private:
    struct Impl;
    std::shared_ptr<const Impl> impl_;
};

/// Options of render_video().
struct RenderDef {
    bool force = false;  ///< replace an existing file
    /// Of pictures ("frames/%06d.png"): draw those alone that are missing or damaged. A picture of another
    /// scene or version of Corda is an error (kUsage), or drawn again with `force`.
    bool resume = false;
    std::int64_t first = 0;
    std::optional<std::int64_t> end;  ///< one past the last frame; default Film::frame_count()
    /// Called after each frame, repeatedly while a large frame is drawn and while the finished video is
    /// ended and checked, and with all frames at the end; returning false stops. Frames of a .gif count
    /// twice: once when drawn, and once when encoded after all are drawn.
    OnProgress on_progress;
};

/// The result of render_video().
struct Rendered {
    std::int64_t frames = 0;       ///< number of frames that are written
    std::int64_t kept_frames = 0;  ///< number of these that were there (see RenderDef::resume)
    bool complete =
        true;  ///< false if it was cancelled or on_progress returned false: then there is no video
    bool reader_left = false;       ///< standard output was closed by its reader, which ends the video early
    std::string encoder{};          ///< libav's name
    std::int64_t empty_frames = 0;  ///< number of empty frames
    double first_empty_s = 0.0;     ///< time of the first empty frame
    std::string left_out{};         ///< why a file that can carry its scene does not; empty: it does
};

namespace media {
struct CheckedVideo;
}

/// A video output that check_render() has accepted.
class CheckedOutput {
  public:
    [[nodiscard]] const std::string& path() const;
    /// The frames first <= k < end of the film are written.
    [[nodiscard]] std::int64_t first() const;
    [[nodiscard]] std::int64_t end() const;
    /// Format and codec; for this library's own use.
    [[nodiscard]] const media::CheckedVideo& video() const { return *video_; }

  private:
    friend CheckedOutput check_render(const Scene& scene, const std::string& path, const RenderDef& def,
                                      const std::string& input);
    explicit CheckedOutput(media::CheckedVideo video);

    std::shared_ptr<const media::CheckedVideo> video_;
};

/// Checks a video of `scene` before there is a film: everything that could make render_video() refuse it
/// later, and whether the encoder starts. Throws corda::Error: kUsage for
/// an invalid ending, size, codec or range, or if `path` is the file `input` (empty: there is none); kIo if
/// the file exists (see force) or cannot be written; kEncoder, kTemporary, kInterrupted.
[[nodiscard]] CheckedOutput check_render(const Scene& scene, const std::string& path,
                                         const RenderDef& def = {}, const std::string& input = {});

/// Draws, encodes, verifies and names a video of a film whose scene was checked. Calls `on_progress` as
/// RenderDef describes. Throws corda::Error: kUsage for a film of another size or rate, kEncoder, kNoGl, kIo,
/// kDiverged. After an error there is no video; pictures that were written stay.
Rendered render_video(const Film& film, const CheckedOutput& output, const OnProgress& on_progress = {});

/// Checks the output, then renders it; the ending of `path` chooses the format.
Rendered render_video(const Film& film, const std::string& path, const RenderDef& def = {});

/// The files that render_video() would write of a whole film under `name`, in memory: one video, or a picture
/// per frame. Throws corda::Error as it does.
[[nodiscard]] std::vector<std::string> video_files(const Film& film, const std::string& name);

/// Poses of a film at several times.
struct FigureDef {
    /// In seconds, increasing, at least one; 0 .. world.duration_s.
    std::vector<double> times_s;
    /// 0: one picture of the film's size, in which earlier poses are fainter and the last one looks as in a
    /// still. Otherwise the columns of a contact sheet, whose cells have the film's size.
    int columns = 0;
    /// Size of a contact sheet; its cells must fit.
    int width_px = 0;
    int height_px = 0;
    /// Exposure as in Film::still(), 0 .. 1; only for one time in one PNG.
    double shutter = 0.0;
    /// The size of the times of a contact sheet; default: grows with its cells.
    std::optional<double> text_px = {};
};

/// A contact sheet of the scene's picture size. Changes `scene` to the size of a cell: draw_figure() and
/// write_figure() draw the sheet with a film of this scene. `columns`: 0 chooses them. `text_px`: the size of
/// all its texts, also those in cells. Throws corda::Error (kUsage) if the cells do not fit.
[[nodiscard]] FigureDef contact_sheet(Scene& scene, std::vector<double> times_s, int columns = 0,
                                      std::optional<double> text_px = {});

/// Throws corda::Error as Film::still(), and kUsage for an invalid definition or poses with too many lines.
[[nodiscard]] Image draw_figure(const Film& film, const FigureDef& def);

/// True if `path` ends with .png, .svg or .pdf.
[[nodiscard]] bool is_figure_path(const std::string& path);

/// Writes a figure; the ending of `path` chooses the format. An .svg or .pdf consists of lines, needs no
/// OpenGL, has the size of the pixels at info.pixels_per_inch, and only the title of the texts of `info`.
/// Returns the times of empty pictures: at most one, except in a contact sheet. Throws corda::Error as
/// draw_figure(), kIo, and kUsage for another ending.
std::vector<double> write_figure(const std::string& path, const Film& film, const FigureDef& def,
                                 const PngInfo& info = {}, const OutputOptions& options = {});

}  // namespace corda
#pragma GCC visibility pop
