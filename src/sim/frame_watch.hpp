#pragma once

#include <cstdint>
#include <functional>

namespace corda::sim {

/// Called before every frame of a run that comes before the one asked for, such as a trial of a method: to
/// show how far it is. What it throws ends that run. May be empty.
using FrameWatch = std::function<void(std::int64_t frame, std::int64_t last_frame)>;

}  // namespace corda::sim
