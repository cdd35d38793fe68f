#include "engine/scene/knobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.h"

namespace etalon {
namespace {

using testing::HasSubstr;

TEST(Knobs, every_row_reads_back_what_it_is_set_to_and_names_what_it_trades)
{
    for (const Knob& row : knobs()) {
        RenderSettings settings;
        const std::string standard = knob_value(settings, row.name);
        set_knob(settings, row.name, standard);
        EXPECT_EQ(knob_value(settings, row.name), standard) << row.name;
        EXPECT_FALSE(row.what.empty() || row.buys.empty() || row.costs.empty()) << row.name;
        EXPECT_EQ(find_knob(row.name), &row);
    }
}

TEST(Knobs, take_their_values_and_refuse_others_with_the_range)
{
    RenderSettings settings;
    set_knob(settings, "spp", "1073741824");
    EXPECT_EQ(settings.spp, 1073741824u);
    set_knob(settings, "max-depth", "1");
    EXPECT_EQ(settings.max_depth, 1);
    set_knob(settings, "msaa", "1");
    EXPECT_EQ(settings.msaa, 1);
    set_knob(settings, "filter", "gaussian");
    EXPECT_EQ(settings.pixel_filter, PixelFilter::gaussian);
    set_knob(settings, "mipmaps", "off");
    EXPECT_FALSE(settings.mipmaps);
    set_knob(settings, "russian-roulette", "on");
    EXPECT_TRUE(settings.russian_roulette);
    struct Bad {
        const char* name;
        const char* text;
        const char* range;
    };
    for (const auto& [name, text, range] :
         {Bad{"spp", "0", "1 to 1073741824 samples/pixel"}, Bad{"spp", "1073741825", "1 to"}, Bad{"spp", "-1", "1 to"},
          Bad{"spp", "9223372036854775808", "1 to"}, Bad{"spp", "99999999999999999999", "1 to"},
          Bad{"spp", "4x", "1 to"}, Bad{"spp", "", "1 to"}, Bad{"spp", " 4", "1 to"},
          Bad{"msaa", "3", "1, 2, 4, 8 or 16"}, Bad{"filter", "triangle", "box, tent, gaussian or blackman-harris"},
          Bad{"filter", "1", "box, tent"}, Bad{"threads", "1000000", "0 to 1024"},
          Bad{"mipmaps", "maybe", "on or off"}}) {
        try {
            set_knob(settings, name, text);
            FAIL() << name << ' ' << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.exit_code(), 2);
            EXPECT_THAT(error.what(), HasSubstr(range));
            EXPECT_THAT(error.what(), HasSubstr(name));
        }
    }
    EXPECT_EQ(settings.spp, 1073741824u) << "a refused value changes nothing";
}

TEST(Knobs, check_settings_made_by_hand)
{
    RenderSettings settings;
    EXPECT_NO_THROW(check_knobs(settings));
    settings.max_depth = -3;
    EXPECT_THROW(check_knobs(settings), Error);
}

TEST(Knobs, unknown_names_are_answered_with_the_known_ones)
{
    EXPECT_EQ(find_knob("sp"), nullptr);
    try {
        knob("sp");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.mend(), HasSubstr("spp"));
    }
}

}  // namespace
}  // namespace etalon
