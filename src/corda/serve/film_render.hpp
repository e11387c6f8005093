#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include "corda/film/film.hpp"

namespace corda::serve {

/// Renders a film to a file on a thread of its own.
class FilmRender : NonCopyable {
  public:
    /// `on_change` is called on that thread whenever json() changes.
    explicit FilmRender(std::function<void()> on_change) : on_change_(std::move(on_change)) {}
    /// Ends a render; there is no file then.
    ~FilmRender() { stop(); }

    /// Begins to render. Throws corda::Error: kUsage if a render is running, and as check_render().
    void start(const Film& film, const std::string& path, bool force);
    /// Ends a render that is running, and waits for its end.
    void stop();

    /// {"path", "is_running", "progress": 0 .. 1, "text": what became of it}; null before the first.
    [[nodiscard]] nlohmann::json json() const;

  private:
    void render(const Film& film, const CheckedOutput& output);
    template <class Change>
    void update(const Change& change);

    std::function<void()> on_change_;
    mutable std::mutex mutex_;  ///< of `json_`
    nlohmann::json json_;
    std::atomic<bool> is_stopping_ = false;
    std::jthread thread_;
};

}  // namespace corda::serve
