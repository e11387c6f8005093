#include "corda/view/font_data.hpp"

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

const unsigned char* font_begin() {
    return corda_font_begin;
}

std::size_t font_bytes() {
    return static_cast<std::size_t>(corda_font_end - corda_font_begin);
}

}  // namespace corda::view
