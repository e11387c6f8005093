#include "corda/media/libav_handles.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdarg>
#include <mutex>

#include "corda/core/exit_code.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"

namespace corda::media {
namespace {

constexpr std::size_t kMaxLog = 400;  // characters; a broken stream can complain once per macroblock

std::atomic<int> quiet_logs{0};
thread_local LogCapture* innermost_capture = nullptr;

void on_log(void* object, int level, const char* format, va_list arguments) {
    if (quiet_logs == 0) return av_log_default_callback(object, level, format, arguments);
    if (innermost_capture == nullptr || level > AV_LOG_ERROR) return;
    std::array<char, 256> line{};
    int print_prefix = 0;  // the prefix holds an address, which differs on every run
    av_log_format_line(nullptr, level, format, arguments, line.data(), static_cast<int>(line.size()),
                       &print_prefix);
    std::string_view text(line.data());
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    innermost_capture->add(text);
}

}  // namespace

Options& Options::set(const char* name, const std::string& value) {
    check_libav(av_dict_set(&dictionary_, name, value.c_str(), 0), ExitCode::kInternal,
                "cannot store an option");
    return *this;
}

std::string Options::left_over() const {
    const AVDictionaryEntry* entry = av_dict_get(dictionary_, "", nullptr, AV_DICT_IGNORE_SUFFIX);
    return entry == nullptr ? std::string() : std::string(entry->key);
}

std::string libav_text(int status) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(status, text.data(), text.size());
    return text.data();
}

void fail_libav(ExitCode code, const std::string& what, int status, std::string_view hint) {
    const std::string_view system_hint = hint_for_errno(AVUNERROR(status));
    const ExitCode exit_code = exit_code_of_errno(AVUNERROR(status), code);
    // What an encoder says in numbers of the system is not about files.
    const bool is_system = !system_hint.empty() && exit_code != ExitCode::kEncoder;
    const std::string_view shown_hint = is_system ? system_hint : hint;
    const std::string log = captured_log();
    std::string message = fmt::format("{}: {}", what, libav_text(status));
    if (!log.empty()) message += fmt::format(" ({})", log);
    if (!shown_hint.empty()) message += fmt::format("; {}", shown_hint);
    throw Error(exit_code, message);
}

int check_libav(int status, ExitCode code, const std::string& what, std::string_view hint) {
    if (status < 0) fail_libav(code, what, status, hint);
    return status;
}

QuietLog::QuietLog() {
    static std::once_flag once;
    std::call_once(once, [] { av_log_set_callback(&on_log); });
    ++quiet_logs;
}

QuietLog::~QuietLog() {
    --quiet_logs;
}

LogCapture::LogCapture() : outer_(innermost_capture) {
    innermost_capture = this;
}

LogCapture::~LogCapture() {
    innermost_capture = outer_;
}

void LogCapture::add(std::string_view line) {
    if (line.empty() || text_.size() + line.size() > kMaxLog) return;
    if (text_.find(line) != std::string::npos) return;
    if (!text_.empty()) text_ += "; ";
    text_ += line;
}

std::string captured_log() {
    return innermost_capture == nullptr ? std::string() : innermost_capture->text();
}

}  // namespace corda::media
