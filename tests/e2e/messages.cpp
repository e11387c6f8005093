// What commands say of their options and of what they read, and that remedies work.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/command.hpp"
#include "support/messages.hpp"

namespace corda {
namespace {

using test::run_corda;
using test::ScratchFolder;
using testing::HasSubstr;
using testing::Not;

const char* const kScene = R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 4, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 30
)";

// Commands: the exit code, and what the message says.
constexpr const char* kUsage = R"(
@command
pla SCENE | 2 | there is no command "pla"; did you mean plan? | pla => plan
zzzzz SCENE | 2 | known are render, still, strobe, sheet, simulate | zzzzz => plan
rendr --help | 2 | there is no command "rendr"; did you mean render? | rendr => render
help rendr | 2 | did you mean render? | rendr => render
plan | 2 | see --help | plan => plan --help ; plan => plan SCENE
render SCENE | 2 | --output
plan SCENE --duratin 0.1 | 2 | unknown option --duratin; did you mean --duration? | tin => tion
render SCENE --fsp=3 | 2 | unknown option --fsp; did you mean --fps?
render SCENE -o DIR/a.mp4 --no-such-flag | 2 | unknown option --no-such-flag
{render,still,simulate,plan,golden,compare} EMPTY -o DIR/a.mp4 | 2 | is empty
render SCENE {-o,--set,--fps,--frames,--size,--backend} EMPTY | 2 | is empty; give one, or leave it out
still SCENE -o DIR {--at,--frame} EMPTY | 2 | is empty
still SCENE -o DIR/a.png --at 0:1:0.25 | 2 | --at 0:1:0.25: is no time in s; list times such as 0,0.25,0.5 | 0:1:0.25 => 0
still SCENE -o DIR/a.png --at soon | 2 | --at soon: is no time in s; give one or more | soon => 0
help nothing_like_that | 2 | there is no help on "nothing_like_that" | nothing_like_that => codes
compare SCENE SCENE --max EMPTY | 2 | --max: "" is not a number
compare SCENE SCENE --diff EMPTY | 2 | is empty
help EMPTY | 2 | TOPIC: the value is empty
plan SCENE --duration EMPTY | 2 | give one, or leave it out | EMPTY => 0.1 ; --duration EMPTY =>
compare SCENE SCENE {--max,--mean} {nan,-inf,1e999} | 2 | is not a number within 0 .. 255
compare SCENE SCENE --share {nan,INF} | 2 | 0 .. 1
still SCENE --at 0 -o DIR/a.png --ppi {nan,INF} | 2 | 1 .. 10000
still SCENE -o DIR/a.png --at {nan,-inf,1e999} | 2 | 0 .. 0.1 s
{simulate,plan} SCENE --duration {abc,nan,-inf,0,1e99} | 2 | duration
render SCENE -o DIR/a.mp4 --fps {nan,INF,0,x} | 2 | 0.001 .. 100000
render SCENE -o DIR/a.mp4 --crf {nan,0,x} | 2 | 1 .. 63
render SCENE -o DIR/a.mp4 --crf 0 --dry-run | 2 | 1 .. 63 | --crf 0 => --crf 1 ; --crf 0 => --crf 51
render SCENE -o DIR/a.mp4 --crf 52 --dry-run | 2 | use 1 to 51 for libx264 | --crf 52 => --crf 51
render SCENE -o DIR/a.mp4 --threads {nan,1e999,99} | 2 | 1 .. 64
render SCENE -o DIR/a.mp4 --jobs -1 | 2 | video.jobs: -1 is not >= 0
watch SCENE --port 70000 | 2 | "70000" is not a number within 0 .. 65535
simulate SCENE --decimal komma | 2 | --decimal: komma not in {point,comma}
plan SCENE --duration nan | 2 | give the duration in s, > 0 | nan => 0.1
plan SCENE --size {0x10,axb,64x99999} | 2 | size
render SCENE DIR/b.mp4 | 2 | the output is named by -o | DIR/b.mp4 => -o DIR/b.mp4
render SCENE -o DIR/c.mp4 --hold 0.5 | 2 | it is a key of the scene: --set video.hold=... | --hold 0.5 => --set video.hold=0.5
plan SCENE --mass 2 | 2 | it is a key of the scene: --set rope[0].mass=... | --mass 2 => --set rope[0].mass=2
plan SCENE --set world.duration = 1 | 2 | a setting has no spaces: --set world.duration=2 | world.duration = 1 => world.duration=2
strobe SCENE --at 0 0.05 -o DIR/s.png | 2 | "0.05" was not expected; lists have commas and no spaces: --at 0,0.5 | 0 0.05 => 0,0.05
--json plan SCENE | 2 | options stand behind the command; begin with corda plan | --json plan SCENE => plan SCENE --json
plan SCENE --size 64by64 | 2 | write e.g. 1920x1080 | 64by64 => 1920x1080
plan SCENE --set video.fps | 2 | give --set key=value, e.g. --set video.fps=30 or --set rope[0].mass=2 | video.fps => video.fps=30 ; video.fps => rope[0].mass=2
plan SCENE --set rope.mass=2 | 3 | give an index: rope[0] | rope.mass => rope[0].mass
plan SCENE --set rope[1].mass=2 | 3 | index 1 is out of range; the list has 1 | rope[1] => rope[0]
plan SCENE --set {video.crf=0,world.duration=abc,video.preset=fastest,video.no=1,solver.method=magic} | 3 | --set
simulate SCENE --duration 0 --set world.drag=-1 | 3 | world.drag
plan DIR/none.toml | 6 | give the path of a TOML file | DIR/none.toml => SCENE
simulate SCENE --set solver.method=relaxation --set rope[0].velocity=[1e5,0] --set solver.force=[1e300,0] | 8 | less speed or force may help, or a smaller solver.step | [1e300,0] => [1,0]
simulate SCENE --set solver.method=relaxation --set rope[0].mass=[1,1,1,1,1e-12] --set solver.force=[0,-1e6] | 8 | less unequal masses of free particles (they differ by a factor of 1e+12) | 1e-12 => 1
simulate SCENE -o - --json | 2 | give the CSV a file name | -o - => -o DIR/a.csv
)";

