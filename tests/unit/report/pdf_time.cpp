#include "corda/report/writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace corda::report {
namespace {

std::string big_endian(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i) & 0xffU);
    return text;
}

/// A zlib stream with one stored (uncompressed) block.
std::string stored(std::string_view text) {
    const auto size = static_cast<std::uint32_t>(text.size());
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const char c : text) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    const auto little_endian = [](std::uint32_t value) {
        return std::string{static_cast<char>(value & 0xffU), static_cast<char>(value >> 8 & 0xffU)};
    };
    return "\x78\x01\x01" + little_endian(size) + little_endian(~size) + std::string(text) +
           big_endian(b << 16 | a, 4);
}

/// The layout of cairo 1.18: object 1 is plain, 2 and 3 are in stream 4, 5 is its length, 6 the
/// cross-reference table.
std::string packed_pdf(std::string_view date) {
    const std::string info = fmt::format("<< /Producer (cairo)\n   /CreationDate (D:{})\n>>\n", date);
    const std::string objects =
        stored(fmt::format("3 0\n2 {}\n{}<< /Type /Catalog\n>>\n", info.size(), info));
    const std::size_t first = fmt::format("3 0\n2 {}\n", info.size()).size();
    std::string pdf = "%PDF-1.5\n";
    const std::size_t plain_at = pdf.size();
    pdf += "1 0 obj\n<< >>\nendobj\n";
    const std::size_t stream_at = pdf.size();
    pdf += fmt::format(
        "4 0 obj\n<< /Type /ObjStm\n   /Length 5 0 R\n   /N 2\n   /First {}\n   /Filter /FlateDecode\n>>\n"
        "stream\n{}\nendstream\nendobj\n",
        first, objects);
    const std::size_t length_at = pdf.size();
    pdf += fmt::format("5 0 obj\n   {}\nendobj\n", objects.size());
    const std::size_t table_at = pdf.size();
    const auto row = [](std::uint32_t kind, std::size_t place, std::uint32_t rest) {
        return big_endian(kind, 1) + big_endian(static_cast<std::uint32_t>(place), 2) + big_endian(rest, 2);
    };
    const std::string table = stored(row(0, 0, 0xffff) + row(1, plain_at, 0) + row(2, 4, 1) + row(2, 4, 0) +
                                     row(1, stream_at, 0) + row(1, length_at, 0) + row(1, table_at, 0));
    return pdf +
           fmt::format(
               "6 0 obj\n<< /Type /XRef\n   /Length {}\n   /Filter /FlateDecode\n   /Size 7\n   /W [1 2 2]\n"
               "   /Root 2 0 R\n   /Info 3 0 R\n>>\nstream\n{}\nendstream\nendobj\nstartxref\n{}\n%%EOF\n",
               table.size(), table, table_at);
}

TEST(PdfTime, OfAPlainPdfIsReplaced) {
    std::string pdf = "1 0 obj\n<< /CreationDate (D:20260102030405Z)\n>>\n";
    forget_time(pdf);
    EXPECT_EQ(pdf, "1 0 obj\n<< /CreationDate (D:20000101000000Z)\n>>\n");
}

TEST(PdfTime, OfACompressedPdfIsReplacedAndTheTableFits) {
    std::string pdf = packed_pdf("20260102030405Z");
    forget_time(pdf);
    EXPECT_EQ(
        pdf,
        "%PDF-1.5\n1 0 obj\n<< >>\nendobj\n"
        "3 0 obj\n<< /Producer (cairo)\n   /CreationDate (D:20000101000000Z)\n>>\nendobj\n"
        "2 0 obj\n<< /Type /Catalog\n>>\nendobj\n"
        "xref\n0 4\n0000000000 65535 f \n0000000009 00000 n \n0000000106 00000 n \n0000000030 00000 n \n"
        "trailer\n<< /Size 4\n   /Root 2 0 R\n   /Info 3 0 R\n>>\nstartxref\n142\n%%EOF\n");
    EXPECT_EQ(pdf.substr(106, 7), "2 0 obj");
    EXPECT_EQ(pdf.substr(142, 4), "xref");
}

TEST(PdfTime, OfADamagedPdfIsLeftAlone) {
    const std::string whole = packed_pdf("20260102030405Z");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        std::string pdf = whole.substr(0, size);
        forget_time(pdf);
        ASSERT_EQ(pdf.substr(0, whole.find("4 0 obj")),
                  whole.substr(0, std::min(size, whole.find("4 0 obj"))));
    }
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string pdf = whole;
        pdf[at] = static_cast<char>(~pdf[at]);
        EXPECT_NO_THROW(forget_time(pdf)) << at;
    }
}

}  // namespace
}  // namespace corda::report
