#include <gmock/gmock.h>

#include "engine/base/error.h"
#include "engine/gl/context.h"
#include "engine/gl/handle.h"
#include "engine/gpu/probe.h"
#include "tests/gl/gl_test.h"

namespace etalon::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(GlFunctions, what_the_driver_lacks_is_named)
{
    const auto all_but_one = [](const char* name) -> void* {
        static int somewhere = 0;
        return std::string_view(name) == "glClipControl" ? nullptr : &somewhere;
    };
    try {
        gl::load_functions(all_but_one);
        FAIL() << "a function that is not there was found";
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        EXPECT_THAT(error.what(), HasSubstr("glClipControl"));
    }
}

TEST(GlContext, both_ways_lead_to_a_context_one_after_the_other)
{
    for (const gl::ContextKind kind : gl::kContextKinds) {
        const gl::Context context({.kind = kind, .on_message = {}});
        EXPECT_TRUE(context.is_current());
        EXPECT_THAT(context.renderer(), Not(IsEmpty()));
        GLint samples = 0;
        context.functions().GetIntegerv(GL_MAX_SAMPLES, &samples);
        EXPECT_GE(samples, 4);
        EXPECT_NO_THROW(gl::check(context.functions(), "glGetIntegerv"));
    }
}

TEST(GlContext, says_what_is_wrong_with_a_call)
{
    std::vector<std::string> heard;
    const gl::Context context(
        {.kind = gl::ContextKind::egl, .on_message = [&](const std::string& text) { heard.push_back(text); }});
    context.functions().Enable(GL_TEXTURE_2D_ARRAY);
    EXPECT_THAT(heard, testing::ElementsAre(HasSubstr("GL_INVALID_ENUM")));
    try {
        gl::check(context.functions(), "glEnable");
        FAIL() << "an error was passed over";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "glEnable: GL_INVALID_ENUM");
    }
}

TEST(GlContext, handles_delete_once)
{
    const gl::Context context({.kind = gl::ContextKind::egl, .on_message = {}});
    const gl::Functions& functions = context.functions();
    GLuint name = 0;
    functions.CreateBuffers(1, &name);
    gl::Buffer first(functions, name);
    gl::Buffer second = std::move(first);
    EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): that is what is asked
    EXPECT_EQ(second.get(), name);
    functions.NamedBufferStorage(name, 4, nullptr, 0);
    EXPECT_NO_THROW(gl::check(functions, "glNamedBufferStorage"));
    second = {};
    functions.NamedBufferStorage(name, 4, nullptr, 0);
    EXPECT_THROW(gl::check(functions, "glNamedBufferStorage"), Error);
}

TEST(GlDevices, every_way_has_a_row_and_one_is_chosen)
{
    const auto reports = gpu::list_devices({.backend = gpu::Backend::opengl});
    ASSERT_EQ(reports.size(), std::size(gl::kContextKinds));
    EXPECT_TRUE(reports[0].chosen);
    EXPECT_THAT(reports[0].reasons, IsEmpty());
    EXPECT_THAT(reports[1].reasons, testing::ElementsAre(HasSubstr("comes first")));
    EXPECT_THAT(reports[1].name, HasSubstr("OSMesa"));
}

TEST(GlDevices, one_that_is_not_there_is_refused_with_every_reason)
{
    try {
        const gpu::Device device({.backend = gpu::Backend::opengl, .device = "nobody's card"});
        FAIL() << device.description();
    } catch (const Error& error) {
        EXPECT_EQ(error.blame(), Blame::machine);
        EXPECT_THAT(error.what(), HasSubstr("EGL"));
        EXPECT_THAT(error.what(), HasSubstr("OSMesa"));
    }
}

class GlProbe : public GlTest {};

TEST_P(GlProbe, draws_and_computes_what_it_should)
{
    const gpu::ProbeResult result = gpu::probe(device());
    EXPECT_TRUE(result.works) << result.detail;
    EXPECT_THAT(device().description(), HasSubstr("OpenGL 4"));
    EXPECT_EQ(device().limits().samples & 5u, 5u);
}
ETALON_EVERY_WAY(GlProbe);

}  // namespace
}  // namespace etalon::test