// Files.
constexpr const char* kFiles = R"(
@command
render DIR/none.toml -o DIR/a.mp4 | 6 | none.toml
still DIR/none.toml --at 0 -o DIR/a.png | 6 | none.toml
simulate DIR/none.toml | 6 | none.toml
compare DIR/a.png DIR/b.png | 6 | a.png
simulate SCENE -o DIR/a.npy | 2 | give such a name, or - for CSV on standard output | a.npy => a.csv ; DIR/a.npy => - ; DIR/a.npy => /dev/null
still SCENE --at 0 -o DIR/a.v2 --dry-run | 2 | stills are written as .png, .svg or .pdf; give such a name, or a folder (ending with / if its name has a dot) | a.v2 => a.png ; a.v2 => a.svg ; a.v2 => a.pdf ; a.v2 => a ; a.v2 => a.v2/
still SCENE --at 0 -o {DIR/x.eps,DIR/x.jpg,-} | 2 | .png
still SCENE --at 0,0.1 -o DIR/a.png --dry-run | 2 | give a folder | a.png => a
render SCENE -o DIR/a.txt --dry-run | 2 | use .mp4 | a.txt => a.mp4
render SCENE -o DIR/x.MP4 | 2 | write it in lower case: .mp4 | .MP4 => .mp4
render SCENE -o DIR/a.png --dry-run | 2 | use e.g. frames/%04d.png | a.png => frames/%04d.png
render SCENE -o DIR/none/a.mp4 --dry-run | 6 | does not exist; make it first | none/ =>
simulate SCENE -o DIR | 6 | give the name of a file, not of a folder | -o DIR => -o DIR/a.csv
render SCENE -o /proc/a.mp4 | 6 | /proc
still SCENE --at 0 -o /proc/a.png | 6 | /proc
simulate SCENE -o /proc/a.csv | 6 | /proc
compare PICTURE PICTURE --diff DIR/c.jpg | 2 | the picture is written as .png; give such a name | c.jpg => c.png
)";

