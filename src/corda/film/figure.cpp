#include "corda/film/film.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/draw.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/vector.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/font.hpp"
#include "corda/view/overlay.hpp"

namespace corda {
namespace {

constexpr int kMinCellPx = 40;
constexpr double kGapPerSide = 1.0 / 90.0;  // of the sheet's shorter side
constexpr double kBlankCell = 3.0;
constexpr double kTextPerSide = 1.0 / 20.0;  // of the shorter side of a cell and its caption
constexpr int kMinTextPx = 8;
constexpr int kMaxTextPx = 60;
constexpr double kLinePerText = 1.6;
constexpr double kCapitalPerText = 0.73;  // of DejaVu Sans

/// Layout of the cells of a contact sheet, each with a line of text below it.
class Sheet {
  public:
    Sheet(int width_px, int height_px, int columns, int count, std::optional<double> text_px)
        : text_px_(text_px),
          width_px_(width_px),
          height_px_(height_px),
          columns_(std::min(columns, kMaxSidePx)),  // more do not fit
          rows_((count - 1) / columns_ + 1),
          gap_px_(std::max(1, static_cast<int>(kGapPerSide * std::min(width_px, height_px)))) {}

    [[nodiscard]] int cell_width_px() const { return (width_px_ - (columns_ + 1) * gap_px_) / columns_; }
    [[nodiscard]] int cell_height_px() const { return row_height_px() - caption_px(); }
    [[nodiscard]] int text_px() const {
        if (text_px_) return static_cast<int>(std::lround(*text_px_));
        return std::clamp(static_cast<int>(kTextPerSide * std::min(cell_width_px(), row_height_px())),
                          kMinTextPx, kMaxTextPx);
    }
    [[nodiscard]] int caption_px() const { return static_cast<int>(kLinePerText * text_px()); }
    [[nodiscard]] bool has_room() const { return std::min(cell_width_px(), cell_height_px()) >= kMinCellPx; }
    /// The upper left corner of cell `i` of this size. The gaps share the remainder of the division.
    [[nodiscard]] int x_px(int i, int cell_px) const {
        return edge(i % columns_, columns_, cell_px, width_px_);
    }
    [[nodiscard]] int y_px(int i, int cell_px) const {
        return edge(i / columns_, rows_, cell_px + caption_px(), height_px_);
    }
    /// True if cells of this size fit.
    [[nodiscard]] bool holds(int cell_width_px, int cell_height_px) const {
        return std::int64_t{cell_width_px} * columns_ <= width_px_ &&
               std::int64_t{cell_height_px + caption_px()} * rows_ <= height_px_;
    }

    /// Penalty for cells that are not square and for blank cells.
    [[nodiscard]] double badness(int count) const {
        if (!has_room()) return 1e9;
        const double ratio = static_cast<double>(cell_width_px()) / cell_height_px();
        return std::abs(std::log(ratio)) + kBlankCell * (columns_ * rows_ - count) / count;
    }

  private:
    [[nodiscard]] int row_height_px() const { return (height_px_ - (rows_ + 1) * gap_px_) / rows_; }
    static int edge(int k, int cells, int cell_px, int side_px) {
        return k * cell_px + (k + 1) * (side_px - cells * cell_px) / (cells + 1);
    }

