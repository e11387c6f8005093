#pragma once

#include <functional>

#include <nlohmann/json.hpp>

namespace corda::bench {

/// What `work` returns, from a child process, which has a peak of memory of its own. `on_wait` is called at
/// least ten times a second; what it throws ends the child. Throws corda::Error: what `work` throws;
/// kTemporary if the child cannot be started or is ended from outside.
[[nodiscard]] nlohmann::json in_child(const std::function<void()>& on_wait,
                                      const std::function<nlohmann::json()>& work);

}  // namespace corda::bench
