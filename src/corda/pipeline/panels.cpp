#include "corda/pipeline/panels.hpp"

#include "corda/core/text.hpp"
#include "corda/view/colors.hpp"

namespace corda {
namespace {

/// Size of cell `k` of `count`, which share a side. Edges are even, so that no sample of 4:2:0 is of two
/// cells.
int share_px(int k, int count, int side_px) {
    const auto edge_px = [&](std::int64_t cell) {
        return cell == count ? side_px : static_cast<int>(side_px * cell / 2 / count) * 2;
    };
    return edge_px(k + 1) - edge_px(k);
}

int rows_of(std::size_t scenes, int columns) {
    const auto row = static_cast<std::size_t>(columns);
    if (columns < 1 || scenes == 0 || scenes % row != 0 || scenes > kMaxPanels)
        throw_usage("{} scenes do not fill {} columns of at most {} panels; give as many scenes as panels",
                    scenes, columns, kMaxPanels);
    return static_cast<int>(scenes / row);
}

}  // namespace

void lay_out_panels(std::span<Scene> scenes, int columns, int width_px, int height_px) {
    const int rows = rows_of(scenes.size(), columns);
    const auto has_room = [](int count, int side_px) { return count == 1 || side_px >= 2 * count; };
    if (!has_room(columns, width_px) || !has_room(rows, height_px))
        throw_usage(
            "{}x{} panels (--panels) have no room in {}x{} pixels (--size); give a size of at least {}x{}, "
            "or fewer panels",
            columns, rows, width_px, height_px, 2 * columns, 2 * rows);
    for (int i = 0; i < columns * rows; ++i) {
        VideoDef& video = scenes[static_cast<std::size_t>(i)].video;
        video.width_px = share_px(i % columns, columns, width_px);
        video.height_px = share_px(i / columns, rows, height_px);
    }
}

VideoDef panels_video(std::span<const Scene> scenes, int columns) {
    const int rows = rows_of(scenes.size(), columns);
    const auto row = static_cast<std::size_t>(columns);
    VideoDef whole = scenes.front().video;
    whole.width_px = whole.height_px = 0;
    for (int i = 0; i < columns; ++i) whole.width_px += scenes[static_cast<std::size_t>(i)].video.width_px;
    for (int i = 0; i < rows; ++i)
        whole.height_px += scenes[static_cast<std::size_t>(i) * row].video.height_px;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const VideoDef& video = scenes[i].video;
        if (video.width_px != scenes[i % row].video.width_px ||
            video.height_px != scenes[i - i % row].video.height_px)
            throw_usage("panel {} of {}x{} pixels fits no grid with the others; lay all out in one size", i,
                        video.width_px, video.height_px);
        if (video.fps.rational() != whole.fps.rational())
            throw_usage(
                "'{}' has {} frames per second and '{}' has {}; panels have one clock: give all scenes the "
                "same video.fps (--fps)",
                scenes[i].name, video.fps.rational().text(), scenes.front().name,
                whole.fps.rational().text());
    }
    return whole;
}

namespace pipeline {

bool are_opaque(std::span<const Scene> scenes) {
    return std::ranges::all_of(
        scenes, [](const Scene& scene) { return view::look_of(scene.style).ground.is_opaque(); });
}

Panels::Panels(std::span<Film> given, int count) : films(given), columns(count) {
    for (const Film& film : films) scenes.push_back(film.scene());
    video = panels_video(scenes, columns);
}

bool Panels::can_draw_in_any_order(std::int64_t end) const {
    return std::ranges::all_of(films, [end](Film& film) {
        return FilmRenderer::can_draw_in_any_order(film, std::min(end, film.frame_count()));
    });
}

bool Panels::have_empty(std::int64_t k) const {
    return std::ranges::any_of(films,
                               [k](Film& film) { return FilmRenderer::is_empty(film, shown_s(film, k)); });
}

PanelRenderer::PanelRenderer(const Panels& panels) : panels_(&panels) {
    for (Film& film : panels.films) renderers_.emplace_back(film);
    if (renderers_.size() > 1) image_ = Image(panels.video.width_px, panels.video.height_px);
}

Damage PanelRenderer::draw(std::int64_t k) {
    Damage all;
    int x = 0;
    int y = 0;
    for (std::size_t i = 0; i < renderers_.size(); ++i) {
        Damage damage = renderers_[i].draw(Panels::shown_s(panels_->films[i], k));
        if (renderers_.size() == 1) return damage;
        const Image& panel = renderers_[i].image();
        for (const PixelRect& given : damage) {
            const PixelRect part = given.intersected(panel.rect());
            for (int row = part.y0; row < part.y1; ++row)
                std::copy_n(panel.pixel(part.x0, row), 4 * part.width(), image_.pixel(x + part.x0, y + row));
            all.push_back({x + part.x0, y + part.y0, x + part.x1, y + part.y1});
        }
        x = (x + panel.width()) % image_.width();
        if (x == 0) y += panel.height();
    }
    return all;
}

const Image& PanelRenderer::image() const {
    return renderers_.size() == 1 ? renderers_.front().image() : image_;
}

bool PanelRenderer::shows_nothing() const {
    return std::ranges::any_of(renderers_, &FilmRenderer::shows_nothing);
}

}  // namespace pipeline
}  // namespace corda
