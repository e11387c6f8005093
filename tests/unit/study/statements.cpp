#include "corda/study/statements.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace corda::study {
namespace {

using testing::HasSubstr;
using testing::Not;

SwingRow row_of(double mass_kg, int reach, double rope_error, double strain, int sweeps = 1) {
    SwingRow row;
    row.def = {40, mass_kg, reach, sweeps};
    row.figures = {strain, rope_error, 0.01, 0.0, 4.0 / std::sqrt(mass_kg), {}};
    return row;
}

TEST(Statements, ChooseTheirWordsByTheFigures) {
    std::vector<SwingRow> rows;
    for (const double mass_kg : {0.1, 1.0, 10.0}) {
        for (const int reach : {1, 2, 7}) rows.push_back(row_of(mass_kg, reach, 1.0 / reach, 0.1 / mass_kg));
    }
    EXPECT_THAT(best_reach_statement(rows), HasSubstr("is 7, 7, 7, as the report found."));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("as the report found"));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("mass has no effect"));
    EXPECT_THAT(mass_statement(rows, 0.1), Not(HasSubstr("no effect")));
    EXPECT_THAT(speed_statement(rows), HasSubstr("livelier: with masses of 0.1, 1, 10 kg"));
    EXPECT_THAT(speed_statement(rows), HasSubstr("12.6, 4, 1.26 m/s, as the report found"));
    EXPECT_THAT(speed_statement(rows), HasSubstr("would be 12.6, 4, 1.26 m/s"));
    EXPECT_THAT(light_statement(rows), HasSubstr("the links stretch more, but"));

    // The opposite: few bars are best, and mass makes the rope softer.
    for (SwingRow& row : rows) row.figures.rope_error = row.def.reach;
    for (SwingRow& row : rows) row.figures.strain = row.def.mass_kg;
    for (SwingRow& row : rows) row.figures.tip_speed_m_s = row.def.mass_kg;
    EXPECT_THAT(speed_statement(rows), HasSubstr("unlike the report's finding"));
    EXPECT_THAT(best_reach_statement(rows), HasSubstr("is 1, 1, 1, unlike the report's finding."));
    EXPECT_THAT(mass_statement(rows, 1e-15), HasSubstr("unlike the report's finding"));
    EXPECT_THAT(light_statement(rows), HasSubstr("does not deteriorate, unlike the report's finding"));
    rows[2].figures.rope_error = 100.0;
    rows[2].figures.strain = 100.0;
    EXPECT_THAT(light_statement(rows), HasSubstr("the motion deteriorates, as the report found"));
}

TEST(Statements, OfSizesSweepsAndSettling) {
    std::vector<SwingRow> rows{row_of(1.0, 1, 0.1, 0.1), row_of(1.0, 1, 0.1, 0.5), row_of(1.0, 7, 0.1, 0.05)};
    rows[0].def.particles = 20;
    rows[1].def.particles = rows[2].def.particles = 100;
    EXPECT_THAT(many_particles_statement(rows), HasSubstr("as the report found"));
    rows[1].figures.strain = rows[2].figures.strain = 0.1;
    EXPECT_THAT(many_particles_statement(rows), HasSubstr("unlike the report's finding"));

    std::vector<SwingRow> passes{row_of(1.0, 7, 0.02, 0.1), row_of(1.0, 7, 0.04, 0.1, 16)};
    EXPECT_THAT(sweeps_statement(passes), HasSubstr("the error from the true rope grows from 0.02 to 0.04"));
    EXPECT_THAT(sweeps_statement(passes), HasSubstr("nearer to the rod"));
    passes[1].figures.rope_error = 0.005;
    EXPECT_THAT(sweeps_statement(passes), HasSubstr("nearer to the true rope"));

    const Settling damped{0.01, 1.0 / 60.0, 0.6, 20.0, 21.0};
    const Settling own_loss{0.0, 1.0 / 60.0, 0.0, 300.0, std::nullopt};
    EXPECT_THAT(settling_statement(std::vector{own_loss, damped}, 600.0),
                HasSubstr("the method itself loses"));
    const Settling never{0.0, 1.0 / 60.0, 0.0, std::nullopt, std::nullopt};
    EXPECT_THAT(settling_statement(std::vector{never, damped}, 600.0), HasSubstr("Only damping"));
    EXPECT_THAT(settling_statement(std::vector{never, damped}, 600.0), HasSubstr("1 of 1 settle"));
}

}  // namespace
}  // namespace corda::study
