#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// A point in pixels, y down. It may lie outside the frame.
struct PixelPoint {
    double x = 0;
    double y = 0;
};

/// The colour of a capsule in a tinted layer.
struct Tint {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    std::uint8_t weight = 1;  ///< weight where capsules overlap; >= 1

    friend bool operator==(const Tint&, const Tint&) = default;
};

/// A line with round caps: all points within `radius` of a segment. A disc if `length` is 0.
///
/// In pixels, x to the right, y down; the centre of the top left pixel is at (0.5, 0.5). (ax, ay) is the
/// start of the segment, a multiple of 1/1024, so that differences to pixel centres are exact in float. (ux,
/// uy) is its unit direction, rounded once from double.
struct Capsule {
    float ax = 0;
    float ay = 0;
    float ux = 1;
    float uy = 0;
    float length = 0;
    float radius = 0;
    /// Within this distance of the segment the ground replaces the layers below; 0: no halo.
    float halo_radius = 0;
    float strength = 255;  ///< 0 .. 255: coverage of a pixel that lies within
    Tint tint;
};

/// Capsules of one colour, or each with its own. They and their halos are united before they are painted, so
/// that joints and crossings of a transparent or smooth-edged line do not darken.
struct Layer {
    Color color;
    std::size_t first_capsule = 0;
    std::size_t capsule_count = 0;
    /// Each capsule has its tint, with the alpha of `color`. A pixel that several cover gets their mean, in
    /// which a capsule has little weight beyond the ends of its segment: collinear links meet at a sharp
    /// edge.
    bool is_tinted = false;
    bool is_note = false;  ///< an annotation, not part of the scene
};

/// A line of text. Font::write() adds it to a draw list.
struct Text {
    /// Left end of the baseline, in whole pixels, y down.
    int x_px = 0;
    int y_px = 0;
    int size_px = 16;  ///< of the font's em
    Color color;
    std::string utf8;
    std::string font = {};  ///< path of its file; empty: DejaVu Sans. Font::write() sets it
};

/// A filled rectangle or the glyphs of a text, painted over the layers.
struct Stamp {
    static constexpr std::size_t kSolid = static_cast<std::size_t>(-1);

    PixelRect box;  ///< within the frame, not empty
    Color color;
    /// Index in DrawList::coverage of the box's coverage, row by row; kSolid: fully covered.
    std::size_t first_coverage = kSolid;
};

/// One frame as plain data: layers painted in order over a ground, and stamps over them.
struct DrawList {
    int width = 0;
    int height = 0;
    Ground ground;
    std::vector<Capsule> capsules;
    std::vector<Layer> layers;  ///< contiguous and in the order of `capsules`
    std::vector<Stamp> stamps;
    std::vector<std::uint8_t> coverage;  ///< coverage of the stamps, 0 .. 255
    std::vector<Text> texts;             ///< texts of the stamps that are not solid

    /// True if no capsule is inside the frame, apart from annotations.
    [[nodiscard]] bool shows_nothing() const;
    [[nodiscard]] bool has_tints() const;
    /// Removes layers and stamps, but keeps their memory.
    void clear();
    /// Adds an empty layer on top of the others.
    void add_layer(Color color, bool is_tinted = false);
    /// Adds the capsule around the segment from `a` to `b` to the last layer, if it can touch the frame. Its
    /// halo extends `halo_px` beyond `radius_px`. `opacity`: 0 .. 1; where capsules of a layer overlap, the
    /// most opaque one shows.
    void add_capsule(PixelPoint a, PixelPoint b, double radius_px, double halo_px = 0.0, Tint tint = {},
                     double opacity = 1.0);
    /// Adds a circle of that radius, drawn with a pen of `width_px`, as a polygon.
    void add_ring(PixelPoint center, double radius_px, double width_px);
    /// Adds the part of a filled rectangle that is in the frame on top of the other stamps.
    void add_box(const PixelRect& box, Color color);
};

/// Distance in pixels beyond its radii at which a capsule can still touch a pixel: half a pixel of smooth
/// edge, and slack for rounding.
inline constexpr float kEdgeMargin = 1.0F;

/// The capsule of `radius_px`, with a halo of `halo_px` more, around the segment from `a` to `b`;
/// std::nullopt if it cannot touch a frame of `width` x `height` pixels, or if a coordinate is not a number.
/// A segment that leaves the frame is cut beyond the visible part, so that every coordinate fits into a
/// float; points farther than 1e30 pixels away count as that far.
[[nodiscard]] std::optional<Capsule> make_capsule(PixelPoint a, PixelPoint b, double radius_px, int width,
                                                  int height, double halo_px = 0.0);

/// Bounding box, in pixels, of the points within `extent` of a capsule's segment.
struct Surroundings {
    float x0;
    float y0;
    float x1;
    float y1;
};
[[nodiscard]] Surroundings surroundings(const Capsule& capsule, float extent);

/// The part of the frame that a capsule may cover.
[[nodiscard]] PixelRect capsule_bounds(const Capsule& capsule, int width, int height);

/// Points of a curve.
struct Arc {
    static constexpr std::size_t kMaxPoints = 49;
    std::array<PixelPoint, kMaxPoints> points;
    std::size_t count = 0;
};

/// The arc of a slack line of `length_px` between two points that are closer, hanging towards `down`, a unit
/// vector: the parabola a + t (b - a) + 4 t (1 - t) s down, 0 <= t <= 1, in equal steps of t, with the sag s
/// that gives them this length. It is symmetric and depends continuously on its ends; for ends above each
/// other it is folded. The points include `a` and `b`.
[[nodiscard]] Arc hang_slack(PixelPoint a, PixelPoint b, double length_px, PixelPoint down);

}  // namespace corda::view
