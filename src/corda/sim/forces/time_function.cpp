#include "corda/sim/forces/time_function.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "corda/sim/cosine_sine.hpp"

namespace corda::sim {
namespace {

constexpr double kTwoPi = 6.283185307179586477;

/// Cosine and sine of a number of turns.
CosineSine<double> cosine_sine_of_turns(double turns) {
    constexpr double kQuarters = 4.0;
    turns -= std::floor(turns);
    const double quarter = std::floor(kQuarters * turns + 0.5);
    const auto [c, s] = cosine_sine_of_small(kTwoPi * (turns - quarter / kQuarters));
    switch (static_cast<int>(quarter) % 4) {
        case 0:
            return {c, s};
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        default:
            return {s, -c};
    }
}

}  // namespace

void TimeFunction::add_wave(const WaveDef& wave) {
    if (wave.amplitude != Vec2{})
        waves_.push_back({wave.frequency_hz, wave.phase_deg / 360.0, wave.amplitude, {}});
}

void TimeFunction::add_path(std::span<const PathKeyDef> keys) {
    assert(pieces_.empty());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        pieces_.push_back({keys[i].time_s, 1.0, {keys[i].by_m}});
        if (i + 1 == keys.size()) break;
        const Vec2 way = keys[i + 1].by_m - keys[i].by_m;
        Piece& piece = pieces_.back();
        piece.unit_s = keys[i + 1].time_s - keys[i].time_s;
        piece.term[3] = 10.0 * way;
        piece.term[4] = -15.0 * way;
        piece.term[5] = 6.0 * way;
    }
}

TimeFunction TimeFunction::from(double time_s) const {
    TimeFunction result = *this;
    for (Wave& wave : result.waves_) wave.turns += wave.frequency_hz * time_s;
    for (Piece& piece : result.pieces_) piece.start_s -= time_s;
    return result;
}

void TimeFunction::add(double factor, const TimeFunction& other) {
    if (factor == 0.0) return;
    constant_ = constant_ + factor * other.constant_;
    for (const Wave& wave : other.waves_) {
        const auto same = std::ranges::find_if(waves_, [&](const Wave& own) {
            return own.frequency_hz == wave.frequency_hz && own.turns == wave.turns;
        });
        if (same == waves_.end()) {
            waves_.push_back({wave.frequency_hz, wave.turns, factor * wave.sine, factor * wave.cosine});
        } else {
            same->sine = same->sine + factor * wave.sine;
            same->cosine = same->cosine + factor * wave.cosine;
        }
    }
    if (pieces_.empty()) {
        for (const Piece& piece : other.pieces_) pieces_.push_back({piece.start_s, piece.unit_s, {}});
    }
    assert(other.pieces_.empty() || other.pieces_.size() == pieces_.size());
    for (std::size_t i = 0; i < other.pieces_.size(); ++i) {
        for (std::size_t k = 0; k < kTerms; ++k)
            pieces_[i].term[k] = pieces_[i].term[k] + factor * other.pieces_[i].term[k];
    }
}

TimeFunction TimeFunction::derivative() const {
    TimeFunction result;
    for (const Wave& wave : waves_) {
        const double rate_1_s = kTwoPi * wave.frequency_hz;
        result.waves_.push_back(
            {wave.frequency_hz, wave.turns, -rate_1_s * wave.cosine, rate_1_s * wave.sine});
    }
    for (const Piece& piece : pieces_) {
        result.pieces_.push_back({piece.start_s, piece.unit_s, {}});
        for (std::size_t k = 1; k < kTerms; ++k)
            result.pieces_.back().term[k - 1] = (static_cast<double>(k) / piece.unit_s) * piece.term[k];
    }
    return result;
}

TimeFunction TimeFunction::turned(Vec2 cosine_sine) const {
    const auto turn = [&](Vec2& v) { v = sim::turned(v, cosine_sine); };
    TimeFunction result = *this;
    turn(result.constant_);
    for (Wave& wave : result.waves_) turn(wave.sine), turn(wave.cosine);
    for (Piece& piece : result.pieces_) std::ranges::for_each(piece.term, turn);
    return result;
}

const TimeFunction::Piece* TimeFunction::piece_at(double time_s) const {
    const auto after = std::ranges::find_if(
        pieces_, [time_s](const Piece& piece) { return !is_reached(piece.start_s, time_s); });
    return after == pieces_.begin() ? nullptr : &*(after - 1);
}

Vec2 TimeFunction::sum_at(double time_s) const {
    Vec2 sum = constant_;
    for (const Wave& wave : waves_) {
        const auto [c, s] = cosine_sine_of_turns(wave.frequency_hz * time_s + wave.turns);
        sum = sum + (s * wave.sine + c * wave.cosine);
    }
    if (const Piece* const piece = piece_at(time_s)) {
        const double t = (time_s - piece->start_s) / piece->unit_s;
        Vec2 value;
        for (std::size_t k = kTerms; k-- > 0;) value = t * value + piece->term[k];
        sum = sum + value;
    }
    return sum;
}

void TimeFunction::expand(double time_s, double unit_s, std::span<Vec2> coefficients) const {
    std::ranges::fill(coefficients, Vec2{});
    coefficients[0] = constant_;
    for (const Wave& wave : waves_) {
        const auto [c, s] = cosine_sine_of_turns(wave.frequency_hz * time_s + wave.turns);
        Vec2 value = s * wave.sine + c * wave.cosine;
        Vec2 slope = c * wave.sine - s * wave.cosine;
        for (std::size_t k = 0; k < coefficients.size(); ++k) {
            coefficients[k] = coefficients[k] + value;
            const double share = kTwoPi * wave.frequency_hz * unit_s / static_cast<double>(k + 1);
            const Vec2 next = share * slope;
            slope = -share * value;
            value = next;
        }
    }
    const Piece* const piece = piece_at(time_s);
    if (piece == nullptr) return;
    const double t = (time_s - piece->start_s) / piece->unit_s;
    std::array<Vec2, kTerms> term = piece->term;  // Horner's shift: afterwards powers of the time from time_s
    for (std::size_t first = 0; first + 1 < kTerms; ++first)
        for (std::size_t k = kTerms - 1; k-- > first;) term[k] = term[k] + t * term[k + 1];
    double power = 1.0;
    for (std::size_t k = 0; k < std::min(kTerms, coefficients.size()); ++k, power *= unit_s / piece->unit_s)
        coefficients[k] = coefficients[k] + power * term[k];
}

double TimeFunction::next_key_s(double time_s) const {
    for (const Piece& piece : pieces_)
        if (!is_reached(piece.start_s, time_s)) return piece.start_s;
    return std::numeric_limits<double>::infinity();
}

double TimeFunction::bound() const {
    constexpr int kSamples = 32;
    double largest = 0.0;
    for (const Piece& piece : pieces_) {
        for (int j = 0; j < kSamples; ++j) {
            Vec2 value;
            for (std::size_t k = kTerms; k-- > 0;) value = (j / double{kSamples}) * value + piece.term[k];
            largest = std::max(largest, length(value.x, value.y));
        }
    }
    largest += length(constant_.x, constant_.y);
    for (const Wave& wave : waves_)
        largest += length(wave.sine.x, wave.sine.y) + length(wave.cosine.x, wave.cosine.y);
    return largest;
}

double TimeFunction::frequency_1_s() const {
    double largest = 0.0;
    for (const Wave& wave : waves_) largest = std::max(largest, kTwoPi * wave.frequency_hz);
    return largest;
}

}  // namespace corda::sim
