#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "corda/view/camera.hpp"
#include "corda/view/overlay_texts.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::view {

/// The label of a body, next to one of its particles.
struct BodyLabel {
    std::string text;
    std::size_t particle = 0;
    /// The label continues the line from this particle; if it is `particle`, the label is above it.
    std::size_t from = 0;
    double clear_px = 0.0;  ///< free distance around the particle, at least
    int row = 0;            ///< above other labels of the same place
    double clear_m = 0.0;   ///< and at least
    double raise_px = 0.0;  ///< of a label above its particle, so that nothing passes it; see LabelRoom
};

/// The labels of bodies that have one: where its style says, else above its first pin, unless another
/// label's body is pinned there too, at its free end, or above its first particle. Several above one pin
/// are in rows.
[[nodiscard]] std::vector<BodyLabel> body_labels(const SceneView& view);

/// A label of a particle: beyond the end of a rope, otherwise above it.
[[nodiscard]] BodyLabel label_at(const SceneView& view, std::size_t particle, std::string text);

/// Where the particles of a label are: that next to it, and that from which its line comes.
struct LabelPlace {
    PixelPoint at;
    PixelPoint from;
    double clear_px = 0.0;  ///< free distance around `at`
};

/// The places of labels in the picture of a state.
[[nodiscard]] LabelPlace place_of(const BodyLabel& label, const State& state, const Camera& camera);
[[nodiscard]] std::vector<LabelPlace> places_of(std::span<const BodyLabel> labels, const State& state,
                                                const Camera& camera);

/// The labels, shortened to a share of the picture's width.
[[nodiscard]] std::vector<BodyLabel> shortened(const TextArea& area, std::vector<BodyLabel> labels);

/// Raises labels above particles by rows where they would overprint others in the picture of a state; true if
/// there are any. Where no row of a few is free, a label stays.
[[nodiscard]] bool stack_labels(const TextArea& area, std::span<BodyLabel> labels, const State& state,
                                const Camera& camera);

/// Extents of labels of particles that stay within `bounds`. Labels are raised over what rises in metres, so
/// that the scale in which `raise_px` was found gives its metres.
[[nodiscard]] std::vector<Drawn> drawn_labels(const TextArea& area, std::span<const BodyLabel> labels,
                                              std::span<const MotionBounds> bounds,
                                              double metres_per_px = 0.0);

/// Adds a label; one far outside the frame is left out.
void draw_label(const TextArea& area, const BodyLabel& label, const LabelPlace& place, DrawList& list);

/// The room above pins that ropes, nets, balls and trails leave for labels during a motion.
class LabelRoom {
  public:
    /// For labels of pins alone; others stay as they are. None is raised at first. The arguments must outlive
    /// this.
    LabelRoom(const TextArea& area, const SceneView& view, std::vector<BodyLabel>& labels);

    /// False if no label is above a pin over which particles within these bounds rise.
    [[nodiscard]] bool is_needed(std::span<const MotionBounds> bounds) const;
    /// `trails`: to the state; where neither pins nor the camera move, earlier states have their places.
    void include(const State& state, const Camera& camera, std::span<const Trail> trails);
    /// Raises labels that something passes to where nothing does; true if there are any. `will_fit`: the
    /// camera will be fitted to the raised ones; otherwise they are only raised within the frame.
    [[nodiscard]] bool raise_labels(bool will_fit);

  private:
    /// A label above a pin.
    struct Above {
        std::size_t label = 0;
        double half_px = 0.0;  ///< half of its text's width
        PixelPoint pin;        ///< in the included state
    };

    /// Marks what is drawn along a line for the labels that it passes over.
    void add_line(PixelPoint a, PixelPoint b, double radius_px);
    /// The same for one label: the ends are to the right of and above its pin.
    void add_line(const Above& above, Vec2 a_px, Vec2 b_px, double radius_px);
    [[nodiscard]] bool is_above_pin(const BodyLabel& label) const {
        return label.from == label.particle && view_->system->is_pinned(label.particle);
    }

    const TextArea* area_;
    const SceneView* view_;
    std::vector<BodyLabel>* labels_;
    std::vector<Above> above_;
    std::vector<PixelPoint> at_;               ///< the particles in the included state
    std::vector<double> above_px_;             ///< of each label: from its pin to the edge, at least
    std::vector<std::vector<bool>> is_taken_;  ///< of each label: rows of pixels above its pin, in its width
};

/// A pose among several in one picture.
struct PoseTime {
    BodyLabel label;
    LabelPlace place;
    double opacity = 1.0;
};

/// Adds the times of poses: those of later poses first, each where it hides no other and is nearest to its
/// own pose; one without such a place is left out.
void draw_times(const TextArea& area, std::span<const PoseTime> poses, DrawList& list);

}  // namespace corda::view
