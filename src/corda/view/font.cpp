#include "corda/view/font.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_ERRORS_H

#include "corda/core/text.hpp"

// DejaVu Sans as Debian ships it; its licence (of Bitstream Vera) allows copies as part of programs. The
// assembler reads the file: as an array it would take the compiler half a minute.
__asm__(
    ".pushsection .rodata\n"
    ".hidden corda_font_begin\n"
    ".hidden corda_font_end\n"
    ".global corda_font_begin\n"
    ".global corda_font_end\n"
    "corda_font_begin:\n"
    ".incbin \"" CORDA_FONT
    "\"\n"
    "corda_font_end:\n"
    ".popsection\n");

extern "C" {
extern const unsigned char corda_font_begin[] __attribute__((visibility("hidden")));
extern const unsigned char corda_font_end[] __attribute__((visibility("hidden")));
}

namespace corda::view {
namespace {

/// Takes the first character off `rest`; U+FFFD for a byte that is not part of one.
char32_t take_character(std::string_view& rest) {
    const Character first = first_character(rest);
    rest.remove_prefix(std::max<std::size_t>(first.bytes, 1));
    return first.bytes == 0 ? U'\xfffd' : char32_t{first.number};
}

void check_font(FT_Error error) {
    if (error != 0)
        throw Error(ExitCode::kInternal, "FreeType: a glyph cannot be drawn: error " + std::to_string(error));
}

}  // namespace

FontFile::FontFile(const std::string& path) {
    FT_Error error = FT_Init_FreeType(&library_);
    if (error == 0) {
        error = path.empty()
                    ? FT_New_Memory_Face(library_, corda_font_begin,
                                         static_cast<FT_Long>(corda_font_end - corda_font_begin), 0, &face_)
                    : FT_New_Face(library_, path.c_str(), 0, &face_);
        if (error == 0 && FT_IS_SCALABLE(face_)) return;
        if (error == 0) FT_Done_Face(face_);
        FT_Done_FreeType(library_);
    }
    if (path.empty())
        throw Error(ExitCode::kInternal, "FreeType: the font cannot be read: error " + std::to_string(error));
    if (error == FT_Err_Cannot_Open_Resource)
        throw_error(ExitCode::kInvalidScene, "'{}' cannot be opened; give the path of a font", path);
    throw_error(ExitCode::kInvalidScene, "'{}' is no font with outlines; give a .ttf or .otf file", path);
}

FontFile::~FontFile() {
    FT_Done_Face(face_);
    FT_Done_FreeType(library_);
}

struct Font::Impl {
    /// One character at one size, as FreeType renders it.
    struct Glyph {
        int left_px = 0;  ///< of the box, from the pen
        int top_px = 0;   ///< of the box, above the baseline
        int width_px = 0;
        int height_px = 0;
        int advance_px = 0;
        std::vector<std::uint8_t> coverage;  ///< row by row, 0 .. 255
    };

    const Glyph& glyph(char32_t character, int size_px) {
        const std::lock_guard lock(mutex);
        const std::pair key(size_px, character);
        auto found = glyphs.find(key);
        if (found == glyphs.end()) found = glyphs.emplace(key, load(character, size_px)).first;
        return found->second;
    }

    Glyph load(char32_t character, int size_px) {
        const FT_Face face = file.face();
        check_font(FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(size_px)));
        check_font(FT_Load_Char(face, character, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP));
        const FT_GlyphSlot slot = face->glyph;
        const FT_Bitmap& bitmap = slot->bitmap;
        if (bitmap.rows > 0 && bitmap.pixel_mode != FT_PIXEL_MODE_GRAY)
            throw_error(ExitCode::kInternal, "FreeType: a glyph of {} pixels has no levels of grey", size_px);
        Glyph glyph;
        glyph.left_px = slot->bitmap_left;
        glyph.top_px = slot->bitmap_top;
        glyph.width_px = static_cast<int>(bitmap.width);
        glyph.height_px = static_cast<int>(bitmap.rows);
        glyph.advance_px = static_cast<int>(slot->advance.x >> 6);
        for (int y = 0; y < glyph.height_px; ++y) {
            const unsigned char* row = bitmap.buffer + static_cast<std::ptrdiff_t>(y) * bitmap.pitch;
            glyph.coverage.insert(glyph.coverage.end(), row, row + bitmap.width);
        }
        return glyph;
    }

    /// Calls `visit` with every glyph and where its box is; returns where the pen ends.
    template <class Visit>
    int for_each_glyph(std::string_view utf8, int x_px, int y_px, int size_px, const Visit& visit) {
        while (!utf8.empty()) {
            const Glyph& next = glyph(take_character(utf8), size_px);
            const int x0 = x_px + next.left_px;
            const int y0 = y_px - next.top_px;
            if (!next.coverage.empty())
                visit(next, PixelRect{x0, y0, x0 + next.width_px, y0 + next.height_px});
            x_px += next.advance_px;
        }
        return x_px;
    }

    explicit Impl(const std::string& file_path) : path(file_path), file(file_path) {}

    std::string path;
    FontFile file;
    std::mutex mutex;
    std::map<std::pair<int, char32_t>, Glyph> glyphs;
};

