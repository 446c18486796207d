# The library, its optional adapters, and how they are installed.
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)

file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
     ${PROJECT_SOURCE_DIR}/include/surfleet/*.hpp)
list(FILTER headers EXCLUDE REGEX "include/surfleet/adapters/")

add_library(surfleet INTERFACE)
add_library(surfleet::surfleet ALIAS surfleet)
target_compile_features(surfleet INTERFACE cxx_std_20)
target_sources(surfleet INTERFACE FILE_SET HEADERS BASE_DIRS include FILES ${headers})
target_link_libraries(surfleet INTERFACE Eigen3::Eigen Threads::Threads)
set(targets surfleet)

# surfleet_adapter(name package headers...): the component surfleet::<name>, where <package> is found.
function(surfleet_adapter name package library)
  find_package(${package} QUIET)
  if(NOT TARGET ${library})
    message(STATUS "surfleet::${name}: ${package} not found, left out")
    return()
  endif()
  set(files)
  foreach(header IN LISTS ARGN)
    list(APPEND files include/surfleet/adapters/${header})
  endforeach()
  add_library(surfleet_${name} INTERFACE)
  add_library(surfleet::${name} ALIAS surfleet_${name})
  target_sources(surfleet_${name} INTERFACE FILE_SET HEADERS BASE_DIRS include FILES ${files})
  target_link_libraries(surfleet_${name} INTERFACE surfleet ${library})
  set_target_properties(surfleet_${name} PROPERTIES EXPORT_NAME ${name})
  set(targets ${targets} surfleet_${name} PARENT_SCOPE)
endfunction()

surfleet_adapter(fcl fcl fcl fcl_body.hpp fcl_body_judge.hpp fcl_mesh_judge.hpp)
surfleet_adapter(embree embree embree embree_ray_caster.hpp)
surfleet_adapter(png PNG PNG::PNG png_depth.hpp png_reader.hpp png_writer.hpp)
surfleet_adapter(zstd zstd zstd::libzstd_shared zstd_codec.hpp)

# What goes over DDS has a type, which is generated from its description, in C.
find_package(CycloneDDS QUIET)
if(TARGET CycloneDDS::ddsc)
  enable_language(C)
  idlc_generate(TARGET surfleet_fleet_message BASE_DIR ${PROJECT_SOURCE_DIR}/include
                FILES ${PROJECT_SOURCE_DIR}/include/surfleet/adapters/fleet_message.idl)
  set(types ${CMAKE_CURRENT_BINARY_DIR}/surfleet/adapters/fleet_message)
  add_library(surfleet_dds_types STATIC ${types}.c ${types}.h)
  add_dependencies(surfleet_dds_types surfleet_fleet_message_generate)
  target_link_libraries(surfleet_dds_types PUBLIC CycloneDDS::ddsc)
  set_target_properties(surfleet_dds_types PROPERTIES EXPORT_NAME dds_types POSITION_INDEPENDENT_CODE ON)
  surfleet_adapter(dds CycloneDDS CycloneDDS::ddsc dds_bodies.hpp dds_team.hpp dds_transport.hpp)
  target_link_libraries(surfleet_dds INTERFACE surfleet_dds_types)
  target_include_directories(surfleet_dds SYSTEM INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_BINARY_DIR}>)
  install(TARGETS surfleet_dds_types EXPORT surfleet_dds)
  install(FILES ${types}.h include/surfleet/adapters/fleet_message.idl
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/surfleet/adapters)
else()
  message(STATUS "surfleet::dds: CycloneDDS not found, left out")
endif()

# What takes the compiler long, compiled once: for projects that build this one along.
file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/compiled/*.cpp)
add_library(surfleet_compiled STATIC EXCLUDE_FROM_ALL ${sources})
add_library(surfleet::compiled ALIAS surfleet_compiled)
target_compile_definitions(surfleet_compiled PUBLIC SURFLEET_COMPILED)
target_link_libraries(surfleet_compiled PUBLIC surfleet)

include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/surfleet-config.cmake.in surfleet-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surfleet)
if(NOT TARGET surfleet_dds)  # nothing but headers
  set(any_machine ARCH_INDEPENDENT)
endif()
write_basic_package_version_file(surfleet-config-version.cmake COMPATIBILITY SameMinorVersion
                                 ${any_machine})
foreach(target IN LISTS targets)
  install(TARGETS ${target} EXPORT ${target} FILE_SET HEADERS)
  install(EXPORT ${target} NAMESPACE surfleet:: FILE ${target}-targets.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surfleet)
endforeach()
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/surfleet-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/surfleet-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/surfleet)
