#pragma once

#include <functional>
#include <string>

namespace corda::study {

/// What a hard case came to.
struct Outcome {
    std::string measured;
    bool is_held = false;
};

/// A row of PHYSICS section 5.
struct HardCase {
    std::string name;
    std::string method;
    std::string criterion;
    bool takes_long = false;  ///< left out of a quick study, and marked there
    std::function<Outcome()> run;
};

}  // namespace corda::study
