// Every way in which a scene can be wrong has a message with the exact place, the value and the remedy, and
// remedies work.
#include "support/messages.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <tuple>

#include "corda/core/removed.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// Syntax, keys and tables.
constexpr const char* kOfFiles = R"(
@file
| 1:1 schema | missing; give schema = 1
[[rope]]\nline = { particles = 2, step = [1, 0] } | 1:1 schema | missing; give schema = 1 | [[rope]] => schema = 1\n[[rope]]
# later\nschema = 2\nnews = 1\n | 2:10 schema | 2 is not a known version
schema = 2\n[[rope]]\nline = { particles = 2, step = [1, 0] } | 1:10 schema | this program reads schema = 1 | = 2 => = 1
schema = "1"\n[[rope]]\nline = { particles = 2, step = [1, 0] }\n | 1:10 schema | "1" is a string, not an integer; give schema = 1 | "1" => 1
@head
| 1:1 rope | missing; give one or more [[rope]] or [[net]] | + [[rope]]\nhang = { links = 2, length = 1 } ; + [[net]]\ngrid = { columns = 2, rows = 2, spacing = 1 }
rope = [] | 2:8 rope | the list is empty; give one or more [[rope]] | rope = [] => [[rope]]\nhang = { links = 2, length = 1 }
rope = [1] | 2:9 rope[0] | 1 is an integer, not a table
[rope]\nmass = 1 | 2:1 rope | this is a table, not a list
net = [] | 2:7 net | the list is empty; give one or more [[net]]
net = [1] | 2:8 net[0] | 1 is an integer, not a table
[net]\nmass = 1 | 2:1 net | this is a table, not a list
@scene
vidio = 1 | 3:1 vidio | unknown key "vidio"; did you mean "video"?
fps = 1 | 3:1 fps | it is a key of video | fps = 1 => video.fps = 1
"a\\u0001b" = 1 | 3:1 a\x01b | unknown key
world = 3 | 3:9 world | 3 is an integer, not a table; write [world] | world = 3 => [world]
nets = 1 | 3:1 nets | did you mean "net"?
[world]\n  gravty = 1 | 4:3 world.gravty | did you mean "gravity"? | gravty => gravity
[world]\nzz = 1\naa = 2 | 4:1 world.zz | valid keys | zz = 1\naa => drag = 1\ngravity
[video]\nfbs = 1 | 4:1 video.fbs | did you mean "fps"?
[style]\nbackgruond = 1 | 4:1 style.backgruond | did you mean "background"?
[camera]\nfoo = 1 | 4:1 camera.foo | valid keys: center, height, margin
[world]\nfloor = -1 | 4:1 world.floor | unknown key "floor"; ropes pass through everything: there are no floors
[world]\nfriction = 1 | 4:1 world.friction | unknown key "friction"; world.drag slows everything | friction = 1 => drag = 1
[overlay]\ntexts = [{ text = "a", end = 2 }] | 4:24 overlay.texts[0].end | to is the time in s | end = => to =
[golden]\nat = [0.0]\ntolerance = 3 | 5:1 golden.tolerance | max, mean and share are its limits | tolerance = => max =
[style]\ncolors = ["red"] | 4:1 style.colors | palette is the list of the colours | colors => palette
[video]\nwidth = 640 | 4:1 video.width | unknown key "width"; video.size is [width, height] in pixels | width = 640 => size = [640, 360]
@rope
drive = 1 | 4:1 rope[0].drive | unknown key "drive"; moves of a rope or net moves a pinned particle: moves = [{ pin = 0, waves = | drive = 1 => moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 1.0 }] }]
Stiffness = 1 | 4:1 rope[0].Stiffness | unknown key "Stiffness"; compliance is the strain per newton of tension
mass = "1,5" | 4:8 rope[0].mass | "1,5" is a string, not a number: decimals need a point; write 1.5 | "1,5" => 1.5
mass = "2" | 4:8 rope[0].mass | "2" is a string, not a number; write 2 | "2" => 2
pinned = [0.0] | 4:11 rope[0].pinned[0] | 0.0 is a number with a point, not an integer; write 0 | 0.0 => 0
strng = true | 4:1 rope[0].strng | did you mean "string"?
moves = [{ pin = 1, path = [{ t = 0, by = [0, 0] }] }] | 4:18 rope[0].moves[0].pin | particle 1 is not pinned; add it to pinned, or give the index of a pinned one | pin = 1 => pin = 0 ; + pinned = [1]
moves = [{ pin = 9, path = [{ t = 0, by = [0, 0] }] }] | 4:18 rope[0].moves[0].pin | 9 is out of range; the rope has particles
moves = [{ pin = 0 }] | 4:10 rope[0].moves[0] | neither waves nor a path; give one of them or both
moves = [{ path = [{ t = 0, by = [0, 0] }] }] | 4:10 rope[0].moves[0].pin | missing; give the index of a pinned particle
moves = [{ pin = 0, path = [{ t = 0, by = [1, 0] }] }] | 4:29 rope[0].moves[0].path[0] | a path starts at the place of its pin; give a first key with by = [0, 0] | [1, 0] => [0, 0]
moves = [{ pin = 0, path = [{ t = 1, by = [0, 0] }, { t = 1, by = [1, 0] }] }] | 4:53 rope[0].moves[0].path[1] | 1 s after 1 s; give times that increase | t = 1, by = [1, 0] => t = 2, by = [1, 0]
moves = [{ pin = 0, path = [{ t = 0, by = [0, 0] }] }, { pin = 0, path = [{ t = 0, by = [0, 0] }] }] | 4:64 rope[0].moves[1].pin | particle 0 moves already; put its waves and its path into one entry
release = [{ pin = 1, t = 1 }] | 4:20 rope[0].release[0].pin | particle 1 is not pinned; add it to pinned, or give the index of a pinned one | pin = 1 => pin = 0 ; + pinned = [1]
release = [{ pin = 0, t = 1 }, { pin = 0, t = 2 }] | 4:40 rope[0].release[1].pin | particle 0 is let go already; remove one | , { pin = 0, t = 2 } =>
release = [{ pin = 0, t = -1 }] | 4:27 rope[0].release[0].t | -1 is not >= 0 | t = -1 => t = 1
release = [{ pins = [0], t = 1 }] | 4:14 rope[0].release[0].pins | pin is the index of one pinned particle; give a table for each
release = [{ pin = 0, at = 1 }] | 4:23 rope[0].release[0].at | t is the time in s | at = 1 => t = 1
cut = [{ links = [1], t = 1 }] | 4:10 rope[0].cut[0].links | link is the index of one link; give a table for each
cut = [{ link = 1, at = 1 }] | 4:20 rope[0].cut[0].at | t is the time in s | at = 1 => t = 1
moves = [{ pins = [0], path = [{ t = 0, by = [0, 0] }] }] | 4:12 rope[0].moves[0].pins | pin is the index of one pinned particle
moves = [{ pin = 0, to = [1, 0] }] | 4:10 rope[0].moves[0] | path moves it from key to key: path = [{ t = 0.0, by = [0.0, 0.0] }, | to = [1, 0] => path = [{ t = 0.0, by = [0.0, 0.0] }, { t = 1.0, by = [1.0, 0.0] }]
moves = [{ pin = 0, amplitude = [1, 0], frequency = 1 }] | 4:10 rope[0].moves[0] | it is a key of rope.moves.waves
moves = [{ pin = 0, path = [{ t = 0, to = [0, 0] }] }] | 4:38 rope[0].moves[0].path[0].to | by is the displacement from the place in the scene, in m | to = [0, 0] => by = [0, 0]
release = [{ pin = 0, t = inf }] | 4:27 rope[0].release[0].t | inf
release = [{ pin = 0 }] | 4:12 rope[0].release[0].t | missing; give the time from which it is free | pin = 0 => pin = 0, t = 1
release = [{ pin = 9, t = 1 }] | 4:20 rope[0].release[0].pin | 9 is out of range; the rope has particles
cut = [{ link = 2, t = 1 }] | 4:17 rope[0].cut[0].link | 2 is out of range; it has links 0 .. 1, or -1 .. -2 from the end | link = 2 => link = 1
cut = [{ link = 1, t = 1 }, { link = -1, t = 2 }] | 4:38 rope[0].cut[1].link | link 1 is cut already; remove one | link = -1 => link = 0
cut = [{ link = 1, t = -1 }] | 4:24 rope[0].cut[0].t | -1 is not >= 0 | t = -1 => t = 1
cut = [{ t = 1 }] | 4:8 rope[0].cut[0].link | missing; give the index of a link
grid = 1 | 4:1 rope[0].grid | it is a key of net
a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a = 1 | - | swing.toml:4:64: a key of more than 32 parts
mass = | - | see https://toml.io for the syntax | mass = => mass = 1
)";

