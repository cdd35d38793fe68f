// The bilateral grid (IP-9): cells hold colour times weight, and weight.
#include "shaders/shared/post.h"

layout(set = 0, binding = 6, scalar) buffer Cells { vec4 cells[]; };
layout(push_constant, scalar) uniform Push { PostGrid push; };

int cell(ivec3 at) { return (at.z * push.cells.y + at.y) * push.cells.x + at.x; }

// Where a luminance lies along the grid: what is brighter than its end counts as its end.
float level(float y) { return clamp(y * push.inverse_r, 0.0, float(kPostGridLevels - 1)); }
