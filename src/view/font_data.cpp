#include "corda/view/font_data.hpp"

#include <string>

#include "corda/core/basics.hpp"

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

FontFile::FontFile() {
    FT_Error error = FT_Init_FreeType(&library_);
    if (error == 0) {
        error = FT_New_Memory_Face(library_, corda_font_begin,
                                   static_cast<FT_Long>(corda_font_end - corda_font_begin), 0, &face_);
        if (error != 0) FT_Done_FreeType(library_);
    }
    if (error != 0)
        throw Error(ExitCode::kInternal, "FreeType: the font cannot be read: error " + std::to_string(error));
}

FontFile::~FontFile() {
    FT_Done_Face(face_);
    FT_Done_FreeType(library_);
}

}  // namespace corda::view
