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
    /// From the left end of a text to where the next one would begin, in pixels.
    [[nodiscard]] int width_px(std::string_view utf8, int size_px);
    /// The smallest rectangle around what write() paints of a text, wherever the frame ends; empty if that is
    /// nothing.
    [[nodiscard]] PixelRect ink(const Text& text);
    /// Adds a text on top of the other stamps. What is outside of the frame is cut off.
    void write(const Text& text, DrawList& list);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Why a text cannot be drawn: "the font, DejaVu Sans, has no U+1F9F6; leave that character out". Empty if it
/// can.
[[nodiscard]] std::string missing_glyph(const std::string& text);

}  // namespace corda::view
