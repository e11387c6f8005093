#include "console.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"

namespace corda::app {
namespace {

constexpr double kSecondsBetweenBars = 0.1;
constexpr double kSecondsBetweenLines = 2.0;
constexpr double kSecondsBeforeLines = 1.0;
constexpr int kBarCells = 30;

/// If the reader leaves, as head(1) does, the command completes its work, and its exit code counts.
void write_stdout(std::string_view text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() &&
                         std::fputc('\n', stdout) != EOF && std::fflush(stdout) == 0;
    if (!written && errno != EPIPE)
        throw_error(ExitCode::kIo, "writing to standard output: {}", std::strerror(errno));
}

/// A closed or full stderr must not end the work.
void write_stderr(const std::string& text) {
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
    std::fflush(stderr);
}

bool is_set(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

/// Makes every text in a value UTF-8, which is all that JSON can hold: names of files can have any bytes.
void make_utf8(nlohmann::json& json) {
    if (json.is_string()) json = utf8(json.get_ref<const std::string&>());
    if (!json.is_structured()) return;
    for (nlohmann::json& value : json) make_utf8(value);
}

std::string duration_text(double seconds) {
    const auto whole = std::llround(seconds);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Console::Console(const ConsoleDef& def)
    : def_(def),
      prints_results_(isatty(STDOUT_FILENO) == 1),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      uses_color_(is_terminal_ && !is_set("NO_COLOR")) {}

void Console::say(std::string_view label, std::string_view color, std::string_view message) const {
    const std::string text = printable_lines(message);
    if (uses_color_ && !label.empty()) {
        write_stderr(fmt::format("corda: \x1b[{}m{}\x1b[0m{}\n", color, label, text));
    } else {
        write_stderr(fmt::format("corda: {}{}\n", label, text));
    }
}

void Console::info(std::string_view text) const {
    if (!def_.quiet) say("", "", text);
}

void Console::detail(std::string_view text) const {
    if (def_.verbose && !def_.quiet) say("", "", text);
}

void Console::warning(std::string_view text) const {
    if (!def_.quiet) say("warning: ", "33", text);
}

void Console::error(std::string_view text) const {
    say("error: ", "31", text);
}

void Console::result(std::string_view text) const {
    if (!def_.json) write_stdout(prints_results_ ? printable_lines(text) : std::string(text));
}

void Console::report(nlohmann::json json) const {
    make_utf8(json);
    // A terminal gets ASCII, which has no control characters if it is JSON.
    if (def_.json) write_stdout(json.dump(2, ' ', prints_results_));
}

Progress::Progress(const Console& console, std::string_view what, std::int64_t total)
    : console_(&console),
      what_(what),
      total_(std::max<std::int64_t>(1, total)),
      start_s_(now_s()),
      next_line_s_(start_s_ + kSecondsBeforeLines) {}

Progress::~Progress() {
    if (bar_is_drawn_) write_stderr("\r\x1b[K");
}

std::string Progress::time_left(std::int64_t done) const {
    const std::int64_t since_start = done - first_done_.value_or(0);
    if (since_start <= 0 && done < total_) return "starting";
    return duration_text((now_s() - start_s_) * static_cast<double>(total_ - done) /
                         static_cast<double>(std::max<std::int64_t>(1, since_start))) +
           " left";
}

void Progress::update(std::int64_t done) {
    if (console_->quiet()) return;
    if (!first_done_ && done > 0) {
        first_done_ = done;
        start_s_ = now_s();
    }
    const double now = now_s();
    if (console_->draws_bar()) {
        const bool is_new_end = done == total_ && !is_at_end_;
        if (now - last_drawn_s_ < kSecondsBetweenBars && !is_new_end) return;
        is_at_end_ = done == total_;
        last_drawn_s_ = now;
        draw_bar(done);
        return;
    }
    const std::int64_t percent = 100 * done / total_;
    if (percent < next_line_percent_ || now < next_line_s_) return;
    next_line_s_ = now + kSecondsBetweenLines;
    next_line_percent_ = percent / 10 * 10 + 10;
    console_->info(
        fmt::format("{} {} % ({} of {}), {}", what_, percent / 10 * 10, done, total_, time_left(done)));
}

void Progress::draw_bar(std::int64_t done) {
    const auto cells = static_cast<int>(kBarCells * done / total_);
    write_stderr(fmt::format("\r\x1b[K{} [{:#<{}}{:.<{}}] {:3} % {}/{}, {}", what_, "", cells, "",
                             kBarCells - cells, 100 * done / total_, done, total_, time_left(done)));
    bar_is_drawn_ = true;
}

}  // namespace corda::app
