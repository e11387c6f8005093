#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/vector.hpp"
#include "corda/view/font.hpp"

namespace corda::render {
namespace {

struct CairoDeleter {
    void operator()(cairo_t* context) const noexcept { cairo_destroy(context); }
    void operator()(cairo_surface_t* surface) const noexcept { cairo_surface_destroy(surface); }
    void operator()(cairo_font_face_t* face) const noexcept { cairo_font_face_destroy(face); }
    void operator()(cairo_pattern_t* pattern) const noexcept { cairo_pattern_destroy(pattern); }
};
using FontFace = std::unique_ptr<cairo_font_face_t, CairoDeleter>;
using Pattern = std::unique_ptr<cairo_pattern_t, CairoDeleter>;

constexpr double kPointsPerMm = 72.0 / kMmPerInch;

cairo_status_t append_bytes(void* file, const unsigned char* bytes, unsigned count) {
    try {
        static_cast<std::string*>(file)->append(reinterpret_cast<const char*>(bytes), count);
        return CAIRO_STATUS_SUCCESS;
    } catch (...) {
        return CAIRO_STATUS_NO_MEMORY;  // cairo is C: no exception may pass through it
    }
}

void check(cairo_status_t status) {
    if (status == CAIRO_STATUS_SUCCESS) return;
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    throw_error(ExitCode::kInternal, "cairo cannot draw the page: {}", cairo_status_to_string(status));
}

Pattern solid(const Color& color) {
    return Pattern(
        cairo_pattern_create_rgba(color.r / 255.0, color.g / 255.0, color.b / 255.0, color.a / 255.0));
}

Pattern pattern_of(const Ground& ground, int height) {
    if (ground.top == ground.bottom) return solid(ground.top);
    const auto [top, bottom] = straight_ends(ground);
    Pattern pattern(cairo_pattern_create_linear(0.0, 0.0, 0.0, height));
    const auto add_stop = [&](double offset, const Color& color) {
        cairo_pattern_add_color_stop_rgba(pattern.get(), offset, color.r / 255.0, color.g / 255.0,
                                          color.b / 255.0, color.a / 255.0);
    };
    add_stop(0.0, top);
    add_stop(1.0, bottom);
    return pattern;
}

/// The face owns the font file, because cairo may keep the face longer than the page lives.
FontFace make_font_face(const std::string& font) {
    static const cairo_user_data_key_t key{};
    auto file = std::make_unique<view::FontFile>(font);
    FontFace face(
        cairo_ft_font_face_create_for_ft_face(file->face(), FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP));
    check(cairo_font_face_set_user_data(face.get(), &key, file.get(),
                                        [](void* kept) { delete static_cast<view::FontFile*>(kept); }));
    static_cast<void>(file.release());
    return face;
}

/// An SVG of cairo whose identifiers, which are unique in this process, are numbers from 0 behind `prefix`.
std::string with_ids(std::string_view svg, const std::string& prefix) {
    constexpr std::string_view kId = " id=\"";
    std::map<std::string_view, std::size_t> numbers;
    std::string made;
    while (!svg.empty()) {
        const std::size_t id = svg.find(kId);
        const std::size_t reference = svg.find('#');
        const std::size_t begin = std::min(id == std::string_view::npos ? svg.size() : id + kId.size(),
                                           reference == std::string_view::npos ? svg.size() : reference + 1);
        made += svg.substr(0, begin);
        svg.remove_prefix(begin);
        const std::string_view name = svg.substr(0, svg.find_first_of("\")"));
        if (!name.empty())
            made += prefix + std::to_string(numbers.try_emplace(name, numbers.size()).first->second);
        svg.remove_prefix(name.size());
    }
    return made;
}

/// An SVG whose masks apply to the whole page. By default, a mask hides what lies outside of the box of the
/// lines without their width: all of a line that is vertical or level.
std::string with_whole_masks(std::string svg, double width, double height) {
    constexpr std::string_view kMask = "<mask ";
    const std::string region =
        fmt::format(R"(maskUnits="userSpaceOnUse" x="0" y="0" width="{}" height="{}" )", width, height);
    for (std::size_t at = svg.find(kMask); at != std::string::npos; at = svg.find(kMask, at + kMask.size()))
        svg.insert(at + kMask.size(), region);
    return svg;
}

/// An SVG of cairo with a title, and with identifiers that no other figure has: several may stand in one page
/// of HTML.
std::string finished_svg(const std::string& svg, const std::string& title) {
    const std::string plain = with_ids(svg, "n");
    std::string made = with_ids(plain, "c" + hash_text(title + plain).substr(0, 8) + "-");
    const std::size_t root = made.find('>', made.find("<svg"));
    made.insert(root + 1, "\n<title>" + markup_text(title) + "</title>");
    return made;
}

/// The capsules with a halo of a layer, in groups of which no two touch.
std::vector<std::vector<view::Capsule>> halos_apart(const view::DrawList& list, const view::Layer& layer) {
    const auto touch = [](const view::Capsule& a, const view::Capsule& b) {
        const auto apart = [&](float a0, float ua, float b0, float ub) {
            const float a1 = a0 + ua * a.length;
            const float b1 = b0 + ub * b.length;
            return std::max(std::min(a0, a1) - std::max(b0, b1), std::min(b0, b1) - std::max(a0, a1)) >
                   a.halo_radius + b.halo_radius;
        };
        return !apart(a.ax, a.ux, b.ax, b.ux) && !apart(a.ay, a.uy, b.ay, b.uy);
    };
    std::vector<std::vector<view::Capsule>> groups;
    for (std::size_t i = layer.first_capsule; i < layer.first_capsule + layer.capsule_count; ++i) {
        const view::Capsule& capsule = list.capsules[i];
        if (capsule.halo_radius <= 0.0F) continue;
        check_cancelled();
        const auto is_free = [&](const std::vector<view::Capsule>& group) {
            return std::ranges::none_of(group,
                                        [&](const view::Capsule& other) { return touch(capsule, other); });
        };
        const auto group = std::ranges::find_if(groups, is_free);
        (group == groups.end() ? groups.emplace_back() : *group).push_back(capsule);
    }
    return groups;
}

class CairoPage : public VectorPage {
  public:
    CairoPage(const PageDef& def, bool is_svg)
        : is_svg_(is_svg),
          title_(printable(def.title)),
          width_(is_svg ? def.width_mm : def.width_mm * kPointsPerMm),
          height_(width_ / def.width_px * def.height_px) {
        const double scale = width_ / def.width_px;
        if (is_svg) {
            surface_.reset(cairo_svg_surface_create_for_stream(append_bytes, &bytes_, width_, height_));
            cairo_svg_surface_set_document_unit(surface_.get(), CAIRO_SVG_UNIT_MM);
            cairo_svg_surface_restrict_to_version(surface_.get(), CAIRO_SVG_VERSION_1_1);
        } else {
            surface_.reset(cairo_pdf_surface_create_for_stream(append_bytes, &bytes_, width_, height_));
            cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_TITLE, title_.c_str());
            cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATOR, "corda");
            // The default is the current time, which would make every file different.
            cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                           "2000-01-01T00:00:00Z");
        }
        cairo_.reset(cairo_create(surface_.get()));
        cairo_scale(cairo_.get(), scale, scale);
        cairo_set_line_cap(cairo_.get(), CAIRO_LINE_CAP_ROUND);
        cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
        check(cairo_status(cairo_.get()));
    }

    void draw(const view::DrawList& given, int x_px, int y_px) override {
        const view::DrawList list = in_even_layers(given);
        cairo_t* const cairo = cairo_.get();
        cairo_save(cairo);
        cairo_translate(cairo, x_px, y_px);
        cairo_rectangle(cairo, 0.0, 0.0, list.width, list.height);
        cairo_clip(cairo);
        const Pattern ground = pattern_of(list.ground, list.height);
        cairo_set_source(cairo, ground.get());
        if (list.ground.top.a != 0 || list.ground.bottom.a != 0) cairo_paint(cairo);
        const bool is_opaque = list.ground.is_opaque();
        if (!is_opaque) cairo_push_group(cairo);
        for (std::size_t l = 0; l < list.layers.size(); ++l) {
            check_cancelled();
            const view::Layer& layer = list.layers[l];
            const LayerStrokes strokes = strokes_of(list, layer);
            if (is_opaque)
                stroke(strokes.halos, ground.get(), layer.color.a);
            else if (!strokes.halos.empty())
                cut_out(list, layer);
            stroke(strokes.lines, nullptr, layer.color.a);
        }
        if (!is_opaque) {
            cairo_pop_group_to_source(cairo);
            cairo_paint(cairo);
        }
        for (const view::Stamp& box : boxes_of(list)) fill_box(box);
        for (const view::Text& text : list.texts) write(text);
        cairo_restore(cairo);
        check(cairo_status(cairo));
    }

    [[nodiscard]] std::string finish() override {
        cairo_show_page(cairo_.get());
        check(cairo_status(cairo_.get()));
        cairo_surface_finish(surface_.get());
        check(cairo_surface_status(surface_.get()));
        if (!is_svg_) return std::move(bytes_);
        return finished_svg(with_whole_masks(std::move(bytes_), width_, height_), title_);
    }

  private:
    /// Paints the union of the strokes with a pattern; each in its own colour if `paint` is null.
    void stroke(const std::vector<Stroke>& strokes, cairo_pattern_t* paint, std::uint8_t alpha) {
        if (strokes.empty() || alpha == 0) return;
        cairo_t* const cairo = cairo_.get();
        if (alpha < 255) cairo_push_group(cairo);
        if (paint != nullptr) cairo_set_source(cairo, paint);
        for (const Stroke& stroke : strokes) {
            if (paint == nullptr) cairo_set_source(cairo, solid(stroke.color).get());
            cairo_set_line_cap(cairo, stroke.is_blunt ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
            cairo_set_line_width(cairo, stroke.width_px);
            for (const auto& line : stroke.lines) {
                cairo_move_to(cairo, line.front().x, line.front().y);
                for (std::size_t i = 1; i < line.size(); ++i) cairo_line_to(cairo, line[i].x, line[i].y);
            }
            cairo_stroke(cairo);
        }
        if (alpha == 255) return;
        cairo_pop_group_to_source(cairo);
        cairo_paint_with_alpha(cairo, alpha / 255.0);
    }

    void fill_box(const view::Stamp& stamp) {
        cairo_set_source(cairo_.get(), solid(stamp.color).get());
        cairo_rectangle(cairo_.get(), stamp.box.x0, stamp.box.y0, stamp.box.width(), stamp.box.height());
        cairo_fill(cairo_.get());
    }

    /// Places glyphs like Font::write(); in a PDF, as text that can be searched and copied.
    void write(const view::Text& text) {
        cairo_t* const cairo = cairo_.get();
        const std::string utf8 = printable(text.utf8);
        const auto bytes = static_cast<int>(utf8.size());
        view::Font& font = fonts_.try_emplace(text.font, text.font).first->second;
        FontFace& face = faces_[text.font];
        if (!face) face = make_font_face(text.font);
        cairo_set_font_face(cairo, face.get());
        cairo_set_font_size(cairo, text.size_px);
        cairo_set_source(cairo, solid(text.color).get());
        cairo_glyph_t* glyphs = nullptr;
        cairo_text_cluster_t* clusters = nullptr;
        int glyph_count = 0;
        int cluster_count = 0;
        cairo_text_cluster_flags_t flags{};
        check(cairo_scaled_font_text_to_glyphs(cairo_get_scaled_font(cairo), text.x_px, text.y_px,
                                               utf8.data(), bytes, &glyphs, &glyph_count, &clusters,
                                               &cluster_count, &flags));
        std::size_t done = 0;
        for (int i = 0; i < std::min(glyph_count, cluster_count); ++i) {
            glyphs[i].x = text.x_px + font.width_px(std::string_view(utf8).substr(0, done), text.size_px);
            done += static_cast<std::size_t>(clusters[i].num_bytes);
        }
        cairo_show_text_glyphs(cairo, utf8.data(), bytes, glyphs, glyph_count, clusters, cluster_count,
                               flags);
        cairo_glyph_free(glyphs);
        cairo_text_cluster_free(clusters);
    }

    /// Erases the layers below the halos of a layer. PDF and SVG have no operator that erases, so everything
    /// is drawn again outside of the halos. A transparent layer erases as much as an opaque one.
    void cut_out(const view::DrawList& list, const view::Layer& layer) {
        cairo_t* const cairo = cairo_.get();
        const Pattern below(cairo_pop_group(cairo));
        cairo_push_group(cairo);
        cairo_save(cairo);
        for (const std::vector<view::Capsule>& group : halos_apart(list, layer)) {
            cairo_rectangle(cairo, 0.0, 0.0, list.width, list.height);
            for (const view::Capsule& capsule : group) {
                const double bx = capsule.ax + static_cast<double>(capsule.ux) * capsule.length;
                const double by = capsule.ay + static_cast<double>(capsule.uy) * capsule.length;
                const double right = std::atan2(capsule.uy, capsule.ux) - 0.5 * std::numbers::pi;
                const double left = right + std::numbers::pi;
                // Against the direction of the rectangle, a hole by either rule: cairo does not tell the rule
                // of a clip in SVG so that viewers understand it.
                cairo_new_sub_path(cairo);
                cairo_arc_negative(cairo, capsule.ax, capsule.ay, capsule.halo_radius,
                                   left + std::numbers::pi, left);
                cairo_arc_negative(cairo, bx, by, capsule.halo_radius, left, right);
                cairo_close_path(cairo);
            }
            cairo_clip(cairo);
        }
        cairo_set_source(cairo, below.get());
        cairo_paint(cairo);
        cairo_restore(cairo);
    }

    bool is_svg_;
    std::string title_;
    double width_;  ///< in millimetres in SVG, in points in PDF
    double height_;
    std::map<std::string, view::Font> fonts_;  ///< by the paths of their files
    std::map<std::string, FontFace> faces_;
    // The surface writes to bytes_ until it is destroyed.
    std::string bytes_;
    std::unique_ptr<cairo_surface_t, CairoDeleter> surface_;
    std::unique_ptr<cairo_t, CairoDeleter> cairo_;
};

}  // namespace

std::unique_ptr<VectorPage> make_svg(const PageDef& def) {
    return std::make_unique<CairoPage>(def, true);
}

std::unique_ptr<VectorPage> make_pdf(const PageDef& def) {
    return std::make_unique<CairoPage>(def, false);
}

}  // namespace corda::render