// Shapes of ropes.
constexpr const char* kOfShapes = R"(
@shape
| 2:1 rope[0] | no shape; give one of: line, hang, points | + line = { particles = 4, step = [0.1, -0.1] } ; + hang = { links = 3, length = 1 } ; + points = [[0, 0], [1, 0]]
hang = { links = 3, length = 1, angel_deg = 3 } | 3:33 rope[0].hang.angel_deg | did you mean "angle_deg"?
line = { particles = 3 } | 3:8 rope[0].line.step | as [dx, dy]
line = { particle = 3, step = [1, 0] } | 3:10 rope[0].line.particle | did you mean "particles"?
line = { step = [0, 1] } | 3:8 rope[0].line.particles | missing
line = { particles = 1, step = [0, 1] } | 3:22 rope[0].line.particles | 1 is not >= 2
line = { particles = 2.5, step = [0, 1] } | 3:22 rope[0].line.particles | 2.5 is a number with a fraction, not an integer
line = { particles = 2, step = [0, 0] }\n[world]\ngravity = 0 | 3:32 rope[0].line.step | is no distance; give a step of at least 1e-12 m | [0, 0] => [1e-12, 0]
line = { particles = 2, step = [0, 1], from = [2e9, 0] } | 3:48 rope[0].line.from[0] | 2000000000 is not <= 1e9
line = { particles = 20, step = [0, -1e8] } | 3:8 rope[0].line | beyond the limit of 1e+09 m
line = [1, 2] | 3:8 rope[0].line | a list of 2, not a table; give line = {
hang = { links = 0, length = 1 } | 3:18 rope[0].hang.links | 0 is not >= 1
hang = { links = 2 } | 3:8 rope[0].hang.length | missing; give the length of the whole rope in m, > 0
hang = { links = 2, length = 0 } | 3:30 rope[0].hang.length | 0 is not > 0
hang = { links = 4, length = 1e-12 }\n[world]\ngravity = 0 | 3:30 rope[0].hang.length | 1e-12 m are less than 1e-12 m per link; make the rope longer | 1e-12 => 4e-12
hang = { links = 2, length = 2e9 } | 3:8 rope[0].hang | beyond the limit of 1e+09 m; make the rope shorter | 2e9 => 1e9
hang = { links = 2, length = 1, angle_deg = inf } | 3:45 rope[0].hang.angle_deg | inf is not a finite number
hang = { length = 1 } | 3:8 rope[0].hang | give links, the number of links, or particles | { => { links = 2, ; { => { particles = 2,
hang = { links = 2, particles = 3, length = 1 } | 3:8 rope[0].hang | links and particles are both given; keep one of them | links = 2, =>
hang = { lengths = [1, 2], angles_deg = [9] } | 3:41 rope[0].hang.angles_deg | 1 values for 2 lengths; give one per link | [9] => [9, 8] ; [1, 2] => [1]
hang = { lengths = [1], angles_deg = [9], rates_deg_s = [1, 2] } | 3:57 rope[0].hang.rates_deg_s | 2 values for 1 lengths; give one per link | [1, 2] => [1]
hang = { lengths = [1, 2] } | 3:8 rope[0].hang.angles_deg | missing; give the angle of each link from straight down, positive to +x in degrees | { => { angles_deg = [3, 4],
hang = { lengths = [1, -2], angles_deg = [9, 9] } | 3:24 rope[0].hang.lengths[1] | -2 is not >= 1e-12
hang = { lengths = [1], angles_deg = [9], links = 1 } | 3:51 rope[0].hang.links | links is of a straight rope, and lengths of one of arms; keep one of them | , links = 1 =>
hang = { angles_deg = [9], links = 1, length = 1 } | 3:23 rope[0].hang.angles_deg | angles_deg is of a rope of arms, which has lengths; give lengths, one per link, in place of links and length | links = 1, length = 1 => lengths = [1]
hang = { lengths = [1, 2e9], angles_deg = [9, 90] } | 3:8 rope[0].hang | the last particle is at [2000000000.1564345, -0.9876883405951378], beyond the limit of 1e+09 m; make the rope shorter | 2e9 => 9e8
hang = { lengths = [2e9, 2e9], angles_deg = [90, -90] } | 3:8 rope[0].hang | particle 1 is at [2000000000, 0], beyond the limit
hang = { lengths = [1], angles_deg = [9], rates_deg_s = [3] }\nvelocity = [1, 0] | 4:12 rope[0].velocity | hang.rates_deg_s gives the velocities, too; keep one of them | , rates_deg_s = [3] => ; velocity = [1, 0] =>
hang = { particles = 1, length = 1 } | 3:22 rope[0].hang.particles | 1 is not >= 2
hang = { links = 2, length = 1 }\nlabel = "\\U0001f9f6" | 4:9 rope[0].label | DejaVu Sans has no U+1F9F6; name a font that has all characters (overlay.font = "file.ttf"), or leave these characters out
hang = { links = 3, length = 1 }\nclosed = true | 4:10 rope[0].closed | give points
points = [[0, 0]] | 3:10 rope[0].points | this is a list of 1; give the positions of the particles
points = [[0, 0], [1]] | 3:19 rope[0].points[1] | this is a list of 1, not [
points = [[0, 0], 3] | 3:19 rope[0].points[1] | 3 is an integer, not [x, y]
points = [[0, 0], [1, 0], [1, 0]] | 3:27 rope[0].points[2] | points 1 and 2 coincide, and a link without length has no direction; move one | [1, 0]] => [1, 1]]
points = [[0, 0], [1, 1], [0, 0]]\n[solver]\nmethod = "relaxation" | 3:27 rope[0].points[2] | points 0 and 2 coincide, and the solver's reach = 7 ties them by a bar, which has no direction; move one, or give a reach below 2 | , [0, 0]] => , [1, 0]] ; + reach = 1
points = [[0, 0], [1, -1e10]] | 3:23 rope[0].points[1][1] | -10000000000 is not >= -1e9
points = [[0, 0], [1, 0]]\nclosed = true | 4:10 rope[0].closed | 2 points close to no ring; give at least 3, or remove it | [1, 0] => [1, 0], [0.5, -1] ; closed = true =>
points = [[0, 0], [1, 0], [1, 1], [0, 0]]\nclosed = true | 3:35 rope[0].points[3] | points 0 and 3 coincide; leave this one out, because closed = true ties the last point to the first | , [0, 0]] => ]
points = [[0, 0], [1, 0], [2, 0], [2, 1], [0, 0], [-1, 1]]\nclosed = true\n[solver]\nmethod = "relaxation" | 3:43 rope[0].points[4] | points 0 and 4 coincide, and the solver's reach = 7 ties them by a bar, which has no direction; move one, or give a reach below 2 | + reach = 1
@rope
points = [[0, 0], [1, 1]] | 2:1 rope[0] | the rope has 2 shapes (line, points); keep one of them | line = { particles = 3, step = [0, -1] } => ; points = [[0, 0], [1, 1]] =>
closed = true | 4:10 rope[0].closed | the closing link of a straight rope would lie on its others; give points, or remove it | line = { particles = 3, step = [0, -1] } => points = [[0, 0], [0.4, -0.3], [0.1, -0.6]] ; closed = true =>
@square
closed = 1 | 4:10 rope[0].closed | 1 is an integer, not true or false; give true or false | closed = 1 => closed = true
closed = true\nstring = true | 5:10 rope[0].string | a closed rope can only hang slack if it stretches; give a compliance, or remove string or closed | + compliance = 1e-3 ; string = true => ; closed = true =>
closed = true\ncompliance = 1\nlink_length = [1, 1, 1] | 6:15 rope[0].link_length | 3 values for 4 links
)";

// Particles and links of ropes.
constexpr const char* kOfRopes = R"(
@rope
mass = "heavy" | 4:8 rope[0].mass | "heavy" is a string, not a number; give the mass of a particle | "heavy" => 1e-9
mass = 0 | 4:8 rope[0].mass | 0 is not >= 1e-12
mass = [1, 2] | 4:8 rope[0].mass | 2 values for 3 particles; give one per particle | 2] => 2, 3]
mass = [1, 2, 0] | 4:15 rope[0].mass[2] | 0 is not >= 1e-12
mass = 1e-13 | 4:8 rope[0].mass | 1e-13 is not >= 1e-12
mass = 1e13 | 4:8 rope[0].mass | is not <= 1e12
payload = true | 4:11 rope[0].payload | true is a boolean, not a number
payload = 2020-01-01 | 4:11 rope[0].payload | a date or a time, not a number
payload = nan | 4:11 rope[0].payload | nan is not a finite number
payload = -inf | 4:11 rope[0].payload | -inf is not a finite number
payload = -1 | 4:11 rope[0].payload | -1 is not >= 0; give the mass added to the last particle in kg, 0 .. 1e12
velocity = 3 | 4:12 rope[0].velocity | 3 is an integer, not a list
velocity = [] | 4:12 rope[0].velocity | a list of 0, not [vx, vy]
velocity = [1, 2, 3] | 4:12 rope[0].velocity | this is a list of 3, not [
velocity = [[1, 2], [3, 4]] | 4:12 rope[0].velocity | 2 values for 3 particles
velocity = [[1, 2], 3, 4] | 4:21 rope[0].velocity[1] | , not [
pinned = 0 | 4:10 rope[0].pinned | 0 is an integer, not a list
pinned = [0.5] | 4:11 rope[0].pinned[0] | 0.5 is a number with a fraction, not an integer
pinned = [3] | 4:11 rope[0].pinned[0] | 3 is out of range; the rope has particles 0 .. 2, or -1 .. -3 from the end | [3] => [2] ; [3] => [-1] ; [3] => [-3]
pinned = [-4] | 4:11 rope[0].pinned[0] | -4 is out of range
pinned = [2, 0, -1] | 4:17 rope[0].pinned[2] | particle 2 is given twice; remove one | , 0, -1] => ]
color = 3 | 4:9 rope[0].color | 3 is an integer, not text
color = "redd" | 4:9 rope[0].color | "redd" is not a colour; did you mean "red"?; give a colour such as "red", "#e8c07d", "#e8c07d80" (with alpha) or "transparent"
width_px = 0 | 4:12 rope[0].width_px | 0 is not >= 0.1
compliance = -1 | 4:14 rope[0].compliance | -1 is not >= 0
compliance = 2e6 | 4:14 rope[0].compliance | is not <= 1e6; give
compliance = true | 4:14 rope[0].compliance | true is a boolean, not a number
string = "yes" | 4:10 rope[0].string | "yes" is a string, not true or false
bending = -1 | 4:11 rope[0].bending | -1 is not >= 0
bending = 1e13 | 4:11 rope[0].bending | give the bending stiffness E I in N m2, 0 .. 1e12
string = true\nbending = 1 | 5:11 rope[0].bending | a string hangs slack, and so has no bending stiffness; remove bending or string | bending = 1 => ; string = true =>
link_length = 2 | 4:15 rope[0].link_length | links that neither stretch nor hang slack are as long as their particles are apart at the start; give compliance or string = true, or remove it | + compliance = 1e-3 ; + string = true ; link_length = 2 =>
string = true\npinned = [0, -1]\nlink_length = 0.5 | 6:15 rope[0].link_length | 0.5 m are less than the 1 m between particles 0 and 1, which lie between pins, and which a string that does not stretch cannot span; give at least that, or a compliance | 0.5 => 1.1 ; + compliance = 1e-3
string = true\npinned = [0, -1]\nlink_length = [2, 0.5] | 6:19 rope[0].link_length[1] | between particles 1 and 2
string = true\nlink_length = [2] | 5:15 rope[0].link_length | 1 values for 2 links; give one per link | [2] => [2, 2]
compliance = 1\nlink_length = 0 | 5:15 rope[0].link_length | 0 is not >= 1e-12; give the length of a link at rest in m, 1e-12 .. 4e9
compliance = 1\nlink_length = [1, "2"] | 5:19 rope[0].link_length[1] | "2" is a string, not a number
color = ["red", "blue"] | 4:9 rope[0].color | set style.color_by = "link", or give one colour | + [style]\ncolor_by = "link" ; ["red", "blue"] => "red"
color = ["red", 3] | 4:17 rope[0].color[1] | 3 is an integer, not text
color = ["red", "bleu"] | 4:17 rope[0].color[1] | "bleu" is not a colour
color = ["red", "#00ff0080"]\n[style]\ncolor_by = "link" | 4:17 rope[0].color[1] | another alpha than that of the first link
color = [] | 4:9 rope[0].color | the list is empty
)";

