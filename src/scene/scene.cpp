#include "corda/scene/scene.hpp"

#include <filesystem>

#include "corda/scene/document.hpp"
#include "corda/scene/limits.hpp"
#include "corda/scene/readers.hpp"
#include "corda/scene/settings.hpp"

namespace corda::scene {

Scene load_scene(const std::string& path, const std::vector<Setting>& settings) {
    return parse_scene(read_file(path), path, settings);
}

Scene parse_scene(std::string_view toml, const std::string& source_name,
                  const std::vector<Setting>& settings) {
    toml::table document = parse_document(toml, source_name);
    for (const Setting& setting : settings) apply_setting(document, setting);
    const Source source(source_name, document);
    const Sections sections = read_sections(source, document);

    Scene scene;
    scene.name = std::filesystem::path(source_name).stem().string();
    scene.world = read_world(sections.world);
    scene.solver = read_solver(sections.solver);
    scene.video = read_video(sections.video);
    scene.style = read_style(sections.style);
    scene.camera = read_camera(sections.camera);

    const std::vector<std::int64_t> particles = count_particles(sections, scene.solver);
    check_work(sections, scene, particles);
    for (std::size_t i = 0; i < particles.size(); ++i) {
        scene.ropes.push_back(read_rope(sections.ropes[i], particles[i], scene.solver.reach));
        scene.rope_styles.push_back(read_rope_style(sections.ropes[i]));
    }
    return scene;
}

}  // namespace corda::scene