// Times and frames.
constexpr const char* kTimes = R"(
@command
still SCENE -o DIR | 2 | --at
still SCENE --at 5 -o DIR/a.png --dry-run | 2 | is not within 0 .. 0.1 s; world.duration sets the end | --at 5 => --at 0 ; --at 5 => --at 0.1 ; --at 5 => --at 5 --set world.duration=5
still SCENE --frame 99 -o DIR/a.png --dry-run | 2 | the frames are 0 to 2, all of them the range 0:3; world.duration sets the end | --frame 99 => --frame 2 ; --frame 99 -o DIR/a.png => --frame 0:3 -o DIR/a ; --frame 99 => --frame 99 --set world.duration=5
still SCENE --frame {3,1:4,2:2,2:1,-1:2,3:,1:2:3,x,1.5,:-1} -o DIR/a | 2 | --frame
still SCENE --at 0,0 -o DIR/a --dry-run | 2 | ask for each time once | 0,0 => 0
still SCENE --duration 10000 --frame :100001 -o DIR/many --dry-run | 2 | corda render
sheet SCENE --frame 0:6:2 -o DIR/a.png | 2 | is neither a frame number nor a range FIRST:END of them; a range has no step: list frames such as 0,24,48
sheet SCENE --frame 0:3 --size 100x64 -o DIR/a.png --dry-run | 2 | (each takes 40 at least), 2 have; ask for fewer times or a larger size | 0:3 => 0:2 ; 100x64 => 200x100
render SCENE -o DIR/a.mp4 --frames 3:2 | 2 | frames 3:2 are not FIRST:END with 0 <= FIRST < END <= 3
)";

// Formats and drivers.
constexpr const char* kFormats = R"(
@command
render SCENE --size 65x64 -o DIR/a.mp4 --dry-run | 2 | use a width of 64 or 66 | 65x64 => 64x64 ; 65x64 => 66x64
render SCENE --preset {fastest,5} -o DIR/a.mp4 --dry-run | 2 | preset
render SCENE --preset slooow -o DIR/a.mp4 --dry-run | 2 | medium, slow, slower | slooow => slow
render SCENE --crf 20 -o DIR/a.mkv --dry-run | 2 | has no rate factor; leave it out | --crf 20 =>
render SCENE --preset slow --codec av1 -o DIR/a.mp4 --dry-run | 2 | unknown to libsvtav1; use one of 0, 1 | --preset slow => --preset 0
render SCENE --fps 60 -o DIR/a.gif --dry-run | 2 | use 50 (--fps 50) | --fps 60 => --fps 50
render SCENE --fps 1/1000 --duration 2000 -o DIR/a.gif --dry-run | 2 | use 20/13107 (--fps 20/13107) | --fps 1/1000 => --fps 20/13107
render SCENE --pix 420 -o DIR/a.mkv --dry-run | 2 | use rgba, another codec, or leave it out | --pix 420 => --pix rgba ; --pix 420 =>
render SCENE --size 66x66 --codec vp9 -o DIR/a.mp4 --dry-run | 2 | use libx264, libsvtav1, libx265, libaom-av1, h264_nvenc | vp9 => libx264 ; vp9 => libsvtav1 ; vp9 => libx265
render SCENE {--codec,--pix} {x,5} -o DIR/a.mp4 | 2 | give one of
render SCENE --codec av1 --size 32x32 -o DIR/a.mp4 --dry-run | 2 | use sides of 64 or more | 32x32 => 64x64
render SCENE --set style.background=transparent -o DIR/x.mp4 | 2 | style.background: "#00000000" is transparent, and H.264 in MP4 cannot be; give an opaque colour (--set style.background=#ffffff), draw stills as .png, or a video as .webm, .mov, .mkv, .gif | =transparent => =#ffffff ; render SCENE => still SCENE --at 0 & x.mp4 => x.png ; x.mp4 => x.webm ; x.mp4 => x.mov ; x.mp4 => x.mkv ; x.mp4 => x.gif & SCENE => SCENE --fps 50
render SCENE --set style.background=transparent -o DIR/x.webm --codec av1 | 2 | AV1 in WebM cannot be; give an opaque colour (--set style.background=#ffffff), or leave out video.codec and video.pix, as another encoder can | =transparent => =#ffffff ; --codec av1 =>
render SCENE --backend magic -o DIR/a.mp4 --dry-run | 2 | use auto, device, device:N, surfaceless or default | magic => auto ; magic => device ; magic => device:0 ; magic => surfaceless ; magic => default
render SCENE --backend device:63 -o DIR/a.mp4 | 4 | no such EGL device
still SCENE --at 0 --backend device:63 -o DIR/a.png | 4 | no such EGL device
)";

/// The commands of a line: `{a,b}` stands for one of each.
std::vector<std::string> expanded(const std::string& line) {
    const std::size_t begin = line.find('{');
    if (begin == std::string::npos) return {line};
    const std::size_t end = line.find('}', begin);
    std::vector<std::string> lines;
    std::istringstream words(line.substr(begin + 1, end - begin - 1));
    for (std::string word; std::getline(words, word, ',');) {
        for (std::string& rest : expanded(line.substr(end + 1)))
            lines.push_back(line.substr(0, begin) + word + std::move(rest));
    }
    return lines;
}

void replace_all(std::string& text, const std::string& was, const std::string& is) {
    for (std::size_t at = text.find(was); at != std::string::npos; at = text.find(was, at + is.size()))
        text.replace(at, was.size(), is);
}

/// Runs a command, in which SCENE is a scene file, DIR its folder, PICTURE a PNG file, and EMPTY an empty
/// word.
test::CommandResult run(const std::string& command, const test::ScratchFolder& folder) {
    std::istringstream words(command);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) {
        // In this order, because the random name of a scratch folder may contain "DIR".
        replace_all(word, "SCENE", "DIR/scene.toml");
        replace_all(word, "DIR", folder.path());
        replace_all(word, "PICTURE", CORDA_GOLDENS "/stills/plain_t0000_700000.png");
        arguments.push_back(word == "EMPTY" ? "" : word);
    }
    return run_corda(arguments);
}