constexpr const char* kOfNets = R"(
@net
| 2:1 net[0] | the net has no shape; give grid, or points and bars | + grid = { columns = 2, rows = 2, spacing = 1 } ; + points = [[0, 0], [1, 0]]\nbars = [[0, 1]]
grid = 3 | 3:8 net[0].grid | 3 is an integer, not a table; give grid = { columns
grid = { rows = 2, spacing = 1 } | 3:8 net[0].grid.columns | missing; give the number
grid = { columns = 2, spacing = 1 } | 3:8 net[0].grid.rows | missing; give the number
grid = { columns = 2, rows = 2 } | 3:8 net[0].grid.spacing | missing; give the distance from one particle to the next in m, 1e-12 .. 1e9, or [dx, dy]
grid = { columns = 0, rows = 2, spacing = 1 } | 3:20 net[0].grid.columns | 0 is not >= 1
grid = { columns = 2, rows = 1.5, spacing = 1 } | 3:30 net[0].grid.rows | 1.5 is a number with a fraction, not an integer
grid = { columns = 1, rows = 1, spacing = 1 } | 3:8 net[0].grid | 1 particle is no net; give more columns or rows | columns = 1 => columns = 2 ; rows = 1 => rows = 2
grid = { columns = 2, rows = 2, spacing = 0 } | 3:43 net[0].grid.spacing | 0 is not >= 1e-12; give the distance
grid = { columns = 2, rows = 2, spacing = [1, -1] } | 3:47 net[0].grid.spacing[1] | -1 is not >= 1e-12
grid = { columns = 2, rows = 2, spacing = [1] } | 3:43 net[0].grid.spacing | this is a list of 1, not [
grid = { columns = 2, rows = 2, spacing = 1, diagonals = 1 } | 3:58 net[0].grid.diagonals | 1 is an integer, not true or false
grid = { columns = 2, rows = 2, spacing = 1, from = [0, 2e9] } | 3:57 net[0].grid.from[1] | 2000000000 is not <= 1e9
grid = { columns = 3, rows = 2, spacing = 6e8 } | 3:8 net[0].grid | beyond the limit of 1e+09 m; make the grid smaller | 6e8 => 1e8
grid = { column = 3, rows = 2, spacing = 1 } | 3:10 net[0].grid.column | did you mean "columns"?
points = [[0, 0], [1, 0]] | 2:1 net[0].bars | missing; give the particles that each bar joins, as a list of [a, b], at least 1 | + bars = [[0, 1]]
points = [[0, 0]]\nbars = [[0, 1]] | 3:10 net[0].points | this is a list of 1; give the positions of the particles
points = [[0, 0], [1, 0], [0, 0]]\nbars = [[0, 1], [0, 2]] | 4:17 net[0].bars[1] | particles 0 and 2 coincide, and a bar without length has no direction; move one | , [0, 0]] => , [0, 1]]
@grid
points = [[0, 0], [1, 1]] | 2:1 net[0] | the net has 2 shapes (grid, points); keep one of them | points = [[0, 0], [1, 1]] =>
payload = 1 | 4:1 net[0].payload | unknown key "payload"; it is a key of rope
mass = [1, 2] | 4:8 net[0].mass | 2 values for 6 particles
velocity = [[1, 2]] | 4:12 net[0].velocity | 1 values for 6 particles
string = true | 4:10 net[0].string | a net can only hang slack if it stretches; give a compliance, or remove string | + compliance = 1e-3 ; string = true =>
compliance = -1 | 4:14 net[0].compliance | -1 is not >= 0
width_px = 0 | 4:12 net[0].width_px | 0 is not >= 0.1
bars = [[0, 1]] | 4:8 net[0].bars | a grid has bars of its own; remove them, or give points in place of the grid | bars = [[0, 1]] => ; grid = { columns = 3, rows = 2, spacing = 0.5 } => points = [[0, 0], [1, 0]]
pinned = [6] | 4:11 net[0].pinned[0] | 6 is out of range; the net has particles 0 .. 5, or -1 .. -6 from the end
pinned = [[3, 0]] | 4:12 net[0].pinned[0][0] | 3 is out of range; the grid has columns 0 .. 2, or -1 .. -3 from the end
pinned = [[0, -3]] | 4:15 net[0].pinned[0][1] | -3 is out of range; the grid has rows 0 .. 1, or -1 .. -2 from the end
pinned = [[1]] | 4:11 net[0].pinned[0] | a list of 1, not [column, row]
pinned = [[2, 0], [-1, 0]] | 4:19 net[0].pinned[1] | particle 2 is given twice; remove one
pinned = 3 | 4:10 net[0].pinned | 3 is an integer, not a list
@graph
bars = [] | 4:8 net[0].bars | the list is empty; give the particles that each bar joins
bars = [[0, 1, 2]] | 4:9 net[0].bars[0] | a list of 3, not [a, b]
bars = [1] | 4:9 net[0].bars[0] | 1 is an integer, not [a, b]
bars = [[0, 0.5]] | 4:13 net[0].bars[0][1] | not an integer
bars = [[0, 1], [1, 4]] | 4:21 net[0].bars[1][1] | 4 is out of range; the net has particles 0 .. 3, or -1 .. -4 from the end
bars = [[0, 1], [3, -1]] | 4:17 net[0].bars[1] | a bar from particle 3 to itself; join two different ones | [3, -1] => [3, 0]
bars = [[0, 1], [1, 2], [0, 1]] | 4:25 net[0].bars[2] | particles 0 and 1 are joined already, by bars[0]; remove one | [1, 2], [0, 1]] => [1, 2]] ; [0, 1],  =>
bars = [[2, 1], [0, 3], [1, 2]] | 4:25 net[0].bars[2] | particles 1 and 2 are joined already, by bars[0]
bars = [[0, 1]]\npinned = [[0, 0]] | 5:11 net[0].pinned[0] | only a grid has columns and rows; give the index of a particle | [[0, 0]] => [0]
bars = [[0, 1]]\npinned = [4] | 5:11 net[0].pinned[0] | 4 is out of range
)";

