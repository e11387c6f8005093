#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/film/series.hpp"

namespace corda::python {

/// Numbers of a film, in C order and little endian.
struct Array {
    std::string name;
    bool is_bytes = false;            ///< numbers are uint8, otherwise float64
    std::vector<std::int64_t> shape;  ///< the first is the number of frames
    std::string data;
};

/// An array that a sample can have: README.md gives shapes and units.
struct Label {
    std::string_view name;
    bool is_bytes;
    std::vector<std::int64_t> (*shape)(const Film& film);  ///< of one frame
    /// Appends the numbers of a frame.
    void (*append)(const Film& film, const film::Instant& frame, std::string& data);
};

/// Null for none.
[[nodiscard]] const Label* find_label(std::string_view name);

/// The arrays of the first `frames` frames. Velocities, tensions and energy need a film whose states have
/// velocities and tensions. Throws corda::Error as Film::state() and Film::mask(), kInterrupted if cancelled.
[[nodiscard]] std::vector<Array> read_labels(const Film& film, std::span<const Label* const> labels,
                                             std::int64_t frames);

}  // namespace corda::python
