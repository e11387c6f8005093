#pragma once

#include <string>
#include <vector>

namespace corda::test {

/// Paths of the files in `folder` that end with `ending`, sorted.
[[nodiscard]] std::vector<std::string> list_files(const std::string& folder, const std::string& ending);

/// "swing" of "some/folder/swing.toml", with anything but letters and digits as "_": a name for a
/// parametrised test.
[[nodiscard]] std::string test_name(const std::string& path);

}  // namespace corda::test