constexpr const char* kOfSolvers = R"(
@solver
sweps = 1 | 4:1 solver.sweps | did you mean "sweeps"?
method = "relaxatoin" | 4:10 solver.method | "relaxatoin" is unknown; did you mean "relaxation"? | toin => tion
method = "magic" | 4:10 solver.method | give one of: auto, exact, rattle, relaxation | magic => auto ; magic => exact ; magic => rattle ; magic => relaxation
method = "rattle"\nstep = 0 | 5:8 solver.step | 0 is not >= 1e-9; give the step in s, >= 1e-9
method = "relaxation"\nreach = 0 | 5:9 solver.reach | 0 is not >= 1
method = "relaxation"\nsweeps = 1000001 | 5:10 solver.sweeps | 1000001 is not <= 1e6
method = "relaxation"\ndelta = 1 | 5:9 solver.delta | 1 is not < 1
method = "relaxation"\ndelta = -0.1 | 5:9 solver.delta | -0.1 is not >= 0
method = "relaxation"\nforce = 3 | 5:9 solver.force | 3 is an integer, not [fx, fy]
tolerance_px = 0 | 4:16 solver.tolerance_px | 0 is not > 0
method = "exact"\ntolerance = 0.02 | 5:13 solver.tolerance | 0.02 is not <= 0.01
method = "rattle"\norder = 3 | 5:9 solver.order | 3 is not allowed; give one of: 2, 4, 6, 8 | order = 3 => order = 2 ; order = 3 => order = 4 ; order = 3 => order = 6 ; order = 3 => order = 8
method = "rattle"\norder = 10 | 5:9 solver.order | 10 is not allowed
method = "relaxation"\ntolerance_px = 0.1 | 5:16 solver.tolerance_px | method "relaxation" does not use it, only auto; remove it | tolerance_px = 0.1 => ; relaxation => auto
tolerance = 1e-9 | 4:13 solver.tolerance | only exact; remove it
method = "exact"\norder = 4 | 5:9 solver.order | only rattle; remove it
method = "exact"\nstep = 0.01 | 5:8 solver.step | only rattle, relaxation; remove it
reach = 7 | 4:9 solver.reach | method "auto" does not use it, only relaxation; remove it: bars to farther particles make a straight rope a rigid rod, and its equations singular, or give method = "relaxation" | reach = 7 => ; + method = "relaxation"
method = "rattle"\nreach = 7 | 5:9 solver.reach | a rigid rod, and its equations singular
method = "exact"\nreach = 7 | 5:9 solver.reach | a rigid rod, and its equations singular
method = "rattle"\ndelta = 0.1 | 5:9 solver.delta | remove it, or give world.drag | delta = 0.1 => ; delta = 0.1 => [world]\ndrag = 0.1
method = "exact"\nforce = [0, 1] | 5:9 solver.force | remove it, or give world.gravity | force = [0, 1] => ; force = [0, 1] => [world]\ngravity = [0, 1]
method = "relaxation"\n[style]\narrows = "tension" | 6:10 style.arrows | knows no tensions; give "velocity" or "weight", or another solver.method | tension => velocity ; tension => weight ; relaxation => exact
method = "relaxation"\n[style]\ncolor_by = "tension" | 6:12 style.color_by | knows no tensions; give "speed" or "strain", or another solver.method | tension => speed ; tension => strain ; relaxation => exact
ropes = [0] | 4:1 solver.ropes | a key of solver.bodies
@solver.bodies
method = "exact" | 3:1 solver.bodies | this is a table, not a list
@scene
solver.bodies = [{ nets = [0], method = "rattle" }] | 3:27 solver.bodies[0].nets | the scene has no nets; remove it
@bodies
method = "rattle"\nropes = [0, 2] | 10:13 solver.bodies[0].ropes[1] | 2 is out of range; the scene has ropes 0 .. 1, or -1 .. -2 from the end
method = "rattle"\nnets = [-2] | 10:9 solver.bodies[0].nets[0] | -2 is out of range
method = "rattle"\nropes = [1, 0, -1] | 10:16 solver.bodies[0].ropes[2] | 1 is named already, by solver.bodies[0]; remove one | [1, 0, -1] => [1, 0]
method = "rattle"\nropes = [0]\nnets = [0]\n[[solver.bodies]]\nmethod = "exact"\nnets = [0] | 14:9 solver.bodies[1].nets[0] | 0 is named already, by solver.bodies[0]
method = "rattle" | 8:1 solver.bodies[0] | names no body; give ropes or nets, the indices of [[rope]] or [[net]] tables | + ropes = [1] ; + nets = [0]
method = "rattle"\nropes = []\nnets = [] | 8:1 solver.bodies[0] | names no body
method = "rattle"\nropes = 1 | 10:9 solver.bodies[0].ropes | 1 is an integer, not a list; give the indices of [[rope]] tables
method = "rattle"\nropes = [1.0] | 10:10 solver.bodies[0].ropes[0] | not an integer
ropes = [0] | 8:1 solver.bodies[0].method | missing; give one of: exact, rattle, relaxation
ropes = [0]\nmethod = "auto" | 10:10 solver.bodies[0].method | give one of: exact, rattle, relaxation | auto => exact
method = "rattle"\nropes = [0]\nstep = 0 | 11:8 solver.bodies[0].step | 0 is not >= 1e-9; give the step in s, >= 1e-9
method = "rattle"\nropes = [0]\nreach = 7 | 11:9 solver.bodies[0].reach | method "rattle" does not use it, only relaxation; remove it: bars to farther
method = "rattle"\nropes = [0]\ntolerance_px = 1 | 11:1 solver.bodies[0].tolerance_px | unknown key "tolerance_px"; did you mean "tolerance"?
method = "rattle"\nrope = [0] | 10:1 solver.bodies[0].rope | unknown key "rope"; did you mean "ropes"?
method = "rattle"\nnets = [0]\nsweps = 1 | 11:1 solver.bodies[0].sweps | did you mean "sweeps"?
)";

