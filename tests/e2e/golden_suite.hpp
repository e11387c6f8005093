#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"

namespace corda::test {

inline constexpr const char* kGoldenScene = R"(schema = 1
[world]
duration = 2
[[rope]]
hang = { links = 10, length = 1.0, angle_deg = 45.0 }
[golden]
at = [0.0, 0.5, 1.0]
)";

inline constexpr const char* kMiddle = "swing_t0000_500000.png";

/// A suite of one scene with kept pictures.
class GoldenSuite : public ::testing::Test {
  protected:
    GoldenSuite() {
        std::filesystem::create_directory(folder_.file("scenes"));
        write_file(folder_.file("scenes/swing.toml"), kGoldenScene);
        EXPECT_EQ(run({"--update"}).exit_code, 0);
    }

    [[nodiscard]] CommandResult run(std::vector<std::string> options = {}) const {
        std::vector<std::string> arguments{"golden", folder_.file("scenes"), "--dir", folder_.file("ref")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run_corda(arguments);
    }

    /// Rewrites a reference with other pixels or texts.
    template <typename Change>
    void change_reference(const std::string& name, Change change) const {
        Image image = read_png(reference(name));
        PngInfo info = read_png_info(reference(name));
        change(image, info);
        write_png(reference(name), image, info, {.force = true});
    }

    /// Changes the provenance, as JSON, and the pixels of a reference.
    template <typename Change>
    void change_provenance(const std::string& name, Change change) const {
        change_reference(name, [&](Image& image, PngInfo& info) {
            auto json = nlohmann::json::parse(info.text.back().second);
            change(image, json);
            info.text.back().second = json.dump();
        });
    }

    [[nodiscard]] std::string reference(const std::string& name) const { return folder_.file("ref/" + name); }

    ScratchFolder folder_;
};

}  // namespace corda::test
