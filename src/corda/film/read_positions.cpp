// Positions in files: CSV, and .npz of NumPy.
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/film/npz.hpp"

namespace corda {
namespace {

constexpr std::size_t kMaxPositionBytes = std::size_t{1} << 30;  // of the positions
constexpr std::size_t kMaxLineBytes = std::size_t{1} << 27;      // of a million particles
constexpr std::size_t kShown = 40;                               // bytes of a bad value

[[noreturn]] void fail(Place place, std::string what, std::string remedy) {
    throw Error(ExitCode::kUsage, Problem{std::move(place), std::move(what), std::move(remedy)});
}

[[noreturn]] void fail_of_size(const std::string& path) {
    fail({path, 0, 0, {}}, fmt::format("the positions take more than {} MiB", kMaxPositionBytes >> 20U),
         "give fewer times");
}

/// The lines of a file, from the bytes that were read before on.
class Lines {
  public:
    Lines(const FileHandle& file, const std::string& path, std::string before)
        : file_(file), path_(path), block_(std::move(before)) {}

    /// False at the end. A line has no end and no carriage return.
    bool next(std::string& line) {
        line.clear();
        ++number_;
        while (true) {
            const std::size_t end = block_.find('\n', at_);
            line.append(block_, at_, end - at_);
            if (line.size() > kMaxLineBytes)
                fail({path_, number_, 1, {}}, "the line is too long", "give CSV, or .npz");
            if (end != std::string::npos) {
                at_ = end + 1;
                break;
            }
            at_ = 0;
            block_.resize(kBlock);
            block_.resize(read_bytes(file_, path_, block_.data(), kBlock));
            if (block_.empty() && line.empty()) return false;
            if (block_.empty()) break;
        }
        if (line.ends_with('\r')) line.pop_back();
        return true;
    }
    [[nodiscard]] std::size_t number() const { return number_; }

  private:
    static constexpr std::size_t kBlock = std::size_t{1} << 16;

    const FileHandle& file_;
    const std::string& path_;
    std::string block_;
    std::size_t at_ = 0;
    std::size_t number_ = 0;
};

/// The first of these characters outside quotes; the end of the text if there is none.
std::size_t find_outside_quotes(std::string_view text, std::string_view characters) {
    bool is_quoted = false;
    std::size_t i = 0;
    for (; i < text.size() && (is_quoted || characters.find(text[i]) == std::string_view::npos); ++i)
        if (text[i] == '"') is_quoted = !is_quoted;
    return i;
}

/// A cell without the spaces and quotes around it.
std::string_view trimmed(std::string_view cell) {
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '"')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '"')) cell.remove_suffix(1);
    return cell;
}

/// The columns of a CSV file: what each holds, as an index of a row: t, x0, y0, x1, ...
struct Columns {
    char separator = ',';
    std::vector<std::optional<std::size_t>> place;  ///< per column; none: it is ignored
    std::size_t row_size = 0;
};

/// "x12" or "label_x12" is number 1 + 2 * 12 of a row; no other name than "t" has a number.
std::optional<std::size_t> place_of(std::string_view name, std::size_t columns) {
    if (name == "t") return 0;
    name.remove_prefix(name.rfind('_') + 1);  // npos + 1 is 0
    if (name.empty() || (name.front() != 'x' && name.front() != 'y')) return std::nullopt;
    const auto particle = whole_number<std::size_t>(name.substr(1));
    if (!particle || *particle > columns) return std::nullopt;  // others are missing, too
    return 1 + 2 * *particle + (name.front() == 'y' ? 1 : 0);
}

std::string name_of(std::size_t place) {
    return place == 0 ? "t" : fmt::format("{}{}", place % 2 == 1 ? 'x' : 'y', (place - 1) / 2);
}

Columns columns_of(std::string_view line, const std::string& path) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (line.starts_with(kMark)) line.remove_prefix(kMark.size());
    if (line.starts_with('#'))
        line.remove_prefix(std::min(line.find_first_not_of("# "), line.size()));  // of savetxt
    Columns columns;
    std::size_t first = find_outside_quotes(line, ",;\t");
    if (first == line.size()) first = find_outside_quotes(line, " ");
    if (first < line.size()) columns.separator = line[first];
    const std::size_t all = static_cast<std::size_t>(std::ranges::count(line, columns.separator)) + 1;
    std::vector<bool> is_there(2 * all + 3);
    while (true) {
        const std::size_t end = find_outside_quotes(line, {&columns.separator, 1});
        const auto place = place_of(trimmed(line.substr(0, end)), all);
        if (place && is_there[*place])
            fail({path, 1, 1, {}}, "two columns are " + name_of(*place), "remove or rename one");
        if (place) is_there[*place] = true;
        columns.place.push_back(place);
        if (place && *place > 0) columns.row_size = std::max(columns.row_size, (*place - 1) / 2 * 2 + 3);
        if (end == line.size()) break;
        line.remove_prefix(end + 1);
    }
    const std::size_t size = std::max<std::size_t>(columns.row_size, 3);
    for (std::size_t place = 0; place < size; ++place)
        if (!is_there[place])
            fail({path, 1, 1, {}}, "the first line names no column " + name_of(place),
                 "name t, x0, y0, x1, y1, ... for all particles, as corda simulate -o does");
    return columns;
}