constexpr const char* kOfWorldAndVideo = R"(
@world
duration = 0 | 4:12 world.duration | 0 is not > 0; give the duration in s, > 0
duration = inf | 4:12 world.duration | inf is not a finite number
drag = -0.5 | 4:8 world.drag | -0.5 is not >= 0; give the drag in 1/s, >= 0
wind = 3 | 4:8 world.wind | 3 is an integer, not [vx, vy]; give the velocity of the air in m/s
wind = 3.0 | 4:8 world.wind | 3.0 is a number with a point, not [vx, vy]; give the velocity of the air in m/s
gusts = 3 | 4:9 world.gusts | 3 is an integer, not a table; give gusts = {
gusts = { frequency = 1 } | 4:9 world.gusts.amplitude | missing; give the amplitude in m/s
gusts = { amplitude = [1, 0], frequency = 1e6 } | 4:43 world.gusts.frequency | 1000000 is not <= 1000; give the frequency in Hz, > 0 and <= 1000
gravity = [1] | 4:11 world.gravity | a list of 1, not [gx, gy]
gravity = [1, nan] | 4:15 world.gravity[1] | nan is not a finite
gravity = "down" | 4:11 world.gravity | or [gx, gy]
@video
size = 100 | 4:8 video.size | not [width, height]; give the size of the picture in px, 1 .. 16384
size = [1, 2, 3] | 4:8 video.size | this is a list of 3, not [
size = [0, 2] | 4:9 video.size[0] | 0 is not >= 1
size = [2, 2.5] | 4:12 video.size[1] | not an integer
size = [16384, 16384] | 4:8 video.size | give a smaller size | [16384, 16384] => [2000, 2000]
fps = 0 | 4:7 video.fps | 0 is out of range; give the frames per second, 0.001 .. 100000
fps = 100001 | 4:7 video.fps | 100001 is out of range
fps = "many" | 4:7 video.fps | 0.001 .. 100000, as a number of up to three decimals or as a fraction in quotes such as "30000/1001" | "many" => 12.5 ; many => 30000/1001
fps = 23.976 | 4:7 video.fps | "24000/1001"
fps = 29.97 | 4:7 video.fps | 29.97 is not exact; write "30000/1001" | 29.97 => "30000/1001"
fps = "29.97" | 4:7 video.fps | 29.97 is not exact; write "30000/1001"
fps = 16.667 | 4:7 video.fps | 16.667 is not exact; write "50/3"
fps = -12.5 | 4:7 video.fps | is out of range
fps = 3.14159265 | 4:7 video.fps | is not exact; give the frames per second
fps = "30/0" | 4:7 video.fps | "30/0" is not a fraction
fps = "0/5" | 4:7 video.fps | is out of range
fps = "1/1001" | 4:7 video.fps | is out of range
fps = "-30" | 4:7 video.fps | "-30" is not a fraction
crf = 0 | 4:7 video.crf | 0 is not >= 1; give the constant rate factor (H.264, H.265: up to 51), 1 .. 63
crf = 64 | 4:7 video.crf | 64 is not <= 63
crf = -1 | 4:7 video.crf | -1 is not >= 1
preset = "slwo" | 4:10 video.preset | did you mean "slow"?
preset = "unknown word" | 4:10 video.preset | ultrafast, superfast
codec = "libx266" | 4:9 video.codec | did you mean "libx264"?
pix = "422" | 4:7 video.pix | did you mean "420"?
threads = 65 | 4:11 video.threads | 65 is not <= 64
threads = 0 | 4:11 video.threads | 0 is not >= 1
shutter = 1.5 | 4:11 video.shutter | 1.5 is not <= 1
shutter = -0.1 | 4:11 video.shutter | -0.1 is not >= 0
subframes = 1 | 4:13 video.subframes | 1 is not >= 2
subframes = 65 | 4:13 video.subframes | 65 is not <= 64
)";

constexpr const char* kOfViews = R"(
@style
background = "clear" | 4:14 style.background | "clear" is not a colour; give a colour such as "red", "#e8c07d", "#e8c07d80" (with alpha) or "transparent" | clear => red ; clear => #e8c07d ; clear => #e8c07d80 ; clear => transparent
background = ["#000000"] | 4:14 style.background | [top, bottom]
background = ["#000000", "#00000"] | 4:26 style.background[1] | is not a colour
theme = "light" | 4:9 style.theme | give one of: dark, paper | light => paper
palette = [] | 4:11 style.palette | the list is empty; give a list of colours such as "red", "#e8c07d" | [] => ["#e8c07d"]
palette = ["#000000", "bleu"] | 4:23 style.palette[1] | "bleu" is not a colour
rope_width_px = 1001 | 4:17 style.rope_width_px | 1001 is not <= 1000
markers = "al" | 4:11 style.markers | did you mean "all"?
bars = "imaginary" | 4:8 style.bars | give one of: none, real, all
marker_radius_px = 0 | 4:20 style.marker_radius_px | 0 is not >= 0.1
color_by = "tensoin" | 4:12 style.color_by | "tensoin" is unknown; did you mean "tension"?
color_by = 3 | 4:12 style.color_by | 3 is an integer, not text
color_range = [0, 1] | 4:15 style.color_range | the colours show no quantity; give style.color_by | + color_by = "speed" ; color_range = [0, 1] =>
color_by = "speed"\ncolor_range = [3, 2] | 5:19 style.color_range[1] | 2 is not above 3; give the lower end first | [3, 2] => [2, 3]
arrow_scale = 100 | 4:15 style.arrow_scale | there are no arrows; give style.arrows | + arrows = "weight" ; arrow_scale = 100 =>
payload = false\npayload_radius = 0.1 | 5:18 style.payload_radius | there are no balls; give a rope a payload | payload = false => payload = true ; payload_radius = 0.1 =>
trail_of = [-1] | 4:12 style.trail_of | no trail without a length; give style.trail_s, or remove trail_of | + trail_s = 1 ; trail_of = [-1] =>
trail_s = 1\ntrail_of = [-1, 900] | 5:17 style.trail_of[1] | 900 is out of range; the particles of the longest rope or net are 0 .. 3 | , 900 => , 1
@camera
center = 3 | 4:10 camera.center | , not [
height = 0 | 4:10 camera.height | 0 is not >= 1e-9; give the height of the picture in m, 1e-9 .. 4e9
margin = 0.46 | 4:10 camera.margin | 0.46 is not <= 0.45
@overlay
time = 1 | 4:8 overlay.time | give true or false
tittle = "a" | 4:1 overlay.tittle | did you mean "title"?
title = 3 | 4:9 overlay.title | give the title, at the upper left as one line
title = "a\\nb" | 4:9 overlay.title | has a control character
title = "a\\u202eb" | 4:9 overlay.title | has a control character
title = "yarn \\U0001f9f6" | 4:9 overlay.title | DejaVu Sans has no U+1F9F6; name a font
title = "\\u6f22"\ntexts = [{ text = "\\u5b57" }] | 4:9 overlay.title | DejaVu Sans has no U+6F22, U+5B57; name a font
title = "\\u0633" | 4:9 overlay.title | the letters of U+0633 change next to others, which is not done; leave
font = "none.ttf" | 4:8 overlay.font | 'none.ttf' cannot be opened; give the path of a font
font = "/dev/null" | 4:8 overlay.font | '/dev/null' is no font with outlines; give a .ttf or .otf file
language = "it" | 4:12 overlay.language | "it" is unknown; give one of:  | "it" => "pt"
plots = ["angle"]\nplot_range = { energy = [0, 1] } | 5:25 overlay.plot_range.energy | the plot energy is not shown; add it to overlay.plots | "angle" => "energy" ; energy = [0, 1] =>
plots = ["phase"]\nplot_range = { angle = [1, 1] } | 5:28 overlay.plot_range.angle[1] | 1 is not above 1; give the lower end first | [1, 1] => [-1, 1]
plots = ["energy"]\nplot_range = { energy = 3 } | 5:25 overlay.plot_range.energy | , not [low, high]
plot_range = { divergence = [0, 1] } | 4:30 overlay.plot_range.divergence[0] | 0 is not >= 1e-100
energy_zero = "lowest" | 4:15 overlay.energy_zero | no energy is shown; give overlay.plots = ["energy"] | + plots = ["energy"] ; energy_zero = "lowest" =>
plots = "energy" | 4:9 overlay.plots | "energy" is a string, not a list; write ["energy"] | "energy" => ["energy"]
plots = ["tip", "tip"] | 4:17 overlay.plots[1] | the same plot twice; remove one | , "tip" =>
plots = ["divergence"] | 4:10 overlay.plots[0] | give another [[rope]] or rope.copies, or remove this plot | } }] => } }, { hang = { links = 3, length = 2.0 } }] ; "divergence" =>
@shape
points = [[0, 0], [1, 0]]\npinned = []\n[overlay]\nplots = ["angle"] | 6:10 overlay.plots[0] | pin one particle of an open rope, or remove this plot | pinned = [] => pinned = [0] ; "angle" =>
)";

