# etalon_embed_shaders(<target> <root> <entry points>): a static library that holds each GLSL entry point below <root> as
# SPIR-V, with one function `std::span<const std::uint32_t> <target>::find(std::string_view path)` (empty when absent).
function(etalon_embed_shaders target root entry_points)
    set(out ${CMAKE_CURRENT_BINARY_DIR}/${target})
    set(includes "")
    set(rows "")
    set(headers "")
    foreach(path ${entry_points})
        string(MAKE_C_IDENTIFIER ${path} name)
        add_custom_command(OUTPUT ${out}/${name}.h
            COMMAND ${GLSLANG_VALIDATOR} --quiet --target-env vulkan1.3 -I${PROJECT_SOURCE_DIR} -g0
                --depfile ${out}/${name}.d --vn ${name} -o ${out}/${name}.h ${root}/${path}
            MAIN_DEPENDENCY ${root}/${path} DEPFILE ${out}/${name}.d
            COMMENT "Compiling shader ${path}" VERBATIM)
        list(APPEND headers ${out}/${name}.h)
        string(APPEND includes "#include \"${name}.h\"\n")
        string(APPEND rows "    if (path == \"${path}\") return ${name};\n")
    endforeach()
    file(GENERATE OUTPUT ${out}/${target}.h CONTENT
"#pragma once
#include <cstdint>
#include <span>
#include <string_view>
namespace ${target} {
/// The SPIR-V of the entry point at `path` (such as \"raster/mesh.vert\"); empty when there is none.
std::span<const std::uint32_t> find(std::string_view path);
}  // namespace ${target}
")
    file(GENERATE OUTPUT ${out}/${target}.cpp CONTENT
"#include \"${target}.h\"
namespace {
${includes}}
namespace ${target} {
std::span<const std::uint32_t> find(std::string_view path)
{
${rows}    static_cast<void>(path);
    return {};
}
}  // namespace ${target}
")
    add_library(${target} STATIC ${out}/${target}.cpp ${headers})
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${out}>)
    target_compile_features(${target} PUBLIC cxx_std_20)
endfunction()