    std::optional<double> text_px_;
    int width_px_;
    int height_px_;
    int columns_;
    int rows_;
    int gap_px_;
};

int best_columns(int width_px, int height_px, int count, std::optional<double> text_px) {
    int best = 1;
    for (int columns = 2; columns <= std::min(count, width_px); ++columns) {
        if (Sheet(width_px, height_px, columns, count, text_px).badness(count) <
            Sheet(width_px, height_px, best, count, text_px).badness(count))
            best = columns;
    }
    return best;
}

/// The most cells that have room, in this many columns or, with 0, in any number of them.
int most_cells(int width_px, int height_px, int columns, std::optional<double> text_px) {
    int most = 0;
    columns = std::min(columns, kMaxSidePx);
    const int last = columns == 0 ? width_px / kMinCellPx : columns;
    for (int c = std::max(columns, 1); c <= last; ++c)
        for (int rows = 1; Sheet(width_px, height_px, c, c * rows, text_px).has_room(); ++rows)
            most = std::max(most, c * rows);
    return most;
}

Sheet sheet_of(const FigureDef& def) {
    return {def.width_px, def.height_px, def.columns, static_cast<int>(def.times_s.size()), def.text_px};
}

void check(const Film& film, const FigureDef& def) {
    if (def.times_s.empty()) throw Error(ExitCode::kUsage, "a figure of no times; give one or more");
    if (!std::ranges::is_sorted(def.times_s))
        throw Error(ExitCode::kUsage, "the times of a figure do not increase; sort them");
    if (def.shutter != 0.0 && (def.columns > 0 || def.times_s.size() > 1))
        throw Error(ExitCode::kUsage, "a figure of several times with a shutter; blur stills, one by one");
    if (def.columns == 0) return;
    const VideoDef& video = film.scene().video;
    if (is_picture_size(def.width_px, def.height_px) && def.columns > 0 &&
        sheet_of(def).holds(video.width_px, video.height_px))
        return;
    throw_usage("{} cells of {}x{} pixels in {} do not fit into a contact sheet of {}x{}", def.times_s.size(),
                video.width_px, video.height_px, counted(def.columns, "column"), def.width_px, def.height_px);
}

/// The colour between cells: the ground, slightly mixed with the colour of supports.
Color gap_color(const view::ThemeColors& colors) {
    if (!colors.ground.is_opaque()) return {0, 0, 0, 0};
    const auto mixed = [](int ground, int line) {
        return static_cast<std::uint8_t>((5 * ground + line + 3) / 6);
    };
    const Color& ground = colors.ground.bottom;
    return {mixed(ground.r, colors.support.r), mixed(ground.g, colors.support.g),
            mixed(ground.b, colors.support.b)};
}

/// A contact sheet without the pictures in its cells.
view::DrawList list_captions(const Film& film, const FigureDef& def) {
    const view::ThemeColors colors = view::theme_colors(film.scene().style);
    const Color gap = gap_color(colors);
    const Sheet sheet = sheet_of(def);
    const VideoDef& video = film.scene().video;
    view::DrawList list;
    list.width = def.width_px;
    list.height = def.height_px;
    list.ground = {gap, gap};
    view::Font font;
    std::vector<std::string> captions = view::digits_of(def.times_s);
    for (std::string& caption : captions) caption = view::time_label(caption, film.scene().overlay.language);
    int size_px = sheet.text_px();
    const auto widest_px = [&] {
        int widest = 0;
        for (const std::string& caption : captions)
            widest = std::max(widest, font.width_px(caption, size_px));
        return widest;
    };
    while (size_px > kMinTextPx && widest_px() > video.width_px) --size_px;
    for (int i = 0; i < static_cast<int>(captions.size()); ++i) {
        const int middle_px = sheet.x_px(i, video.width_px) + video.width_px / 2;
        const int bottom_px = sheet.y_px(i, video.height_px) + video.height_px;
        font.write(
            {.x_px = middle_px - font.width_px(captions[i], size_px) / 2,
             .y_px = bottom_px + static_cast<int>(0.5 * (sheet.caption_px() + kCapitalPerText * size_px)),
             .size_px = size_px,
             .color = text_color(colors),
             .utf8 = captions[i]},
            list);
    }
    return list;
}

/// Calls `visit(time, x, y)` for each cell of a contact sheet.
void for_each_cell(const Film& film, const FigureDef& def,
                   const std::function<void(double, int, int)>& visit) {
    const Sheet sheet = sheet_of(def);
    const VideoDef& video = film.scene().video;
    for (int i = 0; i < static_cast<int>(def.times_s.size()); ++i)
        visit(def.times_s[i], sheet.x_px(i, video.width_px), sheet.y_px(i, video.height_px));
}

std::vector<double> checked_s(const Film& film, const FigureDef& def) {
    std::vector<double> times_s;
    for (const double time_s : def.times_s) times_s.push_back(film.checked_s(time_s));
    return times_s;
}

Image draw_sheet(const Film& film, const FigureDef& def, std::vector<double>& empty_s) {
    Image image = render::render_reference(list_captions(film, def));
    const render::CanvasUse canvas(film.context_def());
    for_each_cell(film, def, [&](double time_s, int x, int y) {
        if (film::paint(film.look(), film.motion(), film.checked_s(time_s), 0.0, *canvas).is_empty)
            empty_s.push_back(time_s);
        const Image& cell = canvas->image();
        for (int row = 0; row < cell.height(); ++row)
            std::copy_n(cell.pixel(0, row), cell.row_bytes(), image.pixel(x, y + row));
    });
    return image;
}

/// Draws a figure as pixels; adds the times of empty pictures.
Image draw(const Film& film, const FigureDef& def, std::vector<double>& empty_s) {
    check(film, def);
    if (def.columns > 0) return draw_sheet(film, def, empty_s);
    const std::vector<double> times_s = checked_s(film, def);
    const render::CanvasUse canvas(film.context_def());
    film::Painted painted;
    if (def.shutter != 0.0)
        painted = film::paint(film.look(), film.motion(), times_s.front(), def.shutter, *canvas);
    else
        painted = film::paint_poses(film.look(), film.motion(), times_s, *canvas);
    if (painted.is_empty) empty_s.push_back(times_s.front());
    return canvas->image();
}

std::string ending_of(const std::string& path) {
    return std::filesystem::path(path).extension().string();
}

void draw_lines(const Film& film, const FigureDef& def, render::VectorPage& page,
                std::vector<double>& empty_s) {
    view::DrawList list;
    const auto add = [&](std::span<const double> times_s, int x, int y) {
        film::draw_poses(film.look(), film.motion(), times_s, list);
        if (list.shows_nothing()) empty_s.push_back(times_s.front());
        page.draw(list, x, y);
    };
    if (def.columns > 0) {
        page.draw(list_captions(film, def), 0, 0);
        for_each_cell(film, def, [&](double time_s, int x, int y) {
            time_s = film.checked_s(time_s);
            add({&time_s, 1}, x, y);
        });
    } else {
        add(checked_s(film, def), 0, 0);
    }
}

/// The bytes of an SVG or a PDF.
std::string vector_bytes(const std::string& ending, const Film& film, const FigureDef& def,
                         const PngInfo& info, std::vector<double>& empty_s) {
    check(film, def);
    if (def.shutter != 0.0) throw_usage("a shutter and {}: lines cannot be blurred; draw a .png", ending);
    const VideoDef& video = film.scene().video;
    render::PageDef page_def{.width_px = def.columns > 0 ? def.width_px : video.width_px,
                             .height_px = def.columns > 0 ? def.height_px : video.height_px};
    page_def.width_mm = page_def.width_px * kMmPerInch / info.pixels_per_inch;
    for (const auto& [keyword, text] : info.text) {
        if (keyword == "Title") page_def.title = utf8(text);
    }
    const auto page = ending == ".svg" ? render::make_svg(page_def) : render::make_pdf(page_def);
    draw_lines(film, def, *page, empty_s);
    return page->finish();
}

}  // namespace

FigureDef contact_sheet(Scene& scene, std::vector<double> times_s, int columns,
                        std::optional<double> text_px) {
    const VideoDef& video = scene.video;
    const int count = static_cast<int>(std::max<std::size_t>(times_s.size(), 1));
    const int asked = columns;
    if (columns == 0) columns = best_columns(video.width_px, video.height_px, count, text_px);
    FigureDef def{std::move(times_s), columns, video.width_px, video.height_px, 0.0, text_px};
    const Sheet sheet(video.width_px, video.height_px, std::max(columns, 1), count, text_px);
    if (columns < 1 || !sheet.has_room()) {
        const int most = columns < 1 ? 0 : most_cells(video.width_px, video.height_px, asked, text_px);
        throw_usage(
            "{} cells{} have no room in a contact sheet of {}x{} pixels (each takes {} at least), {} have; "
            "ask for fewer times or a larger size",
            count, asked == 0 ? "" : " in " + counted(columns, "column"), video.width_px, video.height_px,
            kMinCellPx, most);
    }
    scene.overlay.time = false;  // it is written below the cell
    scene = scaled_to(std::move(scene), sheet.cell_width_px(), sheet.cell_height_px());
    if (text_px) scene.overlay.text_px = text_px;
    return def;
}

Image draw_figure(const Film& film, const FigureDef& def) {
    std::vector<double> ignored;
    return draw(film, def, ignored);
}

bool is_figure_path(const std::string& path) {
    const std::string ending = ending_of(path);
    return ending == ".png" || ending == ".svg" || ending == ".pdf";
}

std::vector<double> write_figure(const std::string& path, const Film& film, const FigureDef& def,
                                 const PngInfo& info, const OutputOptions& options) {
    if (!is_figure_path(path))
        throw_usage("'{}': figures are written as .png, .svg or .pdf; give such a name", path);
    std::vector<double> empty_s;
    const std::string ending = ending_of(path);
    if (ending == ".png")
        write_png(path, draw(film, def, empty_s), info, options);
    else
        save_file(path, vector_bytes(ending, film, def, info, empty_s), options);
    return empty_s;
}

}  // namespace corda
