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
    scene.source = source_name;
    scene.world = read_world(sections.world);
    scene.solver = read_solver(sections.solver);
    scene.video = read_video(sections.video);
    scene.style = read_style(sections.style);
    scene.camera = read_camera(sections.camera);

    const SceneSize size = count_bodies(sections, scene.solver);
    check_work(sections, scene, size.bars);
    for (std::size_t i = 0; i < sections.ropes.size(); ++i) {
        scene.ropes.push_back(read_rope(sections.ropes[i], size.rope_particles[i], scene.solver.reach));
        scene.body_styles.push_back(read_body_style(sections.ropes[i]));
    }
    for (const TableReader& net : sections.nets) {
        scene.nets.push_back(read_net(net));
        scene.body_styles.push_back(read_body_style(net));
    }
    check_stiffness(sections, scene);
    check_pace(sections, scene);
    return scene;
}

sim::System system_of(const Scene& scene) {
    return sim::build_system(scene.ropes, scene.nets, scene.solver.reach);
}

}  // namespace corda::scene
