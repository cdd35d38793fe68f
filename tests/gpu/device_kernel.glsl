// What every test kernel begins with: test::run_kernel of tests/gpu/device_test.h.
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; };

/// The row of the table that this invocation computes; return at once when it is `count` or more.
uint kernel_index() { return gl_GlobalInvocationID.x; }
