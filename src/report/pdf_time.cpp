#include "corda/report/writers.hpp"

#include <zlib.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace corda::report {
namespace {

/// An inflated stream and the text before it in its object.
struct Stream {
    std::string_view dictionary;
    std::string data;
};

/// The number that stands in a text at `at`, behind blanks; or none.
std::optional<std::size_t> number_at(std::string_view text, std::size_t at) {
    at = text.find_first_not_of(" \n", at);
    std::size_t number = 0;
    if (at == std::string_view::npos ||
        std::from_chars(text.data() + at, text.data() + text.size(), number).ec != std::errc())
        return {};
    return number;
}

/// The number behind a key of a dictionary; of a reference, that of its object.
std::optional<std::size_t> number_of(std::string_view dictionary, std::string_view key) {
    const std::size_t at = dictionary.find(key);
    return at == std::string_view::npos ? std::nullopt : number_at(dictionary, at + key.size());
}

/// The inflated text of the zlib stream at the beginning of `packed`; std::nullopt if there is none.
std::optional<std::string> inflated(std::string_view packed) {
    z_stream state{};
    if (inflateInit(&state) != Z_OK) return {};
    std::string bytes(packed);  // zlib's interface wants what may be written to
    state.next_in = reinterpret_cast<Bytef*>(bytes.data());
    state.avail_in = static_cast<uInt>(bytes.size());
    std::string text;
    std::array<char, 4096> block{};
    int status = Z_OK;
    while (status == Z_OK) {
        state.next_out = reinterpret_cast<Bytef*>(block.data());
        state.avail_out = block.size();
        status = inflate(&state, Z_NO_FLUSH);
        text.append(block.data(), block.size() - state.avail_out);
    }
    inflateEnd(&state);
    if (status != Z_STREAM_END) return {};
    return text;
}

/// The stream of the object at an offset, which must be of a type.
std::optional<Stream> stream_at(std::string_view pdf, std::size_t at, std::string_view type) {
    constexpr std::string_view kBegin = ">>\nstream\n";
    const std::size_t begin = pdf.find(kBegin, at);
    if (begin == std::string_view::npos) return {};
    const std::string_view dictionary = pdf.substr(at, begin - at);
    if (dictionary.find(type) == std::string_view::npos) return {};
    std::optional<std::string> data = inflated(pdf.substr(begin + kBegin.size()));
    if (!data) return {};
    return Stream{dictionary, *std::move(data)};
}

/// A row of the table of objects: `kind` 1 is at an offset, 2 in the stream of that number.
struct Row {
    std::uint64_t kind = 0;
    std::uint64_t place = 0;
};

std::vector<Row> rows_of(const Stream& table) {
    constexpr std::string_view kWidths = "/W [";
    const std::size_t at = table.dictionary.find(kWidths);
    if (at == std::string_view::npos) return {};
    std::array<std::size_t, 3> widths{};
    std::size_t from = at + kWidths.size();
    for (std::size_t& width : widths) {
        width = number_at(table.dictionary, from).value_or(0);
        from = table.dictionary.find(' ', from + 1);
        if (width == 0 || width > 8 || from > table.dictionary.size()) return {};
    }
    const std::size_t row_size = widths[0] + widths[1] + widths[2];
    std::vector<Row> rows;
    for (std::size_t row = 0; row + row_size <= table.data.size(); row += row_size) {
        const auto field = [&](std::size_t begin, std::size_t width) {
            std::uint64_t value = 0;
            for (std::size_t i = 0; i < width; ++i)
                value = value << 8U | static_cast<unsigned char>(table.data[begin + i]);
            return value;
        };
        rows.push_back({field(row, widths[0]), field(row + widths[0], widths[1])});
    }
    return rows;
}

/// A PDF that is being written, with the offsets of its objects.
struct Plain {
    std::string text;
    std::map<std::size_t, std::size_t> offsets;

