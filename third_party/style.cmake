# The target `style`: clang-format over every source that git knows, then clang-tidy over every one that is compiled.
find_program(CLANG_FORMAT clang-format-14)
find_program(RUN_CLANG_TIDY NAMES run-clang-tidy-14 run-clang-tidy-14.py)
find_package(Git QUIET)
if(NOT CLANG_FORMAT OR NOT RUN_CLANG_TIDY OR NOT GIT_EXECUTABLE)
    return()
endif()
add_custom_target(style
    COMMAND ${GIT_EXECUTABLE} ls-files -z *.h *.cpp | xargs -0 ${CLANG_FORMAT} --dry-run -Werror
    COMMAND ${RUN_CLANG_TIDY} -quiet -j 2 -p ${PROJECT_BINARY_DIR} "${PROJECT_SOURCE_DIR}/(engine|tools|samples|tests)/"
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} USES_TERMINAL VERBATIM)
add_dependencies(style etalon_shaders)  # clang-tidy reads the headers that are made of them