Font::Font(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;
Font::~Font() = default;

bool needs_shaping(char32_t character) {
    struct Range {
        char32_t first;
        char32_t last;
    };
    constexpr Range kShaped[] = {{0x0590, 0x109f}, {0x1700, 0x18af},   {0x1900, 0x1c7f},  {0x1cc0, 0x1cff},
                                 {0xa800, 0xa95f}, {0xa980, 0xab2f},   {0xabc0, 0xabff},  {0xfb1d, 0xfdff},
                                 {0xfe70, 0xfefe}, {0x10800, 0x11fff}, {0x1e800, 0x1efff}};
    return std::ranges::any_of(kShaped, [character](const Range& range) {
        return character >= range.first && character <= range.last;
    });
}

std::optional<Problem> missing_glyphs(const std::vector<std::string>& texts, const std::string& path,
                                      const std::string& name) {
    std::string all;
    for (const std::string& text : texts) all += text;
    if (all.empty() && path.empty()) return std::nullopt;
    std::string shaped;
    std::string others;
    for (const char32_t character : Font(path).missing(all)) {
        std::string& names = needs_shaping(character) ? shaped : others;
        names += fmt::format("{}U+{:04X}", names.empty() ? "" : ", ", static_cast<std::uint32_t>(character));
    }
    if (shaped.empty() && others.empty()) return std::nullopt;
    Problem problem{{}, "", "leave these characters out"};
    if (!shaped.empty())
        problem.what = fmt::format("the letters of {} change next to others, which is not done", shaped);
    if (!others.empty()) {
        problem.what += fmt::format("{}{} has no {}", shaped.empty() ? "" : "; ",
                                    path.empty() ? "DejaVu Sans" : fmt::format("'{}'", name), others);
        problem.remedy =
            "name a font that has all characters (overlay.font = \"file.ttf\"), or " + problem.remedy;
    }
    return problem;
}

std::u32string Font::missing(std::string_view utf8) const {
    std::u32string missing;
    while (!utf8.empty()) {
        const char32_t character = take_character(utf8);
        const bool is_shown =
            !needs_shaping(character) && FT_Get_Char_Index(impl_->file.face(), character) != 0;
        if (!is_shown && missing.find(character) == std::u32string::npos) missing += character;
    }
    return missing;
}

int Font::width_px(std::string_view utf8, int size_px) const {
    return impl_->for_each_glyph(utf8, 0, 0, size_px, [](const Impl::Glyph&, const PixelRect&) {});
}

std::string Font::shortened(std::string text, int size_px, int room_px, std::string_view separator) const {
    if (width_px(text, size_px) <= room_px) return text;
    const std::string mark = "…";
    int end = width_px(mark, size_px);
    std::size_t kept = 0;
    for (std::size_t next = 0; next < text.size(); kept = next) {
        next += std::max<std::size_t>(first_character(std::string_view(text).substr(next)).bytes, 1);
        end += width_px(std::string_view(text).substr(kept, next - kept), size_px);
        if (end > room_px) break;
    }
    const std::size_t last = text.rfind(separator, kept);
    constexpr double kMinUsed = 0.75;
    const bool is_long_word =
        separator == " " && width_px(text.substr(0, last), size_px) < kMinUsed * room_px;
    if (last != std::string::npos && last > 0 && !is_long_word) kept = last;
    return kept == 0 ? "" : text.substr(0, kept) + mark;
}

PixelRect Font::ink(const Text& text) const {
    PixelRect ink;
    impl_->for_each_glyph(text.utf8, text.x_px, text.y_px, text.size_px,
                          [&ink](const Impl::Glyph&, const PixelRect& box) { ink = ink.united(box); });
    return ink;
}

void Font::write(const Text& text, DrawList& list) const {
    const PixelRect box = ink(text).intersected({0, 0, list.width, list.height});
    if (box.empty()) return;
    const std::size_t first = list.coverage.size();
    list.coverage.resize(first + static_cast<std::size_t>(box.width()) * box.height());
    impl_->for_each_glyph(
        text.utf8, text.x_px, text.y_px, text.size_px, [&](const Impl::Glyph& glyph, const PixelRect& at) {
            const PixelRect seen = at.intersected(box);
            for (int y = seen.y0; y < seen.y1; ++y) {
                for (int x = seen.x0; x < seen.x1; ++x) {
                    std::uint8_t& united =
                        list.coverage[first + static_cast<std::size_t>(y - box.y0) * box.width() +
                                      (x - box.x0)];
                    united = std::max(
                        united,
                        glyph.coverage[static_cast<std::size_t>(y - at.y0) * glyph.width_px + (x - at.x0)]);
                }
            }
        });
    list.stamps.push_back({box, text.color, first});
    list.texts.push_back(text);
    list.texts.back().font = impl_->path;
}

int rounded(double px) {
    return static_cast<int>(std::lround(px));
}

constexpr double kEm = 1.0 / 40.0;

int em_of(int side_px) {
    constexpr double kSmallEm = 1.0 / 16.0;  // of frames in which kEm is too small to read
    constexpr double kReadablePx = 12.0;
    constexpr double kMinPx = 7.0;
    return rounded(std::max({kEm * side_px, std::min(kReadablePx, kSmallEm * side_px), kMinPx}));
}

int em_of(int width_px, int height_px) {
    constexpr double kMaxLarger = 1.5;
    const int side_px = std::min(width_px, height_px);
    const double larger = std::clamp(static_cast<double>(height_px) / width_px, 1.0, kMaxLarger);
    return std::max(em_of(side_px), rounded(larger * kEm * side_px));
}

int edge_of(int side_px, int em_px) {
    constexpr double kEdge = 0.03;
    constexpr double kEdgePerEm = 0.45;
    return rounded(std::max(kEdge * side_px, kEdgePerEm * em_px));
}

}  // namespace corda::view
