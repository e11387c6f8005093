#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "corda/core/basics.hpp"

namespace corda::app {

/// How much is said, and whether results are JSON.
struct ConsoleDef {
    bool quiet = false;    ///< only errors on stderr
    bool verbose = false;  ///< also details
    bool json = false;     ///< results on stdout as JSON in place of words
};

/// Results go to stdout, everything else to stderr. What a terminal shows is printable, whatever names and
/// keys it comes from; a result that goes elsewhere keeps its bytes.
class Console {
  public:
    explicit Console(const ConsoleDef& def);

    [[nodiscard]] bool json() const { return def_.json; }
    [[nodiscard]] bool quiet() const { return def_.quiet; }
    /// Whether stderr is a terminal that a progress bar can be drawn on.
    [[nodiscard]] bool draws_bar() const { return is_terminal_ && !def_.quiet; }

    void info(std::string_view text) const;
    void detail(std::string_view text) const;
    void warning(std::string_view text) const;
    void error(std::string_view text) const;

    /// A line of result on stdout, if results are words. Throws corda::Error (kIo) if stdout takes no more,
    /// unless its reader has left.
    void result(std::string_view text) const;
    /// The result on stdout, if results are JSON. A text that is not UTF-8 is escaped (see core/text.hpp).
    void report(nlohmann::json json) const;

  private:
    void say(std::string_view label, std::string_view color, std::string_view message) const;

    ConsoleDef def_;
    bool prints_results_;  ///< stdout is a terminal
    bool is_terminal_;
    bool uses_color_;
};

/// Progress of a count of equal pieces of work: a bar with the time left on a terminal, otherwise a line
/// after a second and then every 10 %, but not more often than every two seconds.
class Progress : NonCopyable {
  public:
    Progress(const Console& console, std::string_view what, std::int64_t total);
    /// Clears the bar.
    ~Progress();

    void update(std::int64_t done);

  private:
    [[nodiscard]] std::string time_left(std::int64_t done) const;
    void draw_bar(std::int64_t done);

    const Console* console_;
    std::string what_;
    std::int64_t total_;
    std::int64_t next_line_percent_ = 0;
    double start_s_;
    double next_line_s_;
    std::optional<std::int64_t> first_done_;  ///< at start_s_; an earlier run may have done much
    double last_drawn_s_ = 0.0;
    bool bar_is_drawn_ = false;
    bool is_at_end_ = false;
};

/// One row of the table that `corda --help` and the manual page print.
struct ExitCodeText {
    ExitCode code;
    std::string_view meaning;
};

inline constexpr std::array<ExitCodeText, 13> kExitCodes{{
    {ExitCode::kOk, "success"},
    {ExitCode::kInternal, "internal error: a bug in corda"},
    {ExitCode::kUsage, "usage: unknown command, flag or value"},
    {ExitCode::kInvalidScene, "invalid scene: its file, or what --set makes of it"},
    {ExitCode::kNoGl, "no usable OpenGL"},
    {ExitCode::kEncoder, "codec missing or encoder failed"},
    {ExitCode::kIo, "input/output error, disk full, or output exists (see --force)"},
    {ExitCode::kMismatch, "compare or golden found a difference or a problem"},
    {ExitCode::kDiverged, "the simulation diverged"},
    {ExitCode::kTemporary, "out of memory, or another temporary failure: try again"},
    {ExitCode::kHungUp, "hung up (SIGHUP): the terminal closed; finished work is kept"},
    {ExitCode::kInterrupted, "interrupted (SIGINT); finished work is kept"},
    {ExitCode::kTerminated, "terminated (SIGTERM); finished work is kept"},
}};

}  // namespace corda::app
