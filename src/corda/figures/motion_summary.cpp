#include "corda/figures/motion_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <variant>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/timeline.hpp"
#include "corda/figures/summary.hpp"
#include "corda/reference/pendulum.hpp"
#include "corda/sim/recording.hpp"

namespace corda::figures {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<double> times_between_frames_s(const Scene& scene) {
    constexpr std::int64_t kMaxStates = 4000;
    constexpr std::int64_t kMaxPerFrame = 8;
    constexpr std::size_t kMaxParticles = 2'000'000;  // in all states: 80 MB
    const FrameRate fps = scene.video.scene_rate();
    const std::int64_t frames = fps.last_frame_within(scene.world.duration_s) + 1;
    const std::size_t particles = build_system(scene.ropes, scene.nets).particle_count();
    const auto states = std::min(kMaxStates, static_cast<std::int64_t>(kMaxParticles / particles));
    const std::int64_t per_frame = std::clamp(states / frames, std::int64_t{1}, kMaxPerFrame);
    std::vector<double> times_s;
    for (std::int64_t i = 0; i < (frames - 1) * per_frame; ++i) {
        const double share = static_cast<double>(i % per_frame) / static_cast<double>(per_frame);
        if (share > 0.0) times_s.push_back(fps.time_s(i / per_frame) + share * fps.interval_s());
    }
    return times_s;
}

class Reader {
  public:
    Reader(Film& film, const OpenRows& open) : film_(film), system_(film.system()), swing_(film) {
        for (const pipeline::TrackedParticle& followed : pipeline::tracked_particles(system_))
            motion_.bodies.push_back({followed});
        tells_tension_.resize(system_.bodies.size());
        const auto stretches = [](const Body& body) { return body.material.compliance_1_n > 0.0; };
        motion_.is_elastic = !system_.bends.empty() || std::ranges::any_of(system_.bodies, stretches);
        open_rows(open);
    }

    /// Takes the state that the film handed out last.
    void add(const State& state, bool is_frame) {
        add_tips(state, is_frame);
        if (!is_frame) return;
        swing_.add(state);
        tip_(row_);
        add_energy(state);
        add_links(state);
        add_speeds(state);
        ++motion_.rows;
        motion_.end_s = state.time_s;
    }

    [[nodiscard]] MotionSummary take() {
        for (std::size_t b = 0; b < tells_tension_.size(); ++b)
            if (!tells_tension_[b] && system_.bodies[b].link_count > 0) motion_.unknown_tensions.push_back(b);
        motion_.periods_s = swing_.periods_s();
        motion_.angle_max_deg = swing_.summary().angle_max_deg;
        return std::move(motion_);
    }

  private:
    void open_rows(const OpenRows& open) {
        std::vector<std::string> tip{"t_s"};
        std::vector<std::string> tension{"t_s"};
        std::vector<std::string> strain{"t_s", "largest"};
        const std::vector<std::string> keys = body_keys(named_in_files(film_.scene(), system_));
        for (const BodyCurves& body : motion_.bodies) {
            const std::string& key = keys[body.followed.body];
            for (const char* what : {"x_m", "y_m", "vx_m_s", "vy_m_s"}) tip.push_back(key + "_" + what);
            if (body.followed.pin) {
                tip.push_back(key + "_angle_rad");
                tip.push_back(key + "_angular_velocity_rad_s");
            }
            tension.push_back(key + "_largest_n");
            tension.push_back(key + "_link");
            strain.push_back(key + "_largest");
            strain.push_back(key + "_link");
        }
        tip_ = open("tip.csv", tip);
        energy_ = open("energy.csv", {"t_s", "kinetic_j", "weight_since_start_j", "elastic_j",
                                      "total_since_start_j", "energy_error"});
        tension_ = open("tension.csv", tension);
        strain_ = open("strain.csv", strain);
    }

    void add_tips(const State& state, bool is_frame) {
        const double t = state.time_s;
        row_.assign(1, t);
        for (BodyCurves& body : motion_.bodies) {
            const std::size_t i = body.followed.particle;
            const double x_m = state.x_m[i];
            const double y_m = state.y_m[i];
            body.path.push_back({t, x_m, y_m});
            // Relaxation has one velocity per step: between frames it would draw steps.
            const MethodDef& method = film_.plan().bodies[body.followed.body].method;
            if (!is_frame && std::holds_alternative<RelaxationDef>(method)) continue;
            body.phase.push_back({t, x_m - system_.x_m[body.followed.pin.value_or(i)], state.vx_m_s[i]});
            row_.insert(row_.end(), {system_.origin_m.x + x_m, system_.origin_m.y + y_m, state.vx_m_s[i],
                                     state.vy_m_s[i]});
            if (!body.followed.pin) continue;
            add_turning(state, body);
            row_.insert(row_.end(), {body.turning.back().x, body.turning.back().y});
        }
    }

