#include "corda/core/cancel.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/failure.hpp"

namespace corda {
namespace {

TEST(CancelScope, IsAskedInProportionToTheWork) {
    std::uint64_t asked = 0;
    const CancelScope count([&asked] { ++asked; });
    check_cancelled();
    count_work(kUpdatesPerCheck - 1);
    EXPECT_EQ(asked, 1U);
    count_work(1);
    EXPECT_EQ(asked, 2U);
    for (std::uint64_t i = 0; i < 10 * kUpdatesPerCheck; ++i) count_work(1);
    EXPECT_EQ(asked, 12U);
    count_work(100 * kUpdatesPerCheck);
    EXPECT_EQ(asked, 13U);
}

TEST(CancelScope, EndsTheWorkByAnErrorOrTheExceptionOfTheCallback) {
    {
        const CancelScope no([] { return false; });
        EXPECT_EQ(test::code_of([] { check_cancelled(); }), ExitCode::kInterrupted);
        EXPECT_EQ(test::code_of([] { count_work(kUpdatesPerCheck); }), ExitCode::kInterrupted);
    }
    const CancelScope fails([]() -> bool { throw std::runtime_error("enough"); });
    EXPECT_THROW(check_cancelled(), std::runtime_error);
    EXPECT_THROW(check_cancelled(), std::runtime_error);  // an exception removes no scope
}

TEST(CancelScope, HoldsForItsLifeOnItsThreadAlone) {
    std::optional<CancelScope> no(std::in_place, [] { return false; });
    std::jthread([] { EXPECT_NO_THROW(check_cancelled()); });
    EXPECT_THROW(check_cancelled(), Error);
    no.reset();
    EXPECT_NO_THROW(check_cancelled());
    const CancelScope nothing({});
    EXPECT_NO_THROW(check_cancelled());
}

TEST(CancelScopes, AreAskedFromTheOutermostToTheInnermost) {
    std::vector<int> order;
    const auto note = [&order](int number) {
        return [&order, number] {
            order.push_back(number);
            return true;
        };
    };
    const CancelScope first(note(1));
    const CancelScope second(note(2));
    check_cancelled();
    EXPECT_EQ(order, (std::vector<int>{1, 2}));
    {
        const CancelScope alone(note(3), CancelScope::Outer::kIgnored);
        const CancelScope inner(note(4));
        check_cancelled();
    }
    EXPECT_EQ(order, (std::vector<int>{1, 2, 3, 4}));
}

TEST(CancelScopes, AreNotAskedInsideOfACallback) {
    int asked = 0;
    const CancelScope outer([&asked] {
        check_cancelled();
        return ++asked > 0;
    });
    report_progress(
        [](std::int64_t done, std::int64_t total) {
            bool is_own_asked = false;
            const CancelScope own([&] { is_own_asked = true; });
            check_cancelled();
            return is_own_asked && done < total;
        },
        1, 2);
    EXPECT_EQ(asked, 1);  // by report_progress(), after its callback
    const auto stop = [](std::int64_t, std::int64_t) { return false; };
    EXPECT_EQ(test::code_of([&] { report_progress(stop, 1, 2); }), ExitCode::kInterrupted);
}

}  // namespace
}  // namespace corda