void expect_messages(const char* table) {
    for (const test::Message& message : test::messages_of(table)) {
        for (const std::string& command : expanded(message.input)) {
            SCOPED_TRACE(command);
            const test::ScratchFolder folder;
            test::write_file(folder.file("scene.toml"), kScene);
            const test::CommandResult failed = run(command, folder);
            EXPECT_EQ(failed.exit_code, std::stoi(message.place)) << failed.err;
            EXPECT_THAT(failed.err, HasSubstr(message.text));
            EXPECT_THAT(folder.files(), testing::ElementsAre("scene.toml"));
        }
        for (const std::string& command : message.remedied) {
            const test::ScratchFolder folder;
            test::write_file(folder.file("scene.toml"), kScene);
            const test::CommandResult result = run(command, folder);
            EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.err;
        }
    }
}

TEST(CommandMessages, NameTheValueAndRemediesThatWork) {
    for (const char* const table : {kUsage, kFiles, kTimes, kFormats}) expect_messages(table);
}

class Messages : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 2, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 20
)");
    std::string video_ = folder_.file("out.mp4");
};

TEST_F(Messages, WarnOfTextsThatNoFrameShows) {
    const auto told = [&](const std::string& from) {
        return run_corda({"plan", scene_, "--set", "overlay.texts=[{text='a'},{text='b',from=" + from + "}]"})
            .err;
    };
    EXPECT_THAT(told("1.0"),
                HasSubstr("scene.toml: overlay.texts[1].from: 1 s is not before the end of the film "
                          "at 1 s, so that no frame shows the text; give an earlier time, or a "
                          "longer world.duration"));
    EXPECT_THAT(told("0.9"), Not(HasSubstr("overlay.texts")));
    EXPECT_THAT(told("0.5,to=0.9,fade=0.3"), HasSubstr("overlay.texts[1].fade: 0.3 s is too long for a text "
                                                       "that is there for 0.4 s, so that it is never "
                                                       "fully visible; give at most 0.2"));
    EXPECT_THAT(told("0.5,to=0.9,fade=0.19"), Not(HasSubstr("overlay.texts")));
    EXPECT_THAT(told("0.5,fade=0.5"), Not(HasSubstr("overlay.texts")));
}

