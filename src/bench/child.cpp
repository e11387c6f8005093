#include "corda/bench/child.hpp"

#include <cstdint>

#include "corda/core/basics.hpp"
#include "corda/core/child_process.hpp"

namespace corda::bench {

using nlohmann::json;

json in_child(const std::function<void()>& on_wait, const std::function<json()>& work) {
    const auto told = [&work] {
        try {
            return work().dump();
        } catch (const Error& error) {
            return json{{"code", static_cast<int>(error.code())}, {"error", error.what()}}.dump();
        }
    };
    constexpr double kMaxS = 86'400.0;
    const ChildLimits limits{std::uint64_t{1} << 46U, static_cast<std::int64_t>(kMaxS), kMaxS};
    const auto end = run_in_child(told, limits, on_wait);
    if (!end) throw Error(ExitCode::kTemporary, "the system starts no further process; try again");
    if (!end->finished) throw Error(ExitCode::kTemporary, "the process that measures " + end->text);
    json result = json::parse(end->text);
    if (result.contains("error"))
        throw Error(static_cast<ExitCode>(result["code"].get<int>()), result["error"].get<std::string>());
    return result;
}

}  // namespace corda::bench
