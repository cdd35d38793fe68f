#pragma once
#include <gtest/gtest.h>

#include <string>

#include "engine/base/error.h"

namespace etalon::test {

/// The message of the Error that `action` throws; fails the test when it throws none, or blames another.
template <typename Action>
std::string message_of(const Action& action, Blame blame = Blame::input)
{
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), blame) << error.message();
        return error.message();
    }
    ADD_FAILURE() << "no Error was thrown";
    return {};
}

}  // namespace etalon::test
