#pragma once

// Runs of a plain rope, compiled twice: with the simulation as it is, and with a copy of it without the terms
// (kTermsCompiledIn), whose namespace is corda_plain.

/// How long a run took, in processor time, and where it led.
struct TimedRun {
    double seconds = 0.0;
    double tip_x_m = 0.0;
    double tip_y_m = 0.0;
};

namespace corda::test {

/// A rope of 1 m let go at 45 degrees, under method rope of order 4 with the step that it chooses.
TimedRun time_rope(int links, int steps);

/// The same under method exact with its defaults.
TimedRun time_exact(int links, double duration_s);

}  // namespace corda::test

namespace corda_plain::test {

TimedRun time_rope(int links, int steps);
TimedRun time_exact(int links, double duration_s);

}  // namespace corda_plain::test