/// The number in a cell; NaN if it is none.
double number_in(std::string_view cell, bool has_comma) {
    std::string text(trimmed(cell));
    if (has_comma) std::ranges::replace(text, ',', '.');
    if (text.starts_with('+')) text.erase(0, 1);
    double value = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    return status == std::errc{} && end == text.data() + text.size() ? value : std::nan("");
}

/// Decimal commas between commas make two cells of a number.
[[noreturn]] void fail_of_more_cells(Place place, std::size_t column, char separator) {
    place.column = column;
    fail(std::move(place), "more cells than columns",
         separator == ',' ? "give decimal points, or separate cells by semicolons"
                          : "name all columns in the first line, or leave out the row");
}

/// Reads a row into `row`. It may end with a separator.
void read_row(std::string_view line, const Columns& columns, const Place& place, std::vector<double>& row) {
    const std::size_t length = line.size();
    for (std::size_t c = 0; c < columns.place.size(); ++c) {
        const std::size_t end = find_outside_quotes(line, {&columns.separator, 1});
        const std::string_view cell = line.substr(0, end);
        if (columns.place[c]) {
            const double value = number_in(cell, columns.separator == ';');
            const auto at = [&] {
                Place here = place;
                here.column = length - line.size() + 1;
                here.key = name_of(*columns.place[c]);
                return here;
            };
            if (!std::isfinite(value))
                fail(at(),
                     trimmed(cell).empty() ? "there is no number"
                                           : printable(cell.substr(0, kShown)) + " is not a finite number",
                     "give a number, or leave out the row");
            row[*columns.place[c]] = value;
        }
        if (end == line.size() && c + 1 < columns.place.size())
            fail(place, fmt::format("{} of {} cells", c + 1, columns.place.size()),
                 "give all columns of the first line, or leave out the row");
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    if (!trimmed(line).empty()) fail_of_more_cells(place, length - line.size() + 1, columns.separator);
}

GivenMotion read_csv(const FileHandle& file, const std::string& path, std::string before) {
    Lines lines(file, path, std::move(before));
    std::string line;
    if (!lines.next(line)) fail({path, 0, 0, {}}, "the file is empty", "give CSV, or .npz");
    const Columns columns = columns_of(line, path);
    std::vector<double> times_s;
    std::vector<Vec2> positions_m;
    std::vector<double> row(columns.row_size);
    while (lines.next(line)) {
        if (line.empty()) continue;
        check_cancelled();
        const Place place{path, lines.number(), 1, {}};
        read_row(line, columns, place, row);
        if (!times_s.empty() && row[0] - times_s.back() < GivenMotion::kMinIntervalSeconds)
            fail(place, fmt::format("t = {} s comes after {} s", row[0], times_s.back()),
                 "give times that increase, by 1e-9 s or more");
        times_s.push_back(row[0]);
        for (std::size_t i = 1; i < row.size(); i += 2) positions_m.push_back({row[i], row[i + 1]});
        if (positions_m.size() * sizeof(Vec2) > kMaxPositionBytes) fail_of_size(path);
    }
    return {std::move(times_s), std::move(positions_m), path};
}

GivenMotion read_npz(const FileHandle& file, const std::string& path) {
    const Npz arrays(file, path, kMaxPositionBytes);
    const NpyArray times = arrays.read("times");
    const NpyArray positions = arrays.read("positions");
    if (times.shape.size() != 1)
        fail({path, 0, 0, "times"}, fmt::format("shape ({})", fmt::join(times.shape, ", ")),
             "give the shape (n,)");
    if (positions.shape.size() != 3 || positions.shape[0] != times.shape[0] || positions.shape[2] != 2)
        fail({path, 0, 0, "positions"}, fmt::format("shape ({})", fmt::join(positions.shape, ", ")),
             fmt::format("give the shape ({}, particles, 2) for {} times", times.shape[0], times.shape[0]));
    const std::size_t count = positions.shape[0] * positions.shape[1];
    if (count * sizeof(Vec2) > kMaxPositionBytes) fail_of_size(path);
    std::vector<double> times_s(times.shape[0]);
    std::vector<Vec2> positions_m(count);
    times.copy_to(times_s.data());
    positions.copy_to(positions_m.data());
    return {std::move(times_s), std::move(positions_m), path};
}

}  // namespace

GivenMotion read_positions(const std::string& path) {
    const bool is_stream = path == "-";
    const std::string name = scene::source_name(path);
    const FileHandle file = is_stream ? open_standard_input() : open_for_reading(path);
    if (!file) fail_file("read", name, errno);
    std::string start(6, '\0');
    start.resize(read_bytes(file, name, start.data(), start.size()));
    if (start.starts_with("PK") && is_stream)
        fail({name, 0, 0, {}}, "an .npz cannot be read from standard input", "give the path of a file");
    if (start.starts_with("PK")) return read_npz(file, name);
    if (start == "\x93NUMPY")
        fail({name, 0, 0, {}}, "this is one array",
             "save both by numpy.savez(FILE, times=times, positions=positions)");
    return read_csv(file, name, start);
}

}  // namespace corda
