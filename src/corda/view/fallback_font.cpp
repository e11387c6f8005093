#include <fmt/format.h>
#include <fontconfig/fontconfig.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "corda/view/font.hpp"

namespace corda::view {
namespace {

struct Destroy {
    void operator()(FcPattern* pattern) const noexcept { FcPatternDestroy(pattern); }
    void operator()(FcCharSet* characters) const noexcept { FcCharSetDestroy(characters); }
};
using Pattern = std::unique_ptr<FcPattern, Destroy>;

std::optional<FallbackFont> find_font(char32_t character) {
    const std::unique_ptr<FcCharSet, Destroy> characters(FcCharSetCreate());
    FcCharSetAddChar(characters.get(), character);
    const Pattern wanted(FcPatternCreate());
    FcPatternAddCharSet(wanted.get(), FC_CHARSET, characters.get());
    FcPatternAddString(wanted.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>("sans-serif"));
    // The same font and name whatever the language of the environment is.
    FcPatternAddString(wanted.get(), FC_LANG, reinterpret_cast<const FcChar8*>("en"));
    FcPatternAddBool(wanted.get(), FC_SCALABLE, FcTrue);
    FcPatternAddBool(wanted.get(), FC_COLOR, FcFalse);
    FcPatternAddString(wanted.get(), FC_NAMELANG, reinterpret_cast<const FcChar8*>("en"));
    FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
    FcDefaultSubstitute(wanted.get());
    FcResult result{};
    const Pattern font(FcFontMatch(nullptr, wanted.get(), &result));
    FcCharSet* covered = nullptr;
    FcChar8* path = nullptr;
    FcChar8* family = nullptr;
    FallbackFont found;
    int version = 0;
    FcBool is_scalable = FcFalse;
    const bool is_good = font && FcPatternGetCharSet(font.get(), FC_CHARSET, 0, &covered) == FcResultMatch &&
                         FcCharSetHasChar(covered, character) != FcFalse &&
                         FcPatternGetBool(font.get(), FC_SCALABLE, 0, &is_scalable) == FcResultMatch &&
                         is_scalable != FcFalse &&
                         FcPatternGetString(font.get(), FC_FILE, 0, &path) == FcResultMatch &&
                         FcPatternGetInteger(font.get(), FC_INDEX, 0, &found.index) == FcResultMatch &&
                         FcPatternGetString(font.get(), FC_FAMILY, 0, &family) == FcResultMatch &&
                         FcPatternGetInteger(font.get(), FC_FONTVERSION, 0, &version) == FcResultMatch;
    if (!is_good) return std::nullopt;
    found.path = reinterpret_cast<const char*>(path);
    found.family = reinterpret_cast<const char*>(family);
    found.version = fmt::format("{:.3f}", version / 65536.0);
    return found;
}

}  // namespace

bool needs_shaping(char32_t character) {
    struct Range {
        char32_t first;
        char32_t last;
    };
    constexpr Range kShaped[] = {{0x0590, 0x109f}, {0x1700, 0x18af},   {0x1900, 0x1c7f},  {0x1cc0, 0x1cff},
                                 {0xa800, 0xa95f}, {0xa980, 0xab2f},   {0xabc0, 0xabff},  {0xfb1d, 0xfdff},
                                 {0xfe70, 0xfefe}, {0x10800, 0x11fff}, {0x1e800, 0x1efff}};
    return std::any_of(std::begin(kShaped), std::end(kShaped), [character](const Range& range) {
        return character >= range.first && character <= range.last;
    });
}

bool is_emoji(char32_t character) {
    return character >= 0x1f000 && character <= 0x1fbff;
}

bool can_fall_back(char32_t character) {
    return character >= 0x20 && !needs_shaping(character) && !is_emoji(character);
}

const FallbackFont* fallback_font(char32_t character) {
    static std::mutex mutex;
    static std::map<char32_t, std::optional<FallbackFont>> known;
    static std::map<std::string, FallbackFont> fonts;  // one per face
    if (!can_fall_back(character)) return nullptr;
    const std::lock_guard lock(mutex);
    const auto [entry, is_new] = known.try_emplace(character);
    if (is_new) entry->second = find_font(character);
    if (!entry->second) return nullptr;
    const FallbackFont& font = *entry->second;
    return &fonts.try_emplace(fmt::format("{} {}", font.index, font.path), font).first->second;
}

}  // namespace corda::view
