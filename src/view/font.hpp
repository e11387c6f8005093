#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// DejaVu Sans, which the program carries with it. Glyphs stand on whole pixels, each as far from the last
/// one as its width says: all digits are equally wide.
///
/// Text is UTF-8; a character that the font does not have, a control character or a byte that is no character
/// is shown as a box. Rendered glyphs are kept, so a Font is used by one thread at a time.
class Font {
  public:
    /// Throws corda::Error (kInternal) if the font cannot be read.
    Font();
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;
    ~Font();

    /// The characters of a text that the font does not have, each once and in order, as "U+1F9F6, U+6F22";
    /// empty if it has all.
    [[nodiscard]] std::string missing(std::string_view utf8) const;
    /// Advance width of a text, in pixels.
    [[nodiscard]] int width_px(std::string_view utf8, int size_px);
    /// Bounding box of the pixels that write() paints of a text, not cut off by a frame; empty if there are
    /// none.
    [[nodiscard]] PixelRect ink(const Text& text);
    /// Adds a text on top of the other stamps, cut off at the edges of the frame.
    void write(const Text& text, DrawList& list);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The reason a text cannot be shown: "the font, DejaVu Sans, has no U+1F9F6; leave that character out".
/// Empty if it can.
[[nodiscard]] std::string missing_glyph(const std::string& text);

// Sizes of texts, as shares of the em.
inline constexpr double kAscent = 0.76;   ///< of DejaVu's capitals
inline constexpr double kDescent = 0.24;  ///< below the baseline
inline constexpr double kLine = 1.5;      ///< from a baseline to the next
inline constexpr double kGap = 0.4;       ///< between a text and what else is drawn

[[nodiscard]] int rounded(double px);
/// The em in a frame whose shorter side is `side_px`.
[[nodiscard]] int em_of(int side_px);
/// From the edges of that frame to its texts, of that em.
[[nodiscard]] int edge_of(int side_px, int em_px);

}  // namespace corda::view
