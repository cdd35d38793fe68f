// Read by C++ and by GLSL: names the scalar and vector types of shared structs alike in both.
// GLSL includers enable GL_EXT_scalar_block_layout and declare their blocks `scalar`.
#ifndef ETALON_SHADERS_SHARED_TYPES_H
#define ETALON_SHADERS_SHARED_TYPES_H
#ifdef __cplusplus
#include <cstdint>

#include "engine/math/types.h"
#define ETALON_SHARED_BEGIN namespace etalon::shared {
#define ETALON_SHARED_END }
#define ETALON_INOUT(type) type&
#define ETALON_FUNCTION inline
#define ETALON_CONSTANT inline constexpr
namespace etalon::shared {
using uint = std::uint32_t;
}
#else
#define ETALON_SHARED_BEGIN
#define ETALON_SHARED_END
#define ETALON_INOUT(type) inout type
#define ETALON_FUNCTION
#define ETALON_CONSTANT const
#endif
#endif