    static void add_turning(const State& state, BodyCurves& body) {
        const std::size_t i = body.followed.particle;
        const std::size_t pin = body.followed.pin.value();
        body.nearest_m = std::min(body.nearest_m,
                                  sim::length(state.x_m[i] - state.x_m[pin], state.y_m[i] - state.y_m[pin]));
        const view::CurvePoint* const last = body.turning.empty() ? nullptr : &body.turning.back();
        body.turning.push_back(pipeline::turning_of(body.followed, state, last));
    }

    void add_energy(const State& state) {
        const double t = state.time_s;
        const Energy energy = film_.energy();
        const double total_j = energy.kinetic_j + energy.weight_j + energy.elastic_j;
        motion_.kinetic.push_back({t, t, energy.kinetic_j});
        motion_.weight.push_back({t, t, energy.weight_j});
        motion_.elastic.push_back({t, t, energy.elastic_j});
        motion_.total.push_back({t, t, total_j});
        row_.assign({t, energy.kinetic_j, energy.weight_j, energy.elastic_j, total_j,
                     film_.figures().energy_error.value_or(kUnknown)});
        energy_(row_);
    }

    /// The largest size of a quantity of a body's links.
    [[nodiscard]] Extreme largest_of(Quantity quantity, std::size_t b, const State& state) const {
        const Body& body = system_.bodies[b];
        Extreme largest;
        for (std::size_t k = 0; k < body.link_count; ++k) {
            largest.include(sim::kind_of(quantity).value(system_, body, body.first_bar + k, state),
                            state.time_s, b, k);
        }
        return largest;
    }

    void add_links(const State& state) {
        const double t = state.time_s;
        row_.assign(1, t);
        strains_.assign({t, 0.0});
        std::size_t curve = 0;
        Extreme strain;
        for (std::size_t b = 0; b < system_.bodies.size(); ++b) {
            const Extreme tension = largest_of(Quantity::kTension, b, state);
            const Extreme own_strain = largest_of(Quantity::kStrain, b, state);
            if (tension.is_known && (!motion_.tension.is_known || tension.size > motion_.tension.size))
                keep_tensions(b, state);
            tells_tension_[b] = tells_tension_[b] || tension.is_known;
            motion_.tension.include(tension);
            strain.include(own_strain);
            if (curve == motion_.bodies.size() || motion_.bodies[curve].followed.body != b) continue;
            BodyCurves& body = motion_.bodies[curve++];
            const double tension_n = tension.is_known ? tension.size : kUnknown;
            const double link = tension.is_known ? static_cast<double>(tension.index) : kUnknown;
            body.tension.push_back({t, t, tension_n});
            body.strain.push_back({t, t, own_strain.size});
            row_.insert(row_.end(), {tension_n, link});
            strains_.insert(strains_.end(), {own_strain.size, static_cast<double>(own_strain.index)});
        }
        motion_.strain.include(strain);
        strains_[1] = strain.size;
        tension_(row_);
        strain_(strains_);
    }

    void keep_tensions(std::size_t b, const State& state) {
        const Body& body = system_.bodies[b];
        const auto first = state.tension_n.begin() + static_cast<std::ptrdiff_t>(body.first_bar);
        motion_.tensions_n.assign(first, first + static_cast<std::ptrdiff_t>(body.link_count));
    }

    void add_speeds(const State& state) {
        for (std::size_t b = 0; b < system_.bodies.size(); ++b) {
            const Body& body = system_.bodies[b];
            for (std::size_t k = 0; k < body.particle_count; ++k) {
                const std::size_t i = body.first_particle + k;
                motion_.speed.include(
                    std::sqrt(state.vx_m_s[i] * state.vx_m_s[i] + state.vy_m_s[i] * state.vy_m_s[i]),
                    state.time_s, b, k);
            }
        }
    }

