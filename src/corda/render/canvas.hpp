#pragma once

#include <memory>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

/// An OpenGL context with a renderer: turns draw lists of any size into pictures.
class Canvas : NonCopyable {
  public:
    /// Throws corda::Error (kNoGl).
    explicit Canvas(const gl::ContextDef& def) : def_(def), context_(def) {}

    /// Draws a picture; returns what may differ from the last one. Throws as FrameRenderer.
    Damage paint(const view::DrawList& list);
    /// Starts a picture that is the mean of several; discards an unfinished one.
    void begin_exposure();
    /// Adds the layers of a list to the mean. Throws as paint().
    void expose(const view::DrawList& list);
    /// Finishes the picture with the stamps of `list`; returns what may differ from the last one.
    Damage develop(const view::DrawList& list);

    /// The last picture.
    [[nodiscard]] const Image& image() const { return renderer_->image(); }
    [[nodiscard]] const gl::Context& context() const { return context_; }
    [[nodiscard]] const gl::ContextDef& def() const { return def_; }
    /// A draw list whose memory is used again.
    [[nodiscard]] view::DrawList& list() { return list_; }
    /// True if it has taken much memory, for a picture above 4k or for very many capsules.
    [[nodiscard]] bool is_large() const;

  private:
    /// Makes the renderer if there is none of that size, and checks the driver.
    void prepare(const view::DrawList& list);

    gl::ContextDef def_;
    gl::Context context_;  ///< dies last
    std::unique_ptr<FrameRenderer> renderer_;
    bool has_checked_tints_ = false;
    view::DrawList list_;
};

/// Lends a canvas of this thread, whose context is current meanwhile; afterwards the previous one is, which
/// may be the host application's. A thread keeps its canvas for the next use, unless it is large. Uses may
/// nest, each with a canvas of its own, and a process that was forked makes new ones.
class CanvasUse : NonCopyable {
  public:
    /// Throws corda::Error (kNoGl).
    explicit CanvasUse(const gl::ContextDef& def);
    ~CanvasUse();

    [[nodiscard]] Canvas& operator*() const { return *canvas_; }
    [[nodiscard]] Canvas* operator->() const { return canvas_.get(); }

    /// Deletes a canvas, with its context current, or leaks it if that is impossible: OpenGL objects can only
    /// be deleted in their own context, which may be lost or that of a parent process.
    struct Delete {
        void operator()(Canvas* canvas) const;
    };

  private:
    gl::SavedContext saved_;
    std::unique_ptr<Canvas, Delete> canvas_;
};

}  // namespace corda::render
