#include "engine/image/post.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/base/error.h"

namespace etalon {
namespace {

using ::testing::HasSubstr;

std::string complaint(const std::string& text)
{
    try {
        parse_post(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::input);
        return error.message();
    }
    return "none";
}

TEST(PostChain, reads_passes_in_order_with_their_parameters)
{
    const PostChain chain = parse_post("sobel,bilateral:sigma_s=3.5,sigma_r=inf,method=grid,tone:curve=agx");
    ASSERT_EQ(chain.size(), 3u);
    EXPECT_EQ(chain[0].kind, PostKind::sobel);
    EXPECT_EQ(chain[1]["sigma_s"], 3.5);
    EXPECT_TRUE(std::isinf(chain[1]["sigma_r"]));
    EXPECT_TRUE(chain[1].is("method", "grid"));
    EXPECT_TRUE(chain[2].is("curve", "agx"));
}

TEST(PostChain, what_is_left_out_has_the_tables_value)
{
    for (const PostPass& pass : post_passes()) {
        const PostChain chain = parse_post(pass.name);
        for (std::size_t i = 0; i < pass.parameters.size(); ++i)
            EXPECT_EQ(value_text(pass.parameters[i], chain[0].values[i]),
                      value_text(pass.parameters[i], pass.parameters[i].standard));
    }
    EXPECT_TRUE(parse_post("exposure")[0].is("ev", "auto"));
    EXPECT_FALSE(parse_post("exposure:ev=1")[0].is("ev", "auto"));
}

TEST(PostChain, says_itself_so_that_it_reads_itself)
{
    const std::string text = describe(parse_post("exposure,bilateral:sigma_r=0.25,method=separable,bloom,tone"));
    EXPECT_EQ(describe(parse_post(text)), text);
    EXPECT_THAT(text, HasSubstr("exposure:ev=auto,bilateral:sigma_s=3,sigma_r=0.25,method=separable,"));
}

TEST(PostChain, names_the_nearest_to_what_is_misspelt_and_the_range_of_what_is_out_of_it)
{
    EXPECT_THAT(complaint("sobell"), HasSubstr("did you mean sobel?"));
    EXPECT_THAT(complaint("bilateral:sigma_z=1"), HasSubstr("did you mean sigma_"));
    EXPECT_THAT(complaint("xyzzy"), HasSubstr("there are exposure, vignette"));
    EXPECT_THAT(complaint("gaussian:width=1"), HasSubstr("it takes sigma"));
    EXPECT_THAT(complaint("gaussian:sigma=1001"), HasSubstr("0 to 1000 pixels"));
    EXPECT_THAT(complaint("median:radius=1.5"), HasSubstr("a whole number from 0 to 5 pixels"));
    EXPECT_THAT(complaint("bilateral:method=fast"), HasSubstr("exact, separable or grid"));
    EXPECT_THAT(complaint("exposure:ev=bright"), HasSubstr("-100 to 100 EV or auto"));
}

TEST(PostChain, refuses_what_is_no_chain)
{
    for (const char* text :
         {"", ",", "sobel,", ",sobel", "sobel:", "sobel:gain", "sobel:gain=", "sigma=1", ":", "=", "gaussian:sigma=nan",
          "gaussian:sigma=-1", "gaussian:sigma=1e999", "gaussian:sigma=1x", "exposure:ev=inf", "sobel gaussian"})
        EXPECT_NE(complaint(text), "none") << text;
    std::string many = "sobel";
    for (int i = 0; i < 70; ++i) many += ",sobel";
    EXPECT_THAT(complaint(many), HasSubstr("more than 64 passes"));
}

TEST(PostPasses, every_row_says_what_it_is_and_holds_its_own_standard)
{
    for (const PostPass& pass : post_passes()) {
        EXPECT_FALSE(pass.what.empty()) << pass.name;
        EXPECT_EQ(&post_pass(pass.kind), &pass);
        for (const PostParameter& parameter : pass.parameters) {
            EXPECT_FALSE(parameter.what.empty()) << parameter.name;
            const std::string text = std::string(pass.name) + ":" + std::string(parameter.name) + "=" +
                                     value_text(parameter, parameter.standard);
            EXPECT_EQ(complaint(text), "none") << text;
        }
    }
}

TEST(PostPasses, the_page_about_them_has_the_tables_rows)
{
    std::ifstream file(std::filesystem::path(__FILE__).parent_path() / "../../../docs/post.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    ASSERT_FALSE(page.empty());
    for (const PostPass& pass : post_passes()) {
        EXPECT_THAT(page, HasSubstr("| `" + std::string(pass.name) + "` | " + std::string(pass.what) + " |"));
        for (const PostParameter& parameter : pass.parameters)
            EXPECT_THAT(page, HasSubstr("| `" + std::string(pass.name) + "` | `" + std::string(parameter.name) +
                                        "` | " + value_text(parameter, parameter.standard) + " | " +
                                        range_of(parameter) + " | " + std::string(parameter.what) + " |"));
    }
}

}  // namespace
}  // namespace etalon
