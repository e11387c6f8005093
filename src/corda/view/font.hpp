#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

struct FT_LibraryRec_;  // of FreeType
struct FT_FaceRec_;

namespace corda::view {

/// True for scripts that run from the right or whose letters change next to others, which takes more than
/// placing glyphs side by side.
[[nodiscard]] bool needs_shaping(char32_t character);

/// A font as FreeType reads it.
class FontFile : NonCopyable {
  public:
    /// `path`: empty for DejaVu Sans, which is part of the program. Throws corda::Error (kInvalidScene) for a
    /// file that cannot be read or is no font with outlines.
    explicit FontFile(const std::string& path = {});
    ~FontFile();

    [[nodiscard]] FT_FaceRec_* face() const { return face_; }

  private:
    FT_LibraryRec_* library_ = nullptr;
    FT_FaceRec_* face_ = nullptr;
};

/// Draws text in a font. Glyphs stand on whole pixels; all digits of DejaVu Sans are equally wide.
///
/// Text is UTF-8. A character that the font lacks, a control character or an invalid byte is drawn as a box.
/// Several threads may use a font at once; the glyphs that it has rendered are kept under a lock.
class Font {
  public:
    /// As FontFile.
    explicit Font(const std::string& path = {});
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;
    ~Font();

    /// The characters of a text that the font lacks or that need shaping, each once and in order.
    [[nodiscard]] std::u32string missing(std::string_view utf8) const;
    /// Advance width of a text, in pixels.
    [[nodiscard]] int width_px(std::string_view utf8, int size_px) const;
    /// The text, or its beginning and an ellipsis if it is wider than `room_px`; empty without room. It ends
    /// at a separator if it has one; at a space only if no quarter of the room stays empty.
    [[nodiscard]] std::string shortened(std::string text, int size_px, int room_px,
                                        std::string_view separator = " ") const;
    /// Bounding box of the pixels that write() would paint in an unlimited frame; may be empty.
    [[nodiscard]] PixelRect ink(const Text& text) const;
    /// Adds a text on top of the other stamps, cut off at the edges of the frame.
    void write(const Text& text, DrawList& list) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Why texts cannot be shown, with a remedy: "DejaVu Sans has no U+6F22, U+5B57; ...". Empty if they can.
/// `path`: of their font, as FontFile; `name`: that file in messages. Throws as FontFile.
[[nodiscard]] std::optional<Problem> missing_glyphs(const std::vector<std::string>& texts,
                                                    const std::string& path, const std::string& name);

// Sizes of text as shares of the em.
inline constexpr double kAscent = 0.76;   ///< of DejaVu's capitals
inline constexpr double kDescent = 0.24;  ///< below the baseline
inline constexpr double kLine = 1.5;      ///< from a baseline to the next
inline constexpr double kGap = 0.4;       ///< between a text and other items

[[nodiscard]] int rounded(double px);
/// The em in a frame whose shorter side is `side_px`.
[[nodiscard]] int em_of(int side_px);
/// The em in a frame. It is larger in an upright one, which a phone shows at the width of a hand.
[[nodiscard]] int em_of(int width_px, int height_px);
/// From the edges of that frame to its texts, of that em.
[[nodiscard]] int edge_of(int side_px, int em_px);

}  // namespace corda::view
