#include "corda/sim/moving_pins.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace corda::sim {
namespace {

/// The body at rest in the frame that moves like this.
System seen_from(System body, Vec2 velocity_m_s) {
    for (double& vx : body.vx_m_s) vx -= velocity_m_s.x;
    for (double& vy : body.vy_m_s) vy -= velocity_m_s.y;
    body.moves.clear();
    return body;
}

class MovingFrame final : public Solver {
  public:
    MovingFrame(System body, const Forces& forces, const MethodDef& method, TimeFunction displacement,
                std::unique_ptr<Solver> inside)
        : Solver(inside->energy_scale_j(), false),
          body_(std::move(body)),
          displacement_(std::move(displacement)),
          velocity_(displacement_.derivative()),
          inside_(std::move(inside)),
          meter_(body_, forces, {&method, 1}),
          place_{0.0, body_.x_m, body_.y_m, body_.vx_m_s, body_.vy_m_s} {}

    Status advance_to(double time_s, State& state) override {
        // A solver need not write where pins rest.
        for (std::size_t i = 0; i < body_.particle_count(); ++i) {
            if (!body_.is_pinned(i)) continue;
            state.x_m[i] = body_.x_m[i];
            state.y_m[i] = body_.y_m[i];
        }
        if (inside_->advance_to(time_s, state) == Status::kDiverged) return Status::kDiverged;
        const Vec2 moved_m = displacement_(time_s);
        for (double& x : state.x_m) x += moved_m.x;
        for (double& y : state.y_m) y += moved_m.y;
        place_.time_s = time_s;
        place_.x_m = state.x_m;
        place_.y_m = state.y_m;
        return Status::kOk;
    }
    [[nodiscard]] double energy_j() const override {
        State place = place_;
        read_velocities(place);
        const Energy energy = meter_.of(place);
        return energy.kinetic_j + energy.potential_j();
    }
    [[nodiscard]] bool has_branched() const override { return inside_->has_branched(); }
    void velocities(State& state) override { read_velocities(state); }
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override {
        return inside_->tensions(tension_n);
    }
    [[nodiscard]] std::uint64_t steps() const override { return inside_->steps(); }
    [[nodiscard]] std::vector<MethodDef> methods() const override { return inside_->methods(); }
    void read_rest_lengths(std::vector<Bar>& bars) const override { inside_->read_rest_lengths(bars); }
    [[nodiscard]] double margin_m() const override { return inside_->margin_m(); }

  private:
    /// Those of pins too.
    void read_velocities(State& state) const {
        const Vec2 moves_m_s = velocity_(place_.time_s);
        std::ranges::fill(state.vx_m_s, 0.0);
        std::ranges::fill(state.vy_m_s, 0.0);
        inside_->velocities(state);
        for (double& vx : state.vx_m_s) vx += moves_m_s.x;
        for (double& vy : state.vy_m_s) vy += moves_m_s.y;
    }

    System body_;
    TimeFunction displacement_;
    TimeFunction velocity_;
    std::unique_ptr<Solver> inside_;
    EnergyMeter meter_;
    State place_;  ///< the last positions
};

}  // namespace

TimeFunction displacement_of(const MoveDef& move, double start_s) {
    TimeFunction displacement;
    for (const WaveDef& wave : move.waves) displacement.add_wave(wave);
    displacement.shift(-1.0 * displacement(0.0));
    displacement.add_path(move.path);
    if (start_s == 0.0) return displacement;
    displacement = displacement.from(start_s);
    displacement.shift(-1.0 * displacement(0.0));
    return displacement;
}

std::optional<TimeFunction> common_displacement(const System& body) {
    if (body.moves.empty()) return TimeFunction();
    TimeFunction first = displacement_of(body.moves.front(), body.start_s);
    const bool are_alike = std::ranges::all_of(
        body.moves, [&](const MoveDef& move) { return displacement_of(move, body.start_s) == first; });
    if (are_alike && (body.moves.size() == pin_count(body, body.bodies.front()) || first.empty()))
        return first;
    return std::nullopt;
}

std::vector<MovingPin> moving_pins(const System& body) {
    std::vector<MovingPin> pins;
    std::vector<TimeFunction> displacements(body.particle_count());
    for (const MoveDef& move : body.moves) {
        const TimeFunction displacement = displacement_of(move, body.start_s);
        const TimeFunction velocity = displacement.derivative();
        displacements[move.pin] = displacement;
        pins.push_back({move.pin,
                        {body.x_m[move.pin], body.y_m[move.pin]},
                        displacement,
                        velocity,
                        velocity.derivative()});
    }
    for (const Bar& bar : body.bars) {
        if (!body.is_pinned(bar.a) || !body.is_pinned(bar.b) || displacements[bar.a] == displacements[bar.b])
            continue;
        throw Refusal(Refusal::Reason::kUnlikeMoves, "a bar joins the pinned particles " +
                                                         std::to_string(bar.a) + " and " +
                                                         std::to_string(bar.b) + ", which move differently");
    }
    return pins;
}

double next_key_s(std::span<const MovingPin> pins, double time_s) {
    double next_s = std::numeric_limits<double>::infinity();
    for (const MovingPin& pin : pins) next_s = std::min(next_s, pin.displacement.next_key_s(time_s));
    return next_s;
}

std::unique_ptr<Solver> solve_in_frame_of_pins(const System& body, const Forces& forces,
                                               const MethodDef& method, const MakeSolver& make) {
    TimeFunction displacement = common_displacement(body).value();
    if (displacement.empty()) return make(seen_from(body, {}), forces);
    std::unique_ptr<Solver> inside =
        make(seen_from(body, displacement.derivative()(0.0)), forces.seen_from(displacement));
    return std::make_unique<MovingFrame>(body, forces, method, std::move(displacement), std::move(inside));
}

}  // namespace corda::sim