    Film& film_;
    const System& system_;
    SummaryReader swing_;
    MotionSummary motion_;
    OnRow tip_;
    OnRow energy_;
    OnRow tension_;
    OnRow strain_;
    std::vector<double> row_;
    std::vector<double> strains_;
    std::vector<bool> tells_tension_;  ///< per body
};

/// Whether a rope hangs from its first particle, and only weight acts on it.
bool is_plain(const RopeDef& rope, const Scene& scene) {
    return !rope.closed && rope.rest_m.empty() && rope.bending_n_m2 == 0.0 &&
           rope.pinned == std::vector<std::uint32_t>{0} && scene.world.drag_1_s == 0.0 &&
           rope.material.compliance_1_n == 0.0;
}

/// The length of all links if they are equal.
std::optional<double> link_length_m(const RopeDef& rope) {
    const auto length_m = [&](std::size_t link) {
        const Vec2 d = rope.points_m[link + 1] - rope.points_m[link];
        return std::hypot(d.x, d.y);
    };
    for (std::size_t link = 1; link + 1 < rope.points_m.size(); ++link)
        if (std::abs(length_m(link) - length_m(0)) > 1e-9 * length_m(0)) return std::nullopt;
    return length_m(0);
}

/// Whether a rope is straight and its particles have at most 1 % of the payload's mass, which then shorten
/// the period of a point pendulum by a twelfth of that: less than 0.1 %.
bool has_heavy_end(const RopeDef& rope, double length_m) {
    constexpr double kSmallShare = 0.01;
    const Vec2 span = rope.points_m.back() - rope.points_m.front();
    const bool is_straight = std::abs(std::hypot(span.x, span.y) - length_m) <= 1e-9 * length_m;
    return is_straight &&
           std::accumulate(rope.mass_kg.begin(), rope.mass_kg.end(), 0.0) <= kSmallShare * rope.payload_kg;
}

/// The acceleration downwards that a rope feels; 0 or less: none that theory knows.
double gravity_m_s2(const RopeDef& rope, const Scene& scene) {
    Vec2 gravity = scene.world.gravity_m_s2;
    if (const auto* const relaxation = std::get_if<RelaxationDef>(&scene.solver);
        relaxation != nullptr && relaxation->force_n)
        gravity = {relaxation->force_n->x / rope.mass_kg.front(),
                   relaxation->force_n->y / rope.mass_kg.front()};
    return gravity.x == 0.0 ? -gravity.y : 0.0;
}

}  // namespace

void Extreme::include(double value, double at_s, std::size_t of_body, std::size_t at) {
    const double new_size = std::abs(value);
    if (is_known ? !(new_size > size) : std::isnan(new_size)) return;
    *this = {true, new_size, at_s, of_body, at};
}

void Extreme::include(const Extreme& other) {
    if (other.is_known) include(other.size, other.time_s, other.body, other.index);
}

FilmDef film_def(const Scene& scene) {
    FilmDef def;
    def.readings = {.velocities = true, .tensions = true, .unknown_tensions = true};
    def.stills_s = times_between_frames_s(scene);
    return def;
}

MotionSummary read_motion(Film& film, const OpenRows& open, const OnProgress& on_progress) {
    const std::int64_t rows = film.last_frame() + 1;
    const Timeline timeline(film.scene().video.scene_rate(), film.last_frame(),
                            times_between_frames_s(film.scene()));
    Reader reader(film, open);
    std::optional<Error> failure;
    std::int64_t k = 0;
    for (std::size_t i = 0; i < timeline.size(); ++i) {
        if (timeline.is_frame(i)) report_progress(on_progress, k++, rows);
        try {
            reader.add(film.state_at(timeline.time_s(i)), timeline.is_frame(i));
        } catch (const Error& error) {
            if (error.code() != ExitCode::kDiverged || i == 0) throw;
            failure = error;
            break;
        }
    }
    MotionSummary motion = reader.take();
    motion.failure = failure;
    return motion;
}

std::optional<PeriodTheory> period_theory(const Scene& scene, double angle_deg) {
    if (scene.ropes.size() != 1 || !scene.nets.empty()) return std::nullopt;
    const RopeDef& rope = scene.ropes.front();
    const auto length_m = link_length_m(rope);
    const double gravity = gravity_m_s2(rope, scene);
    if (!is_plain(rope, scene) || !length_m || !(gravity > 0.0) || !(angle_deg < 180.0)) return std::nullopt;
    constexpr long double kPi = std::numbers::pi_v<long double>;
    const auto pendulum_s = [&](long double omega0_1_s) {
        return reference::Pendulum(omega0_1_s, angle_deg * kPi / 180.0L).period_s();
    };
    const int links = static_cast<int>(rope.points_m.size()) - 1;
    if (links == 1)
        return {{pendulum_s(std::sqrt(gravity / *length_m)), "a point pendulum of this amplitude"}};
    if (has_heavy_end(rope, links * *length_m))
        return {{pendulum_s(std::sqrt(gravity / (links * *length_m))),
                 "a point pendulum of this amplitude, with all mass at the end of the rope,"}};
    const bool has_equal_masses =
        rope.payload_kg == 0.0 &&
        std::ranges::all_of(rope.mass_kg, [&](double mass_kg) { return mass_kg == rope.mass_kg.front(); });
    if (!has_equal_masses) return std::nullopt;
    if (rope.reach > 1)
        return {{pendulum_s(reference::rod_omega0_1_s(links, *length_m, gravity)),
                 "a rigid rod of this amplitude, as which longer bars tend to hold a rope,"}};
    return {{static_cast<double>(2.0L * kPi / reference::rope_omega0_1_s(links, *length_m, gravity)),
             fmt::format("a hanging rope of {} links at small angles", links)}};
}

}  // namespace corda::figures
