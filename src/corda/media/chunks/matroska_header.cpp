#include "corda/media/bytes.hpp"
#include "corda/media/chunks/track_output.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace corda::media {
namespace {

using namespace std::string_view_literals;

// IDs of elements (RFC 9559).
constexpr std::uint64_t kSegment = 0x18538067;
constexpr std::uint64_t kSeekHead = 0x114d9b74;
constexpr std::uint64_t kSeek = 0x4dbb;
constexpr std::uint64_t kSeekPosition = 0x53ac;
constexpr std::uint64_t kTracks = 0x1654ae6b;
constexpr std::uint64_t kTrackEntry = 0xae;
constexpr std::uint64_t kCodecPrivate = 0x63a2;
constexpr std::uint64_t kTags = 0x1254c367;
constexpr std::uint64_t kTag = 0x7373;
constexpr std::uint64_t kSimpleTag = 0x67c8;
constexpr std::uint64_t kTagString = 0x4487;
constexpr std::uint64_t kVoid = 0xec;
constexpr std::uint64_t kCrc = 0xbf;

/// MaxBlockAdditionID 0, and a Void element in place of a BlockAdditionMapping.
constexpr std::string_view kTrackRoom = "\x55\xee\x81\x00\xec\x01\x00\x00\x00\x00\x00\x00\x02\x00\x00"sv;

struct Element {
    std::uint64_t id = 0;
    std::size_t begin = 0;
    std::size_t length_at = 0;  ///< of the number that is its length
    std::size_t data = 0;
    std::size_t end = 0;
};

void set_number(std::string& file, std::size_t at, int bytes, std::uint64_t value) {
    for (int i = bytes; i-- > 0; value >>= 8)
        file[at + static_cast<std::size_t>(i)] = static_cast<char>(value);
}

/// The element at a position below `end`; none if it ends behind that. The segment, whose length is not read,
/// ends there.
std::optional<Element> element_at(std::string_view file, std::size_t at, std::size_t end) {
    ByteReader bytes(file.substr(0, end));
    if (!bytes.skip(at)) return std::nullopt;
    const auto id = next_ebml_number(bytes);
    const auto length = next_ebml_number(bytes);
    if (!id || id->bytes > 4 || !length) return std::nullopt;
    Element element{.id = id->id,
                    .begin = at,
                    .length_at = at + id->bytes,
                    .data = static_cast<std::size_t>(bytes.position()),
                    .end = end};
    if (element.id == kSegment) return element;
    if (length->length > bytes.left()) return std::nullopt;
    element.end = element.data + static_cast<std::size_t>(length->length);
    return element;
}

/// The last child with this ID in a parent.
std::optional<Element> child(std::string_view file, const Element& parent, std::uint64_t id) {
    std::optional<Element> found;
    for (auto e = element_at(file, parent.data, parent.end); e; e = element_at(file, e->end, parent.end))
        if (e->id == id) found = e;
    return found;
}

/// Makes the elements, from the outermost to the innermost, longer by `by` bytes.
void lengthen(std::string& file, const std::vector<Element>& elements, int by) {
    for (const Element& element : elements) {
        const auto bytes = static_cast<int>(element.data - element.length_at);
        const std::uint64_t length = from_big_endian(
            std::string_view(file).substr(element.length_at, element.data - element.length_at));
        set_number(file, element.length_at, bytes, length + static_cast<std::uint64_t>(by));
    }
}

/// Writes the checksum that an element begins with.
void set_checksum(std::string& file, const Element& element) {
    constexpr std::size_t kCrcElementBytes = 6;
    const auto crc = element_at(file, element.data, element.end);
    if (!crc || crc->id != kCrc || crc->end - crc->begin != kCrcElementBytes) return;
    const std::uint32_t sum =
        ~av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), ~std::uint32_t{0},
                reinterpret_cast<const std::uint8_t*>(file.data()) + crc->end, element.end - crc->end);
    for (std::size_t i = 0; i < 4; ++i) file[crc->data + i] = static_cast<char>(sum >> (8 * i));
}

/// The elements whose names lead from the segment to one; empty if it has another structure.
std::vector<Element> path_to(std::string_view file, const Element& segment,
                             const std::vector<std::uint64_t>& ids) {
    std::vector<Element> path;
    for (const std::uint64_t id : ids) {
        const auto next = child(file, path.empty() ? segment : path.back(), id);
        if (!next) return {};
        path.push_back(*next);
    }
    return path;
}

}  // namespace

std::string with_new_matroska_header(std::string file) {
    const auto head = element_at(file, 0, file.size());
    const auto segment = head ? element_at(file, head->end, file.size()) : std::nullopt;
    if (!segment || segment->id != kSegment) return file;
    const std::vector<Element> words = path_to(file, *segment, {kTags, kTag, kSimpleTag, kTagString});
    const std::vector<Element> private_data = path_to(file, *segment, {kTracks, kTrackEntry, kCodecPrivate});
    const auto seek_head = child(file, *segment, kSeekHead);
    if (words.empty() || private_data.empty() || !seek_head || words[0].begin != private_data[0].end)
        return file;
    const auto room = element_at(file, words[0].end, file.size());
    const bool ends_with_zeros = file.compare(words.back().end - 2, 2, "\0\0"sv) == 0;
    if (!room || room->id != kVoid || room->end - room->begin != kNewMatroskaBytes || !ends_with_zeros)
        return file;

    std::string made = file;
    // From the end on, so that positions before what changes stay valid.
    made.erase(room->begin, kNewMatroskaBytes);
    made.erase(words.back().end - 1, 1);
    lengthen(made, words, -1);
    made.insert(private_data.back().begin, kTrackRoom);
    lengthen(made, {private_data[0], private_data[1]}, static_cast<int>(kTrackRoom.size()));
    for (auto seek = element_at(file, seek_head->data, seek_head->end); seek;
         seek = element_at(file, seek->end, seek_head->end)) {
        const auto position = seek->id == kSeek ? child(file, *seek, kSeekPosition) : std::nullopt;
        if (!position) continue;
        const std::size_t bytes = position->end - position->data;
        const std::uint64_t at = from_big_endian(std::string_view(file).substr(position->data, bytes));
        if (at + segment->data == words[0].begin)
            set_number(made, position->data, static_cast<int>(bytes), at + kTrackRoom.size());
    }
    for (const std::size_t at :
         {seek_head->begin, private_data[0].begin, words[0].begin + kTrackRoom.size()}) {
        if (const auto changed = element_at(made, at, made.size())) set_checksum(made, *changed);
    }
    return made;
}

}  // namespace corda::media
