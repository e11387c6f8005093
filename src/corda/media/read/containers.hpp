#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"

namespace corda::media {

/// One entry of an edit list: which part of the track is shown.
struct Mp4Edit {
    std::uint64_t duration = 0;   ///< in movie ticks
    std::int64_t media_time = 0;  ///< first stamp shown, in track ticks; -1 is an empty stretch
};

/// Values of the boxes of an MP4 file, read without libav, which rounds and repairs them.
struct Mp4Boxes {
    bool is_mp4 = false;        ///< begins with an ftyp box
    bool is_quicktime = false;  ///< its brand is QuickTime's: a .mov
    bool whole = false;         ///< every top-level box ends within the file
    std::uint64_t file_bytes = 0;
    bool has_index = false;    ///< a moov box was found and could be read
    bool fragmented = false;   ///< moof boxes, or a moov that announces them
    bool index_first = false;  ///< moov comes before mdat
    std::uint32_t movie_timescale = 0;
    std::uint64_t movie_duration = 0;
    int tracks = 0;
    // Of the first track:
    std::uint32_t track_timescale = 0;
    std::uint64_t track_duration = 0;      ///< mdhd: of the stored pictures, in track ticks
    std::uint64_t track_presentation = 0;  ///< tkhd: of the shown pictures, in movie ticks
    std::vector<Mp4Edit> edits;
};

/// Reads the boxes of any file; one that is no MP4 gives a struct with little in it. Throws corda::Error
/// (kIo) if the file cannot be opened for reading.
[[nodiscard]] Mp4Boxes read_mp4_boxes(const std::string& path);

/// True if a file of a kind that file_kind() names is shorter than it claims to be: a GIF without its
/// trailer, YUV4MPEG2 that ends in a frame, Matroska of a length that is not
/// there. Decoders take what there is and do not tell. False for other kinds. Throws corda::Error (kIo) if it
/// cannot be opened for reading.
[[nodiscard]] bool is_truncated(const std::string& path, const std::string& kind);

}  // namespace corda::media
