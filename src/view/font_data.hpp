#pragma once

#include <ft2build.h>
#include FT_FREETYPE_H

namespace corda::view {

/// The font that is part of the program, as FreeType reads it.
class FontFile {
  public:
    /// Throws corda::Error (kInternal) if it cannot be read.
    FontFile();
    FontFile(const FontFile&) = delete;
    FontFile& operator=(const FontFile&) = delete;
    ~FontFile();

    [[nodiscard]] FT_Face face() const { return face_; }

  private:
    FT_Library library_ = nullptr;
    FT_Face face_ = nullptr;
};

}  // namespace corda::view
