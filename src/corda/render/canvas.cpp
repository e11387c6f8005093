#include "corda/render/canvas.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "corda/core/cancel.hpp"

namespace corda::render {
namespace {

using OwnedCanvas = std::unique_ptr<Canvas, CanvasUse::Delete>;

/// More canvases than a thread uses in turn would only take memory.
constexpr std::size_t kMaxIdle = 2;

thread_local std::vector<OwnedCanvas> idle;

/// Takes an idle canvas of this thread; null if there is none.
OwnedCanvas take_idle(const gl::ContextDef& def) {
    for (OwnedCanvas& canvas : idle)
        if (canvas->context().is_inherited()) static_cast<void>(canvas.release());  // the parent's
    std::erase(idle, nullptr);
    // The last one back is the outermost of nested uses, and so that of most pictures.
    const auto last = std::find_if(idle.rbegin(), idle.rend(),
                                   [&](const OwnedCanvas& canvas) { return canvas->def() == def; });
    if (last == idle.rend()) return nullptr;
    OwnedCanvas canvas = std::move(*last);
    std::erase(idle, nullptr);
    return canvas;
}

}  // namespace

void Canvas::prepare(const view::DrawList& list) {
    context_.make_current();  // the host may have made another one current
    if (!renderer_ || renderer_->image().width() != list.width ||
        renderer_->image().height() != list.height) {
        const auto lock = context_.exclusive();
        if (renderer_) {  // keeps the compiled programs
            renderer_ = std::make_unique<FrameRenderer>(*renderer_, list.width, list.height);
        } else {
            auto made = std::make_unique<FrameRenderer>(context_, list.width, list.height);
            check_driver(context_, *made, false);
            renderer_ = std::move(made);
        }
    }
    if (has_checked_tints_ || !list.has_tints()) return;
    check_driver(context_, *renderer_, true);
    has_checked_tints_ = true;
}

Damage Canvas::paint(const view::DrawList& list) {
    prepare(list);
    const CancelScope current([this] { context_.make_current(); });  // a callback may leave another one
    return renderer_->render(list);
}

void Canvas::begin_exposure() {
    if (renderer_) renderer_->begin_exposure();
}

void Canvas::expose(const view::DrawList& list) {
    prepare(list);
    const CancelScope current([this] { context_.make_current(); });
    check_cancelled();
    renderer_->expose(list);
}

Damage Canvas::develop(const view::DrawList& list) {
    prepare(list);
    return renderer_->develop(list);
}

bool Canvas::is_large() const {
    constexpr std::size_t kMaxImageBytes = std::size_t{4} * 3840 * 2160;
    constexpr std::size_t kMaxCapsules = 1'000'000;
    return list_.capsules.capacity() > kMaxCapsules ||
           (renderer_ && renderer_->image().size_bytes() > kMaxImageBytes);
}

void CanvasUse::Delete::operator()(Canvas* canvas) const {
    const gl::SavedContext saved;
    const auto lock = canvas->context().exclusive();
    try {
        canvas->context().make_current();  // throws in a forked child
    } catch (const Error&) {
        return;
    }
    delete canvas;
}

CanvasUse::CanvasUse(const gl::ContextDef& def) : canvas_(take_idle(def)) {
    if (!canvas_) canvas_.reset(new Canvas(def));
    canvas_->context().make_current();
}

CanvasUse::~CanvasUse() {
    if (canvas_->is_large()) return;  // deleted, for its memory
    if (idle.size() == kMaxIdle) idle.erase(idle.begin());
    idle.push_back(std::move(canvas_));
}

}  // namespace corda::render
