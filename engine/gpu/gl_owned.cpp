#include "engine/gpu/gl_owned.h"

#include "engine/gpu/gl_commands.h"

namespace etalon::gpu {

void GlDelete::operator()(GlBuffer* buffer) const noexcept
{
    delete buffer;
}
void GlDelete::operator()(GlImage* image) const noexcept
{
    delete image;
}
void GlDelete::operator()(GlSampler* sampler) const noexcept
{
    delete sampler;
}
void GlDelete::operator()(GlPipeline* pipeline) const noexcept
{
    delete pipeline;
}
void GlDelete::operator()(GlCommands* commands) const noexcept
{
    delete commands;
}
void GlDelete::operator()(GlBindings* bindings) const noexcept
{
    delete bindings;
}

}  // namespace etalon::gpu
