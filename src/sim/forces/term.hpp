#pragma once

#include "corda/sim/defs.hpp"

namespace corda::sim {

/// What one force does to every free particle of velocity v: it accelerates it by uniform_m_s2 - drag_1_s v.
/// Every solver integrates forces of this form exactly as it does gravity and drag.
struct ForceTerm {
    Vec2 uniform_m_s2;
    double drag_1_s = 0.0;  ///< >= 0
};

}  // namespace corda::sim