TEST_F(Messages, WarnOfEventsAfterTheEnd) {
    const auto told = [&](const std::string& setting) {
        return run_corda({"plan", scene_, "--set", setting}).err;
    };
    EXPECT_THAT(
        told("rope[0].cut=[{link=0,t=0.5},{link=1,t=1.0}]"),
        HasSubstr("scene.toml: rope[0].cut[1].t: 1 s is not before the end of the film at 1 s, so that "
                  "nothing happens; give an earlier time, or a longer world.duration"));
    EXPECT_THAT(told("rope[0].release=[{pin=0,t=3}]"), HasSubstr("rope[0].release[0].t: 3 s is"));
    EXPECT_THAT(told("rope[0].moves=[{pin=0,path=[{t=2,by=[0,0]},{t=3,by=[1,0]}]}]"),
                HasSubstr("rope[0].moves[0].path[0].t: 2 s is"));
    EXPECT_THAT(told("camera.path=[{t=0,height=1},{t=1.5,height=2},{t=2,height=3}]"),
                HasSubstr("camera.path[1].t: 1.5 s is"));
    EXPECT_THAT(told("camera.path=[{t=0,height=1},{t=1.5,height=2}]"), Not(HasSubstr("end of the film")));
    EXPECT_THAT(told("rope[0].cut=[{link=0,t=0.9}]"), Not(HasSubstr("end of the film")));
}

TEST_F(Messages, WarnOncePerFilmOfPlotsWithoutRoom) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"still", scene_, "--at", "0,0.1", "-o", folder_.file("a")},
                                               {"render", scene_, "-o", folder_.file("a.mp4")}}) {
        std::vector<std::string> words = command;
        words.insert(words.end(), {"--set", "overlay.plots=['energy']"});
        const std::string told = run_corda(words).err;
        const std::string warning =
            "scene.toml: overlay.plots: \"energy\" has little room in 64x64 pixels and is left out";
        EXPECT_THAT(told, HasSubstr(warning));
        EXPECT_EQ(told.find(warning), told.rfind(warning));
    }
}

TEST_F(Messages, CallStandardOutputByItsName) {
    const auto full = test::run_shell(test::quoted(CORDA_PROGRAM) + " simulate " + test::quoted(scene_) +
                                      " -o - > /dev/full");
    EXPECT_EQ(full.exit_code, 6);
    EXPECT_THAT(full.err, HasSubstr("cannot write to 'standard output': No space left on device"));
}

TEST_F(Messages, ShowTenNotesOfAPlanAndCountTheRest) {
    const std::string scene = folder_.write("notes.toml", R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 1, length = 1.0 }
velocity = [0.0, -1.0]
copies = { count = 12, angle_deg = 1.0 }
)");
    const std::string told = run_corda({"plan", scene}).err;
    EXPECT_THAT(told, HasSubstr("rope 9: "));
    EXPECT_THAT(told, Not(HasSubstr("rope 10: ")));
    EXPECT_THAT(told, HasSubstr("2 more, which `corda plan --json` lists as notes"));
    EXPECT_EQ(nlohmann::json::parse(run_corda({"plan", scene, "--json"}).out)["notes"].size(), 12U);
}

TEST_F(Messages, PlanNamesCopiesAndLabelsEach) {
    const std::string scene = folder_.write("copies.toml", R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 1, length = 1.0 }
label = "first"
copies = { count = 3, angle_deg = 1.0 }
[[rope]]
hang = { links = 1, length = 1.0 }
label = "last"
[[rope]]
points = [[0, 0], [1, 0]]
[[solver.bodies]]
ropes = [4]
method = "relaxation"
)");
    EXPECT_THAT(run_corda({"plan", scene}).out, HasSubstr("first, rope 1 to rope 2, last"));
}

TEST_F(Messages, SimulateStatesThePeriodsOfRopesThatSwingEvenly) {
    const std::string scene = folder_.write("ropes.toml", R"(schema = 1
[world]
duration = 6.0
[[rope]]
hang = { links = 20, length = 1.0, angle_deg = 160.0 }
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 90.0 }
label = "pendulum"
[[rope]]
points = [[0, 0], [1, 0]]
pinned = []
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 90.0 }
release = [{ pin = 0, t = 1.0 }]
[[net]]
grid = { columns = 2, rows = 2, spacing = 0.1 }
)");
    const auto ropes = nlohmann::json::parse(run_corda({"simulate", scene, "--json"}).out)["ropes"];
    ASSERT_EQ(ropes.size(), 4U);
    EXPECT_GT(ropes[0]["passages_s"].size(), 3U);
    EXPECT_TRUE(ropes[0]["period_s"].is_null());
    EXPECT_NE(ropes[0]["period_reason"], nullptr);
    EXPECT_EQ(ropes[1]["body"], "pendulum");
    EXPECT_NEAR(ropes[1]["period_s"].get<double>(), 2.3678419475762374, 1e-6);  // R1
    EXPECT_TRUE(ropes[1]["period_reason"].is_null());
    EXPECT_NEAR(ropes[1]["passages_s"].at(0).get<double>(), 2.3678419475762374 / 4.0, 1e-6);
    EXPECT_EQ(ropes[2]["period_reason"], "there is no pin, or several");
    EXPECT_EQ(ropes[3]["passages_s"].size(), 1U);
    EXPECT_EQ(ropes[3]["period_reason"], "fewer than three passages below the pin");
}

