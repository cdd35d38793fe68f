# `cmake --install` puts the rooms, their headers, the shared shader headers, the CLI, its manual page and its completions
# in place; `find_package(etalon)` then offers etalon::<room> and etalon::etalon, which is all of them. tests/consumer
# builds a program that way.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/etalon)
set(header_folder ${CMAKE_INSTALL_INCLUDEDIR}/etalon)  # so that "engine/<room>/<file>.h" meets nobody else's engine/

get_property(rooms GLOBAL PROPERTY ETALON_ROOMS)
add_library(etalon INTERFACE)
add_library(etalon::etalon ALIAS etalon)
set(exported etalon etalon_options etalon_shaders)
foreach(room ${rooms})
    target_link_libraries(etalon INTERFACE etalon_${room})
    set_target_properties(etalon_${room} PROPERTIES EXPORT_NAME ${room})
    list(APPEND exported etalon_${room})
endforeach()
set_target_properties(etalon_options PROPERTIES EXPORT_NAME options)
set_target_properties(etalon_shaders PROPERTIES EXPORT_NAME shaders)

install(TARGETS ${exported} EXPORT etalonTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS etalon_pictures LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT etalonTargets NAMESPACE etalon:: DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/etalonConfig.cmake.in ${PROJECT_BINARY_DIR}/etalonConfig.cmake
    INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/etalonConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/etalonConfig.cmake ${PROJECT_BINARY_DIR}/etalonConfigVersion.cmake
    DESTINATION ${package_folder})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine DESTINATION ${header_folder} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/shared DESTINATION ${header_folder}/shaders FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
