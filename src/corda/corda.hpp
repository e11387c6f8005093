#pragma once

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
