#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace corda::scene {

/// One key of a scene file.
struct KeyText {
    std::string_view section;  ///< dotted name of the table that it stands in; empty for the top level
    std::string_view name;
    std::string_view meaning;  ///< value, unit, range and default
};

/// Every key that a scene file may have. The reader knows a key by this list alone.
inline constexpr std::array kKeys{
    KeyText{"", "schema", "1, the version of this list; required"},
    KeyText{"", "world", "table: what acts on everything"},
    KeyText{"", "rope", "list of tables, [[rope]]: chains; at least one rope or net"},
    KeyText{"", "net", "list of tables, [[net]]: particles and bars in any graph"},
    KeyText{"", "solver", "table: how it is solved"},
    KeyText{"", "video", "table: picture size, rate and encoder"},
    KeyText{"", "style", "table: how it looks"},
    KeyText{"", "camera", "table: where the camera looks; default the whole motion"},

    KeyText{"world", "gravity", "m/s2 downwards, or [gx, gy]; default 9.81"},
    KeyText{"world", "duration", "s, > 0; default 10"},
    KeyText{"world", "drag", "1/s, >= 0: velocities decay by exp(-drag t); default 0"},

    KeyText{"rope", "line", "table: particles in a straight line, from + i * step"},
    KeyText{"rope", "hang", "table: particles in a straight line at an angle"},
    KeyText{"rope", "points", "m: list of [x, y], at least 2"},
    KeyText{"rope", "mass", "kg a particle, or a list with one a particle; 1e-12 .. 1e12; default 1"},
    KeyText{"rope", "payload", "kg added to the last particle, 0 .. 1e12; default 0"},
    KeyText{"rope", "velocity", "m/s: [vx, vy], or a list with one pair a particle; default [0, 0]"},
    KeyText{"rope", "pinned", "particle indices, -1 is the last; default [0]; [] is a free rope"},
    KeyText{"rope", "closed",
            "true: the last point is tied to the first; points only, at least 3; default false"},
    KeyText{"rope", "compliance",
            "1/N: strain a newton, 1/(E A), 0 .. 1e6; default 0, links keep their lengths"},
    KeyText{"rope", "string", "true: links pull and never push; default false"},
    KeyText{"rope", "bending", "N m2: bending stiffness E I, 0 .. 1e12; not of a string; default 0"},
    KeyText{"rope", "link_length",
            "m at rest, or a list with one a link; needs compliance or string; default as they start"},
    KeyText{"rope", "color", "\"#rrggbb\" or \"#rrggbbaa\"; default the next of style.palette"},
    KeyText{"rope", "width_px", "pixels, 0.1 .. 1000; default style.rope_width_px"},

    KeyText{"rope.line", "particles", "number of particles, >= 2; required"},
    KeyText{"rope.line", "from", "m: [x, y] of the first; default [0, 0]"},
    KeyText{"rope.line", "step", "m: [dx, dy] from one to the next; required"},

    KeyText{"rope.hang", "links", "number of links, >= 1: one less than particles; required"},
    KeyText{"rope.hang", "length", "m: of the whole rope, > 0; required"},
    KeyText{"rope.hang", "angle_deg", "degrees from straight down, positive towards +x; default 0"},
    KeyText{"rope.hang", "from", "m: [x, y] of the first particle; default [0, 0]"},

    KeyText{"net", "grid", "table: particles in rows and columns, with bars in all directions"},
    KeyText{"net", "points", "m: list of [x, y], at least 2"},
    KeyText{"net", "bars", "with points: list of pairs of particle indices, -1 is the last; required"},
    KeyText{"net", "mass", "kg a particle, or a list with one a particle; 1e-12 .. 1e12; default 1"},
    KeyText{"net", "velocity", "m/s: [vx, vy], or a list with one pair a particle; default [0, 0]"},
    KeyText{"net", "pinned",
            "particle indices, -1 is the last, of a grid also [column, row]; default its upper corners, of "
            "points [0]"},
    KeyText{"net", "compliance",
            "1/N: strain a newton, 1/(E A), 0 .. 1e6; default 0, bars keep their lengths"},
    KeyText{"net", "string", "true: bars pull and never push; needs compliance; default false"},
    KeyText{"net", "color", "\"#rrggbb\" or \"#rrggbbaa\"; default the next of style.palette"},
    KeyText{"net", "width_px", "pixels, 0.1 .. 1000; default half of style.rope_width_px"},

    KeyText{"net.grid", "columns", "particles in a row, >= 1; particle row * columns + column; required"},
    KeyText{"net.grid", "rows", "number of rows, >= 1, row 0 on top; required"},
    KeyText{"net.grid", "from", "m: [x, y] of the upper left particle; default [0, 0]"},
    KeyText{"net.grid", "spacing", "m from one to the next, > 0, or [dx, dy]; required"},
    KeyText{"net.grid", "diagonals", "true: two imaginary bars across each cell; default true"},

    KeyText{"solver", "method", "auto, relaxation, rope or exact; default auto"},
    KeyText{"solver", "tolerance_px",
            "auto: bound of the displayed position error, pixels, > 0; default 0.1"},
    KeyText{"solver", "tolerance", "exact: relative to the rope's length, 1e-15 .. 1e-2; default 1e-9"},
    KeyText{"solver", "order", "rope: 2, 4, 6 or 8; default 4"},
    KeyText{"solver", "step", "rope and relaxation: s, > 0; default of relaxation one frame"},
    KeyText{"solver", "reach", "relaxation: bars of ropes to the next 1..reach particles, >= 1; default 7"},
    KeyText{"solver", "sweeps", "relaxation: passes a step, 1 .. 1e6; default 1"},
    KeyText{"solver", "delta", "relaxation: share of the velocity lost a step, 0 <= delta < 1; default 0"},
    KeyText{"solver", "force", "relaxation: N on every particle, [fx, fy], in place of gravity"},

    KeyText{"video", "size", "pixels: [width, height]; default [1920, 1080]"},
    KeyText{"video", "fps", "frames a second: an integer, or text such as \"30000/1001\"; default 60"},
    KeyText{"video", "codec", "name of the encoder; default libx264"},
    KeyText{"video", "preset", "ultrafast .. placebo; default medium"},
    KeyText{"video", "crf", "constant rate factor, 1 (best) .. 51; default 18"},
    KeyText{"video", "threads", "of the encoder, 1 .. 64; default 2"},

    KeyText{"style", "background", "opaque colour"},
    KeyText{"style", "palette", "colours of the ropes and nets in turn, 1 .. 64"},
    KeyText{"style", "rope_width_px", "pixels, 0.1 .. 1000; default grows with the height"},
    KeyText{"style", "markers", "none, pinned or all; default pinned"},
    KeyText{"style", "marker_radius_px", "pixels, 0.1 .. 1000; default grows with the rope's width"},
    KeyText{"style", "pinned_color", "colour of the markers of pinned particles"},
    KeyText{"style", "free_color", "colour of the markers of free particles"},
    KeyText{"style", "bars", "none, real or all; default none"},
    KeyText{"style", "bar_width_px", "pixels, 0.1 .. 1000; default a quarter of the rope's width"},
    KeyText{"style", "real_bar_color", "colour of the bars between neighbours"},
    KeyText{"style", "imaginary_bar_color", "colour of the longer bars"},

    KeyText{"camera", "center", "m: [x, y] in the middle of the picture; default fits the motion"},
    KeyText{"camera", "height", "m: height of the picture, 1e-9 .. 4e9; default fits the motion"},
    KeyText{"camera", "margin", "share left free at each edge, 0 .. 0.45; default 0.08"},
};

/// The names of the keys of one table, in the order of the list.
[[nodiscard]] std::vector<std::string_view> keys_of(std::string_view section);

}  // namespace corda::scene
