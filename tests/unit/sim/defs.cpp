#include "corda/sim/defs.hpp"

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(Method, IsNamedAfterItsAlgorithm) {
    EXPECT_EQ(method_name(ExactDef{}), "exact");
    EXPECT_EQ(method_name(RattleDef{}), "rattle");
    EXPECT_EQ(method_name(RelaxationDef{}), "relaxation");
}

}  // namespace
}  // namespace corda
