#pragma once

#include <string>

#include "corda/core/image.hpp"
#include "corda/golden/compare.hpp"

#pragma GCC visibility push(default)
namespace corda {
class Film;
}  // namespace corda

namespace corda::testing {

/// Where a golden picture is kept, and what may differ from it.
struct GoldenOptions {
    std::string folder{};       ///< empty: the environment's CORDA_GOLDEN_DIR, or else the current folder
    DifferenceLimits limits{};  ///< none given: pictures must be equal
    /// The film of the picture. Then an update records its scene in the golden picture, and a failure names
    /// the keys that have changed since.
    const Film* film = nullptr;
    std::string rerun{};  ///< the command that runs this test again, for the message of a failure
};

/// How a picture compares with a golden one.
struct GoldenOutcome {
    bool matches = false;
    bool written = false;  ///< an update wrote it
    /// Why it does not match, how to repeat the test and to accept the picture, and where to see it; what an
    /// update wrote.
    std::string message;
};

/// Compares a picture with NAME.png, and with each NAME.CAUSE.png there is; `name` ends in .png and may begin
/// with folders. A picture of one colour never matches: nothing is in view. The environment says what to do
/// if no golden picture matches:
///   CORDA_UPDATE_GOLDENS     anything but empty or 0: write it, in place of NAME.png. A picture that `corda
///                            golden` keeps is not written: it says how it was made, which a picture does not.
///   CORDA_GOLDEN_ARTIFACTS   a folder for NAME.new.png and NAME.difference.png, not that of the golden pictures
/// Throws corda::Error: kUsage for another ending, and for artifacts among the golden pictures; kIo if a
/// picture cannot be read or written.
[[nodiscard]] GoldenOutcome check_golden(const Image& drawn, const std::string& name,
                                         const GoldenOptions& options = {});

}  // namespace corda::testing
#pragma GCC visibility pop
