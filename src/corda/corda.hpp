#pragma once

#if defined(__cplusplus) && __cplusplus < 202002L
#error "Corda needs C++20: compile with -std=c++20, or target_compile_features(... cxx_std_20)"
#else

/// The public library of Corda: load or build a scene, simulate it, draw frames, write stills and video, and
/// compare pictures.
///
///     #include <corda/corda.hpp>
///
///     corda::Film film(corda::load_scene("swing.toml"));
///     corda::write_png("frame.png", film.frame(30));
///     corda::render_video(film, "swing.mp4");
///
/// Errors are corda::Error, with code() and what(). Coordinates are in metres, y up; times in seconds.

// X11 defines words that are names here.
#pragma push_macro("Status")
#undef Status

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"
#include "corda/film/film.hpp"
#include "corda/golden/compare.hpp"
#include "corda/media/defs.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

#pragma pop_macro("Status")
#endif
