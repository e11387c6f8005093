#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

struct FT_LibraryRec_;  // of FreeType
struct FT_FaceRec_;

namespace corda::view {

/// A font of this machine for characters that DejaVu Sans lacks.
struct FallbackFont {
    std::string path;
    int index = 0;  ///< of the face in the file
    std::string family;
    std::string version;

    [[nodiscard]] std::string name() const { return family + " " + version; }
};

/// True for scripts that run from the right or whose letters change next to others, which takes more than
/// placing glyphs side by side.
[[nodiscard]] bool needs_shaping(char32_t character);

/// True for emoji, whose fonts hold coloured pictures.
[[nodiscard]] bool is_emoji(char32_t character);

/// False for characters that are never looked up: those above and control characters.
[[nodiscard]] bool can_fall_back(char32_t character);

/// The font that fontconfig finds for a character; null if there is none. Threads may call it at once. Fonts
/// live until the process ends.
[[nodiscard]] const FallbackFont* fallback_font(char32_t character);

/// A part of a text in one font; null: DejaVu Sans.
struct FontRun {
    std::string_view utf8;
    const FallbackFont* font = nullptr;
};

/// DejaVu Sans, which is part of the program, or another font, as FreeType reads it.
class FontFile : NonCopyable {
  public:
    /// Throws corda::Error (kInternal) if it cannot be read.
    explicit FontFile(const FallbackFont* font = nullptr);
    ~FontFile();

    [[nodiscard]] FT_FaceRec_* face() const { return face_; }

  private:
    FT_LibraryRec_* library_ = nullptr;
    FT_FaceRec_* face_ = nullptr;
};

/// Draws text in DejaVu Sans, with other fonts for what it lacks. Glyphs stand on whole pixels; all digits
/// are equally wide.
///
/// Text is UTF-8. A character that no font has, a control character or an invalid byte is drawn as a box.
/// Rendered glyphs are cached, so one thread at a time may use a Font.
class Font {
  public:
    /// Throws corda::Error (kInternal) if the font cannot be read.
    Font();
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;
    ~Font();

    /// The characters of a text that no font has or that need shaping, each once and in order.
    [[nodiscard]] std::u32string missing(std::string_view utf8) const;
    /// The parts of a text by their fonts.
    [[nodiscard]] std::vector<FontRun> runs_of(std::string_view utf8) const;
    /// Advance width of a text, in pixels.
    [[nodiscard]] int width_px(std::string_view utf8, int size_px);
    /// The text, or its beginning and an ellipsis if it is wider than `room_px`; empty without room. It ends
    /// at a separator if it has one; at a space only if no quarter of the room stays empty.
    [[nodiscard]] std::string shortened(std::string text, int size_px, int room_px,
                                        std::string_view separator = " ");
    /// Bounding box of the pixels that write() would paint in an unlimited frame; may be empty.
    [[nodiscard]] PixelRect ink(const Text& text);
    /// Adds a text on top of the other stamps, cut off at the edges of the frame.
    void write(const Text& text, DrawList& list);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The reasons a text cannot be shown: "U+0628 needs text shaping, which is not done; leave that character
/// out", or install a font. Empty if it can.
[[nodiscard]] std::string missing_glyph(const std::string& text);

/// The fallback fonts of texts, each name once: "WenQuanYi Micro Hei 0.200".
[[nodiscard]] std::vector<const FallbackFont*> fallback_fonts(const std::vector<std::string>& texts);
[[nodiscard]] std::vector<std::string> fallback_names(const std::vector<std::string>& texts);

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
