#include "corda/pipeline/notes.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/scene/scene.hpp"

namespace corda {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::vector<std::string> notes_of(const std::string& bodies) {
    return Film(parse_scene("schema = 1\nworld.duration = 0.2\n" + bodies, "notes")).plan().notes;
}

TEST(Notes, TellTheShareOfTheEnergyThatRigidBarsDoNotTake) {
    for (const char* const method : {"auto", "exact", "rattle", "relaxation"}) {
        const std::string solver = std::string("solver.method = \"") + method + "\"\n";
        EXPECT_THAT(
            notes_of(solver + "[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [3, 4]]\n"),
            ElementsAre(AllOf(StartsWith("rope 0: 36 % of the kinetic energy at the start, 4.5 J of 12.5 J"),
                              HasSubstr("or a compliance"))))
            << method;
    }
    EXPECT_THAT(
        notes_of("[[rope]]\nhang = { links = 1, length = 1, angle_deg = 0 }\nvelocity = [[0, 0], [0, -5]]\n"),
        ElementsAre(HasSubstr("100 % of the kinetic energy")));
}

TEST(Notes, AreSilentOnVelocityThatABodyCanHave) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [0, 4]]\n"), IsEmpty());
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [1, 1]\npinned = []\n"), IsEmpty());
    EXPECT_THAT(
        notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [3, 4]]\ncompliance = 0.01\n"),
        IsEmpty());
}

TEST(Notes, TellOfAStringThatItsLinksCannotLengthen) {
    const std::string string = "[[rope]]\nstring = true\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], ";
    EXPECT_THAT(notes_of(string + "[3, 4]]\n"), ElementsAre(HasSubstr("36 %")));
    EXPECT_THAT(notes_of(string + "[-3, 4]]\n"), IsEmpty());
}

TEST(Notes, TellOfAStringThatIsPulledIn) {
    const std::string string =
        "[[rope]]\npoints = [[0, 0], [0, -1], [0, -1], [1, -1]]\nstring = true\nlink_length = ";
    EXPECT_THAT(notes_of(string + "0.5\n"),
                ElementsAre(HasSubstr("particle 3 at [0.5, -0.5] instead of [1, -1]")));
    EXPECT_THAT(notes_of(string + "0.5\ncompliance = 1e-3\n"), IsEmpty());
    EXPECT_THAT(notes_of(string + "1.0\n"), IsEmpty());
}

TEST(Notes, TellOfAListOfVelocitiesThatMovesAPinnedParticle) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[1, 0], [0, 2]]\n"),
                ElementsAre(HasSubstr("velocity [1, 0] of particle 0 is left out")));
    // One velocity for all is that of the free ones.
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [0, 2]\n"), IsEmpty());
}

TEST(Notes, TellOfAPayloadOnAPinAndBendingWithoutAJoint) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, -1], [2, 0]]\npinned = [0, -1]\npayload = 2\n"),
                ElementsAre(HasSubstr("payload 2 kg changes nothing")));
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, -1]]\nbending = 2\n"),
                ElementsAre(HasSubstr("bending changes nothing")));
}

TEST(Notes, TellOfColoursBeyondTheLastLink) {
    EXPECT_THAT(notes_of("style.color_by = \"link\"\n[[rope]]\nhang = { links = 2, length = 1 }\n"
                         "color = [\"red\", \"blue\", \"red\"]\n"),
                ElementsAre(HasSubstr("the last 1 of 3 colours are not used")));
}

}  // namespace
}  // namespace corda
