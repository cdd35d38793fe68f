# How a room, a program and a test executable of this house are declared.

# Compiler options of every target here. Contraction off: robust predicates rely on each rounding (docs/numerics.md).
# A designated initialiser that leaves fields to their defaults is how aggregates are made here, not an oversight.
add_library(etalon_options INTERFACE)
# What is installed asks none of this of those who use it.
target_compile_options(etalon_options INTERFACE $<BUILD_INTERFACE:
    -Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-missing-field-initializers;-ffp-contract=off>)
target_include_directories(etalon_options INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/etalon>)
target_compile_features(etalon_options INTERFACE cxx_std_20)
if(ETALON_SANITIZE)
    target_compile_options(etalon_options INTERFACE -fsanitize=${ETALON_SANITIZE} -fno-omit-frame-pointer
        -fno-sanitize-recover=all)
    target_link_options(etalon_options INTERFACE -fsanitize=${ETALON_SANITIZE})
endif()
if(ETALON_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang" OR NOT ETALON_SANITIZE MATCHES "fuzzer-no-link")
        message(FATAL_ERROR "ETALON_FUZZ needs clang and ETALON_SANITIZE with fuzzer-no-link: use the preset fuzz")
    endif()
    # The mutators know the format; tracing comparisons besides costs a fifth of the speed (perf, gltf_preflight).
    target_compile_options(etalon_options INTERFACE -fno-sanitize-coverage=trace-cmp
        -fsanitize-coverage-ignorelist=${PROJECT_SOURCE_DIR}/tests/fuzz/uncounted.txt)
endif()
if(ETALON_COVERAGE)
    target_compile_options(etalon_options INTERFACE --coverage)
    target_link_options(etalon_options INTERFACE --coverage)
endif()

# etalon_program(<target>): what every program of this house gets besides its own sources.
function(etalon_program target)
    if(ETALON_SANITIZE MATCHES "address")
        target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/sanitizers/keep_loaded.cpp)
        set_target_properties(${target} PROPERTIES ENABLE_EXPORTS ON)  # dlclose must be found by the libraries
    elseif(ETALON_SANITIZE MATCHES "thread")
        target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/sanitizers/thread.cpp)
    endif()
endfunction()

# etalon_room(<name> [PUBLIC <targets>...] [PRIVATE <targets>...]): the sources of engine/<name> as etalon_<name>.
function(etalon_room name)
    cmake_parse_arguments(arg "" "" "PUBLIC;PRIVATE" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS *.cpp)
    file(GLOB headers CONFIGURE_DEPENDS *.h)
    add_library(etalon_${name} STATIC ${sources} ${headers})
    add_library(etalon::${name} ALIAS etalon_${name})
    target_link_libraries(etalon_${name} PUBLIC etalon_options ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
    set_property(GLOBAL APPEND PROPERTY ETALON_ROOMS ${name})
endfunction()

# etalon_test(<name> LABELS <labels>... ROOMS <rooms>... [SOURCES <files>...]): a GoogleTest executable test_<name> of the
# .cpp files here (or SOURCES), each case registered with CTest under LABELS.
function(etalon_test name)
    cmake_parse_arguments(arg "" "" "LABELS;ROOMS;SOURCES;PROPERTIES" ${ARGN})
    if(NOT arg_SOURCES)
        file(GLOB arg_SOURCES CONFIGURE_DEPENDS *.cpp)
    endif()
    if(NOT arg_SOURCES)
        return()
    endif()
    add_executable(test_${name} ${arg_SOURCES})
    etalon_program(test_${name})
    list(TRANSFORM arg_ROOMS PREPEND etalon_)
    target_link_libraries(test_${name} PRIVATE ${arg_ROOMS} etalon_test_support GTest::gmock GTest::gtest_main)
    gtest_discover_tests(test_${name} DISCOVERY_MODE PRE_TEST
        PROPERTIES LABELS "${arg_LABELS}" TIMEOUT 600 ${arg_PROPERTIES})
endfunction()