    void add(std::size_t number, std::string_view object) {
        offsets[number] = text.size();
        text += object;
    }
    /// Adds the objects in a stream: pairs of numbers and offsets, and behind those the objects.
    [[nodiscard]] bool add_objects_of(const Stream& stream) {
        const auto count = number_of(stream.dictionary, "/N ");
        const auto first = number_of(stream.dictionary, "/First ");
        if (!count || !first || *first > stream.data.size()) return false;
        const std::string_view data = stream.data;
        std::vector<std::size_t> numbers;
        for (std::size_t at = 0; at < *first && numbers.size() < 2 * *count;) {
            const auto number = number_at(data.substr(0, *first), at);
            if (!number) return false;
            numbers.push_back(*number);
            at = data.find_first_of(" \n", data.find_first_not_of(" \n", at));
        }
        if (numbers.size() != 2 * *count) return false;
        for (std::size_t i = 0; i < *count; ++i) {
            const std::size_t begin = *first + numbers[2 * i + 1];
            const std::size_t end = i + 1 < *count ? *first + numbers[2 * i + 3] : data.size();
            if (begin > end || end > data.size()) return false;
            add(numbers[2 * i],
                fmt::format("{} 0 obj\n{}endobj\n", numbers[2 * i], data.substr(begin, end - begin)));
        }
        return true;
    }
    void finish(std::size_t root, std::size_t info) {
        const std::size_t table = text.size();
        const std::size_t size = offsets.rbegin()->first + 1;
        text += fmt::format("xref\n0 {}\n", size);
        for (std::size_t number = 0; number < size; ++number) {
            const auto at = offsets.find(number);
            text +=
                at == offsets.end() ? "0000000000 65535 f \n" : fmt::format("{:010} 00000 n \n", at->second);
        }
        text +=
            fmt::format("trailer\n<< /Size {}\n   /Root {} 0 R\n   /Info {} 0 R\n>>\nstartxref\n{}\n%%EOF\n",
                        size, root, info, table);
    }
};

/// The same PDF with the objects out of its compressed streams; nothing if it has none of those.
std::optional<std::string> without_object_streams(std::string_view pdf) {
    constexpr std::string_view kStart = "startxref\n";
    const std::size_t start = pdf.rfind(kStart);
    if (start == std::string_view::npos) return {};
    const auto table_at = number_at(pdf, start + kStart.size());
    if (!table_at || *table_at >= pdf.size()) return {};
    const auto table = stream_at(pdf, *table_at, "/Type /XRef");
    if (!table) return {};
    const auto root = number_of(table->dictionary, "/Root ");
    const auto info = number_of(table->dictionary, "/Info ");
    std::map<std::size_t, std::size_t> numbers;  // of objects, by their offset in the file
    std::set<std::size_t> streams;
    const std::vector<Row> rows = rows_of(*table);
    for (std::size_t number = 0; number < rows.size(); ++number) {
        if (rows[number].kind == 1) numbers[rows[number].place] = number;
        if (rows[number].kind == 2) streams.insert(rows[number].place);
    }
    if (!root || !info || numbers.empty() || numbers.rbegin()->first != *table_at) return {};
    std::vector<Stream> packed;
    std::set<std::size_t> dropped{numbers.rbegin()->second};
    for (const auto& [offset, number] : numbers) {
        if (!streams.contains(number)) continue;
        auto stream = stream_at(pdf, offset, "/Type /ObjStm");
        if (!stream) return {};
        dropped.insert(number);
        // cairo keeps the length in an object of its own, behind the stream.
        if (const auto length = number_of(stream->dictionary, "/Length ")) dropped.insert(*length);
        packed.push_back(*std::move(stream));
    }
    Plain plain{std::string(pdf.substr(0, numbers.begin()->first)), {}};
    for (auto object = numbers.begin(); std::next(object) != numbers.end(); ++object) {
        if (!dropped.contains(object->second))
            plain.add(object->second, pdf.substr(object->first, std::next(object)->first - object->first));
    }
    for (const Stream& stream : packed)
        if (!plain.add_objects_of(stream)) return {};
    if (plain.offsets.empty()) return {};
    plain.finish(*root, *info);
    return plain.text;
}

}  // namespace

void forget_time(std::string& pdf) {
    constexpr std::string_view kDate = "/CreationDate (D:";
    constexpr std::string_view kTime = "20000101000000";
    if (auto plain = without_object_streams(pdf)) pdf = *std::move(plain);
    const std::size_t at = pdf.find(kDate);
    if (at != std::string::npos) pdf.replace(at + kDate.size(), kTime.size(), kTime);
}

}  // namespace corda::report
