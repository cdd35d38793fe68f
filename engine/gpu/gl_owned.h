#pragma once
// What the classes of engine/gpu hold where a Device's work is done by OpenGL; inside, see gl_*.h.
#include <memory>

namespace etalon::gpu {

class GlBuffer;
class GlImage;
class GlSampler;
class GlPipeline;
class GlCommands;
struct GlBindings;

/// Deletes what only some files know whole.
struct GlDelete {
    void operator()(GlBuffer* buffer) const noexcept;
    void operator()(GlImage* image) const noexcept;
    void operator()(GlSampler* sampler) const noexcept;
    void operator()(GlPipeline* pipeline) const noexcept;
    void operator()(GlCommands* commands) const noexcept;
    void operator()(GlBindings* bindings) const noexcept;
};
template <class T>
using GlOwned = std::unique_ptr<T, GlDelete>;

}  // namespace etalon::gpu