TEST(SceneMessages, NamePlaceValueAndRemedy) {
    for (const char* const table :
         {kOfFiles, kOfShapes, kOfRopes, kOfNets, kOfSolvers, kOfWorldAndVideo, kOfViews})
        test::expect_scene_messages(table);
}

TEST(SceneMessages, AreWhole) {
    EXPECT_EQ(error_of(rope_with("masss = 1")).message,
              "swing.toml:4:1: rope[0].masss: unknown key \"masss\"; did you mean \"mass\"?");
    EXPECT_EQ(error_of(rope_with("mass = -1")).message,
              "swing.toml:4:8: rope[0].mass: -1 is not >= 1e-12; give the mass of a particle in kg, 1e-12 .. "
              "1e12, or a list with one per particle");
}

TEST(SceneMessages, OfRemovedKeysNameWhatReplacesThem) {
    for (const auto& [name, replacement] : all_removed()) {
        if (name.find('.') == std::string_view::npos) continue;  // a command or an option
        const std::string message = error_of(with(fmt::format("{} = 1", name))).message;
        EXPECT_THAT(message, StartsWith("swing.toml:3:"));
        EXPECT_THAT(message, HasSubstr(fmt::format(": {}: was removed; {}", name, replacement)));
    }
}

TEST(SceneMessages, OfSyntaxNameThePlace) {
    for (const auto& [toml, begin, part] : std::vector<std::array<std::string, 3>>{
             {"schema = \n", "swing.toml:1:10: ", "expected value"},
             {"schema = ,\n", "swing.toml:1:10: ", "see https://toml.io for the syntax"},
             {"[overlay]\ntitle = \"A rope\n",
              "swing.toml:2:9: ", "a text has no closing quote; end it with \""},
             {"[overlay]\ntitle = A rope # or two\n",
              "swing.toml:2:9: ", "A rope is no value; put text in quotes"},
             {"[[rope]]\nstring = True\n",
              "swing.toml:2:10: ", "True is no value; write true or false, in small letters"},
             {"[overlay]\ntitle = 1 m\n",
              "swing.toml:2:9: ", "1 m is no value; write a number without its unit"},
             {"[[rope]]\nhang = { links = 3,\nlength = 1 }\n",
              "swing.toml:2:8: ", "has no end in its own line; write it on one line"},
             {"schema = 1\nschema = 2\n", "swing.toml:2:", "cannot redefine"},
             {"a = [1,\n", "swing.toml:", "end-of-file"},
             {"schema = 1\nx = \"\xff\"\n",
              "swing.toml:2:6: ", "the byte 0xff is not UTF-8 text; save the file as UTF-8"},
             {"schema = 1\n# 80\xb0\n", "swing.toml:2:5: ", "the byte 0xb0 is not UTF-8 text"},
             {std::string("\xff\xfes\0c\0", 6),
              "swing.toml:1:1: ", "the text is UTF-16; save the file as UTF-8"},
             {std::string("\xfe\xff\0s\0c", 6), "swing.toml:1:1: ", "the text is UTF-16"},
             {std::string("s\0c\0h\0", 6), "swing.toml:1:1: ", "the text is UTF-16"},
             {"# é\nschema = \u22121\n", "swing.toml:2:10: ",
              "the character U+2212 (\u2212) has no meaning outside of quotes; write \"-\""},
             {"schema = 1\n[style]\ntheme = \u201cdark\u201d\n",
              "swing.toml:3:9: ", "U+201C (\u201c) has no meaning outside of quotes; write '\"'"},
             {"schema\u00a0= 1\n", "swing.toml:1:7: ", "U+00A0"},
             {"schema = 1\nl\u00e4nge = 1\n",
              "swing.toml:2:2: ", "U+00E4 (\u00e4) has no meaning outside of quotes; put text in quotes"},
             {"schema = 1\n[world]\nduration = -1,5\n",
              "swing.toml:3:12: ", "\"-1,5\" is no number: decimals need a point; write -1.5"},
             {"rope = [{ hang = { links = 3, length = 1,0, angle_deg = 4 } }]\n",
              "swing.toml:1:40: ", "\"1,0\" is no number: decimals need a point; write 1.0"},
             {std::string("schema\0= 1\n", 11), "swing.toml:1:", ""},
             {"schema = " + std::string(100'000, '['), "swing.toml:1:", "nest"}}) {
        EXPECT_EQ(error_of(toml).code, ExitCode::kInvalidScene);
        EXPECT_THAT(error_of(toml).message, testing::AllOf(StartsWith(begin), HasSubstr(part)));
    }
}

TEST(SceneMessages, OfASweepAreOne) {
    EXPECT_EQ(
        error_of("schema = 1\nscene = \"small.toml\"\nsamples = 12\n[vary]\n\"rope[0].mass\" = [1, 2]\n")
            .message,
        "swing.toml:1:1: this is a sweep file, not a scene; make its samples with: python3 -m corda sweep "
        "FILE -o FOLDER; or give the scene that it names");
}

TEST(SceneMessages, OfSettingsNameWhatIsMeant) {
    EXPECT_THAT(error_of(with(""), {"rope[0].hang.angle_deg=\u221240"}).message,
                HasSubstr("is a string, not a number; write -40"));
    EXPECT_THAT(error_of(with(""), {"world.duration=1,5"}).message,
                HasSubstr("decimals need a point; write 1.5"));
}

TEST(SceneMessages, DeepDottedKeysAreRefusedBeforeTheParserRecurses) {
    std::string parts = "a";
    for (int i = 0; i < 1'000'000; ++i) parts.append(".a");
    EXPECT_THAT(error_of(std::string("schema = 1 # a.b\n  ").append(parts).append(" = 1\n")).message,
                StartsWith("swing.toml:2:66: a key of more than 32 parts"));
    EXPECT_THAT(error_of(std::string("[").append(parts).append("]\n")).message,
                StartsWith("swing.toml:1:65: a key of more than 32 parts"));
    const std::string dots(100, '.');
    EXPECT_THAT(
        error_of("# " + dots + "\n" + rope_with("color = \"" + dots + "\"")).message,
        StartsWith("swing.toml:5:9: rope[0].color: \"" + dots.substr(0, 60) + "...\" is not a colour"));
}

TEST(SceneMessages, DoNotBlameColoursForAMisspeltColorBy) {
    EXPECT_THAT(error_of(rope_with("color = [\"red\"]\n[style]\ncolor_by = \"lnik\"")).message,
                testing::AllOf(HasSubstr("did you mean \"link\""), testing::Not(HasSubstr("rope[0].color"))));
}

TEST(SceneMessages, LongTitles) {
    const std::string title(1001, 'x');
    EXPECT_THAT(error_of(with("[overlay]\ntitle = \"" + title + "\"")).message,
                StartsWith("swing.toml:4:9: overlay.title: a text of 1001 bytes, over the limit of 1000"));
    EXPECT_NO_THROW(std::ignore = parse_scene(with("[overlay]\ntitle = \"" + title.substr(1) + "\""), "a"));
}

}  // namespace
}  // namespace corda::scene