TEST_F(Messages, SimulateWarnsOfColumnsOfNoFile) {
    for (const char* const option : {"--tension", "--decimal=comma"}) {
        const auto result = run_corda({"simulate", scene_, option});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_THAT(result.err, HasSubstr("change the file of -o alone; add -o FILE")) << option;
        EXPECT_THAT(run_corda({"simulate", scene_, option, "-o", "-"}).err, Not(HasSubstr("add -o FILE")));
    }
    EXPECT_THAT(run_corda({"simulate", scene_}).err, Not(HasSubstr("add -o FILE")));
}

TEST(UnknownTensions, HaveACauseAndARemedyThatHelps) {
    const ScratchFolder folder;
    const std::string plate =
        folder.write("plate.toml",
                     "schema = 1\n[world]\nduration = 0.1\n[[net]]\npinned = [0]\n"
                     "grid = { columns = 3, rows = 3, spacing = 0.1, diagonals = true }\n");
    const auto warning = [&](const std::string& setting) {
        return run_corda({"simulate", plate, "-o", "-", "--tension", "--set", setting}).err;
    };
    EXPECT_THAT(warning("solver.method=auto"),
                testing::AllOf(testing::HasSubstr("bars that depend on each other"),
                               testing::Not(testing::HasSubstr("relaxation"))));
    EXPECT_THAT(warning("net[0].compliance=1e-3"), testing::Not(testing::HasSubstr("--tension")));
    const std::string relaxed = warning("solver.method=relaxation");
    EXPECT_THAT(relaxed, testing::AllOf(testing::HasSubstr("another solver.method gives them"),
                                        testing::Not(testing::HasSubstr("compliance"))));
}

TEST(ImmobileNets, AreReportedUntilTheAdviceIsFollowed) {
    using testing::HasSubstr;
    using testing::Not;
    const ScratchFolder folder;
    const std::string plate = folder.write("plate.toml",
                                           "schema = 1\n[[net]]\ngrid = { columns = 5, rows = 4, spacing = "
                                           "0.1, diagonals = true }\n[world]\nduration = 0.2\n");
    EXPECT_THAT(run_corda({"plan", plate}).err, HasSubstr("net 0 stands still: its bars make it a plate"));
    for (const char* advice : {"net[0].pinned=[0]", "net[0].compliance=1e-3", "solver.method=relaxation"}) {
        const auto result = run_corda({"plan", plate, "--set", advice});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_THAT(result.err, Not(HasSubstr("stands still"))) << advice;
    }
    // A curtain whose top row is straight between its pins.
    const auto curtain = [&](const std::string& advice) {
        return run_corda({"plan", plate, "--set", "net[0].grid.diagonals=false", "--set", advice}).err;
    };
    EXPECT_THAT(curtain("net[0].pinned=[0, 4]"),
                HasSubstr("net 0 stands still: it hangs from a straight row"));
    for (const char* advice :
         {"net[0].pinned=[0]", "net[0].compliance=1e-3", "net[0].pinned=[0, 1, 2, 3, 4]"})
        EXPECT_THAT(curtain(advice), Not(HasSubstr("stands still"))) << advice;
    // With a string, which relaxation cannot move.
    const std::string scene =
        test::read_file(plate) + "[[rope]]\nhang = { links = 2, length = 1.0 }\nstring = true\n";
    const std::string both = folder.write("both.toml", scene);
    EXPECT_THAT(run_corda({"plan", both}).err,
                HasSubstr("or give it method relaxation in [[solver.bodies]]"));
    const std::string mixed =
        folder.write("mixed.toml", scene + "[[solver.bodies]]\nnets = [0]\nmethod = 'relaxation'\n");
    const auto result = run_corda({"plan", mixed});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("stands still")));
}

}  // namespace
}  // namespace corda
